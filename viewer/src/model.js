// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The model of the view: the scenes of the page, decoded on first use, and the reader's choices.
import { PageError, decodeMotion, decodeScene, readBytes } from './decode.js';
import { Joints, inverse, placed, product } from './joints.js';
import { overlappingPairs } from './pairs.js';
import { sphereAround } from './refit.js';

/** The motion's vertices and the spheres that follow them. Lengths are about `origin`. */
class Scene {
  constructor(entry, motionEntry, motion, spheres) {
    Object.assign(this, { entry, motionEntry, motion, ...spheres });
    this.origin = motionEntry.origin;
    this.step = motionEntry.step;
    this.frameCount = motionEntry.frames.length;
    this.arrange();
    this.ranges = new Map();
    this.pointsOf = { frame: -1, positions: new Float32Array(motion.frames[0].length) };
    this.joints = null;
    if (motionEntry.joints) this.prepareJoints(motionEntry.joints);
  }

  /** Parents, levels and branches of the nodes, from the numbers of children. */
  arrange() {
    const { entry } = this;
    this.nodeCount = entry.child_count.length;
    this.levelCount = entry.level_begin.length - 1;
    this.parent = new Int32Array(this.nodeCount).fill(-1);
    this.firstChild = new Int32Array(this.nodeCount).fill(-1);
    for (let node = 0, next = 1; node < this.nodeCount; ++node) {
      if (entry.child_count[node] > 0) this.firstChild[node] = next;
      for (let k = 0; k < entry.child_count[node]; ++k) this.parent[next++] = node;
    }
    this.levelOf = new Uint8Array(this.nodeCount);
    this.branchOf = new Int32Array(this.nodeCount);
    for (let node = 1; node < this.nodeCount; ++node) {
      this.levelOf[node] = this.levelOf[this.parent[node]] + 1;
      this.branchOf[node] = this.levelOf[node] === 1 ? node - 1 : this.branchOf[this.parent[node]];
    }
    this.levelSets = Array.from({ length: this.levelCount }, (_, level) =>
      Int32Array.from(
        [...Array(this.nodeCount).keys()].filter(
          (node) => this.levelOf[node] === level || (this.levelOf[node] < level && entry.child_count[node] === 0),
        ),
      ),
    );
  }

