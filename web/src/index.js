// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Morula for browsers, workers and node: sphere trees that cover meshes while they deform.
import {MorulaError} from './errors.js';
import {hasVectors, loadFrom} from './load.js';
import {workerAt, workerOf} from './workers.js';

export {MorulaError};

// Written out, so that bundlers find the files.
const places = {
  full: {
    simd: () => new URL('../dist/morula-full-simd.wasm', import.meta.url),
    plain: () => new URL('../dist/morula-full-plain.wasm', import.meta.url),
  },
  runtime: {
    simd: () => new URL('../dist/morula-runtime-simd.wasm', import.meta.url),
    plain: () => new URL('../dist/morula-runtime-plain.wasm', import.meta.url),
  },
};

const starts = [
  () => workerAt(new URL('./worker.js', import.meta.url), () => new Worker(new URL('./worker.js', import.meta.url), {type: 'module'})),
  async () => workerOf((await import('../dist/worker-text.js')).default),
];

export async function load({variant = 'full', simd = hasVectors(), source} = {}) {
  if (!Object.keys(places).includes(variant)) throw new MorulaError(`variant is ${variant}, neither full nor runtime`);
  return loadFrom(source ?? places[variant][simd ? 'simd' : 'plain'](), starts);
}
