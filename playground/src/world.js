// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The bodies of the page and the frames in which they move: goal, soft body, update of the spheres, contacts, picture.
import { kindColor, levelColors, rgb } from '../../viewer/src/colors.js';
import { boxOf, Deformer } from './deform.js';
import { Model, Shown } from './model.js';
import { SoftBody } from './soft.js';
import { Other, Touch } from './touch.js';

const levelTints = levelColors.map(rgb);
const otherTint = rgb('#8fa6d6');
const stepSeconds = 1 / 60;
const mostSteps = 2; // of a frame: a slow page runs slower, and does not stop

export class World {
  /** onframe(): after each frame. */
  constructor(state, stage, onframe) {
    Object.assign(this, { state, stage, onframe });
    this.morula = null;
    this.model = null;
    this.character = null;
    this.other = null;
    this.held = false;
    this.time = 0;
    this.frames = 0;
    this.milliseconds = 0;
  }

  /** A new body. made: of Builder.build(). */
  adopt(made, character) {
    this.dropOther();
    const before = this.model;
    this.model = new Model(this.morula, made, character);
    before?.free();
    Object.assign(this, { made, character });
    this.deformer = new Deformer(made.positions);
    this.size = this.deformer.size || 1;
    this.touch?.free();
    this.touch = new Touch(this.morula, this.size);
    this.goal = Float64Array.from(made.positions);
    this.soft = made.clusters && made.clusters.length > 0 ? new SoftBody(this.goal, made.clusters) : null;
    this.time = 0;
    this.isPosed = false;
    this.shown = new Shown(this.model, this.size);
    this.twin = new Shown(this.model, this.size);
    this.setGoal();
    this.shown.motion.frames[0].set(this.goal);
    this.stage.show(this.shown);
    this.stage.twin.body.show(this.twin);
    this.stage.twin.spheres.show(this.twin);
    this.ask();
  }

  /** made: of Builder.build() for the tool; the body's own for a second body. */
  touchWith(made, kind) {
    this.dropOther();
    const isSoft = kind === 'body';
    this.other = new Other(new Model(this.morula, made, null), isSoft, isSoft ? this.crosswise() : null);
    this.otherShown = new Shown(this.other.model, this.size);
    this.stage.other.body.show(this.otherShown);
    this.stage.other.spheres.show(this.otherShown);
    this.pressAxis = this.axisOfPress();
    const { low, high } = boxOf(this.made.positions);
    const mine = this.other.box;
    this.home = [0, 1, 2].map((k) => 0.5 * (low[k] + high[k] - mine.low[k] - mine.high[k]));
    this.home[this.pressAxis] = high[this.pressAxis] - mine.low[this.pressAxis] + 0.06 * this.size;
    this.approach(high[this.pressAxis] - low[this.pressAxis]);
    this.other.moveTo(this.placeOfOther());
    this.stage.showOther(true);
    this.ask();
  }
  /** Lowers the other body toward the body at rest until a small gap is left: by their distance, again and again, so that it never
   * meets it on the way. If nothing is below it, it stays. */
  approach(most) {
    const { morula, model, other, home, pressAxis } = this;
    const gap = 0.03 * this.size;
    const above = home[pressAxis];
    const atRest = new morula.Body(model.mesh, model.tree);
    for (let step = 0; step < 60; ++step) {
      other.moveTo(home);
      other.writeTo(this.otherShown);
      const way = morula.distance(atRest, other.body).lower - gap;
      home[pressAxis] -= Math.max(0, way);
      if (way < 0.1 * gap || above - home[pressAxis] > most) break;
    }
    atRest.free();
    if (above - home[pressAxis] > most) home[pressAxis] = above;
  }
  /** Across the body: the vertical, unless the body stands. */
  axisOfPress() {
    return this.deformer.along === 1 ? 0 : 1;
  }
  /** A quarter turn of the second body about the axis along which it presses. */
  crosswise() {
    const { along, center } = this.deformer;
    const axis = this.axisOfPress();
    const third = 3 - along - axis;
    const turned = Float64Array.from(this.made.positions);
    const { positions } = this.made;
    for (let i = 0; i < positions.length; i += 3) {
      turned[i + along] = center[along] - (positions[i + third] - center[third]);
      turned[i + third] = center[third] + (positions[i + along] - center[along]);
    }
    return turned;
  }
  dropOther() {
    this.other?.model.free();
    this.other = null;
    this.soft?.wake();
    this.touch?.clear();
    this.stage.showOther(false);
  }
  placeOfOther() {
    return this.state.get('place').map((x, k) => this.home[k] + x * this.size);
  }
  movedOther() {
    if (!this.other) return;
    this.other.moveTo(this.placeOfOther());
    this.soft?.wake();
    this.ask();
  }

