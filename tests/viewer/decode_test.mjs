// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the page decodes is what the command encoded: meshes and spheres read from other files of the same run.
import { readFileSync, writeFileSync } from 'node:fs';
import { at, check, claim, equal, finish, morula } from './support.mjs';
import { elements, isRefused } from './page.mjs';
import { Varints, checksum, decodeMotion, decodeScene, fromBase64, readBytes, readManifest } from '../../viewer/src/decode.js';
import { distanceOutside, sphereGrid } from '../../viewer/src/uncovered.js';
import { SceneList } from '../../viewer/src/model.js';

function obj(path) {
  const vertices = [];
  const facets = [];
  for (const line of readFileSync(path, 'utf8').split('\n')) {
    const words = line.split(/\s+/);
    if (words[0] === 'v') vertices.push(words.slice(1, 4).map(Number));
    if (words[0] === 'f') facets.push(words.slice(1, 4).map((word) => Number(word.split('/')[0]) - 1));
  }
  return { vertices, facets };
}
const digits = (frame) => String(frame).padStart(4, '0');

morula('sample limb -o limb.obj --resolution 16');
morula('build limb.obj -o limb.morula --method grid --depth 2');
morula('deform limb.obj -o motion --bend 70 --frames 5');
morula('update limb.obj limb.morula motion -o spheres --rule approach2 --format json');
morula('view limb.obj limb.morula motion -o limb.html --rule approach2');
const html = readFileSync(at('limb.html'), 'utf8');
const text = elements(html);
const manifest = readManifest(text);
const [entry] = manifest.motions;

await claim('facets_are_the_files', () => {
  const motion = decodeMotion(readBytes(text, entry.data), entry);
  equal(JSON.stringify([...motion.facets]), JSON.stringify(obj(at('limb.obj')).facets.flat()), 'facets');
});

await claim('positions_are_the_files_to_half_a_step', () => {
  const motion = decodeMotion(readBytes(text, entry.data), entry);
  equal(motion.frames.length, 5, 'frames');
  let used = 0;
  motion.frames.forEach((places, frame) => {
    const { vertices } = obj(at(`motion/${digits(frame)}.obj`));
    equal(places.length, 3 * vertices.length, 'coordinates');
    vertices.flat().forEach((x, i) => {
      const read = entry.origin[i % 3] + entry.step[i % 3] * places[i];
      check(Math.abs(read - x) <= 0.5000001 * entry.step[i % 3], `frame ${frame} coordinate ${i}: ${read} for ${x}`);
      used = Math.max(used, places[i]);
    });
  });
  equal(used, 65535, 'the whole range of places is used');
});

await claim('spheres_are_those_of_update_in_single_precision', () => {
  const scene = manifest.scenes[0];
  const { frames } = decodeScene(readBytes(text, scene.data), scene, 5);
  frames.forEach((spheres, frame) => {
    const tree = JSON.parse(readFileSync(at(`spheres/${digits(frame)}.json`), 'utf8'));
    const list = tree.spheres ?? tree.nodes;
    equal(spheres.length, 4 * list.length, 'spheres');
    list.forEach((sphere, node) => {
      const wanted = Array.isArray(sphere) ? sphere : [...sphere.center, sphere.radius];
      wanted.forEach((x, k) => {
        const read = spheres[4 * node + k] + (k < 3 ? entry.origin[k] : 0);
        check(Math.abs(read - x) <= 1e-6, `frame ${frame} node ${node}: ${read} for ${x}`);
      });
    });
  });
});

await claim('level_sets_hold_the_counts_that_measure_prints', () => {
  const scene = new SceneList(manifest, text).scene(0);
  morula('measure limb.obj limb.morula --json');
  const levels = JSON.parse(morula('measure limb.obj limb.morula --json'));
  const rows = levels.levels ?? levels.frames?.[0]?.levels ?? levels.measured[0].levels;
  equal(JSON.stringify(scene.levelSets.map((nodes) => nodes.length)), JSON.stringify(rows.map((row) => row.spheres)), 'level sets');
});

await claim('the_grid_says_what_all_spheres_say', () => {
  const scene = new SceneList(manifest, text).scene(0);
  const nodes = scene.levelSets[2];
  const spheres = scene.frames[2];
  const positions = scene.positions(2);
  const grid = sphereGrid(positions, spheres, nodes);
  let uncovered = 0;
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = positions.subarray(i, i + 3);
    let least = Infinity;
    for (const node of nodes) {
      const [cx, cy, cz, r] = spheres.subarray(4 * node, 4 * node + 4);
      least = Math.min(least, Math.hypot(x - cx, y - cy, z - cz) - r);
    }
    const found = distanceOutside(grid, x, y, z);
    equal(found > 0, least > 0, `vertex ${i / 3} is uncovered`);
    if (least < 0) check(Math.abs(found - least) < 1e-12, `vertex ${i / 3}: ${found} for ${least}`);
    if (least > 0) ++uncovered;
  }
  check(uncovered > 0, 'approach2 leaves some vertices uncovered here, so that the test means something');
});

await claim('varints_of_all_sizes_come_back', () => {
  const values = [0, -1, 1, 63, -64, 64, 65535, -65535, 4294967295, -4294967295];
  const bytes = [];
  for (const value of values) {
    let rest = value >= 0 ? BigInt(value) * 2n : BigInt(-value) * 2n - 1n;
    for (; rest >= 128n; rest >>= 7n) bytes.push(Number(rest & 127n) | 128);
    bytes.push(Number(rest));
  }
  const numbers = new Varints(Uint8Array.from(bytes));
  for (const value of values) equal(numbers.next() + 0, value, 'varint');
  check(isRefused(() => numbers.next()), 'nothing is read past the end');
});

await claim('base64_and_checksum_agree_with_known_answers', () => {
  for (const word of ['', 'f', 'fo', 'foo', 'foob', 'fooba', 'foobar']) {
    const bytes = fromBase64(Buffer.from(word).toString('base64'), word.length);
    equal(Buffer.from(bytes).toString(), word, 'base64');
  }
  equal(checksum(Buffer.from('a')), 0xe40c292c, 'FNV-1a of "a"');
  equal(checksum(Buffer.from('foobar')), 0xbf9cf968, 'FNV-1a of "foobar"');
});

await claim('every_damage_is_told', () => {
  const packed = text(entry.data.id);
  const middle = html.indexOf(packed) + Math.floor(packed.length / 2);
  const changed = html.slice(0, middle) + (html[middle] === 'A' ? 'B' : 'A') + html.slice(middle + 1);
  check(isRefused(() => new SceneList(readManifest(elements(changed)), elements(changed)).scene(0)), 'one changed character');
  check(isRefused(() => readManifest(elements(html.slice(0, middle)))), 'half a file');
  check(isRefused(() => readManifest(elements(html.replace('"format":1', '"format":99')))), 'a newer format');
  check(isRefused(() => readManifest(elements('<html></html>'))), 'no data');
  const short = html.replace(packed, packed.slice(0, -8));
  check(isRefused(() => new SceneList(readManifest(elements(short)), elements(short)).scene(0)), 'data cut short');
});

await claim('nothing_in_the_lock_file_names_a_server', () => {
  const lock = readFileSync(new URL('../../viewer/package-lock.json', import.meta.url), 'utf8');
  check(!/resolved|https?:|\.org|\.com/.test(lock), 'the lock file has no addresses');
});

writeFileSync(at('manifest.json'), JSON.stringify(manifest, null, 1));
finish();
