// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The controls of the page, their texts and figures.
import { byId, element } from '../../viewer/src/dom.js';
import { counted, figure, percent } from '../../viewer/src/numbers.js';
import { bindBox, bindRange, segments } from '../../viewer/src/widgets.js';
import { depths, details, methods, qualities, rules, shapes, touches } from './choices.js';

function bindSelect(select, options, state, name) {
  select.replaceChildren(...options.map(([value, label]) => element('option', { value }, label)));
  select.value = state.get(name);
  select.addEventListener('change', () => state.set({ [name]: select.value }));
  state.listen((changed) => changed.has(name) && (select.value = state.get(name)));
}

const degrees = (value) => `${String(Math.round(value)).replace('-', '\u2212')}°`;

export class Panel {
  constructor(state) {
    this.state = state;
    for (const [id, options] of [['shape', shapes], ['method', methods], ['quality', qualities], ['depth', depths], ['rule', rules]]) bindSelect(byId(id), options, state, id);
    segments(byId('details'), details, state, 'detail');
    segments(byId('coloring'), [['branch', 'Branch', 'Spheres below the same child of the root share a color'], ['level', 'Level', 'Every sphere in the color of its level']], state, 'color');
    segments(byId('touching'), touches.map(([value, label]) => [value, label, '']), state, 'touch');
    for (const [id, name] of [['show-body', 'body'], ['show-spheres', 'spheres'], ['show-uncovered', 'uncovered'], ['show-facets', 'facets'], ['beside', 'beside']]) bindBox(byId(id), state, name);
    this.ranges = ['bend', 'twist', 'stretch', 'level', 'opacity'].map((id) => {
      const range = byId(id);
      bindRange(range, state, id, ['bend', 'twist', 'stretch'].includes(id) ? { playing: false } : {});
      return range;
    });
    byId('flat').addEventListener('change', () => {
      state.set({ flat: Math.max(0, Math.min(2000, Math.round(byId('flat').valueAsNumber) || 0)) });
      this.tell(); // also where the text changes and the value does not
    });
    byId('swing').addEventListener('click', () => state.set({ playing: !state.get('playing') }));
    state.listen(() => this.tell());
    for (const range of this.ranges) range.take();
    this.tell();
  }

  tell() {
    const { state } = this;
    // A thick body bends less than the slider says: the text has the angle that it takes.
    const limit = this.bendLimit?.(state.get('stretch')) ?? 180;
    byId('bend-value').textContent = degrees(Math.max(-limit, Math.min(limit, state.get('bend'))));
    byId('twist-value').textContent = degrees(state.get('twist'));
    byId('stretch-value').textContent = `× ${state.get('stretch').toFixed(2)}`;
    byId('swing').textContent = state.get('playing') ? 'Stop' : 'Play';
    byId('flat').value = String(state.get('flat'));
    byId('depth').disabled = state.get('flat') > 0;
    byId('quality-row').hidden = state.get('method') !== 'optimized';
    byId('touch-more').hidden = state.get('touch') === 'none';
    const rule = rules.find(([value]) => value === state.get('rule'));
    byId('rule-hint').textContent = `${rule[2]}.`;
    document.body.dataset.beside = String(state.get('beside'));
    document.body.dataset.tour = String(state.get('tour') > 0);
    byId('left-name').hidden = byId('right-name').hidden = !state.get('beside');
    byId('left-name').textContent = rule[1];
    byId('right-name').textContent = 'Exact';
  }

  /** A new model. bendLimit: the largest angle by the stretch. */
  show(model, made, character, name, bendLimit) {
    this.bendLimit = bendLimit;
    this.tell();
    const levels = byId('level');
    levels.max = String(model.levelCount - 1);
    levels.disabled = model.levelCount < 2;
    byId('level-ticks').replaceChildren(
      ...model.levelSets.map((_, level) => element('button', { type: 'button', 'aria-label': `Level ${level}`, 'data-level': level, onclick: () => this.state.set({ level }) }, String(level))),
    );
    for (const range of this.ranges) range.take();
    for (const id of ['bend', 'twist', 'stretch']) byId(id).disabled = character !== null;
    byId('clip-row').hidden = !character;
    const clips = character?.clips ?? [];
    byId('clip').replaceChildren(...clips.map((clip, i) => element('option', { value: String(i) }, clip.name || `Motion ${i + 1}`)));
    byId('rule').querySelector('[value=skinned]').hidden = byId('rule').querySelector('[value=skinned]').disabled = !character?.followsBones;
    byId('soft-hint').textContent = made.clusters ? 'Drag the body to pull it, tap to poke it.' : 'This mesh has too many vertices for a soft body.';
    byId('figure-facets').textContent = (model.facets.length / 3).toLocaleString('en');
    byId('figure-build').textContent = made.seconds < 1 ? `${figure(1000 * made.seconds)} ms` : `${figure(made.seconds)} s`;
    byId('title').textContent = name;
    this.level(model);
  }
  level(model) {
    const level = Math.min(this.state.get('level'), model.levelCount - 1);
    const count = model.levelSets[level].length;
    byId('level-name').textContent = counted(count, 'sphere');
    byId('figure-spheres').textContent = `${count.toLocaleString('en')} / ${model.nodeCount.toLocaleString('en')}`;
    for (const button of byId('level-ticks').children) button.setAttribute('aria-pressed', String(button.dataset.level === String(level)));
  }

  /** share: of the surface that is uncovered; proven: whether the certificate holds; loose: null without a volume. */
  figures({ share, proven, loose, update }) {
    const cell = byId('figure-uncovered');
    cell.textContent = share > 0 ? percent(share) : proven ? '0, proven' : '0 found';
    cell.dataset.bare = String(share > 0);
    cell.dataset.proven = String(proven);
    byId('figure-looseness').textContent = figure(loose);
    this.speed(update);
  }
  speed(update) {
    byId('figure-update').textContent = update === null ? '–' : `${figure(update)} µs`;
  }
  contacts(touch, tests) {
    byId('figure-contacts').textContent = touch.finished ? touch.contacts.length.toLocaleString('en') : `${touch.contacts.length.toLocaleString('en')} or fewer`;
    byId('figure-crossings').textContent = (touch.crossings.length / 2).toLocaleString('en');
    if (tests !== null) byId('figure-tests').textContent = tests.toLocaleString('en');
  }

  status(text, share = null, canCancel = false) {
    const place = byId('status');
    place.dataset.idle = String(text === '');
    byId('status-text').textContent = text;
    const bar = byId('share');
    bar.hidden = share === null;
    if (share !== null) bar.value = share;
    byId('cancel').hidden = !canCancel;
  }
  message(text) {
    byId('message').hidden = text === '';
    byId('message-text').textContent = text;
  }
}