  /** The goal of the body: by the sliders, or by the motion of the file. */
  setGoal() {
    const { state, character } = this;
    if (character) character.pose(this.time, this.goal);
    else {
      const swing = state.get('playing') ? Math.cos(2 * this.time) : 1;
      const [bend, twist, stretch] = ['bend', 'twist', 'stretch'].map((name) => state.get(name));
      const limit = this.deformer.bendLimit(stretch);
      this.deformer.apply({ bend: swing * Math.max(-limit, Math.min(limit, bend)), twist: swing * twist, stretch: 1 + (stretch - 1) * Math.abs(swing) }, this.goal);
    }
    this.soft?.setGoal(this.goal);
  }

  /** Asks for a frame; changed: whether the goal did. */
  ask(changed = true) {
    this.goalChanged ||= changed;
    if (this.asked || !this.model) return;
    this.asked = true;
    document.body.dataset.figures = 'pending';
    document.body.dataset.moving = 'true';
    requestAnimationFrame((now) => this.frame(now));
  }

  frame(now) {
    this.asked = false;
    if (!this.model) return;
    const begin = performance.now();
    const elapsed = Math.min(0.1, this.last ? (now - this.last) / 1000 : stepSeconds);
    const playing = this.state.get('playing');
    if (playing) this.time += elapsed;
    if (playing || this.goalChanged) this.setGoal();
    this.goalChanged = false;
    this.owed = Math.min((this.owed ?? 0) + elapsed, mostSteps * stepSeconds);
    for (; this.owed >= 0.9 * stepSeconds; this.owed -= stepSeconds) {
      this.soft?.step();
      this.other?.soft?.step();
    }
    this.pose();
    this.isPosed = true;
    this.milliseconds = performance.now() - begin;
    ++this.frames;
    const goesOn = playing || [this.soft, this.other?.soft].some((soft) => soft && !soft.isStill);
    this.last = goesOn ? now : 0;
    this.stage.ask();
    this.onframe();
    document.body.dataset.moving = String(goesOn);
    if (goesOn) this.ask(false);
  }

  /** Spheres of both bodies and their contacts at the present positions, and the picture of them. */
  pose() {
    const { state, model, stage } = this;
    const rule = state.get('rule');
    this.follow(rule, this.shown);
    if (this.other) {
      this.other.writeTo(this.otherShown);
      this.touch.run(model.body(rule), this.soft, this.other);
      if (this.soft?.wasPushed) this.follow(rule, this.shown);
      if (this.other.soft?.wasPushed) this.other.writeTo(this.otherShown);
    }
    if (state.get('beside')) this.follow('exact', this.twin);
    this.draw();
    stage.surround(this.box());
  }
  follow(rule, shown) {
    const positions = shown.motion.frames[0];
    positions.set(this.soft ? this.soft.x : this.goal);
    this.model.update(rule, positions, this.character?.transforms, shown.frames[0]);
  }
  box() {
    const box = boxOf(this.shown.positions());
    if (!this.other) return box;
    const second = boxOf(this.otherShown.positions());
    return { low: box.low.map((l, k) => Math.min(l, second.low[k])), high: box.high.map((h, k) => Math.max(h, second.high[k])) };
  }

