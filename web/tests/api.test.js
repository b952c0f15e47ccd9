// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The package as its users call it. Queries are judged by brute force over all facets, spheres by the points that they
// have to contain.
import assert from 'node:assert/strict';
import test from 'node:test';
import {packageFile, packageModule} from './package.js';
import {readFile} from 'node:fs/promises';

const {load, MorulaError} = await packageModule();
const morula = await load();
const {Mesh, Tree, Skin, Body, ContactQuery, PairQuery, build} = morula;

const octahedron = () => new Mesh(
  [1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1],
  [0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5]);

function sample(name, resolution, options = {method: 'octree'}) {
  const mesh = Mesh.sample(name, resolution);
  const tree = build(mesh, options);
  return {mesh, tree, body: new Body(mesh, tree)};
}
function bend({mesh, body}, amount) {
  const rest = mesh.positions;
  const now = body.positions;
  for (let v = 0; v < rest.length; v += 3) {
    now[v] = rest[v];
    now[v + 1] = rest[v + 1] + 0.3 * amount * rest[v];
    now[v + 2] = rest[v + 2] + amount * rest[v] * rest[v];
  }
}
const add = (a, b) => a.map((x, i) => x + b[i]);
const sub = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** The corners of all facets at the present positions. */
function triangles({mesh, body}, offset = [0, 0, 0]) {
  const result = [];
  const facets = mesh.facets;
  const corner = (v) => add([...body.positions.subarray(3 * v, 3 * v + 3)], offset);
  for (let f = 0; f < facets.length; f += 3) result.push([corner(facets[f]), corner(facets[f + 1]), corner(facets[f + 2])]);
  return result;
}
/** The parameter at which origin + t direction crosses a triangle; null: it does not. */
function crossing([a, b, c], origin, direction) {
  const u = sub(b, a), v = sub(c, a), p = cross(direction, v), det = dot(u, p);
  if (det === 0) return null;
  const s = sub(origin, a), x = dot(s, p) / det, q = cross(s, u), y = dot(direction, q) / det;
  return x >= 0 && y >= 0 && x + y <= 1 ? dot(v, q) / det : null;
}
const thrown = (code, text) => (error) => {
  assert.ok(error instanceof MorulaError, String(error));
  assert.equal(error.code, code, error.message);
  assert.match(error.message, text);
  return true;
};

test('every level covers the surface of a moved body', () => {
  const scene = sample('limb', 16, {quality: 'draft'});
  bend(scene, 0.4);
  scene.body.update();
  assert.equal(scene.body.certify(), true);
  const spheres = scene.body.spheres();
  const all = triangles(scene);
  for (let level = 0; level < scene.tree.levelCount; ++level) {
    const set = [...scene.tree.levelSet(level)];
    for (const [a, b, c] of all)
      for (const [u, v] of [[1, 0], [0, 1], [0, 0], [0.3, 0.3], [0.1, 0.6]]) {
        const p = [0, 1, 2].map((k) => u * a[k] + v * b[k] + (1 - u - v) * c[k]);
        assert.ok(set.some((n) => {
          const d = sub(p, [...spheres.subarray(4 * n, 4 * n + 3)]);
          return Math.sqrt(dot(d, d)) <= spheres[4 * n + 3] * (1 + 1e-9);
        }), `level ${level} leaves ${p} uncovered`);
      }
  }
});

test('rays hit the nearest facet of all', () => {
  const scene = sample('torus', 14);
  bend(scene, 0.2);
  scene.body.update();
  const all = triangles(scene);
  let hits = 0;
  for (let i = 0; i < 80; ++i) {
    const origin = [Math.sin(3 * i), Math.cos(5 * i), 3];
    const direction = [0.2 * Math.cos(7 * i), 0.2 * Math.sin(i), -1];
    const ts = all.map((t) => crossing(t, origin, direction)).filter((t) => t !== null && t >= 0);
    const hit = morula.firstHit(scene.body, origin, direction);
    assert.equal(hit !== null, ts.length > 0);
    if (hit) {
      ++hits;
      assert.ok(Math.abs(hit.t - Math.min(...ts)) < 1e-9);
      assert.ok(Math.abs(crossing(all[hit.facet], origin, direction) - hit.t) < 1e-9);
    }
  }
  assert.ok(hits > 10 && hits < 80);
  assert.equal(morula.firstHit(scene.body, [0, 0, 9], [0, 0, 1]), null);
});

