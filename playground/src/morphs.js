// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Morph targets: each moves some vertices by offsets, times its influence.

export class Morphs {
  constructor() {
    this.targets = [];
  }

  /** influence: a function; its value now is that of the rest shape. Returns the number of the target. */
  add(influence) {
    return this.targets.push({ influence, atRest: influence(), vertices: [], offsets: [] }) - 1;
  }
  offset(target, vertex, x, y, z) {
    this.targets[target].vertices.push(vertex);
    this.targets[target].offsets.push(x, y, z);
  }
  get moves() {
    return this.targets.some(({ vertices }) => vertices.length > 0);
  }

  /** The rest shape with the influences of now; `rest` itself where nothing moves. */
  applied(rest) {
    if (!this.moves) return rest;
    const out = (this.out ??= new Float64Array(rest.length));
    out.set(rest);
    for (const { influence, atRest, vertices, offsets } of this.targets) {
      const share = influence() - atRest;
      if (share === 0) continue;
      vertices.forEach((v, i) => {
        for (let k = 0; k < 3; ++k) out[3 * v + k] += share * offsets[3 * i + k];
      });
    }
    return out;
  }
}
