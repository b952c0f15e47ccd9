// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The controls next to the picture: the choices of the view, and the figures of the frame.
import { Curves } from './curves.js';
import { byId, element } from './dom.js';
import { css, kindColor, levelColors, mapGradient } from './colors.js';
import { counted, figure, percent } from './numbers.js';
import { bindBox, bindRange, segments } from './widgets.js';

export const colorings = [
  ['level', 'Level', 'Every sphere in the color of its level'],
  ['branch', 'Branch', 'Spheres below the same child of the root share a color'],
  ['empty', 'Looseness', 'The share of a sphere that is outside the body'],
  ['growth', 'Growth', 'Radius over radius at rest'],
];
const measures = [
  ['looseness', 'Looseness'],
  ['uncovered_area', 'Uncovered'],
  ['uncovered_distance', 'Distance'],
  ['growth', 'Growth'],
];

export class Panel {
  constructor(sceneList, state) {
    Object.assign(this, { sceneList, state });
    this.curves = new Curves(byId('curves'), 168, (frame) => state.set({ frame, playing: false }));
    this.makeChoices();
    this.colorButtons = segments(byId('coloring'), colorings, state, 'color');
    this.measureButtons = segments(byId('measure'), measures, state, 'measure');
    segments(byId('section-axis'), [['', 'Off'], ['x', 'x'], ['y', 'y'], ['z', 'z']], state, 'sectionAxis');
    for (const [id, name] of [['show-body', 'body'], ['show-spheres', 'spheres'], ['show-uncovered', 'uncovered'], ['show-facets', 'facets'], ['show-contacts', 'contacts'], ['show-patches', 'patches'], ['section-flip', 'sectionFlip']]) {
      bindBox(byId(id), state, name);
    }
    for (const [id, name] of [['level', 'level'], ['frame', 'frame'], ['opacity', 'opacity'], ['section-at', 'sectionAt']]) {
      bindRange(byId(id), state, name, name === 'frame' ? { playing: false } : {});
    }
    byId('play').addEventListener('click', () => state.set({ playing: !state.get('playing') }));
  }

  makeChoices() {
    const place = byId('choices');
    this.choices = this.sceneList.choices();
    place.hidden = this.choices.length === 0;
    place.replaceChildren(
      ...this.choices.map(({ key, label, values }) => {
        const select = element('select', { id: `choose-${key}` }, ...values.map((value) => element('option', { value }, value)));
        select.addEventListener('change', () => {
          const scene = this.sceneList.nearest({ [key]: select.value }, this.state.get('scene'));
          if (scene >= 0) this.state.set({ scene });
        });
        return element('label', { class: 'choice' }, element('span', {}, label), select);
      }),
    );
  }

  /** Another scene: other ranges, other choices. */
  show(scene) {
    this.scene = scene;
    const its = this.sceneList.describe(this.state.get('scene'));
    for (const { key } of this.choices) byId(`choose-${key}`).value = its[key];
    byId('level').max = String(scene.levelCount - 1);
    byId('frame').max = String(scene.frameCount - 1);
    for (const id of ['level', 'frame', 'opacity', 'section-at']) byId(id).take();
    byId('level-ticks').replaceChildren(
      ...scene.levelSets.map((nodes, level) =>
        element('button', { type: 'button', title: counted(nodes.length, 'sphere'), onclick: () => this.state.set({ level }) }, String(level)),
      ),
    );
    byId('contacts-box').hidden = !scene.contacts;
    byId('contacts-label').textContent = scene.patches ? 'Points' : 'Contacts';
    byId('patches-box').hidden = !scene.patches;
    document.body.dataset.moves = String(scene.frameCount > 1 || (scene.joints?.own.length ?? 0) > 0);
    document.body.dataset.joints = String(scene.joints !== null);
    for (const button of this.colorButtons) {
      if (button.dataset.value === 'empty') button.disabled = scene.emptyShare === null;
      if (button.dataset.value === 'growth') button.disabled = scene.joints !== null;
    }
    for (const button of this.measureButtons) {
      button.disabled = button.dataset.value !== 'growth' && this.series(button.dataset.value).every((s) => s.y.every((y) => y === null));
    }
    this.drawCurves();
    this.drawFigures();
    this.drawLegend();
  }

