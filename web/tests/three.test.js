// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula/three beside three.js itself: hits are those of its own raycast over all facets, bit by bit, and its own vertices are
// in the spheres of every level.
import assert from 'node:assert/strict';
import test from 'node:test';
import {arm, bruteHits, character, interleaved, knot, pose, quantized, random, three, verticesOf} from './characters.js';
import {packageModule} from './package.js';

const {load, MorulaError} = await packageModule();
const {ContactLines, MorulaBounds, SphereLines} = await packageModule('src/three.js');
const morula = await load();
const {BackSide, Box3, BufferAttribute, BufferGeometry, DoubleSide, Float32BufferAttribute, Frustum, InstancedMesh, Matrix4, Mesh,
  MeshBasicMaterial, PlaneGeometry, Raycaster, Vector3} = three;

/** Rays at an object from all sides, some of which miss, some of which start inside. */
function raysAt(object, count, seed = 1) {
  const next = random(seed);
  const corners = verticesOf(object);
  const vertex = () => {
    const v = 3 * Math.floor((next() * corners.length) / 3);
    return new Vector3(...corners.slice(v, v + 3)).applyMatrix4(object.matrixWorld);
  };
  const size = new Box3().setFromArray(corners).getSize(new Vector3()).length() * object.matrixWorld.getMaxScaleOnAxis();
  return Array.from({length: count}, (_, i) => {
    const goal = vertex();
    const aim = vertex().lerp(goal, i % 5 === 0 ? 1 : next()); // every fifth ray goes through a vertex
    const from = new Vector3(next() - 0.5, next() - 0.5, next() - 0.5).normalize().multiplyScalar((i % 3) * size).add(goal);
    if (i % 7 === 0) aim.addScaledVector(new Vector3(next() - 0.5, next() - 0.5, next() - 0.5), size);
    return new Raycaster(from, aim.sub(from).normalize());
  });
}

/** Compares all hits of rays with those of three.js. Returns the number of rays that hit. */
function compareRays(bounds, count, seed) {
  let hitting = 0;
  for (const raycaster of raysAt(bounds.object, count, seed)) {
    const expected = bruteHits(raycaster, bounds.object);
    const hits = [];
    bounds.raycast(raycaster, hits);
    assert.deepEqual(hits.sort((a, b) => a.distance - b.distance), expected);
    raycaster.firstHitOnly = true;
    const first = [];
    bounds.raycast(raycaster, first);
    assert.deepEqual(first, expected.slice(0, 1));
    hitting += expected.length > 0;
  }
  return hitting;
}

/** Checks that every vertex, and points of every facet, are in a sphere of every level, and in the sphere and the box. */
function requireCovered(bounds) {
  const {object} = bounds;
  const points = verticesOf(object);
  const {index} = object.geometry;
  const count = index ? index.count : points.length / 3;
  for (let i = 0; i + 2 < count; i += 3) {
    const corners = [0, 1, 2].map((k) => points.slice(3 * (index ? index.getX(i + k) : i + k)).slice(0, 3));
    for (const [u, v] of [[1 / 3, 1 / 3], [0.5, 0.5], [0.1, 0.2]])
      points.push(...[0, 1, 2].map((k) => u * corners[0][k] + v * corners[1][k] + (1 - u - v) * corners[2][k]));
  }
  if (bounds.space === 'world') {
    const target = new Vector3();
    for (let i = 0; i < points.length; i += 3) target.fromArray(points, i).applyMatrix4(object.matrixWorld).toArray(points, i);
  }
  const allowed = 1e-6 * bounds.sphere.radius;
  for (let level = 0; level < bounds.tree.levelCount; ++level) {
    const spheres = bounds.spheres(level);
    for (let i = 0; i < points.length; i += 3) {
      let isCovered = false;
      for (let s = 0; s < spheres.length && !isCovered; s += 4)
        isCovered = Math.hypot(points[i] - spheres[s], points[i + 1] - spheres[s + 1], points[i + 2] - spheres[s + 2]) <=
          spheres[s + 3] + allowed;
      assert.ok(isCovered, `level ${level}, point ${i / 3}`);
    }
  }
  const point = new Vector3();
  for (let i = 0; i < points.length; i += 3) {
    point.fromArray(points, i);
    assert.ok(bounds.sphere.containsPoint(point) && bounds.box.containsPoint(point), `point ${i / 3} is outside`);
  }
}

