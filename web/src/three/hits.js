// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Hits of a ray on facets, as three.js describes them.
import {BackSide, FrontSide, Matrix4, Ray, Triangle, Vector2, Vector3} from 'three';
import {MorulaError} from '../errors.js';

const corners = [new Vector3(), new Vector3(), new Vector3()];
const local = new Vector3();
const ray = new Ray();
const inverse = new Matrix4();

/** The parts of the geometry that are drawn: first and last corner, and material. */
function drawnRanges({geometry, material}, cornerCount) {
  const {start, count} = geometry.drawRange;
  const whole = {start: 0, count: cornerCount, materialIndex: 0};
  return (Array.isArray(material) ? geometry.groups : [whole]).map((group) => {
    const begin = Math.max(group.start, start);
    const end = Math.min(group.start + group.count, start + count, cornerCount);
    if (begin < end && begin % 3 !== 0) throw new MorulaError(`a draw range begins at corner ${begin}, inside of a facet`);
    return {
      begin,
      end,
      material: Array.isArray(material) ? material[group.materialIndex] : material,
      materialIndex: group.materialIndex,
    };
  });
}

/** Returns a function that lists the hits of one ray on a facet: {hit, range}, one for each drawn part that has the facet.
 * Corners of the facet are computed by three.js itself, so hits are those of Mesh.raycast. */
export function facetTester(object, raycaster) {
  const {geometry, matrixWorld} = object;
  const {index} = geometry;
  const {uv, uv1, normal, position} = geometry.attributes;
  const ranges = drawnRanges(object, index ? index.count : position.count);
  ray.copy(raycaster.ray).applyMatrix4(inverse.copy(matrixWorld).invert());

  function hitOf(indices, material) {
    indices.forEach((vertex, k) => object.getVertexPosition(vertex, corners[k]));
    const [a, b, c] = material.side === BackSide ? [corners[2], corners[1], corners[0]] : corners;
    if (ray.intersectTriangle(a, b, c, material.side === FrontSide || material.side === BackSide, local) === null) return null;
    const point = local.clone().applyMatrix4(matrixWorld);
    const distance = raycaster.ray.origin.distanceTo(point);
    if (distance < raycaster.near || distance > raycaster.far) return null;
    const barycoord = new Vector3();
    Triangle.getBarycoord(local, ...corners, barycoord); // 0 if rounding takes the area away
    const hit = {distance, point, object, barycoord};
    if (uv) hit.uv = Triangle.getInterpolatedAttribute(uv, ...indices, barycoord, new Vector2());
    if (uv1) hit.uv1 = Triangle.getInterpolatedAttribute(uv1, ...indices, barycoord, new Vector2());
    if (normal) {
      hit.normal = Triangle.getInterpolatedAttribute(normal, ...indices, barycoord, new Vector3());
      if (hit.normal.dot(ray.direction) > 0) hit.normal.negate();
    }
    hit.face = {a: indices[0], b: indices[1], c: indices[2], normal: Triangle.getNormal(...corners, new Vector3()), materialIndex: 0};
    return hit;
  }

  return (facet) => {
    const at = 3 * facet;
    const indices = [0, 1, 2].map((k) => (index ? index.getX(at + k) : at + k));
    const found = [];
    ranges.forEach(({begin, end, material, materialIndex}, range) => {
      if (at < begin || at >= end || !material) return;
      const hit = hitOf(indices, material);
      if (!hit) return;
      hit.faceIndex = facet;
      hit.face.materialIndex = materialIndex;
      found.push({hit, range});
    });
    return found;
  };
}
