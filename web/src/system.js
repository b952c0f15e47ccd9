// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The system calls of a module: a clock, random numbers, and text on stderr. There is no file system and no environment.

const success = 0;
const badDescriptor = 8;
const notSupported = 52;

/** Makes the imports `wasi_snapshot_preview1` of a module. memory: a function that returns its memory. */
export function systemCalls(memory) {
  const data = () => new DataView(memory().buffer);
  const text = new TextDecoder();
  const calls = {
    clock_time_get(clock, _precision, result) {
      // Clock 0 counts from 1970, the others from any beginning.
      const milliseconds = clock === 0 ? Date.now() : performance.now();
      data().setBigUint64(result, BigInt(Math.round(milliseconds * 1e6)), true);
      return success;
    },
    clock_res_get(_clock, result) {
      data().setBigUint64(result, 1000n, true);
      return success;
    },
    random_get(begin, size) {
      // getRandomValues gives at most 65,536 bytes a call.
      for (let at = 0; at < size; at += 65536)
        crypto.getRandomValues(new Uint8Array(memory().buffer, begin + at, Math.min(65536, size - at)));
      return success;
    },
    fd_write(descriptor, vectors, count, written) {
      if (descriptor !== 1 && descriptor !== 2) return badDescriptor;
      let total = 0;
      let line = '';
      for (let i = 0; i < count; ++i) {
        const begin = data().getUint32(vectors + 8 * i, true);
        const size = data().getUint32(vectors + 8 * i + 4, true);
        line += text.decode(new Uint8Array(memory().buffer, begin, size));
        total += size;
      }
      if (line !== '') console.error(line.replace(/\n$/, ''));
      data().setUint32(written, total, true);
      return success;
    },
    environ_sizes_get(count, size) {
      data().setUint32(count, 0, true);
      data().setUint32(size, 0, true);
      return success;
    },
    environ_get: () => success,
    sched_yield: () => success,
    proc_exit(code) {
      throw new Error(`the module ended with code ${code}`);
    },
  };
  // A call that needs a file or a socket: there are none.
  return new Proxy(calls, {
    get: (known, name) => known[name] ?? (() => (String(name).startsWith('fd_') ? badDescriptor : notSupported)),
  });
}