test('points are inside by the solid angle of all facets', () => {
  const scene = sample('limb', 12);
  bend(scene, 0.3);
  scene.body.update();
  const all = triangles(scene);
  const points = Array.from({length: 120}, (_, i) => [1.5 * Math.sin(i), 0.3 * Math.cos(3 * i), 0.3 * Math.sin(7 * i) + 0.2]);
  const places = morula.locate(scene.body, points.flat());
  let inside = 0;
  points.forEach((p, i) => {
    let angle = 0;
    for (const triangle of all) {
      const [a, b, c] = triangle.map((corner) => sub(corner, p));
      const [x, y, z] = [a, b, c].map((v) => Math.sqrt(dot(v, v)));
      angle += 2 * Math.atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
    }
    const winding = Math.round(angle / (4 * Math.PI)) || 0; // no -0
    assert.equal(places[i].winding, winding, `${p}`);
    assert.equal(places[i].inside, winding !== 0);
    inside += places[i].inside;
  });
  assert.ok(inside > 5 && inside < 115);
});

test('rays and points in parts, as budgets end them, give the results of one call', () => {
  const scene = sample('limb', 12);
  const rays = Array.from({length: 1500}, (_, i) => [Math.sin(3 * i), Math.cos(5 * i), 3, 0.2 * Math.cos(7 * i), 0.2 * Math.sin(i), -1]);
  const points = rays.map(([x, y, z]) => [x, y, z / 9]);
  const inParts = (items, query) => {
    const all = [];
    let calls = 0;
    for (; all.length < items.length; ++calls) {
      const some = query(items.slice(all.length).flat(), {budgetMs: calls % 3 === 0 ? 0 : 0.05});
      assert.ok(some.length > 0);
      if (calls % 3 === 0) assert.ok(some.length <= 8); // the first slice alone
      all.push(...some);
    }
    assert.ok(calls > 1);
    return all;
  };
  for (const tEnd of [undefined, 2.9])
    assert.deepEqual(inParts(rays, (some, budget) => morula.firstHits(scene.body, some, tEnd, budget)), morula.firstHits(scene.body, rays.flat(), tEnd));
  assert.deepEqual(inParts(points, (some, budget) => morula.locate(scene.body, some, budget)), morula.locate(scene.body, points.flat()));
  assert.equal(morula.firstHits(scene.body, rays.flat(), Infinity, {budgetMs: 1e9}).length, 1500);
  assert.deepEqual(morula.firstHits(scene.body, [], Infinity, {budgetMs: 0}), []);
  for (const budgetMs of [-1, NaN, 1e10]) assert.throws(() => morula.locate(scene.body, [0, 0, 0], {budgetMs}), thrown('bad_argument', /budgetMs/));
});

test('crossings, overlap, contacts and distance of two bodies agree with all pairs of facets', () => {
  const a = sample('blob', 8);
  const b = sample('capsule', 8);
  const query = new ContactQuery();
  let touching = 0;
  let apart = 0;
  for (let step = 0; step < 10; ++step) {
    bend(a, 0.05 * step);
    a.body.update();
    bend(b, -0.03 * step);
    b.body.update();
    const offset = [0.011, 0.173, 0.37 * step];
    b.body.setTransform([1, 0, 0, 0, 1, 0, 0, 0, 1], offset);
    const first = triangles(a);
    const second = triangles(b, offset);
    const expected = [];
    let nearest = Infinity;
    first.forEach((s, i) => second.forEach((t, j) => {
      const edges = (x) => [[x[0], x[1]], [x[1], x[2]], [x[2], x[0]]];
      const meets = ([p, q], triangle) => {
        const at = crossing(triangle, p, sub(q, p));
        return at !== null && at >= 0 && at <= 1;
      };
      if (edges(s).some((e) => meets(e, t)) || edges(t).some((e) => meets(e, s))) expected.push([i, j]);
      for (const p of s) for (const q of t) nearest = Math.min(nearest, Math.hypot(...sub(p, q)));
    }));
    const pairs = morula.crossings(a.body, b.body);
    assert.deepEqual(Array.from({length: pairs.length / 2}, (_, i) => [pairs[2 * i], pairs[2 * i + 1]]), expected);
    const distance = morula.distance(a.body, b.body);
    const contacts = query.run(a.body, b.body);
    assert.equal(distance.crossing, expected.length > 0);
    assert.equal(query.finished, true);
    assert.equal(contacts.length > 0, morula.overlap(a.body, b.body));
    if (expected.length > 0) {
      ++touching;
      assert.ok(contacts.length > 0);
    } else {
      ++apart;
      assert.ok(distance.lower > 0 && distance.upper <= nearest + 1e-12);
      assert.ok(Math.abs(Math.hypot(...sub(distance.pointA, distance.pointB)) - distance.upper) < 1e-9);
    }
    assert.equal(query.run(a.body, b.body, {pairTests: 0}).length > 0 || contacts.length === 0, true);
  }
  assert.ok(touching > 1 && apart > 1);
});

