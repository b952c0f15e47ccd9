// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Another fit of the spheres of one part, with the same number: facets are cut along the spheres' power diagram, and every
// sphere becomes the smallest around its parts of facets, in turn. No page and no drawing in here: tests run it alone.

const square = (p, q) => (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2;
const power = (p, s) => square(p, s) - s[3] * s[3];
const volume = (spheres) => spheres.reduce((sum, s) => sum + s[3] ** 3, 0);

/**
 * A sphere around balls [x, y, z, r], points those with r = 0: [x, y, z, r], at most about one per cent larger than the
 * smallest. Steps toward the farthest ball, each shorter (Bădoiu and Clarkson 2003).
 */
export function sphereAround(balls, steps = 120) {
  const center = balls[0].slice(0, 3);
  const best = [...center, Infinity];
  for (let step = 1; step <= steps; ++step) {
    let far = balls[0];
    let reach = -1;
    for (const ball of balls) {
      const at = Math.sqrt(square(ball, center)) + (ball[3] ?? 0);
      if (at > reach) [far, reach] = [ball, at];
    }
    if (reach < best[3]) best.splice(0, 4, ...center, reach);
    if (reach === 0) break;
    // The farthest point of that ball lies beyond its center.
    const apart = Math.sqrt(square(far, center));
    const stretch = apart > 0 ? reach / apart : 1;
    for (let k = 0; k < 3; ++k) center[k] += (stretch * (far[k] - center[k])) / (step + 1);
  }
  return best;
}

/** The part of a convex polygon in which sphere s has the least power of all the others. */
function cut(polygon, s, others) {
  for (const other of others) {
    if (other === s) continue;
    // Linear in the point: the squares of its coordinates cancel.
    const heights = polygon.map((p) => power(p, s) - power(p, other));
    if (heights.every((height) => height <= 0)) continue;
    const kept = [];
    polygon.forEach((p, i) => {
      const next = (i + 1) % polygon.length;
      if (heights[i] <= 0) kept.push(p);
      if (heights[i] <= 0 !== heights[next] <= 0) {
        const t = heights[i] / (heights[i] - heights[next]);
        kept.push(p.map((x, k) => x + t * (polygon[next][k] - x)));
      }
    });
    polygon = kept;
    if (polygon.length === 0) break;
  }
  return polygon;
}

const isIn = (polygon, s) => polygon.every((p) => power(p, s) <= 0);

/** Parts of triangles that lie in none of the given spheres alone: convex polygons, around all that is outside. */
function outsideOf(triangles, given, depth = 5) {
  if (given.length === 0) return triangles;
  const left = [];
  const divide = (triangle, levels) => {
    if (given.some((s) => isIn(triangle, s))) return;
    const reach = Math.sqrt(Math.max(square(triangle[0], triangle[1]), square(triangle[1], triangle[2]), square(triangle[2], triangle[0])));
    const apart = given.every((s) => Math.sqrt(square(triangle[0], s)) > s[3] + reach);
    if (levels === 0 || apart) {
      left.push(triangle);
      return;
    }
    const [a, b, c] = triangle;
    const [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(([p, q]) => p.map((x, k) => 0.5 * (x + q[k])));
    for (const quarter of [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]) divide(quarter, levels - 1);
  };
  for (const triangle of triangles) divide(triangle, depth);
  return left;
}

/** For every sphere the corners of its polygons, and the balls that it is to contain. */
function assign(pieces, balls, spheres) {
  const points = spheres.map(() => []);
  for (const piece of pieces) {
    const powers = piece.map((p) => spheres.map((s) => power(p, s)));
    let best = 0;
    spheres.forEach((_, k) => {
      if (Math.max(...powers.map((row) => row[k])) < Math.max(...powers.map((row) => row[best]))) best = k;
    });
    // A sphere whose power is larger than another's at all corners has no part of the polygon.
    const owners = spheres.filter((_, k) => k === best || powers.some((row) => row[k] < row[best]));
    for (const s of owners) points[spheres.indexOf(s)].push(...cut(piece, s, owners));
  }
  for (const ball of balls) {
    const grown = spheres.map((s) => Math.sqrt(square(ball, s)) + ball[3] - s[3]);
    points[grown.indexOf(Math.min(...grown))].push(ball);
  }
  return points;
}

/** A sphere without polygons goes to the farthest point of the largest one. */
function relocate(spheres, points, empty) {
  let largest = -1;
  spheres.forEach((s, k) => {
    if (points[k].length > 1 && (largest < 0 || s[3] > spheres[largest][3])) largest = k;
  });
  if (largest < 0) return;
  const far = points[largest].reduce((a, b) => (square(b, spheres[largest]) > square(a, spheres[largest]) ? b : a));
  spheres[empty] = [far[0], far[1], far[2], 0.5 * spheres[largest][3]];
}

/** Seeds: the first at the middle, every other one at the point farthest from those before. */
function spread(points, count) {
  const middle = sphereAround(points);
  const seeds = [[middle[0], middle[1], middle[2], 0]];
  const apart = points.map((p) => square(p, middle));
  while (seeds.length < count) {
    const far = points[apart.indexOf(apart.reduce((most, x) => Math.max(most, x), 0))];
    seeds.push([far[0], far[1], far[2], 0]);
    points.forEach((p, i) => (apart[i] = Math.min(apart[i], square(p, far))));
  }
  return seeds;
}

/**
 * spheres: [x, y, z, r]; keep: a flag for each that stays as it is. margin: a length that every radius has beyond what
 * the polygons need, above 0. Yields after each round, with the best spheres so far; the last value covers all triangles
 * and balls. Null where there is nothing to fit. Needs a free sphere.
 */
export function* refit(triangles, balls, spheres, keep, margin, rounds = 24) {
  const given = spheres.filter((_, k) => keep[k]).map(([x, y, z, r]) => [x, y, z, Math.max(0, r - margin)]);
  const free = spheres.flatMap((_, k) => (keep[k] ? [] : [k]));
  const pieces = outsideOf(triangles, given);
  const left = balls.filter((ball) => !given.some((s) => Math.sqrt(square(ball, s)) + ball[3] <= s[3]));
  const all = [...pieces.flat(), ...left];
  if (all.length === 0 || free.length === 0) return null;
  let best = null;
  const whole = (now) => spheres.map((s, k) => (keep[k] ? s : [...now[free.indexOf(k)].slice(0, 3), now[free.indexOf(k)][3] + margin]));
  for (const begin of [free.map((k) => spheres[k].slice()), spread(all, free.length)]) {
    let now = begin;
    for (let round = 0; round < rounds / 2; ++round) {
      const points = assign(pieces, left, now);
      const fitted = now.map((s, k) => (points[k].length > 0 ? sphereAround(points[k]) : [s[0], s[1], s[2], 0]));
      if (best === null || volume(fitted) < volume(best)) best = fitted.map((s) => s.slice());
      now = fitted;
      now.forEach((_, k) => points[k].length === 0 && relocate(now, points, k));
      yield whole(best);
    }
  }
  return whole(best);
}
