// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
import {MorulaError} from '../errors.js';
import {completedSkin, welded} from '../weld.js';
import {fail} from './check.js';
import {numbersOf, product, rowsOf} from './motion.js';

const field = 'morula_tree';

/** Three corners per facet of triangles, strips and fans, in the order of GLTFLoader, so trees fit its geometries; null for points
 * and lines. */
function cornersOf(primitive, vertexCount, what) {
  const mode = primitive.getMode();
  if (mode < 4) return null;
  const indices = primitive.getIndices();
  const list = indices ? indices.getArray() : Uint32Array.from({length: vertexCount}, (_, i) => i);
  if (mode === 4) {
    if (list.length % 3 !== 0) fail(`${what} has ${list.length} corners, no multiple of 3`);
    return list;
  }
  const corners = [];
  for (let i = 0; i + 2 < list.length; ++i) {
    if (mode === 6) corners.push(list[0], list[i + 1], list[i + 2]);
    else corners.push(list[i + 2 * (i % 2)], list[i + 1], list[i + 2 - 2 * (i % 2)]);
  }
  return Uint32Array.from(corners);
}

/** Joints and weights of all sets, divided by the sum of each vertex. A vertex without weight follows the first joint if no corner
 * is there; otherwise the file is rejected. */
function influencesOf(primitive, corners, what) {
  const sets = [];
  for (let s = 0; primitive.getAttribute(`JOINTS_${s}`) && primitive.getAttribute(`WEIGHTS_${s}`); ++s)
    sets.push({
      bones: numbersOf(primitive.getAttribute(`JOINTS_${s}`), `JOINTS_${s} of ${what}`),
      weights: numbersOf(primitive.getAttribute(`WEIGHTS_${s}`), `WEIGHTS_${s} of ${what}`),
    });
  if (sets.length === 0) fail(`${what} has a skin and no joints`);
  const vertices = sets[0].bones.length / 4;
  const width = 4 * sets.length;
  const bones = new Uint32Array(width * vertices);
  const weights = new Float64Array(width * vertices);
  sets.forEach((set, s) => {
    if (set.bones.length !== 4 * vertices || set.weights.length !== 4 * vertices) fail(`${what} has joints of another number of vertices`);
    for (let i = 0; i < 4 * vertices; ++i) {
      bones[width * Math.floor(i / 4) + 4 * s + (i % 4)] = set.bones[i];
      weights[width * Math.floor(i / 4) + 4 * s + (i % 4)] = set.weights[i];
    }
  });
  const isUsed = new Uint8Array(vertices);
  for (const corner of corners) isUsed[corner] = 1;
  for (let v = 0; v < vertices; ++v) {
    let sum = 0;
    for (let k = width * v; k < width * (v + 1); ++k) sum += weights[k];
    if (sum > 0) for (let k = width * v; k < width * (v + 1); ++k) weights[k] /= sum;
    else {
      if (isUsed[v]) fail(`vertex ${v} of ${what} has no weight`);
      bones.fill(0, width * v, width * (v + 1));
      weights.fill(0, width * v, width * (v + 1));
      weights[width * v] = 1;
    }
  }
  return {width, bones, weights};
}

/** The triangles of one primitive of one node. */
export class GltfPart {
  #document;
  #node;
  #primitive;
  #inverses = null;

