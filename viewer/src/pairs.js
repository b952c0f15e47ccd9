// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Parts whose spheres overlap, in one pose and over random ones. No page and no drawing in here: tests run it alone.

const touch = (spheres, a, b) => {
  const radii = spheres[4 * a + 3] + spheres[4 * b + 3];
  let square = 0;
  for (let k = 0; k < 3; ++k) square += (spheres[4 * a + k] - spheres[4 * b + k]) ** 2;
  return square <= radii * radii;
};

/**
 * Pairs of parts that are not ignored and whose spheres overlap: [{parts: [p, q] with p < q, nodes}], the nodes those
 * leaves that overlap a leaf of the other part. spheres: x, y, z, r of every node. firstOnly: one pair of leaves suffices,
 * and nodes has no more.
 */
export function overlappingPairs(scene, spheres, firstOnly = false) {
  const heads = scene.levelSets[Math.min(1, scene.levelCount - 1)];
  const pairs = [];
  for (let i = 0; i < heads.length; ++i) {
    for (let j = i + 1; j < heads.length; ++j) {
      const [a, b] = [heads[i], heads[j]];
      const parts = [scene.partOf[a], scene.partOf[b]].sort((x, y) => x - y);
      if (scene.joints.ignored.has(parts.join(' ')) || !touch(spheres, a, b)) continue;
      const nodes = overlappingLeaves(scene, spheres, a, b, firstOnly);
      if (nodes.size > 0) pairs.push({ parts, nodes });
    }
  }
  return pairs;
}

function overlappingLeaves(scene, spheres, a, b, firstOnly) {
  const nodes = new Set();
  const [beginA, beginB] = [scene.firstChild[a], scene.firstChild[b]];
  const others = [];
  for (let k = 0; k < scene.entry.child_count[b]; ++k) if (touch(spheres, a, beginB + k)) others.push(beginB + k);
  for (let k = 0; others.length > 0 && k < scene.entry.child_count[a]; ++k) {
    for (const other of others) {
      if (!touch(spheres, beginA + k, other)) continue;
      nodes.add(beginA + k).add(other);
      if (firstOnly) return nodes;
    }
  }
  return nodes;
}

/** Numbers of [0, 1), the same for the same seed (a counter, its bits mixed). */
export function randomNumbers(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x9e3779b9) >>> 0;
    let z = state;
    z = Math.imul(z ^ (z >>> 16), 0x85ebca6b);
    z = Math.imul(z ^ (z >>> 13), 0xc2b2ae35);
    return ((z ^ (z >>> 16)) >>> 0) / 2 ** 32;
  };
}
/** A value within its limits for every joint that the reader moves. */
export const randomValues = (joints, random) =>
  joints.own.map((_, k) => {
    const [lower, upper] = joints.limits(k);
    return lower + random() * (upper - lower);
  });

/** Counts over random configurations, a few at a time. */
export class Rates {
  constructor(scene, wanted, seed = 1) {
    Object.assign(this, { scene, wanted, done: 0, colliding: 0, byPair: new Map() });
    this.random = randomNumbers(seed);
    this.spheres = scene.frames[0].slice();
  }
  get share() {
    return this.done > 0 ? this.colliding / this.done : null;
  }
  /** Tests configurations until `milliseconds` have passed or all are done; at least one. */
  run(milliseconds) {
    const end = performance.now() + milliseconds;
    while (this.done < this.wanted) {
      this.scene.spheresAt(randomValues(this.scene.joints, this.random), this.spheres);
      const pairs = overlappingPairs(this.scene, this.spheres, true);
      if (pairs.length > 0) ++this.colliding;
      for (const { parts } of pairs) {
        const key = parts.join(' ');
        this.byPair.set(key, (this.byPair.get(key) ?? 0) + 1);
      }
      ++this.done;
      if (performance.now() >= end) break;
    }
    return this.done === this.wanted;
  }
}