const places = {
  identity: new Matrix4(),
  uneven: new Matrix4().makeRotationX(0.7).multiply(new Matrix4().makeScale(2, 0.5, 1.3)).setPosition(3, -2, 5),
  mirrored: new Matrix4().makeRotationZ(0.4).multiply(new Matrix4().makeScale(-1.5, 1.5, 1.5)).setPosition(-1, 0, 2),
  far: new Matrix4().makeRotationY(1).setPosition(2e4, -1e4, 3e4),
};
const geometries = {
  indexed: () => arm(),
  plain: () => arm({isIndexed: false}),
  interleaved: () => interleaved(arm()),
};

for (const [name, place] of Object.entries(places))
  for (const space of ['local', 'world'])
    test(`bones: cover and rays, ${name} place, ${space} space`, () => {
      for (const make of Object.values(geometries)) {
        const mesh = character(make(), {place});
        const bounds = new MorulaBounds(morula, mesh, {space});
        for (const amount of [0, 0.4, 1.2]) {
          pose(mesh, amount, amount);
          bounds.update();
          requireCovered(bounds);
          const hitting = compareRays(bounds, 60);
          assert.ok(hitting > 20 && hitting < 60);
        }
        bounds.free();
      }
    });

test('seams are welded: an arm with seams is a closed surface', () => {
  const mesh = character(arm({isIndexed: false}));
  const bounds = new MorulaBounds(morula, mesh);
  const {facets} = bounds.mesh;
  const edges = new Map();
  for (let i = 0; i < facets.length; i += 3)
    for (const [a, b] of [[0, 1], [1, 2], [2, 0]]) {
      const [v, w] = [facets[i + a], facets[i + b]];
      edges.set(`${v} ${w}`, (edges.get(`${v} ${w}`) ?? 0) + 1);
    }
  for (const [edge, count] of edges) assert.equal(edges.get(edge.split(' ').reverse().join(' ')), count, edge);
  assert.ok(bounds.mesh.vertexCount < mesh.geometry.attributes.position.count / 3);
  const apart = new MorulaBounds(morula, mesh, {weld: false});
  assert.equal(apart.mesh.vertexCount, mesh.geometry.attributes.position.count);
  compareRays(apart, 40);
});

test('weights that do not add up to 1, and quantized attributes, move vertices as three.js moves them', () => {
  const halved = arm();
  for (let i = 0; i < halved.attributes.skinWeight.array.length; ++i) halved.attributes.skinWeight.array[i] *= i % 3 ? 0.75 : 1.2;
  for (const geometry of [halved, quantized(arm(), 8)]) {
    const mesh = character(geometry, {place: places.uneven});
    const bounds = new MorulaBounds(morula, mesh);
    pose(mesh, 0.8, 2);
    bounds.update();
    requireCovered(bounds);
    assert.ok(compareRays(bounds, 60) > 10);
  }
});

