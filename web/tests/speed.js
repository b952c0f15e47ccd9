// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Times an update of limb:188 by both modules in node and in Chromium, and by the native library in turn: least times, and ratios,
// as lines "what, TAB, amount". scripts/web --record runs it. usage: MORULA_WEB_ORACLE=web_oracle node web/tests/speed.js
import {execFileSync} from 'node:child_process';
import {inBrowser} from './browser.js';
import {packageModule} from './package.js';

const oracle = process.env.MORULA_WEB_ORACLE;
if (!oracle) throw new Error('MORULA_WEB_ORACLE names no native program');

/** The least time of many updates, ms. It also runs in the page. */
async function leastUpdate(morula) {
  const mesh = morula.Mesh.sample('limb', 188);
  const body = new morula.Body(mesh, morula.build(mesh, {method: 'octree'}));
  if (!body.certify()) throw new Error('the body is not covered');
  let least = Infinity;
  for (let i = 0; i < 300; ++i) {
    const begin = performance.now();
    body.update();
    least = Math.min(least, performance.now() - begin);
  }
  return least;
}

const {load} = await packageModule();
const browserHas = (simd) => (page) =>
  page.evaluate(`import('/src/index.js').then(({load}) => load({simd: ${simd}})).then(${leastUpdate})`);
const runs = [
  ['native', () => Number(execFileSync(oracle, ['--time'], {encoding: 'utf8'}))],
  ['node, SIMD', async () => leastUpdate(await load({simd: true}))],
  ['node, plain', async () => leastUpdate(await load({simd: false}))],
  ['Chromium, SIMD', () => inBrowser(browserHas(true))],
  ['Chromium, plain', () => inBrowser(browserHas(false))],
];
const least = new Map();
for (let round = 0; round < 3; ++round)
  for (const [name, run] of runs) least.set(name, Math.min(least.get(name) ?? Infinity, await run()));
for (const [name, time] of least)
  console.log(name === 'native'
    ? `update of limb:188, ${name}\t${time.toFixed(2)} ms`
    : `update of limb:188, ${name}\t${time.toFixed(2)} ms, ${(time / least.get('native')).toFixed(1)} × native`);
