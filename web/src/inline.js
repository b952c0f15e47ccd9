// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The same as index.js with modules as text in JavaScript files: nothing is fetched but those.
import {MorulaError} from './errors.js';
import {hasVectors, loadFrom} from './load.js';

export {MorulaError};

const texts = {
  full: {
    simd: () => import('../dist/morula-full-simd.js'),
    plain: () => import('../dist/morula-full-plain.js'),
  },
  runtime: {
    simd: () => import('../dist/morula-runtime-simd.js'),
    plain: () => import('../dist/morula-runtime-plain.js'),
  },
};

export async function load({variant = 'full', simd = hasVectors(), source} = {}) {
  if (!(variant in texts)) throw new MorulaError(`variant is ${variant}, neither full nor runtime`);
  if (source !== undefined) return loadFrom(source);
  const text = (await texts[variant][simd ? 'simd' : 'plain']()).default;
  return loadFrom(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)));
}
