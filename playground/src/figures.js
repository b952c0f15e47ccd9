// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Figures of the page, from samples: looseness by voxels, uncovered surface by points of the facets. The definitions are those of
// docs/reference/measure.md; its numbers are finer. Tests run it alone.

export function volumeOf(positions, facets) {
  let sum = 0;
  const o = 3 * facets[0];
  const [ox, oy, oz] = [positions[o], positions[o + 1], positions[o + 2]]; // about a vertex: far from the origin, terms about that would cancel
  for (let i = 0; i < facets.length; i += 3) {
    const [a, b, c] = [3 * facets[i], 3 * facets[i + 1], 3 * facets[i + 2]];
    const [px, py, pz] = [positions[a] - ox, positions[a + 1] - oy, positions[a + 2] - oz];
    const [qx, qy, qz] = [positions[b] - ox, positions[b + 1] - oy, positions[b + 2] - oz];
    const [rx, ry, rz] = [positions[c] - ox, positions[c + 1] - oy, positions[c + 2] - oz];
    sum += px * (qy * rz - qz * ry) + py * (qz * rx - qx * rz) + pz * (qx * ry - qy * rx);
  }
  return sum / 6;
}

/** Whether every edge has two facets that agree about which side is out. */
export function isClosed(facets) {
  const edges = new Map();
  const key = (a, b) => a * 4294967296 + b;
  for (let i = 0; i < facets.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [facets[i + k], facets[i + ((k + 1) % 3)]];
      edges.set(key(a, b), (edges.get(key(a, b)) ?? 0) + 1);
    }
  }
  for (const [edge, count] of edges) {
    const [a, b] = [Math.floor(edge / 4294967296), edge % 4294967296];
    if (edges.get(key(b, a)) !== count) return false;
  }
  return facets.length > 0;
}

/** Crossings of the surface with lines along x through the middles of cells: per row of cells, [x, sign] pairs. */
function crossings(positions, facets, low, edge, [, ny, nz]) {
  const rows = Array.from({ length: ny * nz }, () => []);
  for (let i = 0; i < facets.length; i += 3) {
    const [a, b, c] = [3 * facets[i], 3 * facets[i + 1], 3 * facets[i + 2]];
    const [ay, by, cy] = [a, b, c].map((p) => (positions[p + 1] - low[1]) / edge - 0.5);
    const [az, bz, cz] = [a, b, c].map((p) => (positions[p + 2] - low[2]) / edge - 0.5);
    const area = (by - ay) * (cz - az) - (bz - az) * (cy - ay);
    if (area === 0) continue;
    const to = (value, n) => Math.min(n - 1, Math.floor(value));
    const from = (value) => Math.max(0, Math.ceil(value));
    for (let z = from(Math.min(az, bz, cz)); z <= to(Math.max(az, bz, cz), nz); ++z) {
      for (let y = from(Math.min(ay, by, cy)); y <= to(Math.max(ay, by, cy), ny); ++y) {
        const u = ((by - y) * (cz - z) - (bz - z) * (cy - y)) / area;
        const v = ((cy - y) * (az - z) - (cz - z) * (ay - y)) / area;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const x = u * positions[a] + v * positions[b] + (1 - u - v) * positions[c];
        rows[z * ny + y].push([(x - low[0]) / edge - 0.5, Math.sign(area)]);
      }
    }
  }
  return rows;
}

/**
 * Volume in the spheres of `nodes` and outside the closed surface, over the volume of the body.
 * spheres: x, y, z, r per node. cells: along the longest side.
 */
export function looseness(positions, facets, spheres, nodes, cells = 56) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const node of nodes) {
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], spheres[4 * node + k] - spheres[4 * node + 3]);
      high[k] = Math.max(high[k], spheres[4 * node + k] + spheres[4 * node + 3]);
    }
  }
  const edge = Math.max(...high.map((h, k) => h - low[k])) / cells;
  // Off the lattice of the mesh, whose edges often lie at round places.
  for (let k = 0; k < 3; ++k) low[k] -= edge * [0.0137, 0.0271, 0.0193][k];
  const size = high.map((h, k) => Math.max(1, Math.ceil((h - low[k]) / edge)));
  const [nx, ny] = size;
  const rows = crossings(positions, facets, low, edge, size);
  const isCovered = new Uint8Array(nx * ny * size[2]);
  for (const node of nodes) {
    const [x, y, z, r] = [0, 1, 2].map((k) => (spheres[4 * node + k] - low[k]) / edge - 0.5).concat(spheres[4 * node + 3] / edge);
    for (let k = Math.max(0, Math.ceil(z - r)); k <= Math.min(size[2] - 1, z + r); ++k) {
      const flat = r * r - (k - z) ** 2;
      const wide = Math.sqrt(Math.max(0, flat));
      for (let j = Math.max(0, Math.ceil(y - wide)); j <= Math.min(ny - 1, y + wide); ++j) {
        const reach = Math.sqrt(Math.max(0, flat - (j - y) ** 2));
        const [from, to] = [Math.max(0, Math.ceil(x - reach)), Math.min(nx - 1, Math.floor(x + reach))];
        if (to >= from) isCovered.fill(1, (k * ny + j) * nx + from, (k * ny + j) * nx + to + 1);
      }
    }
  }
  let outside = 0;
  rows.forEach((row, at) => {
    row.sort((p, q) => p[0] - q[0]);
    let [winding, next] = [0, 0];
    for (let x = 0; x < nx; ++x) {
      while (next < row.length && row[next][0] <= x) winding += row[next++][1];
      if (winding === 0 && isCovered[at * nx + x] === 1) ++outside;
    }
  });
  return (outside * edge ** 3) / Math.abs(volumeOf(positions, facets));
}

/** Share of the surface's area in no sphere, by four points a facet. grid: of uncovered.js. */
export function uncoveredShare(positions, facets, grid, tolerance) {
  const { low, edge, size, first, items } = grid;
  const isOutside = (x, y, z) => {
    const [i, j, k] = [(x - low[0]) / edge, (y - low[1]) / edge, (z - low[2]) / edge].map((at, a) => Math.min(Math.max(Math.floor(at), 0), size[a] - 1));
    const cell = (k * size[1] + j) * size[0] + i;
    for (let at = 4 * first[cell]; at < 4 * first[cell + 1]; at += 4) {
      const r = items[at + 3] + tolerance;
      if ((x - items[at]) ** 2 + (y - items[at + 1]) ** 2 + (z - items[at + 2]) ** 2 <= r * r) return false;
    }
    return true;
  };
  const weights = [[1 / 3, 1 / 3, 1 / 3], [2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]];
  let [whole, bare] = [0, 0];
  for (let i = 0; i < facets.length; i += 3) {
    const [a, b, c] = [3 * facets[i], 3 * facets[i + 1], 3 * facets[i + 2]];
    const [ux, uy, uz] = [0, 1, 2].map((k) => positions[b + k] - positions[a + k]);
    const [vx, vy, vz] = [0, 1, 2].map((k) => positions[c + k] - positions[a + k]);
    const area = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
    whole += area;
    for (const [p, q, r] of weights) {
      const at = (k) => p * positions[a + k] + q * positions[b + k] + r * positions[c + k];
      if (isOutside(at(0), at(1), at(2))) bare += 0.25 * area;
    }
  }
  return whole > 0 ? bare / whole : 0;
}