test('weights in float far from the origin: bounds hold what three.js draws', () => {
  const geometry = arm();
  const {array} = geometry.attributes.skinWeight;
  for (let i = 0; i < array.length; i += 4) array.set([0.1 + array[i] * 0.7, 0.1 + array[i + 1] * 0.7, 0.1 + array[i + 2] * 0.7, 0], i);
  const mesh = character(geometry, {place: places.far});
  mesh.normalizeSkinWeights();
  const bounds = new MorulaBounds(morula, mesh);
  pose(mesh, 0.7, 1);
  bounds.update();
  const vertices = verticesOf(mesh);
  for (let i = 0; i < vertices.length; i += 3) {
    const vertex = new Vector3().fromArray(vertices, i);
    assert.ok(bounds.sphere.containsPoint(vertex) && bounds.box.containsPoint(vertex));
  }
  assert.ok(compareRays(bounds, 60) > 10);

  // The sphere of one facet touches its corners, and weights move all of them alike.
  for (const sign of [1, -1]) {
    const facet = new BufferGeometry();
    facet.setAttribute('position', new Float32BufferAttribute([1, 0, 0, -0.5, 0.8, 0, -0.5, -0.8, 0], 3));
    facet.setAttribute('skinIndex', new BufferAttribute(new Uint16Array([0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]), 4));
    facet.setAttribute('skinWeight', new Float32BufferAttribute(Array.from({length: 3}, () => [0.1, 0.2, 0.3, 0.4 + sign * 5e-7]).flat(), 4));
    const one = character(facet, {place: places.far});
    const around = new MorulaBounds(morula, one);
    const corners = verticesOf(one);
    for (let i = 0; i < 9; i += 3) assert.ok(around.sphere.containsPoint(new Vector3().fromArray(corners, i)));
  }
});

test('a detached bind, and bones outside of the mesh', () => {
  const mesh = character(arm());
  const root = mesh.skeleton.bones[0];
  mesh.remove(root);
  root.position.set(1, 2, 3);
  root.updateMatrixWorld(true);
  for (const mode of ['attached', 'detached']) {
    mesh.bindMode = mode;
    mesh.position.set(5, 0, 0);
    const bounds = new MorulaBounds(morula, mesh);
    mesh.position.set(7, 1, 0);
    pose(mesh, 0.5, 1);
    root.updateMatrixWorld(true);
    bounds.update();
    requireCovered(bounds);
    assert.ok(compareRays(bounds, 40) > 10);
  }
});

test('morph targets, with and without bones, relative and absolute', () => {
  for (const isRelative of [true, false])
    for (const hasBones of [true, false]) {
      const geometry = arm();
      const {position} = geometry.attributes;
      const targets = [0, 1].map((j) => new Float32BufferAttribute(Array.from({length: 3 * position.count}, (_, i) =>
        (isRelative ? 0 : position.array[i]) + 0.3 * Math.sin((j + 1) * position.array[3 * Math.floor(i / 3) + 1] + (i % 3))), 3));
      geometry.morphAttributes.position = targets;
      geometry.morphTargetsRelative = isRelative;
      const mesh = hasBones ? character(geometry) : new Mesh(geometry, new MeshBasicMaterial());
      mesh.updateMatrixWorld(true);
      const bounds = new MorulaBounds(morula, mesh);
      mesh.morphTargetInfluences[0] = 0.8;
      mesh.morphTargetInfluences[1] = -1.5;
      if (hasBones) pose(mesh, 0.6, 1);
      bounds.update();
      requireCovered(bounds);
      assert.ok(compareRays(bounds, 40) > 10);
    }
});

test('positions that the program writes', () => {
  const mesh = new Mesh(knot(), new MeshBasicMaterial());
  mesh.applyMatrix4(places.uneven);
  mesh.updateMatrixWorld(true);
  const bounds = new MorulaBounds(morula, mesh);
  const {position} = mesh.geometry.attributes;
  for (let v = 0; v < position.count; ++v) position.setZ(v, position.getZ(v) + 0.4 * Math.sin(2 * position.getX(v)));
  position.needsUpdate = true;
  bounds.update();
  requireCovered(bounds);
  assert.ok(compareRays(bounds, 60) > 10);
  position.setX(0, position.getX(0) + 0.1); // one side of a seam
  position.needsUpdate = true;
  assert.throws(() => bounds.update(), /weld/);
  const apart = new MorulaBounds(morula, mesh, {weld: false});
  position.setX(0, position.getX(0) + 0.1);
  position.needsUpdate = true;
  apart.update();
  requireCovered(apart);
  mesh.geometry.setAttribute('position', position.clone().applyMatrix4(new Matrix4().makeScale(1, 2, 1))); // another attribute
  apart.update();
  requireCovered(apart);
  mesh.geometry.setIndex(mesh.geometry.index.clone());
  assert.throws(() => apart.update(), /index/);
  const skinned = character();
  const own = new MorulaBounds(morula, skinned);
  skinned.geometry.attributes.position.needsUpdate = true;
  assert.throws(() => own.update(), MorulaError);
});

