// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The values of a page that its parts share.
/** Named values with listeners: set() calls every listener with the names of the changed values. */
export class State {
  constructor(values) {
    this.values = { ...values };
    this.listeners = [];
  }
  get(name) {
    return this.values[name];
  }
  listen(f) {
    this.listeners.push(f);
  }
  set(values) {
    const changed = new Set(Object.keys(values).filter((name) => this.values[name] !== values[name]));
    if (changed.size === 0) return;
    Object.assign(this.values, values);
    for (const f of this.listeners) f(changed);
  }
}
