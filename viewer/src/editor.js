// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Editing a robot's spheres: fields, buttons, the cover of the link that the reader works on, and what to save.
import { area, bareBalls, bareSurface } from './bare.js';
import { byId, element } from './dom.js';
import { Edits } from './edits.js';
import { figure, percent } from './numbers.js';
import { inverse, placed } from './joints.js';
import { refit, sphereAround } from './refit.js';
import { offer } from './save.js';

const axes = ['x', 'y', 'z', 'r'];
const pause = 40; // milliseconds from a change to the estimate of its cover
const slice = 12; // milliseconds of that estimate between two pictures
const soon = 100; // slices of its search that Add waits for
const sizeOf = (triangles) => {
  const points = triangles.flat();
  return Math.hypot(...[0, 1, 2].map((k) => points.reduce((most, p) => Math.max(most, p[k]), -Infinity) - points.reduce((least, p) => Math.min(least, p[k]), Infinity)));
};
const areaOf = (triangles) => triangles.reduce((sum, triangle) => sum + area(triangle), 0);
const largest = (triangles) => triangles.reduce((a, b) => (area(b) > area(a) ? b : a));

export class Editor {
  /** onbare(triangles, part): called with the uncovered surface of the link, none for part -1. */
  constructor(state, robot, onbare) {
    Object.assign(this, { state, robot, onbare, scene: null, edits: null, waiting: 0, fitting: 0, facets: new Map(), cover: null, drawn: null });
    byId('edit-fields').replaceChildren(...axes.map((axis, k) => {
      const input = element('input', { type: 'number', step: 'any', id: `edit-${axis}`, onchange: () => this.edits.seal(), oninput: () => this.typed(k, input.valueAsNumber) });
      return element('label', {}, element('span', {}, axis === 'r' ? 'radius' : axis), input);
    }));
    const actions = { add: () => this.add(), copy: () => this.copy(), remove: () => this.remove(), undo: () => this.undo(), redo: () => this.redo(), refit: () => this.refit(), save: () => this.save() };
    this.keys = { a: actions.add, d: actions.copy, r: actions.refit, Delete: actions.remove, Backspace: actions.remove };
    for (const [name, act] of Object.entries(actions)) byId(`edit-${name}`).addEventListener('click', act);
    addEventListener('beforeunload', (event) => this.edits?.changed && !this.saved && event.preventDefault());
  }

  show(scene) {
    this.scene = scene;
    const can = scene.joints !== null && !scene.entry.inside && scene.entry.parts.every((part) => scene.joints.parts[part].spheres?.length > 0);
    byId('edit-section').hidden = !can;
    this.active = can;
    if (can && this.edits === null) {
      this.edits = new Edits(scene.joints.parts.map((part) => ({ ...part, spheres: part.spheres ?? [] })));
      byId('edit-command').textContent = scene.motionEntry.joints.command ?? '';
    }
    this.follow();
  }

  /** The picked link, and the index of the picked sphere among its own: -1 where the link as a whole is picked. */
  get picked() {
    const node = this.state.get('picked');
    if (!this.active || node < 1) return { part: -1, index: -1 };
    const part = this.scene.partOf[node];
    return { part, index: this.scene.leavesOf(part).indexOf(node) };
  }
  pick(part, index) {
    const leaves = this.scene.leavesOf(part);
    return leaves[Math.min(index, leaves.length - 1)] ?? -1;
  }
  /** Shows the lists as they are; index: the sphere to pick. */
  apply(part, index = -1) {
    this.saved = false;
    this.scene.refill(this.edits.spheres);
    const { picked, level } = this.state.values;
    const kept = index >= 0 ? this.pick(part, index) : this.pick(part, 0);
    this.state.set({ edits: this.state.get('edits') + 1, picked: kept < 0 ? picked : kept, level: Math.max(level, this.scene.levelCount - 1) });
  }

  typed(k, value) {
    const { part, index } = this.picked;
    if (index < 0) return;
    const sphere = this.edits.spheres[part][index].slice();
    sphere[k] = value;
    const input = byId(`edit-${axes[k]}`);
    const taken = this.edits.set(part, index, sphere, `type ${part} ${index} ${k}`);
    input.setAttribute('aria-invalid', String(!taken));
    if (taken) this.apply(part, index);
  }
  add() {
    const { part, index } = this.picked;
    if (part < 0) return;
    const list = this.edits.spheres[part];
    // In the largest uncovered triangle, on links of many facets of those found soon; else at the picked sphere.
    for (let k = 0; k < soon && !this.cover.found; ++k) this.search();
    const bare = (this.cover.found ?? this.cover.soFar).triangles;
    const base = list[Math.max(index, 0)];
    const at = bare.length > 0 ? sphereAround(largest(bare)).slice(0, 3) : base.slice(0, 3);
    if (this.edits.add(part, [...at, 0.5 * base[3]])) this.apply(part, list.length);
  }
  copy() {
    const { part, index } = this.picked;
    if (index < 0) return;
    const list = this.edits.spheres[part];
    const [x, y, z, r] = list[index];
    if (this.edits.add(part, [x + 0.5 * r, y, z, r])) this.apply(part, list.length);
  }
  remove() {
    const { part, index } = this.picked;
    if (index >= 0 && this.edits.remove(part, index)) this.apply(part, Math.max(0, index - 1));
  }
  undo() {
    this.back(this.edits.undo());
  }
  redo() {
    this.back(this.edits.redo());
  }
  back(part) {
    if (part >= 0) this.apply(part, Math.max(0, this.picked.part === part ? this.picked.index : 0));
  }