  draw() {
    const { state, stage, model } = this;
    const level = this.level();
    const color = this.colorOf(model);
    const show = (views, shown, at, tint, uncovered) => {
      views.body.pose(0);
      views.body.compare(0, at, uncovered && state.get('uncovered'));
      views.body.facets(state.get('facets'));
      views.spheres.pose(0, at, tint);
      views.spheres.look(state.get('spheres'), state.get('opacity'));
      views.body.parts[0].visible = views.body.parts[1].visible = state.get('body');
    };
    show(stage, this.shown, level, color, true);
    if (state.get('beside')) show(stage.twin, this.twin, level, color, true);
    if (!this.other) return;
    const other = this.other.model;
    show(stage.other, this.otherShown, Math.min(level, other.levelCount - 1), () => otherTint, false);
    stage.contacts.pose(this.touch.drawn(0.04 * this.size), 0.03 * this.size);
    stage.crossings.show(this.touch.crossingTriangles(this.shown.positions(), model.facets));
  }
  level() {
    return Math.min(this.state.get('level'), this.model.levelCount - 1);
  }
  colorOf(model) {
    const tints = this.state.get('color') === 'branch' ? model.branchTints ??= Array.from({ length: 64 }, (_, k) => kindColor(k)) : levelTints;
    const of = this.state.get('color') === 'branch' ? model.branchOf : model.levelOf;
    return (node) => tints[of[node] % tints.length];
  }

  /** Takes hold of the other body, or of the body at the point that the ray meets. */
  grasp(ray) {
    if (!this.model) return null;
    const [from, to] = [ray.origin.toArray(), ray.direction.toArray()];
    const mine = this.morula.firstHit(this.model.body(this.state.get('rule')), from, to);
    const its = this.other ? this.morula.firstHit(this.other.body, from, to) : null;
    if (its && (!mine || its.t < mine.t)) return this.carry(its.point);
    return mine && this.soft ? this.pull(mine.point, to) : null;
  }
  carry(point) {
    const at = this.stage.planeThrough(point);
    const before = this.state.get('place');
    return {
      move: (ray) => {
        const to = at(ray);
        if (to) this.state.set({ place: before.map((x, k) => x + (to[k] - point[k]) / this.size) });
      },
      end: () => {},
    };
  }
  pull(point, direction) {
    const at = this.stage.planeThrough(point);
    const { soft } = this; // a build may end, and bring another, before the reader lets go
    soft.hold(point, 0.14 * this.size);
    this.ask(false);
    return {
      move: (ray) => {
        const to = at(ray);
        if (to) soft.drag(to);
        this.ask(false);
      },
      end: (wasMoved) => {
        soft.release();
        if (!wasMoved && soft === this.soft) this.pokeAt(point, direction);
        this.ask(false);
      },
    };
  }
  pokeAt(point, direction) {
    this.soft.poke(point, 0.16 * this.size, direction.map((d) => 0.1 * this.size * d));
    this.ask(false);
  }
  /** Pokes the body at the point that the ray meets, or else near the vertex that is nearest to the ray. */
  poke(ray) {
    if (!this.model || !this.soft) return;
    const body = this.model.body(this.state.get('rule'));
    const [from, to] = [ray.origin.toArray(), ray.direction.toArray()];
    const hit = this.morula.firstHit(body, from, to);
    if (hit) this.pokeAt(hit.point, to);
    else this.pokeAt(this.nearestVertex(from, to), to);
  }
  nearestVertex(from, to) {
    const { x } = this.soft;
    let [least, nearest] = [Infinity, 0];
    for (let i = 0; i < x.length; i += 3) {
      const [p, q, r] = [x[i] - from[0], x[i + 1] - from[1], x[i + 2] - from[2]];
      const along = p * to[0] + q * to[1] + r * to[2];
      const apart = p * p + q * q + r * r - along * along;
      if (along > 0 && apart < least) [least, nearest] = [apart, i];
    }
    return [...x.subarray(nearest, nearest + 3)];
  }
}