test('sides, groups, draw ranges, near and far', () => {
  const geometry = knot();
  const third = 3 * Math.floor(geometry.index.count / 9);
  geometry.addGroup(0, third, 1);
  geometry.addGroup(third, third, 0);
  geometry.addGroup(third, third, 2); // drawn twice
  const materials = [new MeshBasicMaterial({side: BackSide}), new MeshBasicMaterial(), new MeshBasicMaterial({side: DoubleSide})];
  for (const material of [materials, materials[0], materials[2]]) {
    const mesh = new Mesh(geometry, material);
    mesh.updateMatrixWorld(true);
    const bounds = new MorulaBounds(morula, mesh);
    geometry.setDrawRange(0, Infinity);
    assert.ok(compareRays(bounds, 60) > 10);
    geometry.setDrawRange(6, 2 * third - 9);
    assert.ok(compareRays(bounds, 60, 2) > 10);
    let hits = 0;
    for (const raycaster of raysAt(mesh, 60, 3)) {
      const all = bruteHits(raycaster, mesh);
      if (all.length < 2) continue;
      raycaster.near = all[0].distance + 1e-6; // just beyond the first hit, and just beyond another
      raycaster.far = all[all.length >> 1].distance + 1e-6;
      const expected = bruteHits(raycaster, mesh);
      const found = [];
      bounds.raycast(raycaster, found);
      assert.deepEqual(found.sort((a, b) => a.distance - b.distance), expected);
      hits += expected.length;
    }
    assert.ok(hits > 10);
    geometry.setDrawRange(1, 30);
    assert.throws(() => bounds.raycast(new Raycaster(new Vector3(0, 0, 5), new Vector3(0, 0, -1)), []), /corner 1/);
  }
});

test('facets that lie in one plane, twins and needles', () => {
  const plane = new PlaneGeometry(2, 2, 8, 8);
  const two = new BufferGeometry();
  const {position, uv} = plane.attributes;
  two.setAttribute('position', position);
  two.setAttribute('uv', uv);
  const corners = [...plane.index.array];
  const turned = corners.map((_, i) => corners[i - (i % 3) + (2 - (i % 3))]); // the same facets from below
  two.setIndex([...corners, ...turned, 0, 0, 1, 4, 4, 4, 0, 1, 8]);
  for (const side of [BackSide, DoubleSide, three.FrontSide]) {
    const mesh = new Mesh(two, new MeshBasicMaterial({side}));
    mesh.updateMatrixWorld(true);
    const bounds = new MorulaBounds(morula, mesh);
    const next = random(5);
    for (let i = 0; i < 60; ++i) {
      const x = i % 2 ? Math.round(8 * next()) / 4 - 1 : 2 * next() - 1; // half of the rays go along edges of the grid
      const raycaster = new Raycaster(new Vector3(x, 2 * next() - 1, i % 4 < 2 ? 2 : -2), new Vector3(0, 0, i % 4 < 2 ? -1 : 1));
      const hits = [];
      bounds.raycast(raycaster, hits);
      assert.deepEqual(hits.sort((a, b) => a.distance - b.distance), bruteHits(raycaster, mesh));
      assert.ok(hits.length > 0);
    }
  }
});

test('attributes of half precision', () => {
  const geometry = arm();
  const {position} = geometry.attributes;
  const halves = Uint16Array.from(position.array, (x) => three.DataUtils.toHalfFloat(x));
  geometry.setAttribute('position', new three.Float16BufferAttribute(halves, 3));
  for (const mesh of [new Mesh(geometry, new MeshBasicMaterial()), character(geometry)]) {
    const bounds = new MorulaBounds(morula, mesh);
    requireCovered(bounds);
    assert.ok(bounds.sphere.radius < 5);
    assert.ok(compareRays(bounds, 60) > 20);
  }
});

