// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A soft body by shape matching [muller2005]: every cluster of vertices tends to its shape, turned and moved as it lies, and the
// whole gently to its goal. Tests run it alone.

const damping = 0.985; // of velocities, per step
const stiffness = 0.5; // share of the way to the shapes of the clusters, per step
const homing = 0.035; // the same to the goal

/** Turns the unit quaternion q = [x, y, z, w] toward the rotation nearest to the matrix a, by rows. */
function turnToward(q, a, rounds) {
  for (let round = 0; round < rounds; ++round) {
    const [x, y, z, w] = q;
    // Columns of the rotation.
    const r = [
      1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),
      2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
      2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y),
    ];
    const turn = [0, 0, 0];
    let fit = 1e-30;
    for (let c = 0; c < 3; ++c) {
      const [rx, ry, rz] = [r[3 * c], r[3 * c + 1], r[3 * c + 2]];
      const [ax, ay, az] = [a[c], a[3 + c], a[6 + c]];
      turn[0] += ry * az - rz * ay;
      turn[1] += rz * ax - rx * az;
      turn[2] += rx * ay - ry * ax;
      fit += rx * ax + ry * ay + rz * az;
    }
    const scale = 1 / Math.max(Math.abs(fit), 1e-30);
    const angle = scale * Math.hypot(...turn);
    if (angle < 1e-9) return;
    const share = (scale * Math.sin(0.5 * Math.min(angle, 1))) / angle;
    const [tx, ty, tz] = turn.map((t) => t * share);
    const tw = Math.cos(0.5 * Math.min(angle, 1));
    const to = [tw * x + tx * w + ty * z - tz * y, tw * y - tx * z + ty * w + tz * x, tw * z + tx * y - ty * x + tz * w, tw * w - tx * x - ty * y - tz * z];
    const length = Math.hypot(...to);
    for (let k = 0; k < 4; ++k) q[k] = to[k] / length;
  }
}

export class SoftBody {
  /** goal: x, y, z per vertex; clusters: lists of vertices. */
  constructor(goal, clusters) {
    this.x = Float64Array.from(goal);
    this.goal = Float64Array.from(goal);
    this.velocity = new Float64Array(goal.length);
    this.before = new Float64Array(goal.length);
    this.last = new Float64Array(goal.length);
    this.steps = 0;
    this.isResting = false;
    this.pushedAt = -Infinity;
    this.sum = new Float64Array(goal.length);
    this.share = new Float32Array(goal.length / 3);
    this.clusters = clusters.map((members) => ({ members, shape: new Float64Array(3 * members.length), rotation: [0, 0, 0, 1] }));
    for (const { members } of this.clusters) for (const v of members) ++this.share[v];
    this.held = null;
    this.asleep = true;
    this.takeShapes();
  }

  takeShapes() {
    for (const { members, shape } of this.clusters) {
      const center = this.centerOf(this.goal, members);
      members.forEach((v, i) => {
        for (let k = 0; k < 3; ++k) shape[3 * i + k] = this.goal[3 * v + k] - center[k];
      });
    }
    let [low, high] = [Infinity, -Infinity];
    for (const value of this.goal) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    this.size = high - low || 1;
  }

  centerOf(points, members) {
    let [x, y, z] = [0, 0, 0];
    for (const v of members) {
      x += points[3 * v];
      y += points[3 * v + 1];
      z += points[3 * v + 2];
    }
    return [x / members.length, y / members.length, z / members.length];
  }

  /** A new goal: the body moves along at once, and keeps what it deviates by. */
  setGoal(goal) {
    if (this.asleep) this.x.set(goal);
    else for (let i = 0; i < goal.length; ++i) this.x[i] += goal[i] - this.goal[i];
    this.goal.set(goal);
    this.stale = true;
    this.wake();
  }

  /** Holds the vertices around a point: they follow drag(), less with distance. */
  hold(point, radius) {
    const members = [];
    for (let v = 0; v < this.share.length; ++v) {
      const offset = [0, 1, 2].map((k) => this.x[3 * v + k] - point[k]);
      const near = 1 - (offset[0] ** 2 + offset[1] ** 2 + offset[2] ** 2) / (radius * radius);
      if (near > 0 && this.share[v] > 0) members.push({ v, offset, weight: near * near });
    }
    this.held = { members, to: [...point] };
    this.asleep = false;
    this.wake();
  }
  drag(point) {
    if (this.held) this.held.to = [...point];
    this.wake();
  }
  release() {
    this.held = null;
    this.wake();
  }

