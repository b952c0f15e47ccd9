// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The spheres of a robot's links as the reader changes them, with undo. No page and no drawing in here: tests run it alone.

const isSphere = (s) => s.length === 4 && s.every(Number.isFinite) && s[3] > 0 && s.every((x) => Math.abs(x) < 1e30);

const replaced = (list, index, value) => list.map((other, k) => (k === index ? value : other));

export class Edits {
  /** parts: of the page's joints, with the spheres of each in its own axes. */
  constructor(parts) {
    this.names = parts.map(({ name }) => name);
    this.spheres = parts.map(({ spheres }) => spheres.map((s) => s.slice()));
    /** Whether the reader changed a sphere: a new fit can leave these alone. */
    this.pinned = this.spheres.map((list) => list.map(() => false));
    this.past = [];
    this.future = [];
  }
  get changed() {
    return this.past.length > 0;
  }
  /** Another list for a part. `as`: a text; changes in a row with the same one are undone together. */
  change(part, spheres, pinned, as = null) {
    if (spheres.length === 0 || !spheres.every(isSphere)) return false;
    const last = this.past[this.past.length - 1];
    if (as === null || last?.as !== as) this.past.push({ part, spheres: this.spheres[part], pinned: this.pinned[part], as });
    this.future = [];
    this.spheres[part] = spheres;
    this.pinned[part] = pinned;
    return true;
  }
  /** The end of a drag or of typing: the next change is undone on its own. */
  seal() {
    if (this.past.length > 0) this.past[this.past.length - 1].as = null;
  }
  set(part, index, sphere, as = null) {
    return this.change(part, replaced(this.spheres[part], index, sphere), replaced(this.pinned[part], index, true), as);
  }
  add(part, sphere) {
    return this.change(part, [...this.spheres[part], sphere], [...this.pinned[part], true]);
  }
  /** False for the last sphere of a part, which has to stay. */
  remove(part, index) {
    const without = (list) => list.filter((_, k) => k !== index);
    return this.change(part, without(this.spheres[part]), without(this.pinned[part]));
  }
  /** The part that changed, or -1. */
  undo() {
    return this.move(this.past, this.future);
  }
  redo() {
    return this.move(this.future, this.past);
  }
  move(from, to) {
    const step = from.pop();
    if (!step) return -1;
    const { part } = step;
    to.push({ part, spheres: this.spheres[part], pinned: this.pinned[part], as: null });
    [this.spheres[part], this.pinned[part]] = [step.spheres, step.pinned];
    return part;
  }
  /** The text of a spheres.json, which `morula robot --keep` reads. */
  json(robot) {
    const links = this.names.flatMap((link, part) =>
      this.spheres[part].length === 0 ? [] : [{ link, spheres: this.spheres[part].map(([x, y, z, radius]) => ({ center: [x, y, z], radius })) }]);
    return `${JSON.stringify({ format: 'morula robot spheres', format_version: 1, robot, links }, null, 1)}\n`;
  }
}
