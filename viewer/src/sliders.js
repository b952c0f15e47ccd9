// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A slider for every joint that the reader moves, and which parts meet.
import { byId, element } from './dom.js';
import { counted, figure } from './numbers.js';
import { randomValues } from './pairs.js';

const shown = (joint, value) => (joint.kind === 'turns' ? `${((value * 180) / Math.PI).toFixed(1).replace('-', '\u2212')}°` : figure(value));

export class Sliders {
  constructor(state) {
    this.state = state;
    this.rows = [];
    byId('joints-play').addEventListener('click', () => state.set({ playing: !state.get('playing') }));
    byId('joints-rest').addEventListener('click', () => this.set(this.joints.rest));
    byId('joints-random').addEventListener('click', () =>
      this.set(randomValues(this.joints, Math.random)));
  }

  set(values) {
    this.state.set({ joints: values, playing: false });
  }

  /** The joints of another scene, or none. */
  show(joints) {
    byId('joints-section').hidden = !joints || joints.own.length === 0;
    if (joints === this.joints) return;
    this.joints = joints;
    this.rows = (joints ? joints.own : []).map((i, k) => {
      const joint = joints.joints[i];
      const [lower, upper] = joints.limits(k);
      const range = element('input', {
        type: 'range', id: `joint-${k}`, min: String(lower), max: String(upper), step: 'any', disabled: !(lower < upper),
        oninput: () => this.set(this.state.get('joints').map((value, other) => (other === k ? range.valueAsNumber : value))),
      });
      const output = element('output', { for: `joint-${k}` });
      return { joint, lower, upper, range, output, row: element('label', { class: 'joint' }, element('span', { title: joint.name }, joint.name), output, range) };
    });
    byId('joints').replaceChildren(...this.rows.map(({ row }) => row));
  }

  /** Sets the sliders to the current values; meeting: [[name, name], …]. */
  follow(meeting) {
    this.rows.forEach(({ joint, lower, upper, range, output }, k) => {
      const value = this.state.get('joints')[k];
      range.value = String(value);
      range.style.setProperty('--share', String(upper > lower ? (value - lower) / (upper - lower) : 0));
      output.textContent = shown(joint, value);
    });
    const place = byId('joints-meet');
    place.dataset.meet = String(meeting.length > 0);
    place.textContent = meeting.length === 0 ? 'no links meet' : `${counted(meeting.length, 'pair')} of links ${meeting.length === 1 ? 'meets' : 'meet'}`;
    place.title = meeting.map((pair) => pair.join(' – ')).join('\n');
  }

  playing(on) {
    byId('joints-play').textContent = on ? 'Stop' : 'Swing';
  }
}
