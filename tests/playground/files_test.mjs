// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The playground in a browser: files that it reads, and files that it refuses with a message while the page lives.
import { closeSync, ftruncateSync, openSync, writeFileSync, writeSync } from 'node:fs';
import { at, claim, morula } from '../viewer/support.mjs';
import { barGlb, packed } from './glb.mjs';
import { check, close, equal, farthest, idle, opened, pose, set, share, words } from './playground.mjs';

const small = '#detail=1500';
async function openFile(page, name) {
  await page.setInputFiles('#file', at(name));
  await page.waitForFunction(() => !document.getElementById('message').hidden || document.body.dataset.figures === 'pending' || document.body.dataset.building === 'true');
  await idle(page);
}

morula('sample torus -o torus.obj --resolution 24');
morula('repair torus.obj -o torus.ply');
morula('repair torus.obj -o torus.stl');

await claim('obj_ply_and_stl_files_are_read', () =>
  opened(small, {}, async (page) => {
    const facets = [];
    for (const name of ['torus.obj', 'torus.ply', 'torus.stl']) {
      await openFile(page, name);
      check(!(await page.isVisible('#message')), `${name}: ${await words(page, '#message-text').catch(() => '')}`);
      equal(await words(page, '#title'), name, 'title');
      equal(await words(page, '#figure-uncovered'), '0, proven', name);
      facets.push(await words(page, '#figure-facets'));
    }
    equal(new Set(facets).size, 1, `facets ${facets}`);
  }));

await claim('a_morph_target_moves_the_body_and_the_rule_that_sees_bones_alone_is_not_offered', async () => {
  writeFileSync(at('swell.glb'), barGlb({ morph: true }));
  await opened(small, {}, async (page) => {
    await page.setInputFiles('#file', at('swell.glb'));
    await page.waitForFunction(() => document.getElementById('title').textContent === 'swell.glb');
    check(await page.locator('#rule [value=skinned]').evaluate((option) => option.disabled), 'skinned');
    const radii = [];
    for (let look = 0; look < 5; ++look) {
      await page.waitForTimeout(300);
      await page.locator('#swing').click(); // still
      await idle(page);
      equal(await words(page, '#figure-uncovered'), '0, proven', 'uncovered');
      const radius = (await pose(page)).map(([, y, z]) => Math.hypot(y, z));
      check(Math.max(...radius) - Math.min(...radius) < 1e-6, 'every ring has one radius');
      radii.push(radius[0]);
      await page.locator('#swing').click();
    }
    check(radii.every((radius) => radius > 0.4 - 1e-6 && radius < 0.8 + 1e-6), `radii ${radii}`);
    check(Math.max(...radii) - Math.min(...radii) > 0.02, `radii ${radii}`);
  });
});

await claim('a_character_plays_and_its_skinned_spheres_cover', async () => {
  writeFileSync(at('bar.glb'), barGlb());
  writeFileSync(at('pictured.glb'), barGlb({ image: true }));
  await opened(small, {}, async (page) => {
    for (const name of ['bar.glb', 'pictured.glb']) {
      await page.setInputFiles('#file', at(name));
      await page.waitForFunction((title) => document.getElementById('title').textContent === title, name);
      equal(await page.getAttribute('#clip option', 'value'), '0', 'a clip');
      const [a] = [await pose(page), await page.waitForTimeout(700)];
      check(farthest(await pose(page), a) > 0.05, 'it moves');
      for (const rule of ['exact', 'skinned']) {
        await page.selectOption('#rule', rule);
        await page.waitForTimeout(300);
        await page.locator('#swing').click(); // still, so that the figures are of this pose
        await idle(page);
        equal(await words(page, '#figure-uncovered'), '0, proven', rule);
        await page.locator('#swing').click();
      }
      await page.selectOption('#rule', 'rest');
      let most = 0;
      for (let look = 0; look < 60 && most === 0; ++look) {
        await page.waitForTimeout(250);
        most = share(await words(page, '#figure-uncovered'));
      }
      check(most > 0, 'spheres that stay leave surface bare');
      await page.selectOption('#rule', 'exact');
    }
  });
});

