// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Joints: values in, where the parts of a body are out. No page and no drawing in here: tests run it alone.
import { PageError } from './decode.js';

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]; // rows of a rotation, each with its translation

/** a ∘ b */
export function product(a, b) {
  const c = new Array(12);
  for (let i = 0; i < 12; i += 4) {
    for (let k = 0; k < 4; ++k) c[i + k] = a[i] * b[k] + a[i + 1] * b[4 + k] + a[i + 2] * b[8 + k] + (k === 3 ? a[i + 3] : 0);
  }
  return c;
}
export function inverse(a) {
  const c = [a[0], a[4], a[8], 0, a[1], a[5], a[9], 0, a[2], a[6], a[10], 0];
  for (let i = 0; i < 12; i += 4) c[i + 3] = -(c[i] * a[3] + c[i + 1] * a[7] + c[i + 2] * a[11]);
  return c;
}
export const placed = (a, [x, y, z]) => [0, 4, 8].map((i) => a[i] * x + a[i + 1] * y + a[i + 2] * z + a[i + 3]);

function motion({ kind, axis: [x, y, z] }, value) {
  if (kind === 'slides') return [1, 0, 0, value * x, 0, 1, 0, value * y, 0, 0, 1, value * z];
  const c = Math.cos(value), s = Math.sin(value), d = 1 - c;
  return [
    c + x * x * d, x * y * d - z * s, x * z * d + y * s, 0,
    y * x * d + z * s, c + y * y * d, y * z * d - x * s, 0,
    z * x * d - y * s, z * y * d + x * s, c + z * z * d, 0,
  ];
}

export class Joints {
  constructor(entry) {
    const parts = entry.parts.length;
    for (const { parent, child, leader } of entry.joints) {
      if (!(parent < parts && child < parts) || !(leader === null || leader < entry.joints.length)) throw new PageError('a joint names what is not there');
    }
    this.parts = entry.parts;
    this.joints = entry.joints;
    /** The reason of every ignored pair, by 'a b' with a < b. */
    this.ignored = new Map(entry.ignored.map(([a, b], k) => [`${a} ${b}`, entry.reasons?.[k] ?? '']));
    /** The joints that the reader moves: those that follow no other. */
    this.own = entry.joints.flatMap((joint, i) => (joint.kind !== 'fixed' && joint.leader === null ? [i] : []));
    this.rest = this.own.map((i) => entry.joints[i].rest);
    this.fromRest = this.poses(this.rest).map(inverse);
  }
  limits(k) {
    const { lower, upper } = this.joints[this.own[k]];
    return [lower, upper];
  }
  /** The value nearest to `value` that the limits allow. */
  within(k, value) {
    const [lower, upper] = this.limits(k);
    return Math.min(Math.max(value, lower), upper);
  }
  /** The pose of every part, in the axes of the part that no joint carries. values: one per own joint. */
  poses(values) {
    const given = new Map(this.own.map((i, k) => [i, values[k]]));
    const valueOf = (i, steps = 0) => {
      const { leader, factor, offset } = this.joints[i];
      if (leader === null || steps > this.joints.length) return given.get(i) ?? 0;
      return factor * valueOf(leader, steps + 1) + offset;
    };
    const poses = this.parts.map(() => identity);
    this.joints.forEach((joint, i) => {
      const [a, b, c] = joint.rows;
      const [x, y, z] = joint.translation;
      const at = product(poses[joint.parent], [...a, x, ...b, y, ...c, z]);
      poses[joint.child] = joint.kind === 'fixed' ? at : product(at, motion(joint, valueOf(i)));
    });
    return poses;
  }
  /** The transform of every part from its pose at rest to its current pose. */
  moves(values) {
    return this.poses(values).map((pose, part) => product(pose, this.fromRest[part]));
  }
  /** One joint after the other from its value to both its limits and back. share: 0 to 1 of all of it. */
  swing(values, share) {
    const place = Math.min(Math.max(share, 0), 1) * this.own.length;
    const k = Math.min(Math.floor(place), this.own.length - 1);
    const [lower, upper] = this.limits(k);
    const legs = [values[k], upper, lower, values[k]];
    const along = 3 * (place - k);
    const leg = Math.min(Math.floor(along), 2);
    const smooth = 0.5 - 0.5 * Math.cos(Math.PI * Math.min(along - leg, 1));
    return values.map((value, i) => (i === k ? legs[leg] + smooth * (legs[leg + 1] - legs[leg]) : value));
  }
}
