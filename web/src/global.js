// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The package for pages without modules, such as those of file://: web/bundle.mjs makes dist/morula.global.js of it, a script that
// defines globalThis.morula = {load, MorulaError} and adds the scripts of modules, which lie beside it, to the page.
import {MorulaError} from './errors.js';
import {bytesOf, hasVectors, loadFrom} from './load.js';
import {workerOf} from './workers.js';
import workerText from '../dist/worker-text.js';

const own = globalThis.document?.currentScript?.src;
const variants = ['full', 'runtime'];
const starts = [() => workerOf(workerText)];

function addScript(address) {
  return new Promise((resolve, reject) => {
    const script = document.createElement('script');
    script.src = address;
    script.onload = resolve;
    script.onerror = () => reject(new MorulaError(`${address}: the module cannot be loaded`, 'bad_file'));
    document.head.append(script);
  });
}

async function load({variant = 'full', simd = hasVectors(), source} = {}) {
  if (!variants.includes(variant)) throw new MorulaError(`variant is ${variant}, neither full nor runtime`);
  if (source !== undefined) return loadFrom(source, starts);
  const name = `${variant}-${simd ? 'simd' : 'plain'}`;
  if (!globalThis.morulaModules?.[name]) await addScript(new URL(`morula-${name}.js`, own).href);
  return loadFrom(bytesOf(globalThis.morulaModules[name]), starts);
}

globalThis.morula = {load, MorulaError};
