// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Times an update of limb:188 by both modules, and by the native library in turn: least times, and ratios.
// usage: MORULA_WEB_ORACLE=web_oracle node web/tests/speed.js
import {execFileSync} from 'node:child_process';
import {packageModule} from './package.js';

const oracle = process.env.MORULA_WEB_ORACLE;
if (!oracle) throw new Error('MORULA_WEB_ORACLE names no native program');
const {load} = await packageModule();

async function updateOf(simd) {
  const morula = await load({simd});
  const mesh = morula.Mesh.sample('limb', 188);
  const body = new morula.Body(mesh, morula.build(mesh, {method: 'octree'}));
  if (!body.certify()) throw new Error('the body is not covered');
  return () => {
    let least = Infinity;
    for (let i = 0; i < 300; ++i) {
      const begin = performance.now();
      body.update();
      least = Math.min(least, performance.now() - begin);
    }
    return least;
  };
}
const runs = {
  native: () => Number(execFileSync(oracle, ['--time'], {encoding: 'utf8'})),
  simd: await updateOf(true),
  plain: await updateOf(false),
};
const least = {native: Infinity, simd: Infinity, plain: Infinity};
for (let round = 0; round < 3; ++round)
  for (const [name, run] of Object.entries(runs)) least[name] = Math.min(least[name], run());
console.log('| update of limb:188 | ms | over native |\n| --- | ---: | ---: |');
for (const [name, time] of Object.entries(least))
  console.log(`| ${name} | ${time.toFixed(3)} | ${(time / least.native).toFixed(2)} |`);
