// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Vertices that a vertex buffer repeats, once for each texture coordinate or normal, become one vertex of a mesh.
import {MorulaError} from './errors.js';

/** The rows of a table that differ. columns: arrays with `width` numbers per row. Rows are equal if all their numbers are; a
 * row with NaN equals none. Returns the number of each row's value, and the first row of each value. Cost: linear. */
export function distinctRows(count, columns) {
  const size = 1 << Math.max(4, 33 - Math.clz32(Math.max(count, 1)));
  const slots = new Int32Array(size).fill(-1);
  const numbers = new Uint32Array(count);
  const first = new Uint32Array(count);
  const bits = new Uint32Array(2);
  const value = new Float64Array(bits.buffer);
  const equal = (i, j) => columns.every(({array, width}) => {
    for (let k = 0; k < width; ++k) if (array[width * i + k] !== array[width * j + k]) return false;
    return true;
  });
  let found = 0;
  for (let row = 0; row < count; ++row) {
    let hash = 0x9e3779b9;
    for (const {array, width} of columns)
      for (let k = 0; k < width; ++k) {
        value[0] = array[width * row + k] + 0; // -0 becomes 0
        hash = Math.imul(hash ^ bits[0], 0x85ebca6b);
        hash = Math.imul(hash ^ (hash >>> 15) ^ bits[1], 0xc2b2ae35);
      }
    let slot = (hash ^ (hash >>> 16)) & (size - 1);
    while (slots[slot] >= 0 && !equal(first[slots[slot]], row)) slot = (slot + 1) & (size - 1);
    if (slots[slot] < 0) {
      slots[slot] = found;
      first[found++] = row;
    }
    numbers[row] = slots[slot];
  }
  return {numbers, first: first.slice(0, found)};
}

/** The vertices of a mesh, from those of a vertex buffer. vertexOf: the vertex of the mesh that each vertex of the buffer
 * became; first: the first vertex of the buffer of each. facets: 3 per facet, of the mesh. */
export function welded(positions, corners, others, weld) {
  const count = positions.length / 3;
  const {numbers, first} = weld
    ? distinctRows(count, [{array: positions, width: 3}, ...others])
    : {numbers: Uint32Array.from({length: count}, (_, i) => i), first: Uint32Array.from({length: count}, (_, i) => i)};
  const points = new Float64Array(3 * first.length);
  first.forEach((from, v) => points.set(positions.subarray(3 * from, 3 * from + 3), 3 * v));
  const facets = new Uint32Array(corners.length);
  for (let i = 0; i < corners.length; ++i) {
    if (!(corners[i] < count))
      throw new MorulaError(`corner ${i % 3} of facet ${Math.floor(i / 3)} is vertex ${corners[i]} of ${count}`);
    facets[i] = numbers[corners[i]];
  }
  return {vertexOf: numbers, first, positions: points, facets};
}

/** Influences of a skin: `influences` bones and weights per vertex. If the sum of the weights of a vertex differs from 1 by more
 * than 1e-6, every vertex gets one influence more, of the bone `boneCount`, which completes the sum. missing: the largest
 * difference. */
export function completedSkin(influences, bones, weights, boneCount) {
  const vertices = bones.length / influences;
  let missing = 0;
  const rest = new Float64Array(vertices);
  for (let v = 0; v < vertices; ++v) {
    let sum = 0;
    for (let k = v * influences; k < (v + 1) * influences; ++k) {
      if (!Number.isFinite(weights[k])) throw new MorulaError(`vertex ${v} has the weight ${weights[k]}`);
      if (weights[k] !== 0 && !(bones[k] >= 0 && bones[k] < boneCount))
        throw new MorulaError(`vertex ${v} follows bone ${bones[k]} of ${boneCount}`);
      sum += weights[k];
    }
    rest[v] = 1 - sum;
    missing = Math.max(missing, Math.abs(rest[v]));
  }
  const width = missing > 1e-6 ? influences + 1 : influences;
  const result = {influences: width, bones: new Uint32Array(width * vertices), weights: new Float64Array(width * vertices),
    boneCount: boneCount + width - influences, isCompleted: width > influences, missing};
  for (let v = 0; v < vertices; ++v) {
    for (let k = 0; k < influences; ++k) {
      const weight = weights[v * influences + k];
      result.weights[v * width + k] = weight;
      result.bones[v * width + k] = weight === 0 ? 0 : bones[v * influences + k];
    }
    if (result.isCompleted) {
      result.bones[v * width + influences] = boneCount;
      result.weights[v * width + influences] = rest[v];
    }
  }
  return result;
}
