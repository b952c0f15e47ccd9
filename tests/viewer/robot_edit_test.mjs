// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs, cover and fits that a robot's page computes, compared with sampling and with the command; no browser.
import { readFileSync, writeFileSync } from 'node:fs';
import { at, check, claim, equal, finish, run } from './support.mjs';
import { elements } from './page.mjs';
import { urdf, whereLinksAre, writeRobot } from './robot.mjs';
import { readManifest } from '../../viewer/src/decode.js';
import { SceneList } from '../../viewer/src/model.js';
import { Rates, randomNumbers, randomValues } from '../../viewer/src/pairs.js';
import { bareBalls, bareSurface } from '../../viewer/src/bare.js';
import { Edits } from '../../viewer/src/edits.js';
import { refit, sphereAround } from '../../viewer/src/refit.js';

const spheres = writeRobot('arm');
const sceneOf = (name) => {
  const text = elements(readFileSync(at(name), 'utf8'));
  return new SceneList(readManifest(text), text).scene(0);
};
const scene = sceneOf('arm/robot.html');
const { joints } = scene;
const partOf = (name) => joints.parts.findIndex((part) => part.name === name);
const apart = (p, s) => Math.hypot(p[0] - s[0], p[1] - s[1], p[2] - s[2]) - s[3];
const outside = (p, list) => Math.min(...list.map((s) => apart(p, s)));
/** Points of triangles, each triangle as often as asked. */
function samples(triangles, each, seed = 7) {
  const random = randomNumbers(seed);
  return triangles.flatMap(([a, b, c]) => Array.from({ length: each }, () => {
    let [u, v] = [random(), random()];
    if (u + v > 1) [u, v] = [1 - u, 1 - v];
    return a.map((x, k) => x + u * (b[k] - x) + v * (c[k] - x));
  }));
}
function finished(rounds) {
  let step = rounds.next();
  while (!step.done) step = rounds.next();
  return step.value;
}
const fitted = (...args) => finished(refit(...args));
const margin = 0.51 * scene.tolerance + 2e-6;

await claim('the_page_counts_the_spheres_of_the_files', () => {
  equal(scene.sphereCount, JSON.parse(readFileSync(at('arm/spheres.json'), 'utf8')).spheres, 'spheres');
});

await claim('the_page_has_the_exact_spheres_and_saves_them_unchanged', () => {
  const saved = JSON.parse(new Edits(joints.parts).json('arm'));
  equal(saved.links.length, spheres.size, 'links');
  for (const { link, spheres: list } of saved.links) {
    equal(JSON.stringify(list.map(({ center, radius }) => [...center, radius])), JSON.stringify(spheres.get(link)), link);
  }
});

await claim('rates_are_those_of_all_pairs_of_spheres_in_the_same_configurations', () => {
  const rates = new Rates(scene, 400, 3);
  while (!rates.run(2));
  const random = randomNumbers(3);
  const ignored = new Set(JSON.parse(readFileSync(at('arm/spheres.json'), 'utf8')).self_collision.ignored.map(({ links }) => links.sort().join(' ')));
  let [colliding, close] = [0, 0];
  const byPair = new Map();
  for (let i = 0; i < 400; ++i) {
    const values = randomValues(joints, random);
    const where = whereLinksAre('arm', Object.fromEntries(joints.own.map((own, k) => [joints.joints[own].name, values[k]])));
    const placed = [...spheres].map(([link, list]) => [link, list.map((s) => [...where(link, s.slice(0, 3)), s[3]])]);
    let any = false;
    for (const [p, first] of placed) {
      for (const [q, second] of placed) {
        if (p >= q || ignored.has(`${p} ${q}`)) continue;
        const gap = Math.min(...first.map((s) => Math.min(...second.map((t) => apart(s, t) - s[3]))));
        if (Math.abs(gap) < 1e-6) ++close;
        if (gap > 0) continue;
        any = true;
        byPair.set(`${p} ${q}`, (byPair.get(`${p} ${q}`) ?? 0) + 1);
      }
    }
    if (any) ++colliding;
  }
  check(colliding > 0 && colliding < 400, `some of them collide: ${colliding}`);
  check(Math.abs(rates.colliding - colliding) <= close, `${rates.colliding} of the page, ${colliding} here`);
  const named = new Map([...rates.byPair].map(([key, count]) => [key.split(' ').map((part) => joints.parts[part].name).sort().join(' '), count]));
  equal([...named.keys()].sort().join(), [...byPair.keys()].sort().join(), 'pairs');
  for (const [key, count] of byPair) check(Math.abs(named.get(key) - count) <= close, key);
});

