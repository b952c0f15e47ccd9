// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Finds the surface outside all spheres, pixel by pixel: a grid lists the few spheres that can contain a point.

/** Cells along the longest side of the box, at most; more would cost memory and save nothing. */
const mostCells = 32;

/** The axis-aligned box {low, high} of points, x, y, z each. */
export function boxOf(positions) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      if (positions[i + k] < low[k]) low[k] = positions[i + k];
      if (positions[i + k] > high[k]) high[k] = positions[i + k];
    }
  }
  return { low, high };
}

/**
 * positions: of all vertices; spheres: x, y, z, r per node; nodes: those to look at.
 * Returns {low, edge, size, first, items}: cell (x, y, z) has the spheres first[c] to first[c + 1] of items (x, y, z, r
 * each), c = (z * size[1] + y) * size[0] + x: all that reach into it, or come within a quarter of its edge.
 */
export function sphereGrid(positions, spheres, nodes) {
  const { low, high } = boxOf(positions);
  const longest = Math.max(high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-30);
  const cells = Math.max(1, Math.min(mostCells, Math.ceil(2 * Math.cbrt(nodes.length))));
  const edge = longest / cells;
  const size = low.map((l, k) => Math.max(1, Math.min(cells, Math.ceil((high[k] - l) / edge))));
  const cellOf = (x, k) => Math.min(Math.max(Math.floor((x - low[k]) / edge), 0), size[k] - 1);
  const from = [0, 0, 0];
  const to = [0, 0, 0];
  const eachCell = (node, f) => {
    const r = spheres[4 * node + 3] + 0.25 * edge;
    for (let k = 0; k < 3; ++k) {
      from[k] = cellOf(spheres[4 * node + k] - r, k);
      to[k] = cellOf(spheres[4 * node + k] + r, k);
    }
    for (let z = from[2]; z <= to[2]; ++z) {
      for (let y = from[1]; y <= to[1]; ++y) {
        for (let x = from[0]; x <= to[0]; ++x) f((z * size[1] + y) * size[0] + x);
      }
    }
  };
  const first = new Uint32Array(size[0] * size[1] * size[2] + 1);
  for (const node of nodes) eachCell(node, (cell) => ++first[cell + 1]);
  for (let cell = 1; cell < first.length; ++cell) first[cell] += first[cell - 1];
  const next = first.slice();
  const items = new Float32Array(4 * first[first.length - 1]);
  for (const node of nodes) {
    eachCell(node, (cell) => items.set(spheres.subarray(4 * node, 4 * node + 4), 4 * next[cell]++));
  }
  return { low, edge, size, first, items };
}

/** Least |p - c| - r over the spheres of p's cell: negative inside one. The shader's computation, for tests. */
export function distanceOutside(grid, x, y, z) {
  const cell = [x, y, z].map((at, k) => Math.min(Math.max(Math.floor((at - grid.low[k]) / grid.edge), 0), grid.size[k] - 1));
  const at = (cell[2] * grid.size[1] + cell[1]) * grid.size[0] + cell[0];
  let least = 0.25 * grid.edge;
  for (let i = 4 * grid.first[at]; i < 4 * grid.first[at + 1]; i += 4) {
    least = Math.min(least, Math.hypot(x - grid.items[i], y - grid.items[i + 1], z - grid.items[i + 2]) - grid.items[i + 3]);
  }
  return least;
}

/** The same in GLSL: `float distanceOutside(vec3 p)`. */
export const distanceOutsideShader = `
uniform highp sampler2D gridFirst, gridItems;
uniform vec3 gridLow;
uniform float gridEdge;
uniform ivec3 gridSize;
ivec2 gridPlace(int i) { return ivec2(i & 1023, i >> 10); }
float distanceOutside(vec3 p) {
  ivec3 cell = clamp(ivec3(floor((p - gridLow) / gridEdge)), ivec3(0), gridSize - 1);
  int at = (cell.z * gridSize.y + cell.y) * gridSize.x + cell.x;
  int begin = int(texelFetch(gridFirst, gridPlace(at), 0).x);
  int end = int(texelFetch(gridFirst, gridPlace(at + 1), 0).x);
  float least = 0.25 * gridEdge;
  for (int i = begin; i < end; ++i) {
    vec4 ball = texelFetch(gridItems, gridPlace(i), 0);
    least = min(least, distance(p, ball.xyz) - ball.w);
  }
  return least;
}`;

export const textureWidth = 1024;
