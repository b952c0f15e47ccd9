// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A robot's page moves spheres and surface as its URDF says: compared with arithmetic of the test's own.
import { readFileSync } from 'node:fs';
import { at, check, claim, equal, finish } from './support.mjs';
import { elements, isRefused } from './page.mjs';
import { whereLinksAre, writeRobot } from './robot.mjs';
import { readManifest } from '../../viewer/src/decode.js';
import { Joints } from '../../viewer/src/joints.js';
import { SceneList } from '../../viewer/src/model.js';

function sceneOf(file) {
  const text = elements(readFileSync(at(file), 'utf8'));
  return new SceneList(readManifest(text), text);
}
/** Spread over the limits, the same in every run. */
const someValues = (joints, seed) => joints.own.map((_, k) => {
  const [lower, upper] = joints.limits(k);
  return lower + (upper - lower) * ((0.37 + 0.618 * (seed + 1) * (k + 1)) % 1);
});

for (const name of ['arm', 'gripper']) {
  const spheres = writeRobot(name, ['--inner', '3']);
  const list = sceneOf(`${name}/robot.html`);
  const scene = list.scene(0);
  const { joints } = scene;

  await claim(`${name}_spheres_and_surface_follow_the_joints`, () => {
    let links = 0;
    for (let seed = 0; seed < 6; ++seed) {
      const values = someValues(joints, seed);
      scene.pose(values);
      const where = whereLinksAre(name, Object.fromEntries(joints.own.map((i, k) => [joints.joints[i].name, values[k]])));
      for (const head of scene.levelSets[1]) {
        const part = joints.parts[scene.partOf[head]];
        const wanted = spheres.get(part.name);
        equal(scene.entry.child_count[head], wanted.length, `spheres of ${part.name}`);
        const shown = wanted.map(([x, y, z, radius], i) => {
          const [a, b, c, r] = scene.frames[0].subarray(4 * (scene.firstChild[head] + i));
          const [u, v, w] = where(part.name, [x, y, z]);
          const off = Math.hypot(a + scene.origin[0] - u, b + scene.origin[1] - v, c + scene.origin[2] - w);
          check(off < 1e-6 && Math.abs(r - radius) < 1e-6, `${part.name} ${i}: ${off} away`);
          return [a, b, c, r];
        });
        const [begin, end] = part.vertices;
        check(end > begin, `${part.name} has vertices`);
        const positions = scene.positions(0);
        for (let vertex = begin; vertex < end; ++vertex) {
          const p = positions.subarray(3 * vertex, 3 * vertex + 3);
          const out = Math.min(...shown.map(([a, b, c, r]) => Math.hypot(p[0] - a, p[1] - b, p[2] - c) - r));
          check(out <= scene.tolerance + 1e-7, `vertex ${vertex} of ${part.name} is ${out} outside`);
        }
        ++links;
      }
      const [x, y, z, r] = scene.frames[0];
      for (const node of scene.levelSets[2]) {
        const [a, b, c, own] = scene.frames[0].subarray(4 * node, 4 * node + 4);
        check(Math.hypot(a - x, b - y, c - z) + own <= r + 1e-6, 'the root is around all');
      }
    }
    check(links >= 24, 'links were compared');
  });

  await claim(`${name}_inner_spheres_are_a_scene_of_their_own`, () => {
    const inner = list.scene(1);
    check(list.describe(1).tree !== list.describe(0).tree, 'by another name');
    scene.pose(someValues(joints, 2));
    inner.pose(someValues(joints, 2));
    for (const head of inner.levelSets[1]) {
      const part = inner.partOf[head];
      const around = [...scene.levelSets[1]].find((node) => scene.partOf[node] === part);
      const [x, y, z, r] = scene.frames[0].subarray(4 * around, 4 * around + 4);
      const [a, b, c, own] = inner.frames[0].subarray(4 * head, 4 * head + 4);
      check(Math.hypot(a - x, b - y, c - z) < r + own, `${inner.joints.parts[part].name}: inside where the link is`);
    }
  });

  await claim(`${name}_meeting_links_are_those_of_all_pairs_of_spheres`, () => {
    let met = 0;
    for (let seed = 0; seed < 40; ++seed) {
      scene.pose(someValues(joints, seed));
      const wanted = new Set();
      const leaves = [...scene.levelSets[2]];
      leaves.forEach((a) => leaves.forEach((b) => {
        const [p, q] = [scene.partOf[a], scene.partOf[b]];
        if (p >= q || joints.ignored.has(`${p} ${q}`)) return;
        const [s, t] = [a, b].map((node) => scene.frames[0].subarray(4 * node, 4 * node + 4));
        if (Math.hypot(s[0] - t[0], s[1] - t[1], s[2] - t[2]) <= s[3] + t[3]) wanted.add(`${joints.parts[p].name} ${joints.parts[q].name}`);
      }));
      const found = scene.meeting().map((pair) => pair.join(' '));
      equal(found.sort().join(), [...wanted].sort().join(), 'pairs');
      met += found.length;
    }
    if (name === 'arm') check(met > 0, 'some meet, so that the test means something');
  });
}

await claim('a_swing_goes_to_both_limits_of_each_joint_and_ends_where_it_began', () => {
  const { joints } = sceneOf('arm/robot.html').scene(0);
  const from = someValues(joints, 3);
  const all = Array.from({ length: 3001 }, (_, i) => joints.swing(from, i / 3000));
  joints.own.forEach((_, k) => {
    const [lower, upper] = joints.limits(k);
    const seen = all.map((values) => values[k]);
    check(Math.abs(Math.min(...seen) - lower) < 0.01 && Math.abs(Math.max(...seen) - upper) < 0.01, `joint ${k}`);
  });
  for (const values of [all[0], all[3000]]) values.forEach((value, k) => check(Math.abs(value - from[k]) < 1e-9, `joint ${k}`));
  all.slice(1).forEach((values, i) => check(values.filter((value, k) => value !== all[i][k]).length <= 2, 'one at a time'));
});

await claim('joints_that_name_nothing_are_told', () => {
  const joint = { name: 'j', kind: 'turns', parent: 0, child: 1, rows: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], translation: [0, 0, 0], axis: [0, 0, 1], lower: 0, upper: 1, rest: 0, leader: null, factor: 1, offset: 0 };
  const parts = [{ name: 'a', vertices: [0, 0] }, { name: 'b', vertices: [0, 0] }];
  equal(new Joints({ parts, joints: [joint], ignored: [] }).own.length, 1, 'as it is to be');
  check(isRefused(() => new Joints({ parts, joints: [{ ...joint, child: 2 }], ignored: [] })), 'a part');
  check(isRefused(() => new Joints({ parts, joints: [{ ...joint, leader: 5 }], ignored: [] })), 'a leader');
});

finish();