  series(measure) {
    const { scene } = this;
    const x = scene.motionEntry.frames.map((_, frame) => frame);
    return scene.levelSets.map((_, level) => ({
      name: `level ${level}`,
      x,
      y: measure === 'growth' ? scene.largestGrowth(level) : x.map((frame) => scene.measured(measure, level, frame)),
      color: levelColors[level % levelColors.length],
      strong: level === this.state.get('level'),
    }));
  }

  drawCurves() {
    const measure = this.state.get('measure');
    const shares = measure === 'uncovered_area';
    const series = this.series(measure).map((s) => (shares ? { ...s, y: s.y.map((y) => (y === null ? null : 100 * y)) } : s));
    // The chosen level last, so that it lies on top.
    series.sort((a, b) => Number(a.strong) - Number(b.strong));
    byId('curves-note').textContent = {
      looseness: 'Volume in the spheres and outside the body, in body volumes',
      uncovered_area: 'Share of the surface outside all spheres, in per cent',
      uncovered_distance: 'Largest distance of a surface point from the spheres, mesh units',
      growth: 'Largest radius over radius at rest',
    }[measure];
    this.curves.frame = this.state.get('frame');
    this.curves.draw({ series, frames: true, log: measure === 'looseness' ? 'auto' : false });
  }

  drawFigures() {
    const { scene, state } = this;
    if (scene.joints) {
      this.drawParts();
      return;
    }
    const frame = state.get('frame');
    const measured = scene.entry.measured !== null;
    const head = ['Level', 'Spheres', ...(measured ? ['Looseness', 'Uncovered', 'Distance'] : ['Largest growth'])];
    const rows = scene.levelSets.map((nodes, level) => {
      const cells = measured
        ? [
            element('td', {}, figure(scene.measured('looseness', level, frame))),
            element('td', { class: scene.measured('uncovered_area', level, frame) > 0 ? 'uncovered' : null }, percent(scene.measured('uncovered_area', level, frame))),
            element('td', {}, figure(scene.measured('uncovered_distance', level, frame))),
          ]
        : [element('td', {}, figure(nodes.reduce((most, node) => Math.max(most, scene.growth(frame, node)), 0)))];
      const dot = element('i', { class: 'dot', style: `background:${levelColors[level % levelColors.length]}` });
      return element(
        'tr',
        { class: level === state.get('level') ? 'chosen' : null, onclick: () => state.set({ level }) },
        element('th', { scope: 'row' }, dot, String(level)),
        element('td', {}, nodes.length.toLocaleString('en')),
        ...cells,
      );
    });
    byId('figures').replaceChildren(
      element('thead', {}, element('tr', {}, ...head.map((text) => element('th', { scope: 'col' }, text)))),
      element('tbody', {}, ...rows),
    );
  }

  /** For a body of parts: the spheres of each part, in the colors of the picture. */
  drawParts() {
    const { scene } = this;
    const heads = [...scene.levelSets[Math.min(1, scene.levelCount - 1)]];
    const rows = heads.map((node) => {
      const part = scene.joints.parts[scene.partOf[node]];
      const dot = element('i', { class: 'dot', style: `background:${css(kindColor(scene.branchOf[node]))}` });
      return element('tr', { onclick: () => this.state.set({ picked: node }) },
        element('th', { scope: 'row' }, dot, part.name),
        element('td', {}, Math.max(1, scene.entry.child_count[node]).toLocaleString('en')),
        element('td', {}, figure(part.protrusion)));
    });
    byId('figures').replaceChildren(
      element('thead', {}, element('tr', {}, ...['Link', 'Spheres', 'Stick out by'].map((text) => element('th', { scope: 'col' }, text)))),
      element('tbody', {}, ...rows),
    );
  }

