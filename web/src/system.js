// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The system calls of a module: a clock, and text on stderr. There is no file system.

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
    sched_yield: () => success,
  };
  // A call that needs a file or a socket: there are none.
  return new Proxy(calls, {
    get: (known, name) => known[name] ?? (() => (String(name).startsWith('fd_') ? badDescriptor : notSupported)),
  });
}
