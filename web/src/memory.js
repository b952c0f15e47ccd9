// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
import {codes, MorulaError} from './errors.js';

/** Calls of the C interface of one module, and its memory. */
export class Memory {
  #exports;
  #fault = null;
  #data = null;

  constructor(exports) {
    this.#exports = exports;
  }

  get buffer() {
    return this.#exports.memory.buffer;
  }
  /** The memory as numbers. Growth detaches it, so it is made again. */
  get data() {
    if (this.#data?.buffer !== this.buffer) this.#data = new DataView(this.buffer);
    return this.#data;
  }
  /** Throws unless the module has a function. */
  require(name) {
    if (!(name in this.#exports)) throw new MorulaError(`this module has no ${name}: load the variant "full"`);
  }

  /** Calls a function that returns no status: a count or an address, as a number from 0. */
  get(name, ...given) {
    if (this.#fault) throw new MorulaError(`the module has failed before: ${this.#fault.message}`, 'internal');
    this.require(name);
    try {
      return this.#exports[name](...given) >>> 0;
    } catch (fault) {
      // A trap leaves the module in the middle of a change.
      this.#fault = fault;
      throw new MorulaError(`the module failed: ${fault.message}`, 'internal');
    }
  }
  /** Calls a function that returns a status, and throws a MorulaError unless it is 0. */
  call(name, ...given) {
    const status = this.get(name, ...given);
    if (status !== 0) throw new MorulaError(this.text(this.get('morula_message')), codes[status]);
  }
  /** The same for a function that writes a handle through its last pointer. */
  make(name, ...given) {
    return this.withBlock(4, (result) => {
      this.call(name, ...given, result);
      return this.data.getUint32(result, true);
    });
  }

  allocate(size) {
    const begin = size < 2 ** 32 ? this.get('malloc', Math.max(size, 8)) : 0;
    if (begin === 0) throw new MorulaError(`${size} bytes are more than the module's memory has`, 'out_of_memory');
    return begin;
  }
  free(begin) {
    if (!this.#fault) this.get('free', begin);
  }
  /** Runs a function with a block of memory, which is freed afterwards. */
  withBlock(size, use) {
    const begin = this.allocate(size);
    try {
      return use(begin);
    } finally {
      this.free(begin);
    }
  }
  /** The same with texts that end with 0. */
  withTexts(texts, use) {
    const bytes = texts.map((text) => new TextEncoder().encode(`${text}\0`));
    return this.withBlock(bytes.reduce((sum, one) => sum + one.length, 0), (begin) => {
      let at = begin;
      const places = bytes.map((one) => {
        new Uint8Array(this.buffer, at, one.length).set(one);
        at += one.length;
        return at - one.length;
      });
      return use(...places);
    });
  }
  /** The same with a copy of an array of numbers. */
  withNumbers(Type, given, use) {
    // A view of this memory would be lost if the block makes the memory grow.
    const numbers = given.buffer === this.buffer ? given.slice() : given;
    return this.withBlock(numbers.length * Type.BYTES_PER_ELEMENT, (begin) => {
      new Type(this.buffer, begin, numbers.length).set(numbers);
      return use(begin);
    });
  }

  text(begin) {
    const bytes = new Uint8Array(this.buffer, begin);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
}

/** A block of numbers in the module's memory. */
export class Block {
  #memory;
  #Type;
  #view = null;

  constructor(memory, Type, length, begin = memory.allocate(length * Type.BYTES_PER_ELEMENT)) {
    this.#memory = memory;
    this.#Type = Type;
    this.begin = begin;
    this.length = length;
  }
  /** The numbers, without a copy. When the memory grows, old views have length 0, and this makes a new one. */
  get view() {
    if (this.#view?.buffer !== this.#memory.buffer) this.#view = new this.#Type(this.#memory.buffer, this.begin, this.length);
    return this.#view;
  }
}
