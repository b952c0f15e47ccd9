// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds in the coordinates of an object, which three.js takes to the world: it multiplies the center by the object's matrix, the
// radius by the length of the matrix's longest column, and the corners of the box by the matrix. They have to cover after that.
import {Box3, Matrix4, Vector3} from 'three';

const inverse = new Matrix4();
const reached = new Vector3();
const reachedBox = new Box3();

/** The length of the longest column, and a bound of the factor by which the matrix stretches: equal if columns are orthogonal. */
function sizesOf(e) {
  let longest = 0;
  let stretch = 0;
  for (let i = 0; i < 3; ++i) {
    let sum = 0;
    for (let j = 0; j < 3; ++j) {
      const dot = e[4 * i] * e[4 * j] + e[4 * i + 1] * e[4 * j + 1] + e[4 * i + 2] * e[4 * j + 2];
      sum += Math.abs(dot);
      if (i === j) longest = Math.max(longest, dot);
    }
    stretch = Math.max(stretch, sum);
  }
  return {longest: Math.sqrt(longest), stretch: Math.sqrt(stretch)};
}

/** Bounds that are in the coordinates of the object already. With shear, the longest column is less than what the matrix does to
 * lengths. */
export function boundsUnderShear(sphere, box, {elements}) {
  const {longest, stretch} = sizesOf(elements);
  const result = {sphere: sphere.clone(), box: box.clone()};
  if (longest > 0) result.sphere.radius *= stretch / longest;
  return result;
}

/** Bounds in the world. A matrix that flattens the object has no inverse, and one that nearly does has an inverse that rounding
 * falsifies: what center and box miss after the way back to the world is added. A flattened object gets bounds about its origin. */
export function boundsInObject(sphere, box, matrix) {
  const result = {sphere: sphere.clone(), box: box.clone()};
  inverse.copy(matrix).invert();
  result.sphere.center.applyMatrix4(inverse);
  result.box.applyMatrix4(inverse);
  if (![result.sphere.center, result.box.min, result.box.max].every((point) => point.toArray().every(Number.isFinite))) {
    result.sphere.center.set(0, 0, 0);
    result.box.set(result.sphere.center, result.sphere.center);
  }
  const {longest} = sizesOf(matrix.elements);
  const missed = reached.copy(result.sphere.center).applyMatrix4(matrix).distanceTo(sphere.center);
  // Without a column the object is one point, the image of any center.
  result.sphere.radius = longest > 0 ? (sphere.radius + missed) / longest : 0;
  growBox(result.box, box, matrix);
  return result;
}

/** Grows a box until the matrix takes it to a box around `goal`, except along axes of the world that the matrix flattens. */
function growBox(box, goal, matrix) {
  const e = matrix.elements;
  reachedBox.copy(box).applyMatrix4(matrix);
  for (let i = 0; i < 3; ++i) {
    const axis = 'xyz'[i];
    const missed = Math.max(reachedBox.min[axis] - goal.min[axis], goal.max[axis] - reachedBox.max[axis]);
    if (!(missed > 0)) continue;
    const [x, y, z] = [0, 4, 8].map((column) => Math.abs(e[column + i]));
    const strongest = x >= y && x >= z ? 'x' : y >= z ? 'y' : 'z';
    const growth = missed / Math.max(x, y, z);
    if (growth > 1e30) continue; // flattened
    box.min[strongest] -= growth;
    box.max[strongest] += growth;
  }
}
