// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The keys of the page, and the list of them.
import { byId, element } from '../../viewer/src/dom.js';
import { rules } from './choices.js';

const list = [
  ['Space', 'play, stop'], ['[ ]', 'coarser, finer level'], ['R', 'next update rule'], ['E', 'compare with exact'], ['P', 'poke the middle of the picture'],
  ['← → ↑ ↓', 'turn the view; with Shift move the tool'], ['+ −', 'closer, farther'], ['M S', 'mesh, spheres'], ['U W', 'uncovered surface in red, facets'], ['F', 'fit the view'],
  ['O', 'open a file'], ['N', 'next step of the tour'], ['T', 'light or dark'], ['Esc', 'cancel the build, close'], ['?', 'this list'],
];

export function bindKeys(state, actions) {
  const help = byId('help');
  help.querySelector('dl').replaceChildren(
    ...list.map(([names, text]) => element('div', {}, element('dt', {}, ...names.split(' ').map((name) => element('kbd', {}, name))), element('dd', {}, text))),
  );
  const showHelp = () => (help.open ? help.close() : help.showModal());
  byId('help-button').addEventListener('click', showHelp);
  help.addEventListener('click', (event) => event.target === help && help.close());
  const flip = (name) => () => state.set({ [name]: !state.get(name) });
  const arrow = (x, y) => (event) => (event.shiftKey ? actions.moveOther(x, y) : actions.orbit(x, y));
  const nextRule = () => {
    const names = rules.map(([value]) => value).filter((value) => value !== 'skinned' || actions.hasSkin());
    state.set({ rule: names[(names.indexOf(state.get('rule')) + 1) % names.length] });
  };
  const bindings = {
    ' ': flip('playing'), '[': () => actions.level(-1), ']': () => actions.level(1), r: nextRule, e: flip('beside'), p: actions.poke,
    ArrowLeft: arrow(-1, 0), ArrowRight: arrow(1, 0), ArrowUp: arrow(0, 1), ArrowDown: arrow(0, -1), '+': () => actions.zoom(0.9), '=': () => actions.zoom(0.9), '-': () => actions.zoom(1 / 0.9),
    m: flip('body'), s: flip('spheres'), u: flip('uncovered'), w: flip('facets'), f: actions.fit, o: actions.open, n: actions.nextStep, t: actions.theme, Escape: actions.cancel, '?': showHelp,
  };
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || (help.open && event.key !== '?')) return;
    const at = event.target;
    if (event.key !== 'Escape' && (at instanceof HTMLSelectElement || (at instanceof HTMLInputElement && at.type === 'number'))) return;
    // A slider keeps its own arrows, a button its own space.
    if (at instanceof HTMLInputElement && at.type === 'range' && /^(Arrow|Home|End)/.test(event.key)) return;
    if (event.key === ' ' && (at instanceof HTMLButtonElement || (at instanceof HTMLInputElement && at.type === 'checkbox'))) return;
    const act = bindings[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act(event);
  });
}