  /** Returns null for a primitive without triangles. */
  static of(document, node, primitive, number) {
    const what = `primitive ${number} of node "${node.getName()}"`;
    const position = primitive.getAttribute('POSITION');
    const positions = position && position.getElementSize() === 3 ? numbersOf(position, `POSITION of ${what}`) : null;
    if (!positions) fail(`${what} has no positions`);
    const corners = cornersOf(primitive, positions.length / 3, what);
    return corners && corners.length > 0 ? new GltfPart(document, node, primitive, what, positions, corners) : null;
  }
  constructor(document, node, primitive, what, positions, corners) {
    this.#document = document;
    this.#node = node;
    this.#primitive = primitive;
    this.name = node.getName();
    const targets = primitive.listTargets().map((target, j) => {
      const accessor = target.getAttribute('POSITION');
      const numbers = accessor ? numbersOf(accessor, `target ${j} of ${what}`) : new Float64Array(positions.length);
      if (numbers.length !== positions.length) fail(`target ${j} of ${what} has another number of vertices`);
      return numbers;
    });
    const skin = node.getSkin();
    const joints = skin?.listJoints() ?? [node];
    this.boneNames = joints.map((joint) => joint.getName());
    const given = skin
      ? influencesOf(primitive, corners, what)
      : {width: 1, bones: new Uint32Array(positions.length / 3), weights: new Float64Array(positions.length / 3).fill(1)};
    if (3 * given.bones.length !== given.width * positions.length) fail(`${what} has joints of another number of vertices`);
    const {influences, bones, weights} = completedSkin(given.width, given.bones, given.weights, joints.length);
    const mesh = welded(positions, corners,
      [...targets.map((array) => ({array, width: 3})), {array: bones, width: influences}, {array: weights, width: influences}], true);
    const pick = (array, width) => {
      const picked = new array.constructor(width * mesh.first.length);
      mesh.first.forEach((from, v) => picked.set(array.subarray(width * from, width * (from + 1)), width * v));
      return picked;
    };
    this.positions = mesh.positions;
    this.facets = mesh.facets;
    this.vertexOf = mesh.vertexOf;
    this.targets = targets.map((array) => pick(array, 3));
    this.influences = influences;
    this.bones = pick(bones, influences);
    this.weights = pick(weights, influences);
    this.boneCount = joints.length;
    if (skin) this.#inverses = this.#inversesOf(skin, joints.length, what);
  }
  #inversesOf(skin, count, what) {
    const accessor = skin.getInverseBindMatrices();
    if (!accessor) return Array.from({length: count}, () => Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0));
    const numbers = numbersOf(accessor, `the inverse bind matrices of ${what}`);
    if (numbers.length < 16 * count) fail(`${what} has ${count} joints and ${numbers.length / 16} inverse bind matrices`);
    return Array.from({length: count}, (_, b) => rowsOf(numbers.subarray(16 * b, 16 * b + 16)));
  }

  mesh(morula) {
    return new morula.Mesh(this.positions, this.facets);
  }
  skin(morula) {
    return new morula.Skin(this.influences, this.bones, this.weights, this.boneCount);
  }
  transforms(pose) {
    pose.requireOf(this.#document);
    const result = new Float64Array(12 * this.boneCount);
    const joints = this.#node.getSkin()?.listJoints() ?? [this.#node];
    joints.forEach((joint, b) => {
      const matrix = pose.matrix(joint);
      result.set(this.#inverses ? product(matrix, this.#inverses[b]) : matrix, 12 * b);
    });
    return result;
  }
  morphWeights(pose) {
    pose.requireOf(this.#document);
    return pose.weights(this.#node, this.targets.length);
  }
  positionsAt(pose) {
    const moved = this.positions.slice();
    this.morphWeights(pose).forEach((weight, j) => {
      if (weight !== 0) for (let i = 0; i < moved.length; ++i) moved[i] += weight * this.targets[j][i];
    });
    const rows = this.transforms(pose);
    const result = new Float64Array(moved.length);
    for (let v = 0; 3 * v < moved.length; ++v)
      for (let k = v * this.influences; k < (v + 1) * this.influences; ++k)
        for (let i = 0; i < 3; ++i) {
          const r = 12 * this.bones[k] + 4 * i;
          result[3 * v + i] += this.weights[k] *
            (rows[r] * moved[3 * v] + rows[r + 1] * moved[3 * v + 1] + rows[r + 2] * moved[3 * v + 2] + rows[r + 3]);
        }
    return result;
  }

  storeTree(tree) {
    let text = '';
    for (const byte of tree.toBytes()) text += String.fromCharCode(byte);
    this.#primitive.setExtras({...this.#primitive.getExtras(), [field]: btoa(text)});
  }
  storedTree(morula, mesh) {
    const text = this.#primitive.getExtras()[field];
    if (text === undefined) return null;
    let bytes;
    try {
      bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    } catch {
      throw new MorulaError(`${field} of a primitive is no base64 text`, 'bad_file');
    }
    return morula.Tree.fromBytes(bytes, mesh);
  }
}
