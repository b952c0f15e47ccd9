// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the playground computes by itself: deformations, clusters, the soft body, figures, limits. No browser, no package.
import { check, claim, equal, finish } from '../viewer/support.mjs';
import { clustersOf } from '../../playground/src/clusters.js';
import { beginning, kinds, within } from '../../playground/src/choices.js';
import { Deformer } from '../../playground/src/deform.js';
import { isClosed, looseness, uncoveredShare, volumeOf } from '../../playground/src/figures.js';
import { checkFile, checkMeshBytes, mostBytes } from '../../playground/src/limits.js';
import { Morphs } from '../../playground/src/morphs.js';
import { objText } from '../../playground/src/obj.js';
import { SoftBody } from '../../playground/src/soft.js';
import { readAddress, writeAddress } from '../../viewer/src/address.js';
import { sphereGrid } from '../../viewer/src/uncovered.js';

/** A closed tube along x of length 4 and radius ½. */
function tube(rings, around) {
  const positions = [];
  const facets = [];
  for (let i = 0; i <= rings; ++i) {
    for (let j = 0; j < around; ++j) {
      const angle = (2 * Math.PI * j) / around;
      positions.push(-2 + (4 * i) / rings, 0.5 * Math.cos(angle), 0.5 * Math.sin(angle));
    }
  }
  const end = positions.length / 3;
  positions.push(-2, 0, 0, 2, 0, 0);
  for (let j = 0; j < around; ++j) {
    const next = (j + 1) % around;
    for (let i = 0; i < rings; ++i) {
      const [a, b] = [i * around + j, i * around + next];
      facets.push(a, b, a + around, b, b + around, a + around);
    }
    facets.push(end, next, j, end + 1, rings * around + j, rings * around + next);
  }
  return { positions: Float64Array.from(positions), facets: Uint32Array.from(facets) };
}
const body = tube(40, 24);
const near = (a, b, off, what) => check(Math.abs(a - b) <= off, `${what}: ${a} is not ${b}`);
const throws = (f, text) => {
  try {
    f();
  } catch (error) {
    check(error.message.includes(text), `${error.message} does not say ${text}`);
    return;
  }
  check(false, `no error about ${text}`);
};
const most = (a, b) => a.reduce((off, x, i) => Math.max(off, Math.abs(x - b[i])), 0);

await claim('deformations_are_those_of_their_formulas', () => {
  const deformer = new Deformer(body.positions);
  const out = new Float64Array(body.positions.length);
  deformer.apply({ bend: 0, twist: 0, stretch: 1 }, out);
  equal(most(out, body.positions), 0, 'at rest');
  // Pappus: bending about the middle line keeps the volume; so do a twist and this stretch.
  for (const values of [{ bend: 90, twist: 0, stretch: 1 }, { bend: 0, twist: 90, stretch: 1 }, { bend: 0, twist: 0, stretch: 1.7 }, { bend: 100, twist: 60, stretch: 0.8 }]) {
    deformer.apply(values, out);
    near(volumeOf(out, body.facets), volumeOf(body.positions, body.facets), 0.02, JSON.stringify(values));
  }
  deformer.apply({ bend: 180, twist: 0, stretch: 1 }, out);
  const ends = [out.length - 6, out.length - 3].map((i) => [...out.slice(i, i + 3)]);
  near(Math.hypot(...ends[0].map((x, k) => x - ends[1][k])), 8 / Math.PI, 1e-12, 'ends of a half circle of length 4 apart');
  deformer.apply({ bend: 0, twist: 90, stretch: 1 }, out);
  near(Math.hypot(out[1], out[2]), 0.5, 1e-12, 'a twist keeps the distance from the axis');
  check(deformer.bendLimit(0.5) < deformer.bendLimit(1), 'a short thick body bends less');
});

await claim('a_body_bent_to_its_limit_does_not_fold', () => {
  const thick = tube(12, 24);
  for (let i = 0; i < thick.positions.length; ++i) if (i % 3 > 0) thick.positions[i] *= 3.5;
  const deformer = new Deformer(thick.positions);
  const out = new Float64Array(thick.positions.length);
  for (const sign of [1, -1]) {
    deformer.apply({ bend: sign * deformer.bendLimit(1), twist: 0, stretch: 1 }, out);
    for (let v = 0; v < out.length; v += 3) check(Number.isFinite(out[v] + out[v + 1] + out[v + 2]), 'finite');
    check(volumeOf(out, thick.facets) > 0, 'not inside out');
  }
});