const refused = [
  ['notes.txt', 'hello', 'this page reads'],
  ['empty.obj', '', 'empty'],
  ['words.obj', 'this is no mesh\n', ''],
  ['indices.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n', ''],
  ['nan.obj', 'v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n', ''],
  ['cut.ply', 'ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\n', ''],
  ['noise.stl', Buffer.from(Array.from({ length: 500 }, (_, i) => (i * 73) % 251)), ''],
  ['noise.glb', Buffer.from(Array.from({ length: 500 }, (_, i) => (i * 73) % 251)), 'no GLB file'],
  ['text.glb', packed({ asset: { version: '2.0' } }, new Uint8Array(0)), 'no triangles'],
  ['null.glb', packed(null, new Uint8Array(0)), 'damaged'],
  ['hole.glb', packed({ asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }], accessors: [{ count: 3, type: 'VEC3', componentType: 5126, bufferView: 7 }] }, new Uint8Array(0)), 'damaged'],
  ['many.glb', packed({ asset: { version: '2.0' }, meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }], accessors: [{ count: 9 }, { count: 30_000_000 }] }, new Uint8Array(0)), '10,000,000 facets'],
];
// Few triangles, and a scene with more than a thousand places of them.
const corners = Float32Array.from({ length: 1800 }, (_, i) => Math.sin(i * i));
refused.push(['places.glb', packed({
  asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: Array.from({ length: 1100 }, (_, i) => i) }], nodes: Array.from({ length: 1100 }, (_, i) => ({ mesh: 0, translation: [i, 0, 0] })),
  meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }], accessors: [{ bufferView: 0, componentType: 5126, type: 'VEC3', count: 600, min: [-1, -1, -1], max: [1, 1, 1] }],
  bufferViews: [{ buffer: 0, byteOffset: 0, byteLength: 7200 }], buffers: [{ byteLength: 7200 }],
}, new Uint8Array(corners.buffer)), '200,200 facets']);
for (const [name, content] of refused) writeFileSync(at(name), content);
/** A file of a size that takes no room on the disk. */
function sparse(name, size, head = Buffer.alloc(0)) {
  const file = openSync(at(name), 'w');
  writeSync(file, head);
  ftruncateSync(file, size);
  closeSync(file);
}
sparse('huge.obj', 2 ** 31);
sparse('tenmillion.stl', 84 + 50 * 10_000_000);
sparse('tenmillion.ply', 100 * 2 ** 20, Buffer.from('ply\nformat binary_little_endian 1.0\nelement vertex 5000000\nproperty float x\nproperty float y\nproperty float z\nelement face 10000000\nproperty list uchar int vertex_indices\nend_header\n'));
refused.push(['huge.obj', null, '2,048 MB'], ['tenmillion.stl', null, 'MB'], ['tenmillion.ply', null, '10,000,000 facets']);

await claim('a_file_that_is_none_gets_a_message_and_the_page_lives', () =>
  opened(small, {}, async (page) => {
    const title = await words(page, '#title');
    for (const [name, , text] of refused) {
      await page.setInputFiles('#file', at(name));
      await page.waitForSelector('#message:not([hidden])');
      const told = await words(page, '#message-text');
      check(told.includes(name) || told.includes('facets'), `${name}: ${told}`);
      check(told.includes(text), `${name}: ${told}`);
      await idle(page);
      equal(await words(page, '#title'), title, `the body after ${name}`);
      await page.click('#message-close');
    }
    await set(page, 'bend', 33);
    equal(await words(page, '#figure-uncovered'), '0, proven', 'after all of them');
    await openFile(page, 'torus.obj');
    equal(await words(page, '#title'), 'torus.obj', 'a good file after them');
  }));

await claim('a_dropped_file_is_opened', () =>
  opened(small, {}, async (page) => {
    await page.evaluate(() => {
      const data = new DataTransfer();
      data.items.add(new File(['v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n'], 'drop.obj'));
      dispatchEvent(new DragEvent('dragover', { dataTransfer: data, cancelable: true }));
      dispatchEvent(new DragEvent('drop', { dataTransfer: data, cancelable: true }));
    });
    await page.waitForFunction(() => document.getElementById('title').textContent === 'drop.obj');
    await idle(page);
    equal(await words(page, '#figure-facets'), '4', 'facets');
  }));

await close();