  /** A body of parts: `frames[0]` becomes what pose() fills, from the spheres as they were. */
  prepareJoints(entry) {
    this.joints = new Joints(entry);
    const parts = this.joints.parts;
    this.assignParts();
    if (parts.length === 0 || this.frameCount !== 1 || this.partOf.subarray(1).some((part) => !(part >= 0 && part < parts.length))) {
      throw new PageError('spheres of a part that is not there');
    }
    this.values = this.joints.rest;
    this.atRest = this.frames[0].slice();
    this.moves = this.joints.moves(this.values);
    this.overlapping = overlappingPairs(this, this.frames[0]);
  }
  assignParts() {
    this.partOf = new Int32Array(this.nodeCount).fill(-1);
    for (let node = 1; node < this.nodeCount; ++node) this.partOf[node] = this.entry.parts[this.branchOf[node]] ?? -1;
  }
  /** The spheres that a file has: without those around a part's or the robot's for a body of parts. */
  get sphereCount() {
    return this.joints ? this.levelSets[this.levelCount - 1].length : this.nodeCount;
  }
  /** values: one per joint that the reader moves. */
  pose(values) {
    this.values = values;
    this.moves = this.joints.moves(values);
    this.spheresAt(values, this.frames[0], this.moves);
    this.pointsOf.frame = -1;
    this.overlapping = overlappingPairs(this, this.frames[0]);
  }
  /** Writes all spheres in the pose of these values into `spheres`. */
  spheresAt(values, spheres, moves = this.joints.moves(values)) {
    const { atRest, origin } = this;
    for (let node = 1; node < this.nodeCount; ++node) {
      const at = 4 * node;
      const move = moves[this.partOf[node]];
      const [x, y, z] = [atRest[at] + origin[0], atRest[at + 1] + origin[1], atRest[at + 2] + origin[2]];
      for (let k = 0; k < 3; ++k) spheres[at + k] = move[4 * k] * x + move[4 * k + 1] * y + move[4 * k + 2] * z + move[4 * k + 3] - origin[k];
      spheres[at + 3] = atRest[at + 3];
    }
    // The root is around its children wherever they are.
    const children = this.levelSets[Math.min(1, this.levelCount - 1)];
    const ends = (k, sign) => children.reduce((most, node) => Math.max(most, sign * spheres[4 * node + k] + spheres[4 * node + 3]), -Infinity);
    for (let k = 0; k < 3; ++k) spheres[k] = 0.5 * (ends(k, 1) - ends(k, -1));
    spheres[3] = children.reduce((most, node) => Math.max(most,
      Math.hypot(...[0, 1, 2].map((k) => spheres[4 * node + k] - spheres[k])) + spheres[4 * node + 3]), 0);
  }
  /** Pairs of parts whose spheres overlap in this pose although they must not: [[name, name], …]. */
  meeting() {
    return this.overlapping.map(({ parts }) => parts.map((part) => this.joints.parts[part].name));
  }
  /** Whether a node, or a leaf below it, overlaps a sphere of another part although it must not. */
  get collidingNodes() {
    return new Set(this.overlapping.flatMap(({ nodes }) => [...nodes].flatMap((node) => [node, this.parent[node]])));
  }
  /** Leaves of a part, in the order of the part's spheres. */
  leavesOf(part) {
    const head = [...this.levelSets[Math.min(1, this.levelCount - 1)]].find((node) => this.partOf[node] === part);
    return head === undefined ? [] : Array.from({ length: this.entry.child_count[head] }, (_, k) => this.firstChild[head] + k);
  }
  /** Other spheres: lists[part] has those of a part in its own axes. The same parts have some. */
  refill(lists) {
    const parts = this.entry.parts;
    const counts = parts.map((part) => lists[part].length);
    const nodes = 1 + parts.length + counts.reduce((sum, count) => sum + count, 0);
    const leaves = Array(nodes - 1 - parts.length).fill(0);
    this.entry = { ...this.entry, child_count: [parts.length, ...counts, ...leaves], level_begin: [0, 1, 1 + parts.length, nodes] };
    this.atRest = new Float32Array(4 * nodes);
    const poses = this.joints.poses(this.joints.rest);
    let leaf = 1 + parts.length;
    parts.forEach((part, head) => {
      const placedAtRest = lists[part].map(([x, y, z, r]) => [...placed(poses[part], [x, y, z]).map((at, k) => at - this.origin[k]), r]);
      for (const sphere of placedAtRest) this.atRest.set(sphere, 4 * leaf++);
      const around = sphereAround(placedAtRest);
      // Slightly larger, for its rounding to float.
      this.atRest.set([...around.slice(0, 3), around[3] * (1 + 1e-6)], 4 * (1 + head));
    });
    this.frames[0] = this.atRest.slice();
    this.rest = this.atRest;
    this.emptyShare = null;
    this.arrange();
    this.ranges.clear();
    this.assignParts();
    this.pose(this.values);
  }
  /** Facets of a part in its own axes, [[a, b, c], …] with points. */
  facetsOf(part) {
    const { frames: [places], facets } = this.motion;
    const [begin, end] = this.joints.parts[part].vertices;
    const toPart = inverse(this.joints.poses(this.joints.rest)[part]);
    const point = (vertex) => placed(toPart, [0, 1, 2].map((k) => places[3 * vertex + k] * this.step[k] + this.origin[k]));
    const points = Array.from({ length: end - begin }, (_, i) => point(begin + i));
    const triangles = [];
    for (let i = 0; i < facets.length; i += 3) {
      if (facets[i] >= begin && facets[i] < end) triangles.push([0, 1, 2].map((k) => points[facets[i + k] - begin]));
    }
    return triangles;
  }
  /** Rows of the part's pose in the axes of the picture. */
  poseOf(part) {
    return product([1, 0, 0, -this.origin[0], 0, 1, 0, -this.origin[1], 0, 0, 1, -this.origin[2]], this.joints.poses(this.values)[part]);
  }