test('facets whose area rounding takes away, and groups that begin inside of a facet', () => {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute([0, 0, 0, 1, 0, 0, 0.5, 1e-9, 0], 3));
  geometry.setAttribute('uv', new Float32BufferAttribute([0, 0, 1, 0, 0, 1], 2));
  geometry.setAttribute('normal', new Float32BufferAttribute([0, 0, 1, 0, 0, 1, 0, 0, 1], 3));
  const mesh = new Mesh(geometry, new MeshBasicMaterial());
  const bounds = new MorulaBounds(morula, mesh);
  const raycaster = new Raycaster(new Vector3(0.5, 3e-10, 1), new Vector3(0, 0, -1));
  const hitsOf = () => {
    const hits = [];
    bounds.raycast(raycaster, hits);
    return hits;
  };
  const expected = bruteHits(raycaster, mesh);
  assert.equal(expected.length, 1);
  assert.deepEqual(hitsOf(), expected);
  mesh.material = [mesh.material];
  geometry.addGroup(0, 3, 0);
  geometry.addGroup(1, 0, 0); // without facets
  assert.deepEqual(hitsOf(), expected);
  geometry.addGroup(1, 2, 0);
  assert.throws(hitsOf, MorulaError);
});

test('attached bounds serve culling and raycasters, and come off again', () => {
  const mesh = character();
  const before = Object.getOwnPropertyNames(mesh);
  const camera = new three.PerspectiveCamera(30, 1, 0.1, 20);
  camera.up.set(0, 0, 1);
  camera.position.set(6, 12, 0);
  camera.lookAt(6, 6, 0);
  camera.updateMatrixWorld(true);
  const frustum = new Frustum().setFromProjectionMatrix(new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
  mesh.computeBoundingSphere(); // as three.js leaves it: at the first pose
  mesh.skeleton.bones[0].position.set(6, 4, 0);
  mesh.updateMatrixWorld(true);
  const vertex = new Vector3();
  const isSeen = Array.from({length: mesh.geometry.attributes.position.count}, (_, v) => v)
    .some((v) => frustum.containsPoint(mesh.getVertexPosition(v, vertex).applyMatrix4(mesh.matrixWorld)));
  assert.ok(isSeen && !frustum.intersectsObject(mesh)); // culled, though in the picture
  const bounds = new MorulaBounds(morula, mesh).attach();
  assert.ok(frustum.intersectsObject(mesh));
  assert.ok(new Box3().setFromObject(mesh).containsBox(new Box3().setFromObject(mesh, true)));
  mesh.boundingSphere = null; // programs do so to have it made again
  assert.ok(frustum.intersectsObject(mesh));
  const raycaster = new Raycaster(new Vector3(6.05, 6.03, 9), new Vector3(0, 0, -1));
  assert.deepEqual(raycaster.intersectObject(mesh), bruteHits(raycaster, mesh));
  assert.equal(raycaster.intersectObject(mesh).length, 1);
  bounds.detach();
  assert.deepEqual(Object.getOwnPropertyNames(mesh), before);
  assert.equal(mesh.raycast, three.SkinnedMesh.prototype.raycast);
  const still = new Mesh(knot(), new MeshBasicMaterial());
  new MorulaBounds(morula, still).attach().free();
  assert.equal('boundingSphere' in still, false);
});

test('bounds of one object take turns, and freed ones do not attach', () => {
  const mesh = new Mesh(knot(), new MeshBasicMaterial());
  const [a, b] = [0, 1].map(() => new MorulaBounds(morula, mesh).attach());
  assert.equal(mesh.raycast, b.raycast);
  a.free();
  assert.equal(mesh.raycast, b.raycast);
  assert.throws(() => a.attach(), MorulaError);
  b.free();
  for (const name of ['raycast', 'boundingSphere', 'computeBoundingBox']) assert.ok(!Object.hasOwn(mesh, name), name);
  assert.throws(() => new MorulaBounds(morula, new three.SkinnedMesh(arm(), new MeshBasicMaterial())), MorulaError);
});

test('culling under a matrix with shear', () => {
  for (const space of ['local', 'world']) {
    const parent = new three.Group();
    parent.scale.set(5, 1, 1);
    const mesh = new Mesh(new three.BoxGeometry(4, 0.1, 0.1).rotateZ(-0.6), new MeshBasicMaterial());
    mesh.rotation.z = 0.6; // the box lies where the parent stretches
    parent.add(mesh);
    parent.updateMatrixWorld(true);
    new MorulaBounds(morula, mesh, {space}).attach();
    const sphere = mesh.boundingSphere.clone().applyMatrix4(mesh.matrixWorld);
    const box = new Box3().setFromObject(mesh);
    const vertices = verticesOf(mesh);
    let farthest = 0;
    for (let i = 0; i < vertices.length; i += 3) {
      const vertex = new Vector3().fromArray(vertices, i).applyMatrix4(mesh.matrixWorld);
      assert.ok(box.containsPoint(vertex));
      farthest = Math.max(farthest, vertex.distanceTo(sphere.center));
    }
    assert.ok(farthest <= sphere.radius && sphere.radius < 2 * farthest);
  }
});

/** Matrices that flatten an object along one axis, along two, to a point, nearly, and askew. */
const flat = {
  plane: () => new Matrix4().makeScale(2, 0, 1).setPosition(1, 2, 3),
  line: () => new Matrix4().makeScale(0, 3, 0),
  point: () => new Matrix4().makeScale(0, 0, 0).setPosition(5, -4, 3),
  nearly: () => new Matrix4().makeRotationX(0.7).multiply(new Matrix4().makeScale(1, 1e-17, 1)).multiply(new Matrix4().makeRotationZ(0.5)),
  askew: () => new Matrix4().makeRotationX(0.7).multiply(new Matrix4().makeScale(1, 0, 0.5)).multiply(new Matrix4().makeRotationZ(0.5))
    .setPosition(-3, 0, 9),
};
for (const [name, make] of Object.entries(flat))
  test(`bounds of an object that its matrix flattens: ${name}`, () => {
    for (const space of ['local', 'world'])
      for (const isSkinned of [false, true]) {
        const mesh = isSkinned ? character() : new Mesh(knot().translate(3, 0, 0), new MeshBasicMaterial());
        if (isSkinned) mesh.bindMode = 'detached'; // the bones stay where they are
        const bounds = new MorulaBounds(morula, mesh, {space}).attach();
        mesh.matrixAutoUpdate = false;
        mesh.matrix.copy(make());
        mesh.updateMatrixWorld(true);
        bounds.update();
        const sphere = mesh.boundingSphere.clone().applyMatrix4(mesh.matrixWorld);
        const box = new Box3().setFromObject(mesh);
        const numbers = [...sphere.center.toArray(), sphere.radius, ...box.min.toArray(), ...box.max.toArray()];
        assert.ok(numbers.every(Number.isFinite), `${space}: ${numbers}`);
        const vertices = verticesOf(mesh);
        const allowed = 1e-12 * (1 + sphere.radius);
        for (let i = 0; i < vertices.length; i += 3) {
          const vertex = new Vector3().fromArray(vertices, i).applyMatrix4(mesh.matrixWorld);
          assert.ok(sphere.distanceToPoint(vertex) <= allowed && box.distanceToPoint(vertex) <= allowed, `${space}, vertex ${i / 3}`);
        }
        const hits = [];
        bounds.raycast(new Raycaster(new Vector3(0, 0, 20), new Vector3(0, 0, -1)), hits);
        assert.deepEqual(hits, bruteHits(new Raycaster(new Vector3(0, 0, 20), new Vector3(0, 0, -1)), mesh));
        bounds.free();
      }
  });

test('rays on a geometry that was replaced since the last update throw', () => {
  const raycaster = new Raycaster(new Vector3(0, 0, 9), new Vector3(0, 0, -1));
  const mesh = new Mesh(knot().toNonIndexed(), new MeshBasicMaterial({side: DoubleSide}));
  const bounds = new MorulaBounds(morula, mesh).attach();
  const hitsOf = () => raycaster.intersectObject(mesh);
  const throwsChanged = () => assert.throws(hitsOf, (error) => error instanceof MorulaError && /has changed since/.test(error.message));
  assert.deepEqual(hitsOf(), bruteHits(raycaster, mesh));
  // As many vertices elsewhere: an update follows them.
  mesh.geometry = knot().rotateX(1).toNonIndexed();
  throwsChanged();
  bounds.update();
  assert.deepEqual(hitsOf(), bruteHits(raycaster, mesh));
  // Other facets: only new bounds follow.
  const {geometry} = mesh;
  for (const other of [knot(), new three.BoxGeometry(), new three.BoxGeometry().toNonIndexed()]) {
    mesh.geometry = other;
    throwsChanged();
    assert.throws(() => bounds.update(), MorulaError);
    throwsChanged();
  }
  mesh.geometry = geometry;
  assert.equal(hitsOf().length, bruteHits(raycaster, mesh).length);
  geometry.setIndex(Array.from({length: 30}, (_, i) => i));
  throwsChanged();
});

test('bounds are tight', () => {
  const mesh = character(arm({round: 24, long: 60}));
  const bounds = new MorulaBounds(morula, mesh);
  pose(mesh, 0.5, 1);
  bounds.update();
  const exact = new Box3().setFromArray(verticesOf(mesh));
  assert.ok(bounds.box.getSize(new Vector3()).length() < 1.2 * exact.getSize(new Vector3()).length());
  assert.ok(bounds.sphere.radius < 1.2 * exact.getBoundingSphere(new three.Sphere()).radius);
});

test('characters share a tree, which lives as long as one of them', () => {
  const geometry = arm();
  const first = new MorulaBounds(morula, character(geometry));
  const mesh = character(geometry);
  const second = new MorulaBounds(morula, mesh, {like: first});
  assert.equal(first.tree, second.tree);
  first.free();
  pose(mesh, 0.7);
  second.update();
  requireCovered(second);
  assert.ok(compareRays(second, 30) > 5);
  second.free();
  second.free();
  assert.throws(() => second.update(), MorulaError);
  assert.throws(() => second.raycast(new Raycaster(), []), MorulaError);
  assert.throws(() => second.tree, MorulaError);
  assert.throws(() => new MorulaBounds(morula, mesh, {like: second}), MorulaError);
  const other = new MorulaBounds(morula, character());
  assert.throws(() => new MorulaBounds(morula, character(), {like: other}), MorulaError);
});

test('a tree from bytes, and from the userData of the geometry', async () => {
  const mesh = character();
  const bytes = new MorulaBounds(morula, mesh).tree.toBytes();
  const small = await load({variant: 'runtime'});
  const bounds = new MorulaBounds(small, mesh, {tree: bytes});
  mesh.geometry.userData.morula_tree = Buffer.from(bytes).toString('base64');
  const again = new MorulaBounds(small, mesh);
  for (const name of ['spheres', 'parent', 'firstChild', 'childCount']) assert.deepEqual(again.tree[name], bounds.tree[name], name);
  mesh.geometry.userData.morula_tree = 'no base64!';
  assert.throws(() => new MorulaBounds(small, mesh), MorulaError);
  assert.throws(() => new MorulaBounds(small, character(arm({long: 5})), {tree: bytes}), /another mesh/);
});

test('lines of a level, and of contacts', () => {
  const mesh = character();
  const bounds = new MorulaBounds(morula, mesh);
  const lines = new SphereLines(bounds, 1);
  mesh.add(lines);
  assert.equal(lines.geometry.instanceCount, bounds.tree.levelSet(1).length);
  for (let i = 0; i < lines.geometry.attributes.position.count; ++i)
    assert.ok(Math.abs(new Vector3().fromBufferAttribute(lines.geometry.attributes.position, i).length() - 1) < 1e-6);
  pose(mesh, 0.8);
  bounds.update();
  lines.update();
  const {array} = lines.geometry.attributes.sphere;
  bounds.spheres(1).forEach((x, i) => assert.equal(array[i], Math.fround(x)));
  for (let i = 0; i < array.length; i += 4)
    assert.ok(lines.boundingSphere.center.distanceTo(new Vector3(...array.slice(i, i + 3))) + array[i + 3] <=
      lines.boundingSphere.radius * (1 + 1e-6));
  lines.setLevel(2);
  assert.equal(lines.geometry.instanceCount, bounds.tree.levelSet(2).length);
  assert.deepEqual(new Raycaster(new Vector3(0, 1, 5), new Vector3(0, 0, -1)).intersectObject(lines), []);

  const other = character();
  other.position.x = 0.7;
  other.updateMatrixWorld(true);
  const second = new MorulaBounds(morula, other);
  const contacts = new morula.ContactQuery().run(bounds.placeInWorld().body, second.placeInWorld().body);
  assert.ok(contacts.length > 0);
  const drawn = new ContactLines({length: 0.5}).update(contacts);
  const [points, normals] = drawn.children;
  assert.equal(points.geometry.drawRange.count, contacts.length);
  contacts.forEach(({point, normal}, i) => {
    const begin = new Vector3().fromBufferAttribute(normals.geometry.attributes.position, 2 * i);
    const end = new Vector3().fromBufferAttribute(normals.geometry.attributes.position, 2 * i + 1);
    assert.ok(begin.distanceTo(new Vector3(...point)) < 1e-6);
    assert.ok(end.sub(begin).distanceTo(new Vector3(...normal).multiplyScalar(0.5)) < 1e-6);
  });
  other.scale.setScalar(2);
  other.updateMatrixWorld(true);
  assert.throws(() => second.placeInWorld(), /world/);
  other.scale.set(-1, 1, 1);
  other.updateMatrixWorld(true);
  assert.throws(() => second.placeInWorld(), /mirrors/);
  const scaled = new MorulaBounds(morula, other, {space: 'world'});
  assert.ok(new morula.ContactQuery().run(bounds.body, scaled.placeInWorld().body).length > 0);
});

test('bad input throws', () => {
  const material = new MeshBasicMaterial();
  const fails = (object, text, options) => assert.throws(() => new MorulaBounds(morula, object, options), (error) => {
    assert.ok(error instanceof MorulaError, String(error));
    assert.match(error.message, text);
    return true;
  });
  fails(null, /Mesh/);
  fails(new three.Points(), /Mesh/);
  fails(new InstancedMesh(knot(), material, 2), /InstancedMesh/);
  fails(new Mesh(new BufferGeometry(), material), /position/);
  fails(new Mesh(new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(4), 2)), material), /position/);
  fails(new Mesh(knot(), material), /space/, {space: 'view'});
  const wild = arm();
  wild.index.array[7] = 60000;
  fails(character(wild), /corner 1 of facet 2/);
  const holes = arm();
  holes.attributes.position.array[5] = NaN;
  fails(character(holes), /finite/);
  const lost = arm();
  lost.attributes.skinIndex.array[9] = 77;
  fails(character(lost), /bone 77 of 4/);
  const mesh = character();
  const bounds = new MorulaBounds(morula, mesh);
  const before = bounds.spheres();
  mesh.skeleton.bones[1].position.x = NaN;
  mesh.updateMatrixWorld(true);
  assert.throws(() => bounds.update(), MorulaError);
  assert.deepEqual(bounds.spheres(), before);
  mesh.skeleton.bones[1].position.x = 0;
  mesh.updateMatrixWorld(true);
  assert.ok(compareRays(bounds, 30) > 5); // the failed update has changed nothing
  mesh.skeleton.bones.pop();
  assert.throws(() => bounds.update(), /3 bones instead of 4/);
});