  drawLegend() {
    const { scene, state } = this;
    const level = state.get('level');
    const color = state.get('color');
    const legend = byId('legend');
    const parts = [];
    if (state.get('spheres')) {
      if (color === 'growth' || color === 'empty') {
        const [low, high] = scene.range(color, level);
        parts.push(
          element('div', { class: 'scale' },
            element('span', { class: 'scale-name' }, color === 'growth' ? 'radius / radius at rest' : 'share of the sphere outside the body'),
            element('span', { class: 'scale-bar', style: `background:${mapGradient()}` }),
            element('span', { class: 'scale-ends' }, element('span', {}, figure(low)), element('span', {}, figure(high)))),
        );
      } else {
        const levels = [...new Set([...scene.levelSets[level]].map((node) => scene.levelOf[node]))].sort();
        const text = (l) => (l === level ? `level ${l}` : `level ${l}, leaves`);
        parts.push(
          element('div', { class: 'kinds' },
            ...(color === 'level'
              ? levels.map((l) => element('span', { class: 'kind' }, element('i', { class: 'dot', style: `background:${levelColors[l % levelColors.length]}` }), text(l)))
              : [element('span', { class: 'kind' }, scene.joints ? 'one color for every link' : 'one color for every child of the root')])),
        );
      }
    }
    if (state.get('uncovered') && state.get('body') && !scene.entry.inside) {
      const share = scene.measured('uncovered_area', level, state.get('frame'));
      const text = share === null ? 'uncovered surface' : share > 0 ? `uncovered ${percent(share)}` : 'the whole surface is covered';
      parts.push(element('span', { class: 'kind', id: 'uncovered-chip', 'data-uncovered': share === null ? 'unknown' : String(share > 0) }, element('i', { class: 'dot uncovered-dot' }), text));
    }
    if (scene.joints && this.meeting?.length > 0) {
      const named = this.meeting.slice(0, 3).map((pair) => pair.join(' – '));
      const more = this.meeting.length > 3 ? ` and ${this.meeting.length - 3} more` : '';
      parts.push(element('span', { class: 'kind', id: 'meet-chip' }, `meet: ${named.join(', ')}${more}`));
    }
    if (scene.contacts && state.get('contacts')) {
      const now = scene.contacts[state.get('frame')];
      const depths = now.filter((_, i) => i % 7 === 6);
      const deepest = depths.length > 0 ? `, deepest ${figure(depths.reduce((most, d) => Math.max(most, d)))}` : '';
      parts.push(element('span', { class: 'kind', id: 'contacts-chip' }, `${counted(depths.length, scene.patches ? 'point' : 'contact')}${deepest}`));
    }
    if (scene.patches && state.get('patches')) {
      const { volumes, depths } = scene.entry.patches[state.get('frame')];
      const sizes = depths.length > 0 ? `, volume ${figure(volumes.reduce((sum, v) => sum + v))}, deepest ${figure(Math.max(...depths))}` : '';
      parts.push(element('span', { class: 'kind', id: 'patches-chip' }, `${counted(depths.length, 'patch', 'patches')}${sizes}`));
    }
    legend.replaceChildren(...parts);
    legend.hidden = parts.length === 0;
  }

  /** After the scene of the state is the one that is shown. */
  follow(changed) {
    const { state, scene } = this;
    if (!scene) return;
    const has = (...names) => names.some((name) => changed.has(name));
    if (has('scene', 'frame')) {
      const frame = state.get('frame');
      byId('frame-name').textContent = `${frame} / ${scene.frameCount - 1}`;
      byId('frame-name').title = scene.motionEntry.frames[frame];
    }
    if (has('scene', 'level', 'edits')) {
      const level = state.get('level');
      byId('level-name').textContent = `${level} · ${counted(scene.levelSets[level].length, 'sphere')}`;
      [...byId('level-ticks').children].forEach((tick, l) => tick.setAttribute('aria-pressed', String(l === level)));
    }
    if (has('level', 'measure')) this.drawCurves();
    else if (has('frame')) this.curves.moveTo(state.get('frame'));
    if (scene.joints ? has('scene', 'edits') : has('scene', 'level', 'frame')) this.drawFigures();
    if (has('scene', 'level', 'frame', 'color', 'spheres', 'uncovered', 'body', 'contacts', 'patches')) this.drawLegend();
    if (has('sectionAxis')) byId('section-more').hidden = !state.get('sectionAxis');
    if (has('playing')) {
      byId('play').setAttribute('aria-label', state.get('playing') ? 'Pause' : 'Play');
      byId('play').dataset.playing = String(state.get('playing'));
    }
  }
}
