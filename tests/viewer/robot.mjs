// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A robot of the tests as a page, and where its links are by arithmetic of our own, read from its URDF.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { at, run } from './support.mjs';

export const urdf = (name) => fileURLToPath(new URL(`../../extras/robot/tests/robots/${name}_description/urdf/${name}.urdf`, import.meta.url));

/** NAME/robot.html, and the spheres that it shows, by link: [[x, y, z, r], …] in the link's axes. */
export function writeRobot(name, options = []) {
  run(['robot', urdf(name), '-o', name, '--spheres', '5', '--samples', '20', '--page', ...options]);
  const { links } = JSON.parse(readFileSync(at(`${name}/spheres.json`), 'utf8'));
  return new Map(links.map(({ link, spheres }) => [link, spheres.map(({ center, radius }) => [...center, radius])]));
}

const numbers = (text, fallback) => (text ?? fallback).trim().split(/\s+/).map(Number);
const attribute = (text, element, name) => new RegExp(`<${element}\\b[^>]*\\b${name}="([^"]*)"`).exec(text)?.[1];

/** Turns a point by a unit quaternion. */
function turned([w, x, y, z], [a, b, c]) {
  const t = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * t[0] + y * t[2] - z * t[1], b + w * t[1] + z * t[0] - x * t[2], c + w * t[2] + x * t[1] - y * t[0]];
}
const times = ([a, b, c, d], [e, f, g, h]) => [
  a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e,
];
const about = (axis, angle) => [Math.cos(angle / 2), ...axis.map((x) => x * Math.sin(angle / 2))];

/** {link: f} with f taking a point of the link to the root. values: by joint. */
export function whereLinksAre(name, values) {
  const text = readFileSync(urdf(name), 'utf8');
  const joints = [...text.matchAll(/<joint name="([^"]*)" type="([^"]*)">([\s\S]*?)<\/joint>/g)].map(([, joint, type, inside]) => ({
    joint, type, parent: attribute(inside, 'parent', 'link'), child: attribute(inside, 'child', 'link'),
    xyz: numbers(attribute(inside, 'origin', 'xyz'), '0 0 0'), rpy: numbers(attribute(inside, 'origin', 'rpy'), '0 0 0'),
    axis: numbers(attribute(inside, 'axis', 'xyz'), '1 0 0'),
    leader: attribute(inside, 'mimic', 'joint'), factor: Number(attribute(inside, 'mimic', 'multiplier') ?? 1), offset: Number(attribute(inside, 'mimic', 'offset') ?? 0),
  }));
  const value = (joint) => {
    const { leader, factor, offset } = joints.find((other) => other.joint === joint);
    return leader ? factor * value(leader) + offset : values[joint] ?? 0;
  };
  const carrier = new Map(joints.map((joint) => [joint.child, joint]));
  const place = (link, point) => {
    const joint = carrier.get(link);
    if (!joint) return point;
    const { xyz, rpy: [roll, pitch, yaw], type } = joint;
    const size = Math.hypot(...joint.axis);
    const axis = joint.axis.map((x) => x / size);
    const q = times(times(about([0, 0, 1], yaw), about([0, 1, 0], pitch)), about([1, 0, 0], roll));
    const moved = type === 'prismatic' ? point.map((x, k) => x + value(joint.joint) * axis[k])
      : type === 'fixed' ? point : turned(about(axis, value(joint.joint)), point);
    return place(joint.parent, turned(q, moved).map((x, k) => x + xyz[k]));
  };
  return (link, point) => place(link, point);
}