test('a body of bones covers its vertices without being given them', () => {
  const {mesh, tree} = sample('limb', 12);
  const rest = mesh.positions.slice();
  const weights = [];
  for (let v = 0; v < rest.length; v += 3) weights.push(1 + rest[v] * rest[v], 1);
  using_(new Skin(2, weights.map((_, i) => i % 2), weights, 2), (skin) => {
    const body = new Body(mesh, tree, {rules: 'skinned', skin});
    assert.deepEqual([...body.transforms.slice(0, 12)], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]);
    body.transforms[3] = 0.5; // bone 0 moves along x
    body.transforms[15] = -0.25;
    body.updateSkinned();
    const moved = rest.slice();
    for (let v = 0; v < rest.length; v += 3) {
      const [w, x] = weights.slice((2 * v) / 3, (2 * v) / 3 + 2);
      moved[v] += (0.5 * w - 0.25 * x) / (w + x);
    }
    assert.equal(body.certify(moved), true);
    assert.equal(body.certify(rest.map((x) => x + 1)), false);
    body.free();
  });
});
function using_(object, use) {
  try {
    return use(object);
  } finally {
    object[Symbol.dispose ?? Symbol.for('Symbol.dispose')]();
    assert.throws(() => object.handle, thrown('bad_argument', /freed/));
  }
}

test('trees and meshes are read from bytes', async () => {
  const {mesh, tree} = sample('torus', 10);
  const bytes = tree.toBytes();
  const again = Tree.fromBytes(bytes, mesh);
  assert.deepEqual(again.spheres.slice(), tree.spheres.slice());
  assert.deepEqual(again.toBytes(), bytes);
  const bad = bytes.slice();
  bad[bad.length >> 1] ^= 1;
  assert.throws(() => Tree.fromBytes(bad, mesh), thrown('bad_file', /checksum/));
  assert.throws(() => Tree.fromBytes(bytes.subarray(0, 100), mesh), thrown('bad_file', /bytes/));
  assert.throws(() => Tree.fromBytes(bytes, octahedron()), thrown('bad_file', /another mesh/));
  const text = new TextEncoder().encode('v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n');
  assert.equal(Mesh.fromBytes('a.obj', text).facetCount, 4);
  assert.throws(() => Mesh.fromBytes('a.obj', new Uint8Array(0)), thrown('bad_file', /a\.obj/));
  assert.throws(() => Mesh.fromBytes('a.txt', text), thrown('bad_file', /known mesh format/));

  // The small module reads what the large one wrote.
  const runtime = await load({variant: 'runtime'});
  const same = new runtime.Mesh(mesh.positions.slice(), mesh.facets.slice());
  const tree2 = runtime.Tree.fromBytes(bytes, same);
  const body = new runtime.Body(same, tree2);
  body.update();
  assert.deepEqual(tree2.spheres.slice(), tree.spheres.slice());
  assert.throws(() => runtime.build(same), thrown('bad_argument', /variant "full"/));
  assert.throws(() => new morula.Body(same, tree), thrown('bad_argument', /no Mesh of this module/));
});

test('bad input throws the text of the library, and changes nothing', () => {
  const {mesh, tree, body} = sample('limb', 8);
  body.update();
  const before = body.spheres().slice();
  assert.throws(() => body.update([1, 2, 3]), thrown('rejected', /3 numbers/));
  const bad = body.positions.slice();
  bad[4] = NaN;
  assert.throws(() => body.update(bad), thrown('rejected', /not finite/));
  assert.deepEqual(body.spheres().slice(), before);
  assert.throws(() => body.updateSkinned(), thrown('bad_argument', /no skin/));
  assert.throws(() => new Body(mesh, tree, {rules: 'none'}), thrown('bad_argument', /"none"/));
  assert.throws(() => new Body(mesh, tree, {rules: 'skinned'}), thrown('bad_argument', /rule/));
  assert.throws(() => new Mesh([0, 0, 0], [0, 1, 2]), thrown('bad_argument', /./));
  assert.throws(() => new Mesh([0, 0], []), thrown('bad_argument', /multiple of 3/));
  assert.throws(() => new Mesh([0, 0, 0], [0, 0, -1]), thrown('bad_argument', /no index/));
  assert.throws(() => build(mesh, {method: 'magic'}), thrown('bad_argument', /magic/));
  assert.throws(() => build(mesh, {depth: 99}), thrown('bad_argument', /depth/));
  assert.throws(() => new ContactQuery().run(body, body, {pairTests: 1, budgetMs: 1}), thrown('bad_argument', /budget/));
  assert.throws(() => morula.firstHit(body, [0, 0, NaN], [0, 0, 1]), thrown('rejected', /./));
  const open = new Mesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]);
  assert.throws(() => morula.locate(new Body(open, build(open)), [0, 0, 0]), thrown('bad_argument', /edge/));
  body.free();
  body.free();
  assert.throws(() => body.update(), thrown('bad_argument', /freed/));
});

