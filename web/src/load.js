// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
import {MorulaError} from './errors.js';
import {libraryOf} from './library.js';
import {Memory} from './memory.js';
import {systemCalls} from './system.js';

// A module of one function, () -> v128: i32.const 0, i8x16.splat.
const vectorModule = new Uint8Array([
  0, 0x61, 0x73, 0x6d, 1, 0, 0, 0, // magic, version
  1, 5, 1, 0x60, 0, 1, 0x7b, 3, 2, 1, 0, // types, functions
  10, 8, 1, 6, 0, 0x41, 0, 0xfd, 0x0f, 0x0b, // code
]);
// The same of () -> (): try, end.
const exceptionModule = new Uint8Array([
  0, 0x61, 0x73, 0x6d, 1, 0, 0, 0, 1, 4, 1, 0x60, 0, 0, 3, 2, 1, 0, 10, 8, 1, 6, 0, 0x06, 0x40, 0x19, 0x0b, 0x0b,
]);

/** Whether this engine runs modules with vector instructions. */
export const hasVectors = () => WebAssembly.validate(vectorModule);

const inNode = () => globalThis.process?.versions?.node !== undefined;

/** The URL of a text: an absolute one, or one relative to the page, or in node a path from the working directory. */
async function addressOf(text) {
  for (const base of [undefined, globalThis.location?.href]) {
    try {
      return new URL(text, base);
    } catch {
      // Relative, or the page is one of data: or blob:.
    }
  }
  if (!inNode()) throw new MorulaError(`source is ${JSON.stringify(text)}, no address: this page has none to start from`);
  const {pathToFileURL} = await import(/* webpackIgnore: true */ /* @vite-ignore */ 'node:url');
  return pathToFileURL(text);
}

/** Compiles a module from where it lies: bytes, an address, a Response, or a compiled module. */
async function compiled(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (ArrayBuffer.isView(source) || source instanceof ArrayBuffer) return WebAssembly.compile(source);
  const address = typeof source === 'string' ? await addressOf(source) : source;
  if (address instanceof URL && address.protocol === 'file:' && inNode()) {
    const {readFile} = await import(/* webpackIgnore: true */ /* @vite-ignore */ 'node:fs/promises');
    return WebAssembly.compile(await readFile(address));
  }
  const response = address instanceof Response ? address : await fetch(address);
  if (!response.ok) throw new MorulaError(`${response.url}: the module cannot be fetched (${response.status})`, 'bad_file');
  // Not compileStreaming: it fails on servers that do not know the type of .wasm files.
  return WebAssembly.compile(await response.arrayBuffer());
}

/** The bytes of a module that is text. */
export const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

/** Loads a module, and returns its classes and functions. starts: functions that start a worker, the preferred one first. */
export async function loadFrom(source, starts = []) {
  if (!WebAssembly.validate(exceptionModule))
    throw new MorulaError('this engine has no exceptions of WebAssembly: use a browser of 2022 or later');
  const state = {progress: null, failure: null};
  let instance = null;
  const imports = {
    wasi_snapshot_preview1: systemCalls(() => instance.exports.memory),
    morula: {
      progress(share) {
        try {
          return state.progress(share) === false ? 1 : 0;
        } catch (reason) {
          state.failure = {reason};
          return 1;
        }
      },
    },
  };
  const module = await compiled(source);
  instance = await WebAssembly.instantiate(module, imports);
  instance.exports._initialize();
  return libraryOf(new Memory(instance.exports), state, {module, starts});
}
