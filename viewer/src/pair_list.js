// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pairs of links: those that collide in this pose, the reasons of those that need no test, and rates over random
// configurations.
import { byId, element } from './dom.js';
import { counted, percent } from './numbers.js';
import { Rates } from './pairs.js';

const slice = 12; // milliseconds of counting between two pictures

export class PairList {
  /** onfocus(parts): called when the reader presses a pair. */
  constructor(onfocus) {
    Object.assign(this, { onfocus, scene: null, rates: null, timer: 0 });
    byId('rate-run').addEventListener('click', () => (this.timer ? this.stop() : this.start()));
    byId('other-pairs').addEventListener('toggle', () => this.draw());
  }

  show(scene) {
    this.reset();
    this.scene = scene;
    byId('pairs-section').hidden = !scene.joints || this.pairCount === 0;
    byId('rate-row').hidden = !scene.joints || scene.joints.own.length === 0;
  }
  get pairCount() {
    const count = this.scene.entry.parts?.length ?? 0;
    return (count * (count - 1)) / 2;
  }
  /** Forgets counts: they were of other spheres. */
  reset() {
    this.stop();
    this.rates = null;
  }

  start() {
    const wanted = Math.round(byId('rate-count').valueAsNumber);
    if (!(wanted >= 1 && wanted <= 1e6)) return;
    this.rates = new Rates(this.scene, wanted);
    byId('rate-run').textContent = 'Stop';
    const step = () => {
      const done = this.rates.run(slice);
      this.timer = done ? 0 : setTimeout(step, 0);
      if (done) this.stop();
      else this.drawRate();
    };
    this.timer = setTimeout(step, 0);
  }
  stop() {
    clearTimeout(this.timer);
    this.timer = 0;
    byId('rate-run').textContent = 'Count';
    if (this.scene) this.draw();
  }

  drawRate() {
    const { rates } = this;
    byId('rate').textContent = rates && rates.done > 0 ? `${percent(rates.share)} of ${rates.done.toLocaleString('en')} collide` : '';
  }

  /** One row for each pair that collides in this pose or in a counted configuration, then the others. */
  draw() {
    const { scene, rates } = this;
    if (!scene?.joints) return;
    this.drawRate();
    const now = new Set(scene.overlapping.map(({ parts }) => parts.join(' ')));
    const rate = (key) => (rates?.byPair.get(key) ?? 0) / Math.max(1, rates?.done ?? 0);
    const first = [...new Set([...now, ...(rates?.byPair.keys() ?? [])])].sort((a, b) => rate(b) - rate(a));
    byId('pairs').replaceChildren(...first.map((key) => this.row(key, now.has(key), rates ? percent(rate(key)) : 'collide')));
    byId('pairs').hidden = first.length === 0;
    this.drawOthers(new Set(first));
  }
  drawOthers(first) {
    const { ignored } = this.scene.joints;
    const parts = [...this.scene.entry.parts].sort((a, b) => a - b);
    const keys = parts.flatMap((a, i) => parts.slice(i + 1).map((b) => `${a} ${b}`)).filter((key) => !first.has(key));
    const place = byId('other-pairs');
    place.querySelector('summary').textContent = `${counted(keys.length, 'other pair')}, ${keys.filter((key) => ignored.has(key)).length} of them ignored`;
    const rows = place.open ? keys.map((key) => this.row(key, false, ignored.has(key) ? 'ignored' : 'apart')) : [];
    place.querySelector('div').replaceChildren(...rows);
  }
  row(key, collides, text) {
    const { ignored, parts } = this.scene.joints;
    const pair = key.split(' ').map(Number);
    const why = ignored.has(key) ? `ignored: ${ignored.get(key) || 'no reason given'}` : collides ? 'spheres overlap in this pose' : 'spheres are apart in this pose';
    const name = pair.map((part) => parts[part].name).join(' – ');
    return element('button', { type: 'button', class: 'pair-row', title: `${name}\n${why}`, 'data-collides': String(collides), onclick: () => this.onfocus(pair) },
      element('span', {}, name), element('span', {}, text));
  }
}
