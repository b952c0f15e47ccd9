// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Surface outside a union of spheres, by dividing facets. An estimate for the reader; the certificate is the command's. No
// page and no drawing in here: tests run it alone.

const distance = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
export const area = ([a, b, c]) => {
  const [u, v] = [b, c].map((p) => p.map((x, k) => x - a[k]));
  return 0.5 * Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
};
const slice = 200; // triangles looked at between two results

/**
 * triangles: [[a, b, c], …] of points; spheres: [[x, y, z, r], …]. Every point that is farther than `within` from all
 * spheres lies in one of the triangles that are found; a triangle in one sphere is never among them.
 * Finds {triangles, area, deepest}: deepest is the largest distance of their corners from the spheres. coarse: edges of
 * triangles with an uncovered corner are not divided below it. Yields what is found so far, often; the last value is all.
 */
export function* bareSurface(triangles, spheres, within, coarse) {
  const most = 300_000 + 10 * triangles.length; // triangles looked at; the rest counts as uncovered
  const found = { triangles: [], area: 0, deepest: 0 };
  const stack = triangles.map((triangle) => [triangle, spheres]);
  for (let steps = 1; stack.length > 0; ++steps) {
    if (steps % slice === 0) yield found;
    const [triangle, around] = stack.pop();
    const edges = triangle.map((p, k) => distance(p, triangle[(k + 1) % 3]));
    const longest = edges.indexOf(Math.max(...edges));
    // Every point of a triangle is nearer than this to its first corner.
    const near = around.filter(([x, y, z, r]) => distance(triangle[0], [x, y, z]) <= r + edges[longest] + within);
    if (near.some(([x, y, z, r]) => triangle.every((p) => distance(p, [x, y, z]) <= r + within))) continue;
    const outside = triangle.map((p) => near.reduce((least, s) => Math.min(least, distance(p, s) - s[3]), Infinity));
    const isBare = Math.max(...outside) > 0.55 * within;
    // No point is farther from the spheres than a corner and the way to it.
    if (!isBare && edges[longest] <= 0.45 * within) continue;
    if ((isBare && edges[longest] <= coarse) || near.length === 0 || steps > most) {
      found.triangles.push(triangle);
      found.area += area(triangle);
      for (const p of triangle) {
        found.deepest = Math.max(found.deepest, spheres.reduce((least, s) => Math.min(least, distance(p, s) - s[3]), Infinity));
      }
      continue;
    }
    const [a, b, c] = [0, 1, 2].map((k) => triangle[(longest + k) % 3]);
    const middle = a.map((x, k) => 0.5 * (x + b[k]));
    stack.push([[a, middle, c], near], [[middle, b, c], near]);
  }
  return found;
}

/** Balls of the part's shapes that no single sphere contains up to `within`. */
export const bareBalls = (balls, spheres, within) =>
  balls.filter((ball) => !spheres.some((s) => distance(ball, s) + ball[3] <= s[3] + within));