test('numbers that 32 bits do not hold, and arrays of other types, do not become others', () => {
  const {mesh, tree, body} = sample('limb', 8);
  for (const bad of [2 ** 32, 0.5, NaN, -1, undefined, '1']) {
    assert.throws(() => tree.levelSet(bad), thrown('bad_argument', /level/));
    assert.throws(() => new Skin(bad, [0, 0], [1, 1], 1), thrown('bad_argument', /influences/));
    assert.throws(() => new Skin(1, [0, 0], [1, 1], bad), thrown('bad_argument', /boneCount/));
    assert.throws(() => new Mesh([0, 0, 0], [0, 0, bad]), thrown('bad_argument', /facets\[2\]/));
  }
  for (const bad of [2 ** 32 + 4, 4.5, NaN]) {
    for (const name of ['branching', 'depth', 'spheres'])
      assert.throws(() => build(mesh, {method: 'octree', [name]: bad}), thrown('bad_argument', new RegExp(name)));
    assert.throws(() => Mesh.sample('limb', bad), thrown('bad_argument', /resolution/));
    assert.throws(() => new ContactQuery().run(body, body, {level: bad}), thrown('bad_argument', /level/));
    assert.throws(() => morula.proximity(body, null, {distance: 0, rings: bad}), thrown('bad_argument', /rings/));
  }
  for (const bad of [-1, 1.5, 2 ** 53, 2n ** 64n, -1n, '7'])
    assert.throws(() => build(mesh, {seed: bad}), thrown('bad_argument', /seed/));
  assert.ok(build(mesh, {method: 'octree', seed: 2n ** 64n - 1n}).nodeCount > 1);
  assert.throws(() => new Mesh([0, 0, 0], new BigUint64Array(3)), thrown('bad_argument', /no index/));
  assert.throws(() => morula.firstHit(body, [0, 0], [5, 0, 0, -1]), thrown('rejected', /origin has 2/));
  assert.throws(() => morula.firstHit(body, [0, 0, 5], [0, 0, -1, 0, 0, 5, 0, 0, -1]), thrown('rejected', /direction has 9/));
  assert.throws(() => morula.locate(body, {length: 3 * 2 ** 29}), thrown('out_of_memory', /bytes/));
  body.setTransform({length: 9, ...[1, 0, 0, 0, 1, 0, 0, 0, 1]}, {length: 3, ...[0, 0, 0]}); // any ArrayLike

  const bytes = tree.toBytes();
  const shared = new Uint8Array(new SharedArrayBuffer(bytes.length));
  shared.set(bytes);
  const padded = new Uint8Array(bytes.length + 8);
  padded.set(bytes, 8);
  for (const form of [bytes.buffer, new DataView(padded.buffer, 8), shared, shared.buffer])
    assert.deepEqual(Tree.fromBytes(form, mesh).toBytes(), bytes);
  for (const form of [null, undefined, 5, [...bytes]])
    assert.throws(() => Tree.fromBytes(form, mesh), thrown('bad_argument', /ArrayBuffer/));
});

test('a rejected update leaves positions and transforms', () => {
  const {mesh, tree, body} = sample('limb', 8);
  const ray = [body, [0.3, 0.1, 5], [0, 0, -1]];
  const hit = morula.firstHit(...ray);
  const before = body.positions.slice();
  assert.throws(() => body.update(before.map((x) => 2 * x).fill(NaN, 9)), thrown('rejected', /not finite/));
  assert.throws(() => body.update(Array.from(before, (x, i) => (i < 9 ? 0 : Symbol()))), TypeError);
  assert.deepEqual(body.positions, before);
  body.update();
  assert.deepEqual(morula.firstHit(...ray), hit);
  const {vertexCount} = mesh;
  const skin = new Skin(1, new Uint32Array(vertexCount), new Float64Array(vertexCount).fill(1), 1);
  const follower = new Body(mesh, tree, {rules: 'skinned', skin});
  assert.throws(() => follower.updateSkinned(new Float64Array(12).fill(NaN)), thrown('rejected', /not finite/));
  assert.deepEqual([...follower.transforms], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]);
});

test('progress is told, stops a build, and may throw', () => {
  const mesh = Mesh.sample('limb', 16);
  const shares = [];
  build(mesh, {quality: 'draft', progress: (share) => void shares.push(share)});
  assert.ok(shares.length > 1 && shares.every((x, i) => x >= (shares[i - 1] ?? 0) && x <= 1));
  assert.throws(() => build(mesh, {quality: 'draft', progress: () => false}), thrown('stopped', /./));
  const own = new TypeError('of the page');
  assert.throws(() => build(mesh, {quality: 'draft', progress: () => { throw own; }}), (error) => error === own);
  assert.ok(build(mesh, {quality: 'draft'}).nodeCount > 1);
});

