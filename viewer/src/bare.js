// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How far the surface is outside the spheres: at every vertex, least of |p - c| - r.

/**
 * Fills `outside`, one per vertex: negative inside some sphere; where no sphere is near, a length that is surely positive.
 * Spheres are put into the cells of a grid that they meet, so that a vertex looks at few of them.
 */
export function distanceOutside(positions, spheres, nodes, outside) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      if (positions[i + k] < low[k]) low[k] = positions[i + k];
      if (positions[i + k] > high[k]) high[k] = positions[i + k];
    }
  }
  const longest = Math.max(high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-30);
  const cells = Math.max(1, Math.min(32, Math.ceil(2 * Math.cbrt(nodes.length))));
  const edge = longest / cells;
  const size = low.map((l, k) => Math.max(1, Math.min(cells, Math.ceil((high[k] - l) / edge))));
  const lists = Array.from({ length: size[0] * size[1] * size[2] }, () => []);
  const cellOf = (x, k) => Math.min(Math.max(Math.floor((x - low[k]) / edge), 0), size[k] - 1);
  for (const node of nodes) {
    const r = spheres[4 * node + 3] + 0.25 * edge; // spheres that just miss a cell give its vertices a true distance
    const from = [0, 1, 2].map((k) => cellOf(spheres[4 * node + k] - r, k));
    const to = [0, 1, 2].map((k) => cellOf(spheres[4 * node + k] + r, k));
    for (let z = from[2]; z <= to[2]; ++z) {
      for (let y = from[1]; y <= to[1]; ++y) {
        for (let x = from[0]; x <= to[0]; ++x) lists[(z * size[1] + y) * size[0] + x].push(node);
      }
    }
  }
  for (let i = 0, vertex = 0; i < positions.length; i += 3, ++vertex) {
    const x = positions[i];
    const y = positions[i + 1];
    const z = positions[i + 2];
    let least = 0.25 * edge;
    for (const node of lists[(cellOf(z, 2) * size[1] + cellOf(y, 1)) * size[0] + cellOf(x, 0)]) {
      const at = 4 * node;
      const dx = x - spheres[at];
      const dy = y - spheres[at + 1];
      const dz = z - spheres[at + 2];
      const d = Math.sqrt(dx * dx + dy * dy + dz * dz) - spheres[at + 3];
      if (d < least) least = d;
    }
    outside[vertex] = least;
  }
}