  /** x, y, z of every vertex of a frame. The array is reused by the next call. */
  positions(frame) {
    const { positions } = this.pointsOf;
    if (this.pointsOf.frame !== frame) {
      const places = this.motion.frames[frame];
      const [x, y, z] = this.step;
      for (let i = 0; i < positions.length; i += 3) {
        positions[i] = places[i] * x;
        positions[i + 1] = places[i + 1] * y;
        positions[i + 2] = places[i + 2] * z;
      }
      if (this.joints) this.placeParts(positions);
      this.pointsOf.frame = frame;
    }
    return positions;
  }
  placeParts(positions) {
    const { origin } = this;
    this.joints.parts.forEach(({ vertices: [begin, end] }, part) => {
      const move = this.moves[part];
      for (let i = 3 * begin; i < 3 * end; i += 3) {
        const at = placed(move, [positions[i] + origin[0], positions[i + 1] + origin[1], positions[i + 2] + origin[2]]);
        for (let k = 0; k < 3; ++k) positions[i + k] = at[k] - origin[k];
      }
    });
  }
  /** {low, high} of the vertices in the current pose. */
  bounds() {
    const positions = this.positions(0);
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < positions.length; ++i) {
      if (positions[i] < low[i % 3]) low[i % 3] = positions[i];
      if (positions[i] > high[i % 3]) high[i % 3] = positions[i];
    }
    return { low, high };
  }
  /** Diagonal of a rounding step: twice the largest displacement of a vertex by rounding. */
  get tolerance() {
    return Math.hypot(...this.step);
  }
  growth(frame, node) {
    const rest = this.rest[4 * node + 3];
    return rest > 0 ? this.frames[frame][4 * node + 3] / rest : 1;
  }
  empty(frame, node) {
    return this.emptyShare ? this.emptyShare[frame][node] / 65535 : null;
  }
  /** [least, most] of a quantity over the nodes of a level set in all frames. */
  range(quantity, level) {
    const key = `${quantity} ${level}`;
    if (!this.ranges.has(key)) {
      let least = Infinity;
      let most = -Infinity;
      for (let frame = 0; frame < this.frameCount; ++frame) {
        for (const node of this.levelSets[level]) {
          const value = this[quantity](frame, node);
          least = Math.min(least, value);
          most = Math.max(most, value);
        }
      }
      this.ranges.set(key, [least, most]);
    }
    return this.ranges.get(key);
  }
  /** Per frame the largest growth in a level set. */
  largestGrowth(level) {
    return this.motionEntry.frames.map((_, frame) =>
      this.levelSets[level].reduce((most, node) => Math.max(most, this.growth(frame, node)), 0),
    );
  }
  measured(figure, level, frame) {
    const all = this.entry.measured;
    return all ? all[figure][level][frame] : null;
  }
}

export class SceneList {
  constructor(manifest, text) {
    this.manifest = manifest;
    this.text = text;
    this.motions = new Map();
    this.scenes = new Map();
  }
  motionEntry(index) {
    return this.manifest.motions[this.manifest.scenes[index].motion];
  }
  scene(index) {
    if (!this.scenes.has(index)) {
      const entry = this.manifest.scenes[index];
      const motionEntry = this.manifest.motions[entry.motion];
      if (!motionEntry) throw new PageError(`scene ${index} has no motion`);
      if (!this.motions.has(entry.motion)) {
        this.motions.set(entry.motion, decodeMotion(readBytes(this.text, motionEntry.data), motionEntry));
      }
      const spheres = decodeScene(readBytes(this.text, entry.data), entry, motionEntry.frames.length);
      this.scenes.set(index, new Scene(entry, motionEntry, this.motions.get(entry.motion), spheres));
    }
    return this.scenes.get(index);
  }
  /** The keys in which scenes differ: [{key, label, values}]; keys with one value are left out. */
  choices() {
    const of = (index) => this.describe(index);
    const count = this.manifest.scenes.length;
    return [
      ['body', 'Body'], ['motion', 'Motion'], ['tree', 'Tree'], ['rule', 'Rule'],
    ].map(([key, label]) => ({
      key,
      label,
      values: [...new Set([...Array(count).keys()].map((index) => of(index)[key]))],
    })).filter((choice) => choice.values.length > 1);
  }
  describe(index) {
    const entry = this.manifest.scenes[index];
    const motion = this.motionEntry(index);
    return { body: motion.body, motion: motion.name, tree: entry.tree, rule: entry.rule };
  }
  /** The scene with the required values that is otherwise most like the given one; -1 when no scene has them. */
  nearest(wanted, index) {
    const now = this.describe(index);
    let best = -1;
    let likeness = -1;
    for (let other = 0; other < this.manifest.scenes.length; ++other) {
      const its = this.describe(other);
      if (Object.keys(wanted).some((key) => its[key] !== wanted[key])) continue;
      const alike = Object.keys(now).filter((key) => its[key] === now[key]).length;
      if (alike > likeness) [best, likeness] = [other, alike];
    }
    return best;
  }
}