/** Nearest points of two convex hulls by taking weight from one difference of corners to another: slow, without cases. */
function hullDistance(a, b) {
  const corners = a.flatMap((p) => b.map((q) => ({at: sub(p, q), weight: 0})));
  corners[0].weight = 1;
  let now = corners[0].at;
  for (let step = 0; step < 3000; ++step) {
    const low = corners.reduce((x, y) => (dot(y.at, now) < dot(x.at, now) ? y : x));
    const high = corners.filter((c) => c.weight > 0).reduce((x, y) => (dot(y.at, now) > dot(x.at, now) ? y : x));
    const way = sub(low.at, high.at);
    const slope = -dot(way, now);
    if (slope <= 1e-14) break;
    const amount = Math.min(slope / dot(way, way), high.weight);
    low.weight += amount;
    high.weight -= amount;
    now = now.map((x, k) => x + amount * way[k]);
  }
  return Math.sqrt(dot(now, now));
}

test('near pairs are those of all vertices, edges and facets', () => {
  const a = sample('limb', 5);
  const b = sample('torus', 6);
  bend(a, 0.2);
  a.body.update();
  const offset = [0.3, 0.1, 0.2];
  b.body.setTransform([1, 0, 0, 0, 1, 0, 0, 0, 1], offset);
  const placesOf = ({mesh, body}, by) => Array.from({length: mesh.vertexCount}, (_, v) =>
    add([...body.positions.subarray(3 * v, 3 * v + 3)], by));
  const facetsOf = ({mesh}) => Array.from({length: mesh.facetCount}, (_, f) => [...mesh.facets.subarray(3 * f, 3 * f + 3)]);
  const edgesOf = (scene) => [...new Map(facetsOf(scene).flatMap(([x, y, z]) => [[x, y], [y, z], [z, x]])
    .map((e) => e.sort((x, y) => x - y)).map((e) => [e.join(), e])).values()];
  const places = [placesOf(a, [0, 0, 0]), placesOf(b, offset)];
  const single = (list) => list.map((_, v) => [v]);
  const distance = 0.15;
  const sure = [];
  const possible = new Set();
  for (const [kind, first, second] of [['vertex-facet', single(places[0]), facetsOf(b)],
    ['facet-vertex', facetsOf(a), single(places[1])], ['edge-edge', edgesOf(a), edgesOf(b)]])
    for (const x of first)
      for (const y of second) {
        const d = hullDistance(x.map((v) => places[0][v]), y.map((v) => places[1][v]));
        const key = `${kind} ${[...x].sort()} ${[...y].sort()}`;
        if (d < distance - 1e-4) sure.push(key);
        if (d < distance + 1e-4) possible.add(key);
      }
  const pairs = morula.proximity(a.body, b.body, {distance});
  const found = new Set(pairs.map((p) => `${p.kind} ${[...p.verticesA].sort()} ${[...p.verticesB].sort()}`));
  assert.ok(sure.length > 20 && sure.length < 2000, `${sure.length}`);
  assert.equal(found.size, pairs.length);
  assert.deepEqual(sure.filter((key) => !found.has(key)), []);
  assert.deepEqual([...found].filter((key) => !possible.has(key)), []);
  for (const p of pairs) {
    const point = (vertices, weights, all) =>
      vertices.reduce((sum, v, i) => add(sum, all[v].map((x) => x * weights[i])), [0, 0, 0]);
    assert.ok(Math.hypot(...sub(point(p.verticesA, p.weightsA, places[0]), p.pointA)) < 1e-6);
    assert.ok(Math.hypot(...sub(point(p.verticesB, p.weightsB, places[1]), p.pointB)) < 1e-6);
    assert.ok(Math.abs(Math.hypot(...sub(p.pointA, p.pointB)) - p.distance) < 1e-6);
  }
});

