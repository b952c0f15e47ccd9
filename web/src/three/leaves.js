// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The facets that may have a part in each leaf of a sphere tree.

/** The squared distance of a point from a triangle. p, a, b, c: offsets of 3 numbers in their arrays. */
function squaredDistance(points, p, corners, a, b, c) {
  const [px, py, pz] = [points[p], points[p + 1], points[p + 2]];
  const ax = corners[a] - px, ay = corners[a + 1] - py, az = corners[a + 2] - pz;
  const bx = corners[b] - px, by = corners[b + 1] - py, bz = corners[b + 2] - pz;
  const cx = corners[c] - px, cy = corners[c + 1] - py, cz = corners[c + 2] - pz;
  const ux = bx - ax, uy = by - ay, uz = bz - az, vx = cx - ax, vy = cy - ay, vz = cz - az;
  const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  const area = nx * nx + ny * ny + nz * nz;
  const side = (x1, y1, z1, x2, y2, z2) => (y1 * z2 - z1 * y2) * nx + (z1 * x2 - x1 * z2) * ny + (x1 * y2 - y1 * x2) * nz;
  const edge = (x1, y1, z1, x2, y2, z2) => {
    const ex = x2 - x1, ey = y2 - y1, ez = z2 - z1;
    const length = ex * ex + ey * ey + ez * ez;
    const t = length > 0 ? Math.min(1, Math.max(0, -(x1 * ex + y1 * ey + z1 * ez) / length)) : 0;
    return (x1 + t * ex) ** 2 + (y1 + t * ey) ** 2 + (z1 + t * ez) ** 2;
  };
  const nearest = Math.min(edge(ax, ay, az, bx, by, bz), edge(bx, by, bz, cx, cy, cz), edge(cx, cy, cz, ax, ay, az));
  // Inside the three planes through the edges along the normal, the distance is that of the plane. The normal of a needle may be
  // wrong, but its edges are then as near as its inside.
  const isAbove = area > 0 && side(ax, ay, az, bx, by, bz) >= 0 && side(bx, by, bz, cx, cy, cz) >= 0 && side(cx, cy, cz, ax, ay, az) >= 0;
  return isAbove ? Math.min(nearest, (ax * nx + ay * ny + az * nz) ** 2 / area) : nearest;
}

/** Lists of facets: those of leaf n are facets[begin[n]] to facets[begin[n + 1] - 1]. A leaf owns parts of facets that lie in
 * its sphere at rest, so these are the facets that reach into that sphere and into those of all nodes above: at least the
 * facets of which the leaf owns a part. Spheres, positions and facets are those of a tree and of its mesh. */
export function facetsOfLeaves(tree, mesh) {
  const {firstChild, childCount, nodeCount, spheres} = tree;
  const {facets, positions} = mesh;
  const lists = Array.from({length: nodeCount}, () => []);
  const open = [];
  for (let f = 0; f < facets.length / 3; ++f) {
    const [a, b, c] = [3 * facets[3 * f], 3 * facets[3 * f + 1], 3 * facets[3 * f + 2]];
    open.push(0);
    while (open.length > 0) {
      const node = open.pop();
      const at = 4 * node;
      // 1e-9 of the size allows for the rounding here; the spheres themselves are rounded outward.
      const size = Math.abs(spheres[at]) + Math.abs(spheres[at + 1]) + Math.abs(spheres[at + 2]) + spheres[at + 3];
      if (squaredDistance(spheres, at, positions, a, b, c) > (spheres[at + 3] + 1e-9 * size) ** 2) continue;
      if (childCount[node] === 0) lists[node].push(f);
      else for (let k = 0; k < childCount[node]; ++k) open.push(firstChild[node] + k);
    }
  }
  const begin = new Uint32Array(nodeCount + 1);
  lists.forEach((list, node) => (begin[node + 1] = begin[node] + list.length));
  const result = new Uint32Array(begin[nodeCount]);
  lists.forEach((list, node) => result.set(list, begin[node]));
  return {begin, facets: result};
}
