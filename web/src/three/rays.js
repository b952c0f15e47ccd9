// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The way of a ray through the spheres of a body, down to facets.
import {facetTester} from './hits.js';

const length = (x, y, z) => Math.sqrt(x * x + y * y + z * z);
/** Whether a hit comes before another among hits sorted by distance. */
const before = (a, b) =>
  (a.hit.distance - b.hit.distance || a.range - b.range || a.hit.faceIndex - b.hit.faceIndex) <= 0;

/** Two unit vectors that are perpendicular to a direction and to each other. */
function crossAxes(x, y, z) {
  const size = length(x, y, z);
  const [a, b, c] = [x / size, y / size, z / size];
  // The coordinate axis that is farthest from the direction, less its part along the direction.
  const k = Math.abs(a) <= Math.abs(b) && Math.abs(a) <= Math.abs(c) ? 0 : Math.abs(b) <= Math.abs(c) ? 1 : 2;
  const part = [a, b, c][k];
  const u = [-part * a, -part * b, -part * c];
  u[k] += 1;
  const long = length(...u);
  const [ux, uy, uz] = u.map((value) => value / long);
  return [ux, uy, uz, b * uz - c * uy, c * ux - a * uz, a * uy - b * ux];
}

/** Rays on the facets of one object. */
export class RayWalk {
  #model;
  #pose;
  #ray = 0;
  #open = [];
  #facetRay; // the last ray that tested each facet
  #vertexRay; // and that projected each vertex
  #u; // coordinates of vertices across the ray
  #v;

  constructor(model, pose) {
    this.#model = model;
    this.#pose = pose;
    this.#facetRay = new Uint32Array(model.arrays.facets.length / 3);
    this.#vertexRay = new Uint32Array(model.arrays.first.length);
    this.#u = new Float64Array(model.arrays.first.length);
    this.#v = new Float64Array(model.arrays.first.length);
  }

  /** Appends hits to a list as Mesh.raycast does; with raycaster.firstHitOnly the nearest alone. line: origin and direction in
   * the space of the spheres, where origin + t direction is at the distance t in the world. slack: how far vertices may be
   * outside of their spheres by rounding. */
  run(object, raycaster, line, spheres, slack, hits) {
    if (!line.every(Number.isFinite) || length(line[3], line[4], line[5]) === 0) return;
    const test = facetTester(object, raycaster);
    const onlyFirst = raycaster.firstHitOnly === true;
    const found = [];
    let far = raycaster.far;
    const axes = crossAxes(line[3], line[4], line[5]);
    ++this.#ray;
    for (const leaf of this.#leaves(line, spheres, slack, raycaster)) {
      if (leaf.entry > far) break; // leaves come in the order of their entries
      for (const facet of this.#facets(leaf, line, axes))
        for (const one of test(facet)) {
          if (onlyFirst && found.length > 0) {
            if (before(found[0], one)) continue;
            found.pop();
          }
          found.push(one);
          if (onlyFirst) far = one.hit.distance + leaf.margin;
        }
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
      const allowance = slack + 1e-14 * (Math.abs(x) + Math.abs(y) + Math.abs(z));
      const radius = spheres[at + 3] + allowance;
      const off = length(y * dz - z * dy, z * dx - x * dz, x * dy - y * dx) / d;
      if (off > radius) continue;
      const middle = (x * dx + y * dy + z * dz) / (d * d);
      const half = Math.sqrt(radius * radius - off * off) / d;
      const margin = 2 * allowance / d;
      if (middle + half + margin < near || middle - half - margin > far) continue;
      if (childCount[node] === 0) result.push({node, entry: middle - half - margin, allowance, margin});
      else for (let k = 0; k < childCount[node]; ++k) open.push(firstChild[node] + k);
    }
    return result.sort((a, b) => a.entry - b.entry);
  }

  /** The facets of a leaf that the ray may hit and that no leaf before had. */
  #facets({node, allowance}, [ox, oy, oz], [ux, uy, uz, vx, vy, vz]) {
    const {leaves, arrays} = this.#model;
    const pose = this.#pose;
    const [points, stamps, us, vs, ray] = [pose.points, this.#vertexRay, this.#u, this.#v, this.#ray];
    const project = (vertex) => {
      stamps[vertex] = ray;
      const at = pose.position(vertex);
      const x = points[at] - ox, y = points[at + 1] - oy, z = points[at + 2] - oz;
      us[vertex] = ux * x + uy * y + uz * z;
      vs[vertex] = vx * x + vy * y + vz * z;
    };
    const result = [];
    for (let i = leaves.begin[node]; i < leaves.begin[node + 1]; ++i) {
      const facet = leaves.facets[i];
      if (this.#facetRay[facet] === ray) continue;
      this.#facetRay[facet] = ray;
      const a = arrays.facets[3 * facet], b = arrays.facets[3 * facet + 1], c = arrays.facets[3 * facet + 2];
      if (stamps[a] !== ray) project(a);
      if (stamps[b] !== ray) project(b);
      if (stamps[c] !== ray) project(c);
      const au = us[a], bu = us[b], cu = us[c], av = vs[a], bv = vs[b], cv = vs[c];
      if ((au > allowance && bu > allowance && cu > allowance) || (au < -allowance && bu < -allowance && cu < -allowance) ||
        (av > allowance && bv > allowance && cv > allowance) || (av < -allowance && bv < -allowance && cv < -allowance)) continue;
      // Seen along the ray, its point is on one side of all edges. A corner that moves by the allowance changes a product by at
      // most the allowance times the size of the other corner.
      const bound = allowance * (Math.abs(au) + Math.abs(av) + Math.abs(bu) + Math.abs(bv) + Math.abs(cu) + Math.abs(cv) + allowance);
      const ab = au * bv - av * bu, bc = bu * cv - bv * cu, ca = cu * av - cv * au;
      if ((ab >= -bound && bc >= -bound && ca >= -bound) || (ab <= bound && bc <= bound && ca <= bound)) result.push(facet);
    }
    return result;
  }
}