await claim('clusters_hold_every_vertex_and_do_not_join_parts', () => {
  const clusters = clustersOf(body.positions, body.facets, 12);
  const seen = new Set(clusters.flatMap((members) => [...members]));
  equal(seen.size, body.positions.length / 3, 'vertices in clusters');
  // Two tubes almost in touch.
  const shifted = body.positions.map((x, i) => (i % 3 === 1 ? x + 1.0001 : x));
  const count = body.positions.length / 3;
  const both = clustersOf(Float64Array.from([...body.positions, ...shifted]), Uint32Array.from([...body.facets, ...body.facets.map((v) => v + count)]), 12);
  for (const members of both) check(new Set([...members].map((v) => v < count)).size === 1, 'a cluster of both parts');
});

await claim('a_soft_body_follows_a_drag_and_comes_back_exactly', () => {
  const soft = new SoftBody(body.positions, clustersOf(body.positions, body.facets, 24));
  equal(soft.step(), false, 'nothing to do at rest');
  soft.hold([0, 0.5, 0], 0.6);
  soft.drag([0, 1.5, 0]);
  for (let step = 0; step < 40; ++step) soft.step();
  const top = Math.max(...soft.x.filter((_, i) => i % 3 === 1));
  check(top > 1.1 && top < 1.6, `the top is at ${top}`);
  check(most(soft.x.filter((_, i) => i % 3 === 0), body.positions.filter((_, i) => i % 3 === 0)) < 0.5, 'its ends stay near');
  soft.release();
  for (let step = 0; step < 1500 && !soft.asleep; ++step) soft.step();
  check(soft.asleep, 'it sleeps');
  equal(most(soft.x, body.positions), 0, 'off the goal');
});

await claim('a_body_under_steady_pressure_rests_and_one_that_comes_back_does_not', () => {
  const soft = new SoftBody(body.positions, clustersOf(body.positions, body.facets, 24));
  // A floor below which no vertex stays.
  const press = () => {
    for (let v = 0; 3 * v < soft.x.length; ++v) if (soft.x[3 * v + 1] < -0.4) soft.push(v, 0, -0.4 - soft.x[3 * v + 1], 0);
  };
  press();
  let steps = 0;
  for (; steps < 1200 && !soft.isStill; ++steps) {
    soft.step();
    press();
  }
  check(soft.isStill, 'it rests on the floor');
  check(most(soft.x, body.positions) > 0.02, 'off its goal');
  soft.wake();
  for (steps = 0; steps < 1500 && !soft.isStill; ++steps) soft.step();
  equal(most(soft.x, body.positions), 0, 'off the goal when it is still again');
});

await claim('a_soft_body_survives_what_is_absurd', () => {
  const soft = new SoftBody(body.positions, clustersOf(body.positions, body.facets, 24));
  for (const push of [[1e3, 0, 0], [0, NaN, 0], [Infinity, 0, 0]]) {
    soft.poke([0, 0.5, 0], 1, push);
    for (let step = 0; step < 200; ++step) soft.step();
    check(soft.x.every(Number.isFinite), `finite after ${push}`);
  }
  const turned = body.positions.map((x, i) => (i % 3 === 2 ? x : -x)); // half a turn at once
  soft.setGoal(turned);
  soft.poke([0, 0.5, 0], 1, [0, 0.1, 0]);
  for (let step = 0; step < 1500 && !soft.asleep; ++step) soft.step();
  check(most(soft.x, turned) < 0.01, 'it comes to the new goal');
});