  /** Pushes the vertices around a point along a direction, as a finger would. */
  poke(point, radius, push) {
    for (let v = 0; v < this.share.length; ++v) {
      let squared = 0;
      for (let k = 0; k < 3; ++k) squared += (this.x[3 * v + k] - point[k]) ** 2;
      const near = 1 - squared / (radius * radius);
      if (near > 0) for (let k = 0; k < 3; ++k) this.velocity[3 * v + k] += near * near * push[k];
    }
    this.asleep = false;
    this.wake();
  }

  /** Moves a vertex out of another body. */
  push(v, x, y, z) {
    // The velocity takes part: without it the body would press in again in the next step.
    [x, y, z].forEach((way, k) => {
      this.x[3 * v + k] += way;
      this.velocity[3 * v + k] = 0.5 * (this.velocity[3 * v + k] + way);
    });
    this.asleep = false;
    this.wasPushed = true;
    this.pushedAt = this.steps;
  }

  match({ members, shape, rotation }) {
    const { x, sum } = this;
    const center = this.centerOf(x, members);
    const a = [0, 0, 0, 0, 0, 0, 0, 0, 0];
    for (let i = 0; i < members.length; ++i) {
      const v = 3 * members[i];
      const [px, py, pz] = [x[v] - center[0], x[v + 1] - center[1], x[v + 2] - center[2]];
      const [qx, qy, qz] = [shape[3 * i], shape[3 * i + 1], shape[3 * i + 2]];
      a[0] += px * qx; a[1] += px * qy; a[2] += px * qz;
      a[3] += py * qx; a[4] += py * qy; a[5] += py * qz;
      a[6] += pz * qx; a[7] += pz * qy; a[8] += pz * qz;
    }
    turnToward(rotation, a, 3);
    const [qx, qy, qz, qw] = rotation;
    const [r0, r1, r2] = [1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz), 2 * (qx * qz + qw * qy)];
    const [r3, r4, r5] = [2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qw * qx)];
    const [r6, r7, r8] = [2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy)];
    for (let i = 0; i < members.length; ++i) {
      const v = 3 * members[i];
      const [sx, sy, sz] = [shape[3 * i], shape[3 * i + 1], shape[3 * i + 2]];
      sum[v] += center[0] + r0 * sx + r1 * sy + r2 * sz;
      sum[v + 1] += center[1] + r3 * sx + r4 * sy + r5 * sz;
      sum[v + 2] += center[2] + r6 * sx + r7 * sy + r8 * sz;
    }
  }

  /** One step of a sixtieth of a second. Returns whether the body may have moved. */
  step() {
    if (this.asleep && !this.held) return false;
    const { x, velocity, before, sum, share, goal } = this;
    if (this.stale) this.takeShapes();
    this.stale = false;
    before.set(x);
    for (let i = 0; i < x.length; ++i) x[i] += damping * velocity[i];
    for (const { v, offset, weight } of this.held?.members ?? []) {
      for (let k = 0; k < 3; ++k) x[3 * v + k] += weight * (this.held.to[k] + offset[k] - x[3 * v + k]);
    }
    sum.fill(0);
    for (const cluster of this.clusters) this.match(cluster);
    let off = 0;
    for (let v = 0; v < share.length; ++v) {
      for (let i = 3 * v; i < 3 * v + 3; ++i) {
        if (share[v] > 0) x[i] += stiffness * (sum[i] / share[v] - x[i]);
        x[i] += homing * (goal[i] - x[i]);
        velocity[i] = x[i] - before[i];
        off = Math.max(off, Math.abs(x[i] - goal[i]), Math.abs(velocity[i]));
      }
    }
    if (++this.steps % 30 === 0) this.compare();
    if (!(off < 100 * this.size)) this.settle();
    else if (!this.held && !this.wasPushed && off < 2e-4 * this.size) this.settle();
    this.wasPushed = false;
    return true;
  }

  /** Whether it has come to rest: at its goal, or where something holds it. */
  get isStill() {
    return (this.asleep && !this.held) || this.isResting;
  }
  /** Lets it move: what holds it has changed. */
  wake() {
    this.isResting = false;
    this.steps = 0;
    this.pushedAt = -Infinity;
  }
  /** Every half second: a body that something holds rests once it moves by less than can be seen. */
  compare() {
    let moved = 0;
    for (let i = 0; i < this.x.length; ++i) moved = Math.max(moved, Math.abs(this.x[i] - this.last[i]));
    this.last.set(this.x);
    const isHeld = this.held !== null || this.steps - this.pushedAt < 30;
    this.isResting = isHeld && moved < 1.5e-3 * this.size;
  }

  /** Puts the body at its goal, at rest. */
  settle() {
    this.x.set(this.goal);
    this.velocity.fill(0);
    for (const cluster of this.clusters) cluster.rotation = [0, 0, 0, 1];
    this.asleep = this.held === null;
  }
}