await claim('ignored_pairs_have_their_reasons', () => {
  check(joints.ignored.size > 3, 'there are some');
  for (const reason of joints.ignored.values()) check(reason.length > 3, reason);
  check([...joints.ignored.values()].includes('neighbors'), 'neighbors');
});

await claim('bare_surface_is_found_where_samples_find_it', () => {
  const random = randomNumbers(5);
  let [bareOnes, missing] = [0, 0];
  for (const part of scene.entry.parts) {
    const facets = scene.facetsOf(part);
    const whole = joints.parts[part].spheres;
    const none = finished(bareSurface(facets, whole, scene.tolerance, 0.01));
    equal(none.triangles.length, 0, `bare pieces of ${joints.parts[part].name}, which is proven to be covered`);
    for (let without = 0; without < Math.min(3, whole.length) && whole.length > 1; ++without) {
      const list = whole.filter((_, k) => k !== without).map((s) => [s[0], s[1], s[2], s[3] * (1 - 0.1 * random())]);
      const bare = finished(bareSurface(facets, list, scene.tolerance, 0.02));
      const points = samples(facets, Math.ceil(1000 / facets.length)).filter((p) => outside(p, list) > scene.tolerance).filter((_, k) => k % 5 === 0);
      if (points.length > 0) ++bareOnes;
      for (const p of points) {
        // On a returned triangle: the areas of the three that it divides it into add up to the whole.
        const on = bare.triangles.some((triangle) => isOn(p, triangle));
        if (!on) ++missing;
      }
      check(points.every((p) => outside(p, list) <= bare.deepest + 0.021), 'deepest, up to the size of a piece');
    }
  }
  check(bareOnes > 10, `some were bare: ${bareOnes}`);
  equal(missing, 0, 'bare points in no bare piece');
});

/** Facets of a ball around the origin, 4 * rings². */
function ball(radius, rings) {
  const point = (i, k) => {
    const [u, v] = [(Math.PI * i) / rings, (Math.PI * k) / rings];
    return [Math.sin(u) * Math.cos(v), Math.sin(u) * Math.sin(v), Math.cos(u)].map((x) => radius * x);
  };
  const ring = (i) => Array.from({ length: 2 * rings }, (_, k) => [point(i, k), point(i + 1, k), point(i + 1, k + 1), point(i, k + 1)]);
  return Array.from({ length: rings }, (_, i) => ring(i)).flat().flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]);
}
await claim('bare_surface_of_many_facets_is_found_bit_by_bit', () => {
  const facets = ball(1, 60);
  check(facets.length > 10_000, 'many facets');
  // The sphere leaves the cap above z = h uncovered, whose share of the surface is (1 - h) / 2.
  const h = 0.6;
  const [down, within] = [0.5, 1e-3];
  const sphere = [0, 0, -down, Math.sqrt(1 + down * down + 2 * down * h)];
  const search = bareSurface(facets, [sphere], within, 0.02);
  let [yields, before] = [0, 0];
  let step = search.next();
  for (; !step.done; step = search.next()) {
    ++yields;
    check(step.value.area >= before, 'what is found stays');
    before = step.value.area;
  }
  check(yields >= facets.length / 200, `${yields} pauses`);
  const { triangles, area, deepest } = step.value;
  check(triangles.every((triangle) => Math.max(...triangle.map((p) => p[2])) > h - 0.01), 'none below the cap');
  const share = area / (4 * Math.PI);
  check(share > 0.98 * (1 - h) / 2 && share < 1.1 * (1 - h) / 2, `share of the cap: ${share}`);
  check(Math.abs(deepest - (1 + down - sphere[3])) < 1e-6, `depth of the pole: ${deepest}`);
});
function isOn(p, [a, b, c]) {
  if (p.some((x, k) => x < Math.min(a[k], b[k], c[k]) - 1e-9 || x > Math.max(a[k], b[k], c[k]) + 1e-9)) return false;
  const cross = (u, v) => Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
  const minus = (q, r) => q.map((x, k) => x - r[k]);
  const twice = (q, r, s) => cross(minus(r, q), minus(s, q));
  const all = twice(a, b, c);
  return twice(p, a, b) + twice(p, b, c) + twice(p, c, a) <= all * (1 + 1e-6) + 1e-12;
}

