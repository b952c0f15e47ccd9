// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A second body that touches the first: a rigid tool, or a soft body. Contacts and crossings of both, and vertices pushed out of each other.
import { boxOf } from './deform.js';
import { SoftBody } from './soft.js';

const identity = [1, 0, 0, 0, 1, 0, 0, 0, 1];
const mostInside = 600; // vertices looked at in a frame

/** Vertices of `x` inside `body`, and how far along the normal of the contacts (times sign) they leave it: [v, x, y, z] each. */
function waysOut(morula, x, body, box, contacts, sign, size, offset = [0, 0, 0]) {
  const candidates = [];
  const points = [];
  for (let i = 0; i < x.length && candidates.length < mostInside; i += 3) {
    if ([0, 1, 2].some((k) => x[i + k] < box.low[k] + offset[k] || x[i + k] > box.high[k] + offset[k])) continue;
    candidates.push(i / 3);
    points.push(x[i], x[i + 1], x[i + 2]);
  }
  if (candidates.length === 0) return [];
  const inside = morula.locate(body, points).flatMap((place, i) => (place.inside ? [i] : []));
  if (inside.length === 0) return [];
  // The deeper and nearer a contact, the more its normal counts: a single one may turn within a frame.
  const directions = inside.map((i) => {
    const sum = [0, 0, 0];
    for (const { point, normal, depth } of contacts) {
      const apart = [0, 1, 2].reduce((all, k) => all + (point[k] - points[3 * i + k]) ** 2, 0) / (size * size);
      const weight = Math.max(depth, 0) / (0.002 + apart) ** 2;
      for (let k = 0; k < 3; ++k) sum[k] += weight * normal[k];
    }
    const length = Math.hypot(...sum);
    return length > 0 ? sum.map((n) => (sign * n) / length) : contacts[0].normal.map((n) => sign * n);
  });
  const rays = inside.flatMap((i, at) => [points[3 * i], points[3 * i + 1], points[3 * i + 2], ...directions[at]]);
  return morula.firstHits(body, rays, size).flatMap((hit, at) => {
    if (!hit) return [];
    return [[candidates[inside[at]], ...directions[at].map((n) => n * hit.t)]];
  });
}

export class Other {
  /** model: its mesh and tree; turned: its vertices as it stands, soft or not. */
  constructor(model, isSoft, turned) {
    this.model = model;
    this.isSoft = isSoft && model.clusters !== null;
    this.turned = turned ?? model.rest;
    this.box = boxOf(this.turned);
    this.goal = Float64Array.from(this.turned);
    this.soft = this.isSoft ? new SoftBody(this.turned, model.clusters) : null;
    this.place = [0, 0, 0];
    this.body = model.body('exact');
    this.spheres = model.restSpheres.slice();
  }

  moveTo(place) {
    this.place = [...place];
    if (this.isSoft) {
      const { turned } = this;
      for (let i = 0; i < turned.length; ++i) this.goal[i] = turned[i] + place[i % 3];
      this.soft.setGoal(this.goal);
    } else {
      this.body.setTransform(identity, place);
    }
  }

  /** Writes its vertices and spheres, in the axes of the picture. */
  writeTo(shown) {
    const positions = shown.motion.frames[0];
    const { rest, restSpheres } = this.model;
    if (this.isSoft) {
      positions.set(this.soft.x);
      this.model.update('exact', positions, null, shown.frames[0]);
      return;
    }
    for (let i = 0; i < rest.length; ++i) positions[i] = rest[i] + this.place[i % 3];
    const spheres = shown.frames[0];
    for (let i = 0; i < spheres.length; ++i) spheres[i] = restSpheres[i] + (i % 4 < 3 ? this.place[i % 4] : 0);
  }
}

export class Touch {
  constructor(morula, size) {
    this.morula = morula;
    this.size = size;
    this.query = new morula.ContactQuery();
    this.clear();
  }
  clear() {
    this.contacts = [];
    this.crossings = new Uint32Array(0);
    this.finished = true;
  }

  /** Queries body and other where they are, and pushes soft ones apart. soft: of the body, or null. */
  run(body, soft, other) {
    const { morula, size } = this;
    this.contacts = this.query.run(body, other.body, { budgetMs: 3 });
    this.finished = this.query.finished;
    this.crossings = this.contacts.length > 0 ? morula.crossings(body, other.body) : new Uint32Array(0);
    if (this.crossings.length === 0 || !soft) return;
    const share = other.isSoft ? 0.5 : 1;
    const boxOther = other.isSoft ? boxOf(other.soft.x) : other.box;
    const offset = other.isSoft ? [0, 0, 0] : other.place;
    const forBody = waysOut(morula, soft.x, other.body, boxOther, this.contacts, 1, size, offset);
    const forOther = other.isSoft ? waysOut(morula, other.soft.x, body, boxOf(soft.x), this.contacts, -1, size) : [];
    for (const [v, ...way] of forBody) soft.push(v, ...way.map((w) => share * w));
    for (const [v, ...way] of forOther) other.soft.push(v, ...way.map((w) => share * w));
  }

  /** Tests of pairs of spheres that the query of contacts takes: the smallest budget with which it ends complete. */
  countTests(body, other) {
    const ends = (pairTests) => {
      this.query.run(body, other.body, { pairTests });
      return this.query.finished;
    };
    let most = 1;
    while (most < 2 ** 24 && !ends(most)) most *= 2;
    let least = most >> 1;
    while (most - least > 1) {
      const middle = (least + most) >> 1;
      if (ends(middle)) most = middle;
      else least = middle;
    }
    return most;
  }

  /** Facets of the body that meet the other, as triangles of points. */
  crossingTriangles(positions, facets) {
    const met = new Set();
    for (let i = 0; i < this.crossings.length; i += 2) met.add(this.crossings[i]);
    return [...met].map((facet) => [0, 1, 2].map((k) => [0, 1, 2].map((axis) => positions[3 * facets[3 * facet + k] + axis])));
  }

  /** The deepest contacts at least `apart` from each other: seven numbers each, as contacts.js of viewer/ draws them. */
  drawn(apart) {
    const shown = [];
    for (const contact of [...this.contacts].sort((a, b) => b.depth - a.depth)) {
      if (shown.length === 24) break;
      if (shown.every(({ point }) => Math.hypot(...point.map((x, k) => x - contact.point[k])) > apart)) shown.push(contact);
    }
    return Float32Array.from(shown.flatMap(({ point, normal, depth }) => [...point, ...normal, depth]));
  }

  free() {
    this.query.free();
  }
}
