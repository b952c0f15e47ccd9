// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
import {MorulaError} from './errors.js';

/** Frees what an object owned: a handle by its destroy function, blocks of memory by free. It must not hold the object. */
function release({memory, destroy, handle, blocks}) {
  if (handle !== 0) memory.get(destroy, handle);
  for (const block of blocks) memory.free(block);
}
const collected = new FinalizationRegistry((owned) => {
  try {
    release(owned);
  } catch {
    // The module has failed: all its memory goes with it.
  }
});

/** An object in the module's memory. It lives until free(), the end of its `using` block, or the garbage collector. */
export class Handle {
  #owned;

  constructor(memory, destroy, handle) {
    this.#owned = {memory, destroy, handle, blocks: []};
    collected.register(this, this.#owned, this);
  }
  /** The address of the object. Throws after free(). */
  get handle() {
    if (this.#owned.handle === 0) throw new MorulaError(`${this.constructor.name}: it has been freed`);
    return this.#owned.handle;
  }
  get memory() {
    return this.#owned.memory;
  }
  /** Frees a block together with the object. */
  own(block) {
    this.#owned.blocks.push(block.begin);
    return block;
  }
  free() {
    if (this.#owned.handle === 0) return;
    collected.unregister(this);
    const owned = {...this.#owned};
    this.#owned.handle = 0;
    this.#owned.blocks = [];
    release(owned);
  }
}
// Engines without explicit resource management have no such symbol; compilers of `using` define this one.
Object.defineProperty(Handle.prototype, Symbol.dispose ?? Symbol.for('Symbol.dispose'), {
  value() {
    this.free();
  },
});
