// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The modules compute the bits of the native library: web/tests/oracle.cpp computes the same scenes there.
// MORULA_WEB_ORACLE: that program. MORULA_WEB_PACKAGE: the folder of the package.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import test from 'node:test';
import {packageModule} from './package.js';

const {load} = await packageModule();

class Hash {
  #value = 0xcbf29ce484222325n;
  add(array) {
    for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength))
      this.#value = BigInt.asUintN(64, (this.#value ^ BigInt(byte)) * 0x100000001b3n);
    return this;
  }
  numbers(...list) {
    return this.add(Float64Array.from(list.flat()));
  }
  indices(...list) {
    return this.add(Uint32Array.from(list));
  }
  toString() {
    return this.#value.toString(16).padStart(16, '0');
  }
}

const identity = [1, 0, 0, 0, 1, 0, 0, 0, 1];

function scenesOf(morula) {
  const lines = new Map();
  const make = (name, resolution, method, quality) => {
    const mesh = morula.Mesh.sample(name, resolution);
    const tree = morula.build(mesh, {method, quality});
    return {mesh, tree, body: new morula.Body(mesh, tree)};
  };
  const bend = ({mesh, body}, amount) => {
    const rest = mesh.positions;
    const now = body.positions;
    for (let v = 0; v < rest.length; v += 3) {
      const [x, y, z] = rest.subarray(v, v + 3);
      now[v] = x + 0.25 * amount * y;
      now[v + 1] = y;
      now[v + 2] = z + amount * x * x;
    }
    body.update();
  };
  const updates = (name, scene) => {
    const hash = new Hash();
    for (const amount of [0, 0.125, 0.5, -0.75]) {
      bend(scene, amount);
      hash.add(scene.body.spheres());
    }
    lines.set(`${name} updates`, hash);
  };
  const limb = make('limb', 24, 'octree');
  const torus = make('torus', 16, 'grid');
  const all = {limb, torus, blob: make('blob', 12, 'optimized', 'draft'), bar: make('bar', 8, 'medial')};
  for (const [name, scene] of Object.entries(all)) {
    lines.set(`${name} tree`, new Hash().add(scene.tree.spheres).add(scene.tree.firstChild));
    lines.set(`${name} file`, new Hash().add(scene.tree.toBytes()));
    updates(name, scene);
  }

  for (const rules of ['wrapped', 'approach1', 'approach2', 'traditional', 'weighted', 'exact,approach2,wrapped']) {
    const body = new morula.Body(limb.mesh, limb.tree, {rules, conservative: true});
    updates(`limb ${rules}`, {...limb, body});
    body.free();
  }

  const rest = limb.mesh.positions.slice();
  const weights = [];
  for (let v = 0; v < rest.length; v += 3)
    weights.push(1 + rest[v] * rest[v], 0.5 + rest[v + 1] * rest[v + 1], rest[v] < 0 ? 0 : 0.25);
  const skin = new morula.Skin(3, weights.map((_, i) => i % 3), weights, 3);
  const skinned = new morula.Body(limb.mesh, limb.tree, {rules: ['skinned'], skin});
  const frames = new Hash();
  for (let frame = 0; frame < 4; ++frame) {
    for (let i = 0; i < 36; ++i)
      skinned.transforms[i] = ((i % 12) % 5 === 0 ? 1 : 0) + 0.0625 * frame * (Math.floor(i / 12) - ((i % 12) % 3));
    skinned.updateSkinned();
    frames.add(skinned.spheres());
  }
  lines.set('limb skinned', frames);

  const contacts = new Hash();
  const crossings = new Hash();
  const distances = new Hash();
  const query = new morula.ContactQuery();
  for (let step = 0; step < 8; ++step) {
    bend(limb, 0.0625 * step);
    bend(torus, -0.0625 * step);
    torus.body.setTransform(identity, [0.125 * step, 0.25, 0.1875 * step]);
    const options = {margin: 0.0625, ...(step % 2 === 1 ? {pairTests: 40 * step} : {})};
    for (const c of query.run(limb.body, torus.body, options))
      contacts.indices(c.nodeA, c.nodeB).numbers(c.point, c.normal, c.depth);
    crossings.add(morula.crossings(limb.body, torus.body));
    const d = morula.distance(limb.body, torus.body);
    distances.numbers(d.lower, d.upper, d.pointA, d.pointB);
  }
  lines.set('limb and torus contacts', contacts);
  lines.set('limb and torus crossings', crossings);
  lines.set('limb and torus distances', distances);

  bend(torus, 0.25);
  const rays = [];
  const points = [];
  for (let i = 0; i < 64; ++i) {
    const u = ((i % 8) - 3.5) / 4;
    const v = (Math.floor(i / 8) - 3.5) / 8;
    rays.push(u, v, 4, 0.0625 * v, 0.03125 * u, -1);
    points.push(u, v, 0.25 * u * u);
  }
  const hits = new Hash();
  for (const hit of morula.firstHits(torus.body, rays, 1e300))
    if (hit) hits.indices(hit.facet).numbers(hit.t, hit.point, hit.normal);
  lines.set('torus rays', hits);
  const inside = new Hash();
  for (const at of morula.locate(torus.body, points)) inside.add(Int32Array.of(at.inside, at.onSurface, at.winding));
  lines.set('torus inside', inside);
  return lines;
}

const native = new Map();
if (process.env.MORULA_WEB_ORACLE)
  for (const line of execFileSync(process.env.MORULA_WEB_ORACLE, {encoding: 'utf8'}).trim().split('\n'))
    native.set(line.slice(17), line.slice(0, 16));

for (const simd of [true, false])
  test(`the module ${simd ? 'with' : 'without'} SIMD computes the native bits`,
    {skip: native.size === 0 && 'MORULA_WEB_ORACLE names no native program'}, async () => {
      const computed = scenesOf(await load({simd}));
      assert.deepEqual([...computed.keys()].sort(), [...native.keys()].sort());
      const different = [...native].filter(([name, hash]) => computed.get(name).toString() !== hash);
      assert.deepEqual(different.map(([name]) => name), []);
    });
