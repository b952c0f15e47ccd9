// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How the vertices of an object move. Each class has update(body, toSpace), where toSpace is the matrix from the object's
// coordinates to those of the body; position(vertex), the offset in `points` of a vertex as of the last update; and weightSlack,
// how far three.js may put a vertex elsewhere because weights in float do not add up to 1.
import {Matrix4} from 'three';
import {MorulaError} from '../errors.js';
import {numbersOf, targetsOf, Versions} from './geometry.js';

const inverseOfBind = new Matrix4();
const isIdentity = (e) => e.every((x, i) => x === (i % 5 === 0 ? 1 : 0));

/** Writes the product of two matrices of three.js, whose last rows are 0 0 0 1, by columns. */
function multiply(a, b, to) {
  for (let k = 0; k < 4; ++k) {
    const x = b[4 * k], y = b[4 * k + 1], z = b[4 * k + 2], w = k === 3 ? 1 : 0;
    for (let i = 0; i < 3; ++i)
      to[4 * k + i] = a[i] * x + a[4 + i] * y + a[8 + i] * z + a[12 + i] * w;
  }
}
const first = new Float64Array(16);
const second = new Float64Array(16);

/** Writes the rows of [A | t] of each bone: x -> A x + t takes vertices at rest to where the bone alone would move them. The
 * bone that completes sums of weights has A = 0, for three.js adds the weighted bones up without dividing by the sum. */
function writeTransforms(object, toSpace, isCompleted, rows) {
  const {bones, boneInverses} = object.skeleton;
  const bind = object.bindMatrix.elements;
  const hasBind = !isIdentity(bind);
  const inverse = inverseOfBind.multiplyMatrices(toSpace, object.bindMatrixInverse).elements;
  for (let b = 0; b < bones.length; ++b) {
    multiply(inverse, bones[b].matrixWorld.elements, first);
    multiply(first, boneInverses[b].elements, second);
    let e = second;
    if (hasBind) multiply(second, bind, (e = first));
    for (let i = 0; i < 3; ++i) for (let k = 0; k < 4; ++k) rows[12 * b + 4 * i + k] = e[4 * k + i];
  }
  if (!isCompleted) return;
  for (let i = 0; i < 3; ++i) {
    rows.fill(0, 12 * bones.length + 4 * i, 12 * bones.length + 4 * i + 3);
    rows[12 * bones.length + 4 * i + 3] = inverse[12 + i];
  }
}

/** Writes sum_b w_b (A_b x + t_b) of a vertex. Arrays and offsets: x from, result to. */
function writeSkinned(skin, rows, vertex, from, begin, to, at) {
  const x = from[begin], y = from[begin + 1], z = from[begin + 2];
  let rx = 0, ry = 0, rz = 0;
  for (let k = vertex * skin.influences; k < (vertex + 1) * skin.influences; ++k) {
    const w = skin.weights[k];
    if (w === 0) continue;
    const r = 12 * skin.bones[k];
    rx += w * (rows[r] * x + rows[r + 1] * y + rows[r + 2] * z + rows[r + 3]);
    ry += w * (rows[r + 4] * x + rows[r + 5] * y + rows[r + 6] * z + rows[r + 7]);
    rz += w * (rows[r + 8] * x + rows[r + 9] * y + rows[r + 10] * z + rows[r + 11]);
  }
  to[at] = rx;
  to[at + 1] = ry;
  to[at + 2] = rz;
}

/** three.js adds L (A_b x + t_b) with the weights, and then the translation of the matrix back to the object; here that
 * translation is a part of every bone's. Relative to the size of the body the difference is in MorulaBounds. */
function slackOf(skin) {
  const e = inverseOfBind.elements;
  return skin.isCompleted ? 0 : 2 * skin.missing * (Math.abs(e[12]) + Math.abs(e[13]) + Math.abs(e[14]));
}

function requireSameFacets(object, model) {
  if (!model.versions.facets(object))
    throw new MorulaError('the index or the skin of the geometry has changed: make new bounds');
  if (!object.isSkinnedMesh) return;
  const {bones} = object.skeleton;
  const count = model.arrays.skin.boneCount - (model.arrays.skin.isCompleted ? 1 : 0);
  if (bones.length !== count) throw new MorulaError(`the skeleton has ${bones.length} bones instead of ${count}`);
}

