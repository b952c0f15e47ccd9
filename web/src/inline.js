// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The same as index.js with modules as text in JavaScript files: nothing is fetched but those.
import {MorulaError} from './errors.js';
import {bytesOf, hasVectors, loadFrom} from './load.js';
import {workerOf} from './workers.js';

export {MorulaError};

// Each file sets globalThis.morulaModules['VARIANT-KIND'], so that pages without modules can use it, too.
const files = {
  full: {
    simd: () => import('../dist/morula-full-simd.js'),
    plain: () => import('../dist/morula-full-plain.js'),
  },
  runtime: {
    simd: () => import('../dist/morula-runtime-simd.js'),
    plain: () => import('../dist/morula-runtime-plain.js'),
  },
};
const starts = [async () => workerOf((await import('../dist/worker-text.js')).default)];

export async function load({variant = 'full', simd = hasVectors(), source} = {}) {
  if (!Object.keys(files).includes(variant)) throw new MorulaError(`variant is ${variant}, neither full nor runtime`);
  if (source !== undefined) return loadFrom(source, starts);
  const kind = simd ? 'simd' : 'plain';
  await files[variant][kind]();
  return loadFrom(bytesOf(globalThis.morulaModules[`${variant}-${kind}`]), starts);
}
