// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Geometry of three.js as arrays of a mesh.
import {MorulaError} from '../errors.js';
import {completedSkin, welded} from '../weld.js';

// getComponent of a Float16BufferAttribute returns its bits.
const components = ['getX', 'getY', 'getZ', 'getW'];

/** The numbers of an attribute as shaders read them: interleaved, quantized and normalized ones in double. */
export function numbersOf(attribute, width, name) {
  if (!attribute?.getX || !(attribute.itemSize >= width))
    throw new MorulaError(`the geometry has no attribute ${name} of ${width} numbers that the processor can read`);
  const numbers = new Float64Array(width * attribute.count);
  for (let i = 0; i < attribute.count; ++i)
    for (let k = 0; k < width; ++k) numbers[width * i + k] = attribute[components[k]](i);
  return numbers;
}

/** The vertex of each corner, 3 per facet, of the whole index, whatever the draw range. Corners beyond a multiple of 3 belong to
 * no facet. */
export function cornersOf(geometry) {
  const {index} = geometry;
  const count = index ? index.count : geometry.attributes.position.count;
  const corners = new Uint32Array(count - (count % 3));
  for (let i = 0; i < corners.length; ++i) corners[i] = index ? index.getX(i) : i;
  return corners;
}

/** The displacements of each morph target, 3 numbers per vertex. */
export function targetsOf(geometry, positions) {
  return (geometry.morphAttributes.position ?? []).map((attribute, j) => {
    const numbers = numbersOf(attribute, 3, `morph target ${j}`);
    if (numbers.length !== positions.length) throw new MorulaError(`morph target ${j} has another number of vertices`);
    return geometry.morphTargetsRelative ? numbers : numbers.map((x, i) => x - positions[i]);
  });
}

/** Notes which attributes an object has, and their versions. facets(): whether index and skin are as noted; vertices(): whether
 * positions and morph targets are. Owners change them by needsUpdate, or put other attributes in place. */
export class Versions {
  #facets = [];
  #vertices = [];

  constructor(object) {
    this.facets(object, true);
    this.vertices(object, true);
  }
  facets({geometry, isSkinnedMesh}, isNoted = false) {
    const {skinIndex, skinWeight} = geometry.attributes;
    return compare(this.#facets, 0, geometry.index, isNoted) &&
      (!isSkinnedMesh || (compare(this.#facets, 1, skinIndex, isNoted) && compare(this.#facets, 2, skinWeight, isNoted)));
  }
  vertices({geometry}, isNoted = false) {
    const targets = geometry.morphAttributes.position ?? [];
    let isSame = compare(this.#vertices, 0, geometry.attributes.position, isNoted);
    for (let j = 0; j < targets.length; ++j) isSame = compare(this.#vertices, j + 1, targets[j], isNoted) && isSame;
    return isSame;
  }
}
function compare(notes, i, attribute, isNoted) {
  const version = (attribute?.isInterleavedBufferAttribute ? attribute.data : attribute)?.version;
  if (isNoted) notes[i] = {attribute, version};
  return notes[i]?.attribute === attribute && notes[i].version === version;
}

/** The mesh of an object: see welded(), and for a SkinnedMesh the skin of the welded vertices. Vertices are welded if their
 * positions, displacements, bones and weights are equal, so they are equal in every pose. */
export function arraysOf(object, weld) {
  const {geometry} = object;
  const positions = numbersOf(geometry.attributes.position, 3, 'position');
  const targets = targetsOf(geometry, positions);
  const others = targets.map((array) => ({array, width: 3}));
  let skin = null;
  if (object.isSkinnedMesh) {
    const bones = numbersOf(geometry.attributes.skinIndex, 4, 'skinIndex');
    const weights = numbersOf(geometry.attributes.skinWeight, 4, 'skinWeight');
    if (bones.length !== weights.length || 3 * bones.length !== 4 * positions.length)
      throw new MorulaError('skinIndex, skinWeight and position have different numbers of vertices');
    skin = completedSkin(4, bones, weights, object.skeleton.bones.length);
    others.push({array: skin.bones, width: skin.influences}, {array: skin.weights, width: skin.influences});
  }
  const mesh = welded(positions, cornersOf(geometry), others, weld);
  const pick = (array, width) => {
    const picked = new array.constructor(width * mesh.first.length);
    mesh.first.forEach((from, v) => picked.set(array.subarray(width * from, width * (from + 1)), width * v));
    return picked;
  };
  return {
    ...mesh,
    targets: targets.map((array) => pick(array, 3)),
    skin: skin && {...skin, bones: pick(skin.bones, skin.influences), weights: pick(skin.weights, skin.influences)},
  };
}