  /** Fits the link again, a round between two pictures. */
  async refit() {
    const { part } = this.picked;
    if (part < 0 || this.fitting) return;
    const { edits } = this;
    const list = edits.spheres[part];
    const keep = byId('edit-keep').checked ? edits.pinned[part] : list.map(() => false);
    const run = (this.fitting = {});
    byId('edit-refit').disabled = true;
    const rounds = refit(this.facetsOf(part), this.scene.joints.parts[part].balls ?? [], list, keep, this.margin(part));
    let step = rounds.next();
    for (; !step.done && edits.spheres[part] === list; step = rounds.next()) await new Promise((done) => setTimeout(done, 0));
    this.fitting = 0;
    byId('edit-refit').disabled = false;
    // The reader went on editing meanwhile, and that counts.
    if (!step.done || edits.spheres[part] !== list) return;
    if (step.value === null) {
      byId('edit-cover').textContent = 'Nothing to fit: no sphere of this link is free, or the kept ones cover it.';
      return;
    }
    if (edits.change(part, step.value, keep.slice())) this.apply(part);
  }
  /** Vertices are off by half the diagonal of a rounding step; files are read as floats. */
  margin(part) {
    const reach = [...this.facetsOf(part), this.edits.spheres[part]].flat(2).reduce((most, x) => Math.max(most, Math.abs(x)), 0);
    return 0.51 * this.scene.tolerance + 2e-6 * reach;
  }
  facetsOf(part) {
    if (!this.facets.has(part)) this.facets.set(part, this.scene.facetsOf(part));
    return this.facets.get(part);
  }

  /** A sphere of the picture's axes that the reader drags, or null. */
  grabbed() {
    const { index } = this.picked;
    const node = this.state.get('picked');
    return index >= 0 && byId('edit-drag').checked ? [...this.scene.frames[0].subarray(4 * node, 4 * node + 4)] : null;
  }
  dragged([x, y, z, r]) {
    const { part, index } = this.picked;
    if (index < 0) return;
    const center = placed(inverse(this.scene.poseOf(part)), [x, y, z]);
    if (this.edits.set(part, index, [...center, r].map((value) => Number(value.toPrecision(8))), `drag ${part} ${index}`)) this.apply(part, index);
  }

  save() {
    offer(new Blob([this.edits.json(this.robot)], { type: 'application/json' }), 'spheres.json');
    this.saved = true;
    byId('edit-command-row').hidden = false;
  }

  /** Updates fields and buttons for the picked node, and starts the estimate of its link's cover. */
  follow() {
    if (!this.active) {
      this.onbare([], -1);
      return;
    }
    const { part, index } = this.picked;
    const sphere = index >= 0 ? this.edits.spheres[part][index] : null;
    axes.forEach((axis, k) => {
      const input = byId(`edit-${axis}`);
      input.disabled = sphere === null;
      if (sphere === null || input !== document.activeElement || input.valueAsNumber !== sphere[k]) input.value = sphere === null ? '' : String(sphere[k]);
      input.removeAttribute('aria-invalid');
    });
    byId('edit-link').textContent = part < 0 ? '' : this.edits.names[part];
    byId('edit-hint').hidden = part >= 0;
    byId('edit-work').hidden = part < 0;
    for (const [name, on] of [['copy', sphere], ['remove', sphere && this.edits.spheres[part].length > 1], ['undo', this.edits.past.length], ['redo', this.edits.future.length]]) {
      byId(`edit-${name}`).disabled = !on;
    }
    this.judge(part);
  }

  /** Starts the estimate of the link's cover, unless it is of the same spheres; one of other spheres ends. */
  judge(part) {
    const list = part < 0 ? null : this.edits.spheres[part];
    if ((this.cover?.list ?? null) !== list) {
      clearTimeout(this.waiting);
      this.cover = list && { part, list, rounds: null, soFar: null, found: null };
      if (list) this.waiting = setTimeout(() => this.judgeOn(), pause);
    }
    this.tell();
  }
  judgeOn() {
    const { cover } = this;
    const end = performance.now() + slice;
    while (!cover.found && performance.now() < end) this.search();
    if (cover.found) this.tell();
    else this.waiting = setTimeout(() => this.judgeOn(), 0);
  }
  /** Some more triangles of the estimate. */
  search() {
    const { cover } = this;
    const { part, list } = cover;
    const facets = this.facetsOf(part);
    cover.rounds ??= bareSurface(facets, list, this.scene.tolerance, sizeOf(facets) / 150);
    const { done, value } = cover.rounds.next();
    cover.soFar = value;
    if (!done) return;
    cover.balls = bareBalls(this.scene.joints.parts[part].balls ?? [], list, this.scene.tolerance);
    cover.share = value.area / (areaOf(facets) || 1);
    cover.found = value;
  }
  /** Says and draws the estimate. While it runs, uncovered facets of the same link's last one remain. */
  tell() {
    const { cover } = this;
    const place = byId('edit-cover');
    if (!cover) {
      this.drawn = null;
      this.onbare([], -1);
      return;
    }
    const { part, found, balls, share } = cover;
    if (found) this.drawn = { part, triangles: found.triangles };
    this.onbare(this.drawn?.part === part ? this.drawn.triangles : [], part);
    if (!found) {
      delete place.dataset.bare;
      place.textContent = 'Estimating the cover…';
      return;
    }
    const isBare = found.triangles.length > 0 || balls.length > 0;
    place.dataset.bare = String(isBare);
    place.textContent = !isBare ? 'Covered (estimate); the command proves it'
      : found.triangles.length > 0 ? `Uncovered (estimate): ${percent(share)} of the surface, up to ${figure(found.deepest)} deep`
        : 'Uncovered (estimate): a ball of the link lies in no single sphere';
  }
}
