// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Overlapping clusters of vertices for a soft body: balls of the surface's shortest ways along edges, so that fingers which
// only lie near each other share none. Runs in the worker; tests run it alone.

/** Neighbors of each vertex: first[v] to first[v + 1] of `list`. */
function neighbors(vertexCount, facets) {
  const first = new Uint32Array(vertexCount + 1);
  for (const v of facets) first[v + 1] += 2;
  for (let v = 0; v < vertexCount; ++v) first[v + 1] += first[v];
  const next = first.slice();
  const list = new Uint32Array(2 * facets.length);
  for (let i = 0; i < facets.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const v = facets[i + k];
      list[next[v]++] = facets[i + ((k + 1) % 3)];
      list[next[v]++] = facets[i + ((k + 2) % 3)];
    }
  }
  return { first, list };
}

/** A heap of vertices by distance; the same vertex may be in it more than once. */
class Heap {
  constructor() {
    this.items = [];
  }
  push(distance, vertex) {
    const items = this.items;
    let at = items.push([distance, vertex]) - 1;
    while (at > 0) {
      const above = (at - 1) >> 1;
      if (items[above][0] <= items[at][0]) break;
      [items[above], items[at]] = [items[at], items[above]];
      at = above;
    }
  }
  pop() {
    const items = this.items;
    const top = items[0];
    const last = items.pop();
    if (items.length === 0) return top;
    items[0] = last;
    for (let at = 0; ; ) {
      let least = at;
      for (const below of [2 * at + 1, 2 * at + 2]) if (below < items.length && items[below][0] < items[least][0]) least = below;
      if (least === at) return top;
      [items[least], items[at]] = [items[at], items[least]];
      at = least;
    }
  }
}

function distancesFrom(source, positions, { first, list }) {
  const distances = new Float64Array(positions.length / 3).fill(Infinity);
  const heap = new Heap();
  distances[source] = 0;
  heap.push(0, source);
  while (heap.items.length > 0) {
    const [distance, v] = heap.pop();
    if (distance > distances[v]) continue;
    for (let at = first[v]; at < first[v + 1]; ++at) {
      const w = list[at];
      const d = distance + Math.hypot(positions[3 * v] - positions[3 * w], positions[3 * v + 1] - positions[3 * w + 1], positions[3 * v + 2] - positions[3 * w + 2]);
      if (d < distances[w]) {
        distances[w] = d;
        heap.push(d, w);
      }
    }
  }
  return distances;
}

/** Lists of vertices, `wanted` of them or a few more: every vertex of a facet is in one at least. */
export function clustersOf(positions, facets, wanted) {
  const vertexCount = positions.length / 3;
  const graph = neighbors(vertexCount, facets);
  const isUsed = new Uint8Array(vertexCount);
  for (const v of facets) isUsed[v] = 1;
  const nearest = new Float64Array(vertexCount).map((_, v) => (isUsed[v] ? Infinity : -1));
  const fields = [];
  const farthest = () => nearest.reduce((best, d, v) => (d > nearest[best] ? v : best), 0);
  // Each next center is the vertex farthest from all; a part of the mesh without a center is infinitely far.
  for (let source = farthest(); fields.length < Math.max(wanted, 1) || nearest[source] === Infinity; source = farthest()) {
    if (!(nearest[source] > 0) || fields.length >= 4 * wanted) break;
    const field = distancesFrom(source, positions, graph);
    fields.push(field);
    for (let v = 0; v < vertexCount; ++v) if (field[v] < nearest[v]) nearest[v] = field[v];
  }
  const reach = nearest.reduce((most, d) => (d < Infinity && d > most ? d : most), 0);
  const found = fields.map((field) => {
    const members = [];
    field.forEach((d, v) => isUsed[v] && d <= 1.6 * reach && members.push(v));
    return Uint32Array.from(members);
  });
  return found.filter((members) => members.length >= 4);
}