await claim('figures_are_those_of_shapes_whose_volume_is_known', () => {
  check(isClosed(body.facets) && !isClosed(body.facets.subarray(3)), 'closed, and open without a facet');
  const volume = volumeOf(body.positions, body.facets);
  near(volumeOf(body.positions.map((x) => x + 2 ** 20), body.facets), volume, 1e-6, 'volume far from the origin');
  const sphere = Float32Array.from([0, 0, 0, 2.2]);
  near(looseness(body.positions, body.facets, sphere, [0]), ((4 / 3) * Math.PI * 2.2 ** 3 - volume) / volume, 0.15, 'one sphere around');
  near(looseness(body.positions, body.facets, Float32Array.from([0, 0, 0, 0.45]), [0]), 0, 1e-12, 'a sphere inside');
  // A sphere at the middle of the axis holds the mantle up to a known place, and no end.
  const grid = sphereGrid(body.positions, Float32Array.from([0, 0, 0, 1.3]), [0]);
  const mantle = 2 * Math.PI * 0.5 * 4;
  const whole = mantle + 2 * Math.PI * 0.25;
  const covered = (2 * Math.sqrt(1.3 ** 2 - 0.25) * Math.PI) / whole;
  near(uncoveredShare(body.positions, body.facets, grid, 0), 1 - covered, 0.01, 'uncovered share');
  equal(uncoveredShare(body.positions, body.facets, sphereGrid(body.positions, sphere, [0]), 0), 0, 'share that one sphere leaves');
});

await claim('files_too_large_or_of_no_kind_are_refused_unread', () => {
  throws(() => checkFile({ name: 'body.txt', size: 10 }), 'this page reads');
  throws(() => checkFile({ name: 'body', size: 10 }), 'this page reads');
  throws(() => checkFile({ name: 'body.obj', size: 0 }), 'empty');
  throws(() => checkFile({ name: 'body.STL', size: 2 ** 31 }), '2,048 MB');
  checkFile({ name: 'body.PLY', size: mostBytes });
  const head = new TextEncoder().encode('ply\nformat binary_little_endian 1.0\nelement vertex 5000000\nelement face 10000000\nend_header\n');
  throws(() => checkMeshBytes('a.ply', head), '10,000,000 facets');
  const stl = new Uint8Array(84);
  new DataView(stl.buffer).setUint32(80, 10_000_000, true);
  checkMeshBytes('a.stl', stl); // text, or damaged: the reader says so
});

await claim('morph_targets_add_their_offsets_times_what_their_influences_differ_from_rest', () => {
  const morphs = new Morphs();
  const rest = Float64Array.from([1, 2, 3, 4, 5, 6]);
  equal(morphs.applied(rest), rest, 'without targets');
  const influences = [0, 0.5];
  influences.forEach((_, k) => morphs.add(() => influences[k]));
  check(!morphs.moves, 'targets without offsets move nothing');
  morphs.offset(0, 1, 1, 0, -2);
  morphs.offset(1, 0, 0, 8, 0);
  morphs.offset(1, 1, 0, 0, 4);
  equal(morphs.applied(rest).join(), rest.join(), 'at rest');
  influences[0] = 2;
  influences[1] = 0;
  equal(morphs.applied(rest).join(), '1,-2,3,6,5,0', 'moved'); // 2 (1, 0, -2), and -0.5 (0, 8, 0) and -0.5 (0, 0, 4)
  equal(rest.join(), '1,2,3,4,5,6', 'the rest shape stays');
});

await claim('an_address_keeps_what_was_set_and_passes_nonsense_over', () => {
  const now = { ...beginning, bend: -75, twist: 33, stretch: 1.25, rule: 'approach1', beside: true, level: 3, place: [0.1, -0.2, 0], touch: 'tool' };
  const back = { ...beginning, ...within(readAddress(writeAddress(now, beginning, '', kinds), kinds).values) };
  for (const name of Object.keys(kinds)) equal(JSON.stringify(back[name]), JSON.stringify(now[name]), name);
  const odd = within(readAddress('#bend=1e9&twist=NaN&stretch=-3&rule=none&level=99&place=1,2&tour=77&flat=1e99&shape=../x', kinds).values);
  equal(JSON.stringify(odd), JSON.stringify({ tour: 5, stretch: 0.5, level: 8, place: [0, 0, 0] }), 'what is left of nonsense');
  equal(within({ place: [1e300, -1e300, 0.5] }).place.join(), '10,-10,0.5', 'a place out of reach');
});

await claim('a_saved_mesh_has_all_digits', () => {
  const positions = Float64Array.from([0.1 + 0.2, -0, 1e-300, Math.PI, 1e22, -7]);
  const back = objText(positions, [0, 1, 1]).split('\n').filter((line) => line.startsWith('v')).flatMap((line) => line.split(' ').slice(1).map(Number));
  back.forEach((x, i) => check(Object.is(x, positions[i]), `${x} for ${positions[i]}`));
});

finish();