test('budgets end queries, whose answers then hold, and the rest follows', () => {
  const a = sample('limb', 24);
  const b = sample('torus', 24);
  b.body.setTransform([1, 0, 0, 0, 1, 0, 0, 0, 1], [0.2, 0.1, 0.1]);
  const pairs = new PairQuery();
  const key = (p) => [p.kind, p.a, p.b].join();
  for (const search of ['near', 'crossing']) {
    const all = pairs[search](a.body, b.body, {distance: 0.05}).map(key);
    assert.ok(all.length > 10 && pairs.finished);
    assert.throws(() => pairs.resume(), thrown('bad_argument', /budget/));
    let some = pairs[search](a.body, b.body, {distance: 0.05, boxTests: 20}).map(key);
    assert.ok(!pairs.finished && some.length < all.length);
    let calls = 0;
    for (; !pairs.finished; ++calls) {
      assert.ok(calls < 10000 && some.every((one) => all.includes(one)));
      some = pairs.resume(calls % 2 ? {boxTests: 100} : {budgetMs: 0.05}).map(key);
    }
    assert.ok(calls > 1);
    assert.deepEqual(some, all);
    assert.equal(pairs.count, all.length);
  }
  const contacts = new ContactQuery();
  const nodes = (list) => list.map((c) => [c.nodeA, c.nodeB].join()).sort();
  const complete = nodes(contacts.run(a.body, b.body));
  contacts.run(a.body, b.body, {pairTests: 100});
  assert.equal(contacts.finished, false);
  let last = null;
  for (let calls = 0; !contacts.finished; ++calls) {
    assert.ok(calls < 10000);
    last = contacts.resume(calls % 2 ? {pairTests: 300} : {budgetMs: 0.1});
  }
  assert.deepEqual(nodes(last), complete);
  contacts.run(a.body, b.body, {pairTests: 100});
  b.body.setTransform([1, 0, 0, 0, 1, 0, 0, 0, 1], [0.2, 0.1, 2]);
  assert.throws(() => contacts.resume(), thrown('rejected', /./));

  const exact = morula.distance(a.body, b.body);
  assert.equal(exact.complete, true);
  for (const options of [{pairTests: 0}, {budgetMs: 0}, {tolerance: 0.5}, {stopAbove: 0.01}, {stopBelow: 9}]) {
    const rough = morula.distance(a.body, b.body, options);
    assert.ok(rough.lower <= exact.upper && rough.upper >= exact.lower);
    assert.equal(rough.complete, !('pairTests' in options || 'budgetMs' in options));
  }
  for (const bad of [{budgetMs: -1}, {budgetMs: NaN}, {pairTests: 1.5}, {pairTests: 1, budgetMs: 1}, {tolerance: NaN}])
    assert.throws(() => morula.distance(a.body, b.body, bad), MorulaError);
  assert.throws(() => pairs.near(a.body, b.body, {distance: -1}), thrown('bad_argument', /distance/));
  assert.throws(() => pairs.near(a.body, b.body, {distance: 1, rings: -1}), thrown('bad_argument', /rings/));
  const tree = build(a.mesh, {quality: 'best', budgetMs: 1});
  assert.equal(new Body(a.mesh, tree).certify(), true);
  assert.throws(() => build(a.mesh, {budgetMs: 1, timeLimitSeconds: 1}), thrown('bad_argument', /one limit/));
});

test('a search for pairs that its budget ended ends for good with its bodies', () => {
  const a = sample('limb', 16);
  const b = sample('torus', 16);
  b.body.setTransform([1, 0, 0, 0, 1, 0, 0, 0, 1], [0.2, 0.1, 0.1]);
  for (const {body} of [a, b]) body.update();
  const pairs = new PairQuery();
  const all = pairs.near(a.body, b.body, {distance: 0.05});
  assert.ok(all.length > 10);
  pairs.near(a.body, b.body, {distance: 0.05, boxTests: 20});
  assert.throws(() => pairs.near(a.body, b.body, {distance: -1}), thrown('bad_argument', /distance/));
  assert.deepEqual(pairs.resume(), all);
  pairs.near(a.body, b.body, {distance: 0.05, boxTests: 20});
  b.body.free();
  assert.throws(() => pairs.resume(), thrown('bad_argument', /freed/));
  assert.equal(pairs.finished, false);
  // The next search needs no body of this one.
  pairs.near(a.body, null, {distance: 0.05, rings: 2, boxTests: 20});
  pairs.resume();
  a.body.free();
  assert.equal(pairs.finished, true);
});

test('workers end with the builds that do not begin', {timeout: 60000}, async () => {
  const mesh = Mesh.sample('limb', 16);
  const ports = () => process.getActiveResourcesInfo().filter((name) => name === 'MessagePort').length;
  const before = ports();
  const reason = new Error('of the page');
  // While the worker starts: an exception in its events would end the process.
  for (const later of [(abort) => abort(), queueMicrotask, setImmediate]) {
    const stop = new AbortController();
    const pending = morula.buildAsync(mesh, {quality: 'draft', signal: stop.signal});
    later(() => stop.abort(reason));
    await assert.rejects(pending, (error) => error === reason);
  }
  const freed = Mesh.sample('limb', 16);
  const pending = morula.buildAsync(freed, {quality: 'draft'});
  freed.free();
  await assert.rejects(pending, thrown('bad_argument', /freed/));
  assert.ok((await morula.buildAsync(mesh, {quality: 'draft'})).nodeCount > 1);
  for (let wait = 0; ports() > before && wait < 500; ++wait) await new Promise((resolve) => setTimeout(resolve, 10));
  assert.equal(ports(), before);
  await assert.rejects(morula.buildAsync(mesh, {signal: {}}), thrown('bad_argument', /AbortSignal/));
  // Signals of browsers before Chrome 98 and Safari 15.4 have neither a reason nor throwIfAborted.
  const old = Object.assign(new EventTarget(), {aborted: true});
  await assert.rejects(morula.buildAsync(mesh, {signal: old}), {name: 'AbortError'});
});

