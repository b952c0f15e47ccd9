// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The way of a ray through the spheres of a body, down to facets.
import {facetTester} from './hits.js';

const length = (x, y, z) => Math.sqrt(x * x + y * y + z * z);
/** Whether a hit comes before another among hits sorted by distance. */
const before = (a, b) =>
  (a.hit.distance - b.hit.distance || a.range - b.range || a.hit.faceIndex - b.hit.faceIndex) <= 0;

/** Rays on the facets of one object. */
export class RayWalk {
  #model;
  #pose;
  #tested;
  #ray = 0;
  #open = [];

  constructor(model, pose) {
    this.#model = model;
    this.#pose = pose;
    this.#tested = new Uint32Array(model.arrays.facets.length / 3);
  }

  /** Appends hits to a list as Mesh.raycast does; with raycaster.firstHitOnly the nearest alone. line: origin and direction in
   * the space of the spheres, where origin + t direction is at the distance t in the world. slack: how far vertices may be
   * outside of their spheres by rounding. */
  run(object, raycaster, line, spheres, slack, hits) {
    if (!line.every(Number.isFinite) || length(line[3], line[4], line[5]) === 0) return;
    const test = facetTester(object, raycaster);
    const onlyFirst = raycaster.firstHitOnly === true;
    const found = [];
    ++this.#ray;
    let far = raycaster.far;
    for (const leaf of this.#leaves(line, spheres, slack, raycaster)) {
      if (leaf.entry > far) break; // leaves come in the order of their entries
      this.#facets(leaf, line, spheres, (facet) => {
        for (const one of test(facet)) {
          if (onlyFirst && found.length > 0) {
            if (before(found[0], one)) continue;
            found.pop();
          }
          found.push(one);
          if (onlyFirst) far = one.hit.distance + leaf.margin;
        }
      });
    }
    // The order of Mesh.raycast, which decides between hits at one distance.
    found.sort((a, b) => a.range - b.range || a.hit.faceIndex - b.hit.faceIndex);
    for (const {hit} of found) hits.push(hit);
  }

  /** The leaves whose spheres the ray meets, by the distance at which it enters them. */
  #leaves([ox, oy, oz, dx, dy, dz], spheres, slack, {near, far}) {
    const {firstChild, childCount} = this.#model;
    const open = this.#open;
    const result = [];
    const d = length(dx, dy, dz);
    open.length = 0;
    open.push(0);
    while (open.length > 0) {
      const node = open.pop();
      const at = 4 * node;
      const x = spheres[at] - ox, y = spheres[at + 1] - oy, z = spheres[at + 2] - oz;
      const allowance = slack + 1e-14 * length(x, y, z);
      const radius = spheres[at + 3] + allowance;
      const off = length(y * dz - z * dy, z * dx - x * dz, x * dy - y * dx) / d;
      if (off > radius) continue;
      const middle = (x * dx + y * dy + z * dz) / (d * d);
      const half = Math.sqrt(radius * radius - off * off) / d;
      const margin = 2 * allowance / d;
      if (middle + half + margin < near || middle - half - margin > far) continue;
      if (childCount[node] === 0) result.push({node, entry: middle - half - margin, middle, allowance, margin});
      else for (let k = 0; k < childCount[node]; ++k) open.push(firstChild[node] + k);
    }
    return result.sort((a, b) => a.entry - b.entry);
  }

  /** Calls a function with the facets of a leaf that the ray may hit and that no leaf before had. */
  #facets({node, middle, allowance}, [ox, oy, oz, dx, dy, dz], spheres, use) {
    const {leaves, arrays} = this.#model;
    const pose = this.#pose;
    const points = pose.points;
    // Corners relative to a point of the ray near the leaf, so products do not lose digits.
    const qx = ox + middle * dx, qy = oy + middle * dy, qz = oz + middle * dz;
    const tolerance = allowance * length(dx, dy, dz);
    for (let i = leaves.begin[node]; i < leaves.begin[node + 1]; ++i) {
      const facet = leaves.facets[i];
      if (this.#tested[facet] === this.#ray) continue;
      this.#tested[facet] = this.#ray;
      const a = pose.position(arrays.facets[3 * facet]);
      const b = pose.position(arrays.facets[3 * facet + 1]);
      const c = pose.position(arrays.facets[3 * facet + 2]);
      const ax = points[a] - qx, ay = points[a + 1] - qy, az = points[a + 2] - qz;
      const bx = points[b] - qx, by = points[b + 1] - qy, bz = points[b + 2] - qz;
      const cx = points[c] - qx, cy = points[c + 1] - qy, cz = points[c + 2] - qz;
      // The ray passes each edge on the same side: products of its direction and two corners have one sign. A corner that
      // moves by the allowance changes a product by at most allowance x |direction| x |other corner|.
      const bound = tolerance * (Math.abs(ax) + Math.abs(ay) + Math.abs(az) + Math.abs(bx) + Math.abs(by) + Math.abs(bz) +
        Math.abs(cx) + Math.abs(cy) + Math.abs(cz) + allowance);
      const ab = dx * (ay * bz - az * by) + dy * (az * bx - ax * bz) + dz * (ax * by - ay * bx);
      const bc = dx * (by * cz - bz * cy) + dy * (bz * cx - bx * cz) + dz * (bx * cy - by * cx);
      const ca = dx * (cy * az - cz * ay) + dy * (cz * ax - cx * az) + dz * (cx * ay - cy * ax);
      if ((ab >= -bound && bc >= -bound && ca >= -bound) || (ab <= bound && bc <= bound && ca <= bound)) use(facet);
    }
  }
}
