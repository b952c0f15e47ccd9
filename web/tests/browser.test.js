// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The package in Chromium: a page, a worker, pages of file://, and content security policies. Results have the bits of node, which
// bits.test.js compares with the native library.
import assert from 'node:assert/strict';
import {cp, mkdtemp, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import test from 'node:test';
import {pathToFileURL} from 'node:url';
import {inBrowser} from './browser.js';
import {packageFile, packageModule} from './package.js';

/** Bytes of a tree and of moved spheres, as numbers. Self-contained: it also runs in pages. */
async function figures(morula) {
  const mesh = morula.Mesh.sample('limb', 16);
  const tree = morula.build(mesh, {quality: 'draft'});
  const body = new morula.Body(mesh, tree);
  for (let i = 0; i < body.positions.length; i += 3) body.positions[i + 2] += 0.25 * body.positions[i] ** 2;
  body.update();
  const other = new morula.Body(mesh, tree);
  const pairs = morula.proximity(body, other, {distance: 0.02}).map((p) => [p.a, p.b, p.distance]);
  const spheres = [...body.spheres()];
  for (const object of [mesh, tree, body, other]) object.free();
  const torus = morula.Mesh.sample('torus', 12);
  return {spheres, pairs, bytes: [...morula.build(torus, {method: 'grid'}).toBytes()]};
}
let expected = null;
const own = async () => (expected ??= await figures(await (await packageModule()).load()));

const strict = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'; worker-src 'self'";

for (const simd of [true, false])
  test(`a page computes the bits of node ${simd ? 'with' : 'without'} SIMD`, async () => {
    const found = await inBrowser((page) => page.evaluate(
      `import('/src/index.js').then(({load}) => load({simd: ${simd}})).then(${figures})`), strict);
    assert.deepEqual(found, await own());
  });

test('a worker of a page computes them, too', async () => {
  const found = await inBrowser((page, address) => page.evaluate((text) => new Promise((resolve, reject) => {
    const worker = new Worker(URL.createObjectURL(new Blob([text], {type: 'text/javascript'})), {type: 'module'});
    worker.onmessage = ({data}) => resolve(data);
    worker.onerror = reject;
  }), `import {load} from '${address}/src/index.js'; postMessage(await (${figures})(await load()));`));
  assert.deepEqual(found, await own());
});

/** Builds in a worker, in a page: whether the bytes are those of build(), the longest time without a turn, progress. */
async function buildsAsync(morula) {
  const mesh = morula.Mesh.sample('limb', 24);
  let longest = 0;
  let turns = 0;
  let last = performance.now();
  const clock = setInterval(() => {
    longest = Math.max(longest, performance.now() - last);
    last = performance.now();
    ++turns;
  }, 4);
  const shares = [];
  const tree = await morula.buildAsync(mesh, {quality: 'draft', progress: (share) => void shares.push(share)});
  clearInterval(clock);
  const bytes = tree.toBytes().join();
  return {equal: bytes === morula.build(mesh, {quality: 'draft'}).toBytes().join(), longest, turns, shares: shares.length};
}

for (const [name, entry, csp] of [
  ['the worker file', 'index', strict],
  ['text in a blob, where the file is forbidden', 'index', strict.replace("worker-src 'self'", 'worker-src blob:')],
  ['text in a blob, of the inline entry', 'inline', strict.replace("worker-src 'self'", 'worker-src blob:')],
])
  test(`buildAsync uses ${name}`, async (context) => {
    const found = await inBrowser((page) =>
      page.evaluate(`import('/src/${entry}.js').then(({load}) => load()).then(${buildsAsync})`), csp);
    context.diagnostic(`longest time without a turn: ${found.longest.toFixed(1)} ms`);
    assert.ok(found.equal && found.turns > 3 && found.shares > 1, JSON.stringify(found));
  });

test('buildAsync says that there are no workers', async () => {
  const found = await inBrowser((page) => page.evaluate(
    `import('/src/index.js').then(({load}) => load())
      .then((m) => m.buildAsync(m.Mesh.sample('bar', 4))).catch((error) => [error.code, error.message])`),
  strict.replace("worker-src 'self'", "worker-src 'none'"));
  assert.equal(found[0], 'no_worker');
  assert.match(found[1], /build\(\)/);
});

test('a page of file:// works by scripts', async () => {
  const place = await mkdtemp(join(tmpdir(), 'morula-web-'));
  try {
    await cp(packageFile('dist'), join(place, 'dist'), {recursive: true});
    await writeFile(join(place, 'page.html'), '<!doctype html><script src="dist/morula.global.js"></script>');
    await inBrowser(async (page) => {
      await page.goto(pathToFileURL(join(place, 'page.html')).href);
      assert.deepEqual(await page.evaluate(`morula.load().then(${figures})`), await own());
      const built = await page.evaluate(`morula.load({simd: false}).then(${buildsAsync})`);
      assert.ok(built.equal, JSON.stringify(built));
      assert.equal(await page.evaluate("morula.load({variant: 'runtime'}).then((m) => m.version)"), '0.1.0');
    });
  } finally {
    await rm(place, {recursive: true});
  }
});

test('the memory of a page is flat over 1000 builds and frees', async () => {
  const [size, later] = await inBrowser((page) => page.evaluate(async () => {
    const {load} = await import('/src/index.js');
    const morula = await load();
    const round = () => {
      const mesh = morula.Mesh.sample('bar', 3);
      const tree = morula.build(mesh, {method: 'octree', depth: 1});
      const body = new morula.Body(mesh, tree);
      body.update();
      for (const object of [mesh, tree, body]) object.free();
    };
    for (let i = 0; i < 20; ++i) round();
    const before = morula.memory().byteLength;
    for (let i = 0; i < 1000; ++i) round();
    return [before, morula.memory().byteLength];
  }), strict);
  assert.equal(later, size);
});
