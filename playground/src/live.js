// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The live figures, computed between frames, so that no frame waits for them.
import { sphereGrid } from '../../viewer/src/uncovered.js';
import { coverRules } from './choices.js';
import { isClosed, looseness, uncoveredShare } from './figures.js';

const mostFacetsOfLooseness = 50_000; // above, it would take longer than a frame may
const pause = 250; // milliseconds between two computations

export class Figures {
  constructor(world, state, panel) {
    Object.assign(this, { world, state, panel });
    this.timer = 0;
    this.update = null;
    this.rule = '';
    this.jobs = [];
  }

  /** A new body. */
  restart() {
    this.update = null;
    this.looks = 0;
    this.closed = null;
    this.ask();
  }
  ask() {
    this.isStale = true;
    if (this.timer === 0) this.timer = setTimeout(() => this.begin(), pause);
  }

  /** One figure per turn of the page's loop: together they would take a frame's time. */
  begin() {
    // The first frame of a body moves the spheres to it.
    if (this.world.model && !this.world.isPosed) {
      this.timer = setTimeout(() => this.begin(), pause);
      return;
    }
    this.isStale = false;
    const found = { share: 0, proven: false, loose: null, update: null };
    this.jobs = [() => this.uncovered(found), () => this.loose(found), () => this.speed(found), () => this.contacts(), () => this.panel.figures(found)];
    this.next();
  }
  next() {
    const job = this.world.model ? this.jobs.shift() : null;
    if (!job) {
      this.timer = 0;
      if (this.isStale) this.ask();
      else document.body.dataset.figures = 'done';
      this.speedAgain();
      return;
    }
    job();
    setTimeout(() => this.next());
  }

  uncovered(found) {
    const { world, state } = this;
    const [rule, shown] = [state.get('rule'), world.shown];
    const positions = shown.positions();
    found.proven = coverRules.includes(rule) && world.model.body(rule).certify(positions);
    if (found.proven) return;
    const grid = sphereGrid(positions, shown.frames[0], shown.levelSets[world.level()]);
    found.share = uncoveredShare(positions, world.model.facets, grid, shown.tolerance);
  }
  loose(found) {
    const { world } = this;
    if (world.model.facets.length / 3 > mostFacetsOfLooseness) return;
    this.closed ??= isClosed(world.model.facets);
    if (!this.closed) return;
    found.loose = looseness(world.shown.positions(), world.model.facets, world.shown.frames[0], world.shown.levelSets[world.level()]);
  }
  /** The least time so far of this rule: other work of the machine only adds to it. */
  speed(found) {
    const rule = this.state.get('rule');
    if (rule !== this.rule) [this.rule, this.update, this.looks] = [rule, null, 0];
    ++this.looks;
    if (rule !== 'rest') found.update = this.update = Math.min(this.update ?? Infinity, this.world.model.measureUpdate(rule));
  }
  /** The first updates run before the browser has compiled them well. */
  speedAgain() {
    clearTimeout(this.again);
    if (this.looks >= 6) return;
    this.again = setTimeout(() => {
      if (!this.world.model || this.timer !== 0) return;
      const found = { update: null };
      this.speed(found);
      this.panel.speed(found.update);
      this.speedAgain();
    }, 300);
  }
  contacts() {
    const { world, panel } = this;
    if (!world.other) return;
    panel.contacts(world.touch, world.touch.countTests(world.model.body(this.state.get('rule')), world.other));
  }
}