await claim('a_new_fit_covers_the_link_by_samples', () => {
  for (const part of scene.entry.parts) {
    const { name, balls, spheres: before } = joints.parts[part];
    const facets = scene.facetsOf(part);
    for (const count of [1, 2, before.length, before.length + 4]) {
      const random = randomNumbers(count);
      const begin = Array.from({ length: count }, () => [random() - 0.5, random() - 0.5, random() - 0.5, 0.1]);
      const list = fitted(facets, balls, begin, begin.map(() => false), margin);
      equal(list.length, count, `spheres of ${name}`);
      const worst = Math.max(-Infinity, ...samples(facets, Math.ceil(3000 / Math.max(1, facets.length))).map((p) => outside(p, list)));
      check(worst <= -0.9 * margin, `${name}, ${count}: a sample is ${worst} outside, margin ${margin}`);
      equal(bareBalls(balls, list, 0).length, 0, `balls of ${name}`);
    }
  }
});

await claim('a_new_fit_is_about_as_tight_as_the_command', () => {
  for (const name of ['base', 'forearm']) {
    const part = partOf(name);
    const before = joints.parts[part].spheres;
    const list = fitted(scene.facetsOf(part), joints.parts[part].balls, before, before.map(() => false), margin);
    const largest = (of) => Math.max(...of.map((s) => s[3]));
    check(largest(list) <= 1.25 * largest(before), `${name}: ${largest(list)} for ${largest(before)}`);
  }
});

await claim('a_new_fit_leaves_kept_spheres_alone', () => {
  const part = partOf('base');
  const facets = scene.facetsOf(part);
  const before = joints.parts[part].spheres;
  const keep = before.map((_, k) => k === 1 || k === 3);
  const moved = before.map((s, k) => (k === 1 ? [s[0] + 0.02, s[1], s[2], 0.7 * s[3]] : s));
  const list = fitted(facets, [], moved, keep, margin);
  keep.forEach((kept, k) => kept && equal(list[k].join(), moved[k].join(), `sphere ${k}`));
  const worst = Math.max(...samples(facets, 40).map((p) => outside(p, list)));
  check(worst <= 0, `a sample is ${worst} outside`);
  equal(fitted(facets, [], before, before.map(() => true), margin), null, 'without a free sphere');
});

await claim('a_link_of_many_facets_gets_a_new_fit', () => {
  const facets = ball(1, 120);
  const list = fitted(facets, [], [[0.4, 0, 0, 1], [-0.4, 0, 0, 1]], [false, false], 1e-6, 2);
  const worst = Math.max(...samples(facets.filter((_, k) => k % 20 === 0), 3).map((p) => outside(p, list)));
  check(worst <= 0, `a sample is ${worst} outside`);
});

await claim('the_sphere_around_balls_contains_them_and_is_small', () => {
  const random = randomNumbers(11);
  for (let trial = 0; trial < 50; ++trial) {
    // Points of a sphere, its poles among them: it is the smallest.
    const center = [random(), random(), random()];
    const radius = 0.1 + random();
    const balls = Array.from({ length: 30 }, () => {
      const u = [random() - 0.5, random() - 0.5, random() - 0.5];
      const size = Math.hypot(...u);
      const r = 0.4 * radius * random();
      return [...center.map((x, k) => x + ((radius - r) * u[k]) / size), r];
    });
    for (const sign of [1, -1]) balls.push([center[0] + sign * radius, center[1], center[2], 0]);
    const around = sphereAround(balls);
    check(balls.every((ball) => apart(ball, around) + ball[3] <= 1e-12), 'all are inside');
    check(around[3] <= 1.02 * radius, `${around[3]} for ${radius}`);
  }
});