test('a worker that fails in a build ends it, and no other begins', async () => {
  const {run} = await packageModule('src/workers.js');
  for (const isReady of [false, true]) {
    let ended = 0;
    const worker = {
      postMessage() {
        if (isReady) worker.onmessage({data: {isReady}});
        worker.onerror({message: 'full'});
        worker.onmessage({data: {bytes: null}}); // too late
      },
      terminate: () => ++ended,
    };
    const result = run(worker, {}, [], null, (message) => !message.isReady);
    await assert.rejects(result, (error) => thrown('internal', /full/)(error) && error.unstarted === !isReady);
    assert.equal(ended, 1);
  }
  // The worker of the package says when its module is loaded.
  const {workerAt} = await packageModule('src/workers.js');
  const worker = await workerAt(packageFile('src/worker.js'));
  const heard = [];
  const mesh = octahedron();
  const job = {module: await WebAssembly.compile(await readFile(packageFile('dist/morula-full-plain.wasm'))),
    positions: mesh.positions.slice(), facets: mesh.facets.slice(), options: {method: 'octree'}, hasProgress: false};
  await run(worker, job, [], null, (message) => heard.push(Object.keys(message)[0]) === 2);
  assert.deepEqual(heard, ['isReady', 'bytes']);
});

test('buildAsync builds the same tree in a worker, tells progress, and stops', async () => {
  const inline = await packageModule('src/inline.js');
  for (const own of [morula, await inline.load()]) {
    const mesh = own.Mesh.sample('limb', 16);
    const shares = [];
    const ticks = setInterval(() => shares.push('tick'), 1);
    const tree = await own.buildAsync(mesh, {quality: 'draft', progress: (share) => void shares.push(share)});
    clearInterval(ticks);
    assert.ok(shares.includes('tick') && shares.filter((x) => x !== 'tick').length > 1);
    const bytes = tree.toBytes();
    assert.deepEqual(bytes, own.build(mesh, {quality: 'draft'}).toBytes());
    await assert.rejects(own.buildAsync(mesh, {progress: () => false}), thrown('stopped', /stopped/));
    const reason = new TypeError('of the page');
    await assert.rejects(own.buildAsync(mesh, {progress: () => { throw reason; }}), (error) => error === reason);
    const signal = AbortSignal.abort(reason);
    await assert.rejects(own.buildAsync(mesh, {signal}), (error) => error === reason);
    const later = new AbortController();
    const pending = own.buildAsync(own.Mesh.sample('limb', 64), {quality: 'best', signal: later.signal});
    setTimeout(() => later.abort(reason), 100);
    await assert.rejects(pending, (error) => error === reason);
    await assert.rejects(own.buildAsync(mesh, {method: 'magic'}), thrown('bad_argument', /magic/));
    await assert.rejects(own.buildAsync(mesh, {seed: () => 1}), /clone/);
    await assert.rejects(own.buildAsync(mesh, {seed: 1.5}), thrown('bad_argument', /seed/));
    await assert.rejects(own.buildAsync({}), thrown('bad_argument', /no Mesh/));
    const two = await Promise.all([0, 1].map(() => own.buildAsync(mesh, {quality: 'draft'})));
    for (const one of two) assert.deepEqual(one.toBytes(), bytes);
  }
  const runtime = await load({variant: 'runtime'});
  await assert.rejects(runtime.buildAsync(new runtime.Mesh([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2])),
    thrown('bad_argument', /variant "full"/));
});

test('views follow the memory when it grows', async () => {
  const own = await load();
  const mesh = own.Mesh.sample('limb', 12);
  const body = new own.Body(mesh, own.build(mesh, {method: 'octree'}));
  body.update();
  const old = body.positions;
  const values = old.slice();
  const size = own.memory().byteLength;
  const large = own.Mesh.sample('limb', 150);
  assert.ok(own.memory().byteLength > size);
  assert.equal(old.length, 0);
  assert.deepEqual(body.positions, values);
  // A view of the module's memory as the argument of calls that allocate.
  assert.equal(body.certify(body.positions), true);
  assert.equal(new own.Mesh(large.positions, large.facets).vertexCount, large.vertexCount);
});

