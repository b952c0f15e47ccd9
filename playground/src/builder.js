// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page's side of the worker. One job at a time: a new one, or cancel(), ends the one that runs.

export class Builder {
  /** source: of the worker; packed: the module, compressed and as text. onmodule(module): compiled. onfail(error). */
  constructor(source, packed, onmodule, onfail) {
    this.address = URL.createObjectURL(new Blob([source], { type: 'text/javascript' }));
    this.packed = packed;
    this.onmodule = onmodule;
    this.onfail = onfail;
    this.module = null;
    this.last = 0;
    this.job = null;
    this.start();
  }

  start() {
    this.worker = new Worker(this.address);
    this.worker.addEventListener('message', ({ data }) => this.hear(data));
    this.worker.addEventListener('error', (event) => this.hear({ id: this.job?.id ?? 0, error: event.message ?? 'the worker ended' }));
    this.worker.postMessage({ module: this.module ?? this.packed });
  }

  hear(data) {
    if (data.module) {
      this.module = data.module;
      this.packed = null;
      this.onmodule(data.module);
    } else if (data.id === 0 && data.error) {
      this.onfail(new Error(data.error));
    } else if (this.job && data.id === this.job.id) {
      if (data.share !== undefined) {
        this.job.ontold(data.share);
        return;
      }
      const { done, failed } = this.job;
      this.job = null;
      if (data.error !== undefined) {
        // The module of the worker may have no memory left.
        if (data.code === 'out_of_memory' || data.code === 'internal' || data.code === 'RangeError') this.restart();
        failed(new Error(data.code === 'out_of_memory' ? `there is not enough memory for this mesh in a page (${data.error})` : data.error));
      } else {
        done(data.made);
      }
    }
  }

  restart() {
    this.worker.terminate();
    this.start();
  }

  /** source: {shape, detail}, {file} or {mesh}; options: of build(). Resolves to {positions, facets, tree, seconds, clusters}; to null
   * if it was canceled. */
  build(source, options, ontold) {
    this.cancel();
    return new Promise((done, failed) => {
      this.job = { id: ++this.last, ontold, done, failed };
      this.worker.postMessage({ id: this.job.id, source, options });
    });
  }

  cancel() {
    if (!this.job) return;
    const { done } = this.job;
    this.job = null;
    this.restart();
    done(null);
  }
}