await claim('changes_are_undone_and_done_again', () => {
  const edits = new Edits(joints.parts);
  const part = partOf('base');
  const states = [JSON.stringify(edits.spheres[part])];
  const note = () => states.push(JSON.stringify(edits.spheres[part]));
  edits.add(part, [0, 0, 0, 1]), note();
  edits.set(part, 0, [1, 2, 3, 4], 'drag'), edits.set(part, 0, [1, 2, 3, 5], 'drag'), note();
  edits.seal();
  edits.set(part, 0, [1, 2, 3, 6], 'drag'), note();
  edits.remove(part, 1), note();
  for (let k = states.length - 2; k >= 0; --k) equal([edits.undo(), JSON.stringify(edits.spheres[part])].join(), [part, states[k]].join(), `undo to ${k}`);
  equal(edits.undo(), -1, 'nothing is left');
  for (let k = 1; k < states.length; ++k) equal([edits.redo(), JSON.stringify(edits.spheres[part])].join(), [part, states[k]].join(), `redo to ${k}`);
  equal(edits.redo(), -1, 'nothing is left');
  check(!edits.set(part, 0, [0, 0, 0, NaN]) && !edits.set(part, 0, [0, 0, 0, 0]) && !edits.set(part, 0, [0, 0, 0, -1]), 'what is no sphere is refused');
  while (edits.spheres[part].length > 1) check(edits.remove(part, 0), 'all but one');
  check(!edits.remove(part, 0), 'the last one stays');
});

await claim('other_spheres_are_shown_where_they_are', () => {
  const other = sceneOf('arm/robot.html');
  const edits = new Edits(other.joints.parts);
  const part = partOf('forearm');
  edits.add(part, [0.1, -0.05, 0.2, 0.07]);
  edits.remove(partOf('base'), 0);
  other.refill(edits.spheres);
  const values = randomValues(other.joints, randomNumbers(2));
  other.pose(values);
  const where = whereLinksAre('arm', Object.fromEntries(joints.own.map((own, k) => [joints.joints[own].name, values[k]])));
  for (const shown of other.entry.parts) {
    const leaves = other.leavesOf(shown);
    equal(leaves.length, edits.spheres[shown].length, 'number');
    leaves.forEach((node, k) => {
      const s = edits.spheres[shown][k];
      const [x, y, z, r] = other.frames[0].subarray(4 * node, 4 * node + 4);
      const [u, v, w] = where(joints.parts[shown].name, s.slice(0, 3));
      check(Math.hypot(x + other.origin[0] - u, y + other.origin[1] - v, z + other.origin[2] - w) < 1e-6 && Math.abs(r - s[3]) < 1e-6, `sphere ${k}`);
    });
    const head = other.parent[leaves[0]];
    const [a, b, c, R] = other.frames[0].subarray(4 * head, 4 * head + 4);
    for (const node of leaves) check(apart(other.frames[0].subarray(4 * node, 4 * node + 3), [a, b, c, R]) + other.frames[0][4 * node + 3] < 1e-5, 'the sphere around a link');
  }
});

await claim('the_command_certifies_a_new_fit', () => {
  const edits = new Edits(joints.parts);
  for (const part of scene.entry.parts) {
    const list = fitted(scene.facetsOf(part), joints.parts[part].balls, edits.spheres[part], edits.pinned[part], margin);
    edits.change(part, list, edits.pinned[part]);
  }
  writeFileSync(at('fitted.json'), edits.json('arm'));
  const report = JSON.parse(run(['robot', urdf('arm'), '-o', 'certified', '--keep', 'fitted.json', '--format', 'json', '--samples', '20', '--json']));
  check(report.covered, 'covered');
  equal(report.spheres, scene.sphereCount, 'spheres');
});

finish();