test('the memory is flat: builds and frees, failures, and what the garbage collector finds', async () => {
  const own = await load();
  const round = () => {
    const mesh = own.Mesh.sample('bar', 3);
    const tree = own.build(mesh, {method: 'octree', depth: 1});
    const body = new own.Body(mesh, tree);
    body.update();
    for (const object of [mesh, tree, body]) object.free();
    assert.throws(() => own.build(octa, {depth: 99}), MorulaError);
  };
  const octa = new own.Mesh([1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0], [0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0]);
  for (let i = 0; i < 20; ++i) round();
  const size = own.memory().byteLength;
  for (let i = 0; i < 1000; ++i) round();
  assert.equal(own.memory().byteLength, size);

  const {setFlagsFromString} = await import('node:v8');
  const {runInNewContext} = await import('node:vm');
  setFlagsFromString('--expose-gc');
  const gc = runInNewContext('gc');
  const many = new Float64Array(300000);
  many[3] = many[7] = 1;
  const forget = () => {
    for (let i = 0; i < 20; ++i) new own.Mesh(many, [0, 1, 2]);
  };
  const settle = async () => {
    gc();
    await new Promise((done) => setTimeout(done, 20));
  };
  forget();
  await settle();
  const kept = own.memory().byteLength;
  for (let i = 0; i < 20; ++i) {
    forget();
    await settle();
  }
  assert.ok(own.memory().byteLength <= 2 * kept, `${kept} became ${own.memory().byteLength}`);
});

test('the small variant answers as the other, and says what it lacks', async () => {
  const small = await load({variant: 'runtime'});
  const scene = sample('limb', 16);
  bend(scene, 0.4);
  scene.body.update();
  const mesh = new small.Mesh(scene.mesh.positions, scene.mesh.facets);
  const tree = small.Tree.fromBytes(scene.tree.toBytes(), mesh);
  const body = new small.Body(mesh, tree);
  body.update(scene.body.positions);
  assert.deepEqual(body.spheres(), scene.body.spheres());
  assert.deepEqual(body.selfCrossings(), scene.body.selfCrossings());
  const other = new small.Body(mesh, tree);
  const like = new Body(scene.mesh, scene.tree);
  for (const one of [other, like]) one.setTransform([1, 0, 0, 0, 1, 0, 0, 0, 1], [0.05, 0.1, 0]);
  assert.equal(small.overlap(body, other), morula.overlap(scene.body, like));
  assert.deepEqual(small.crossings(body, other), morula.crossings(scene.body, like));
  assert.deepEqual(small.distance(body, other), morula.distance(scene.body, like));
  assert.deepEqual(new small.ContactQuery().run(body, other), new ContactQuery().run(scene.body, like));
  assert.deepEqual(small.proximity(body, other, {distance: 0.02}), morula.proximity(scene.body, like, {distance: 0.02}));
  assert.deepEqual(small.firstHit(body, [0, 3, 0], [0, -1, 0]), morula.firstHit(scene.body, [0, 3, 0], [0, -1, 0]));
  assert.deepEqual(small.locate(body, [0, 0, 0]), morula.locate(scene.body, [0, 0, 0]));
  assert.equal(body.certify(), true);
  const lacks = thrown('bad_argument', /variant "full"/);
  for (const call of [() => small.build(mesh), () => tree.toBytes(), () => small.Mesh.sample('limb', 16),
    () => small.Mesh.fromBytes('a.obj', new Uint8Array(1)), () => new small.Body(mesh, tree, {rules: 'wrapped'}),
    () => new small.Body(mesh, tree, {rules: ['exact', 'traditional']})]) assert.throws(call, lacks);
  body.update();
  assert.deepEqual(body.spheres(), scene.body.spheres());
});

test('a variant is one of two', async () => {
  const inline = await packageModule('src/inline.js');
  for (const own of [load, inline.load])
    for (const variant of ['toString', 'tiny', null]) await assert.rejects(own({variant}), thrown('bad_argument', /variant/));
});

test('modules come as bytes, as a compiled module, and as text in JavaScript', async () => {
  const bytes = await readFile(packageFile('dist/morula-runtime-plain.wasm'));
  for (const source of [bytes, await WebAssembly.compile(bytes), packageFile('dist/morula-runtime-simd.wasm')])
    assert.equal((await load({source})).version, morula.version);
  const inline = await packageModule('src/inline.js');
  assert.equal((await inline.load({variant: 'runtime'})).version, morula.version);
  await assert.rejects(load({variant: 'tiny'}), thrown('bad_argument', /tiny/));
});