/** Vertices that follow bones alone. Spheres follow the bones, and vertices are computed when a ray needs them. */
export class BonePose {
  #rows;
  #next;
  #made;
  #stamp = 0;

  constructor(object, model) {
    this.object = object;
    this.model = model;
    this.rules = 'skinned';
    this.weightSlack = 0;
    this.#rows = new Float64Array(12 * model.arrays.skin.boneCount);
    this.#next = this.#rows.slice();
    this.#made = new Uint32Array(model.arrays.first.length);
    this.points = new Float64Array(3 * model.arrays.first.length);
  }
  update(body, toSpace) {
    const {model, object} = this;
    requireSameFacets(object, model);
    if (!model.versions.vertices(object))
      throw new MorulaError('the positions of a skinned geometry have changed: make new bounds');
    writeTransforms(object, toSpace, model.arrays.skin.isCompleted, this.#next);
    body.updateSkinned(this.#next);
    [this.#rows, this.#next] = [this.#next, this.#rows];
    this.weightSlack = slackOf(model.arrays.skin);
    ++this.#stamp;
  }
  position(vertex) {
    if (this.#made[vertex] !== this.#stamp) {
      const {skin, positions} = this.model.arrays;
      writeSkinned(skin, this.#rows, vertex, positions, 3 * vertex, this.points, 3 * vertex);
      this.#made[vertex] = this.#stamp;
    }
    return 3 * vertex;
  }
}

/** Vertices that are computed in every update: those of morph targets, of positions that the program writes, and of objects
 * that never move. */
export class VertexPose {
  #rest;
  #targets;
  #versions;
  #rows = null;

  constructor(object, model) {
    this.object = object;
    this.model = model;
    this.rules = 'exact';
    this.weightSlack = 0;
    this.#rest = model.arrays.positions;
    this.#targets = model.arrays.targets;
    this.#versions = model.versions;
    this.points = this.#rest.slice();
    if (model.arrays.skin) this.#rows = new Float64Array(12 * model.arrays.skin.boneCount);
  }
  update(body, toSpace) {
    const {object, model, points} = this;
    requireSameFacets(object, model);
    this.#read();
    const next = this.#rest.slice();
    this.#targets.forEach((target, j) => {
      const weight = object.morphTargetInfluences?.[j] ?? 0;
      if (weight !== 0) for (let i = 0; i < next.length; ++i) next[i] += weight * target[i];
    });
    if (this.#rows) {
      const {skin} = model.arrays;
      writeTransforms(object, toSpace, skin.isCompleted, this.#rows);
      for (let v = 0; 3 * v < next.length; ++v) writeSkinned(skin, this.#rows, v, next, 3 * v, next, 3 * v);
    } else {
      const e = toSpace.elements;
      for (let i = 0; i < next.length; i += 3) {
        const x = next[i], y = next[i + 1], z = next[i + 2];
        for (let k = 0; k < 3; ++k) next[i + k] = e[k] * x + e[4 + k] * y + e[8 + k] * z + e[12 + k];
      }
    }
    body.update(next);
    points.set(next);
    if (this.#rows) this.weightSlack = slackOf(model.arrays.skin);
  }
  position(vertex) {
    return 3 * vertex;
  }
  /** Reads positions and morph targets again if their owner has changed them. */
  #read() {
    if (this.#versions.vertices(this.object)) return;
    const versions = new Versions(this.object);
    const {geometry} = this.object;
    const {vertexOf, first} = this.model.arrays;
    const {count} = geometry.attributes.position;
    if (count !== vertexOf.length)
      throw new MorulaError(`the geometry has ${count} vertices instead of ${vertexOf.length}: make new bounds`);
    const positions = numbersOf(geometry.attributes.position, 3, 'position');
    const targets = targetsOf(geometry, positions);
    for (const array of [positions, ...targets])
      vertexOf.forEach((vertex, i) => {
        for (let k = 0; k < 3; ++k)
          if (array[3 * i + k] !== array[3 * first[vertex] + k])
            throw new MorulaError(`vertices ${first[vertex]} and ${i} were equal at first, and differ: make bounds with {weld: false}`);
      });
    const of = (array) => Float64Array.from({length: 3 * first.length}, (_, i) => array[3 * first[Math.floor(i / 3)] + (i % 3)]);
    this.#targets = targets.map(of);
    this.#rest = of(positions);
    this.#versions = versions;
  }
}
