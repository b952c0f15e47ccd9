// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Stretch, twist and bend along the longest axis of a mesh [barr1984], in this order. Tests run it alone.

import { boxOf } from '../../viewer/src/uncovered.js';

export { boxOf };

export class Deformer {
  /** rest: x, y, z per vertex. */
  constructor(rest) {
    this.rest = rest;
    const { low, high } = boxOf(rest);
    this.center = low.map((l, k) => 0.5 * (l + high[k]));
    const size = low.map((l, k) => high[k] - l);
    this.size = Math.hypot(...size);
    this.along = size.indexOf(Math.max(...size));
    this.across = (this.along + 1) % 3;
    this.third = (this.along + 2) % 3;
    this.half = 0.5 * size[this.along];
    this.reach = 0; // from the axis, to any side: a twist may turn it
    for (let i = 0; i < rest.length; i += 3) {
      const [v, w] = [this.across, this.third].map((k) => rest[i + k] - this.center[k]);
      this.reach = Math.max(this.reach, Math.hypot(v, w));
    }
  }

  /** The largest angle, in whole degrees up to 180, to which the stretched body bends without folding over itself. */
  bendLimit(stretch) {
    const radians = (0.95 * 2 * this.half * stretch ** 1.5) / (this.reach || 1e-30);
    return Math.floor(Math.min(180, (radians * 180) / Math.PI));
  }

  /** bend, twist: degrees from end to end; stretch: factor of the length, of which the volume is kept. Writes to `out`. */
  apply({ bend, twist, stretch }, out) {
    const { rest, center, along, across, third, half } = this;
    if (bend === 0 && twist === 0 && stretch === 1) {
      out.set(rest);
      return;
    }
    const thin = 1 / Math.sqrt(stretch);
    const length = 2 * half * stretch || 1e-30;
    const curvature = (bend * Math.PI) / 180 / length;
    const turn = (twist * Math.PI) / 180 / length;
    for (let i = 0; i < rest.length; i += 3) {
      const u = (rest[i + along] - center[along]) * stretch;
      const p = (rest[i + across] - center[across]) * thin;
      const q = (rest[i + third] - center[third]) * thin;
      const angle = turn * u;
      const v = Math.cos(angle) * p - Math.sin(angle) * q;
      const w = Math.sin(angle) * p + Math.cos(angle) * q;
      let x = u;
      let y = v;
      if (Math.abs(curvature * length) > 1e-9) {
        const sine = Math.sin(curvature * u);
        const halfSine = Math.sin(0.5 * curvature * u);
        x = sine / curvature - v * sine;
        y = (2 * halfSine * halfSine) / curvature + v * Math.cos(curvature * u);
      }
      out[i + along] = center[along] + x;
      out[i + across] = center[across] + y;
      out[i + third] = center[third] + w;
    }
  }
}
