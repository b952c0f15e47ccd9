// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The keyboard, and the list of its keys.
import { byId, element } from './dom.js';
import { colorings } from './panel.js';

const keys = [
  ['Space', 'play, pause'],
  ['← →', 'frame before, after'],
  ['Home End', 'first, last frame'],
  ['[ ]', 'coarser, finer level'],
  ['c', 'next coloring'],
  ['m s', 'mesh, spheres'],
  ['b w', 'uncovered surface in red, facets'],
  ['x y z', 'section plane across an axis'],
  [', .', 'move the section plane'],
  ['f u', 'fit the view, another axis up'],
  ['t', 'light or dark'],
  ['Esc', 'let go of the sphere'],
  ['a d Del', 'robots: add, copy, remove a sphere'],
  ['r', 'robots: refit the link'],
  ['Ctrl+Z Ctrl+Y', 'robots: undo, redo'],
  ['?', 'this list'],
];

/** Whether it was a key of the editor of spheres; a field keeps its own. */
function editing(event, editor) {
  const at = event.target;
  if (at instanceof HTMLInputElement && at.type === 'number') return false;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if ((event.ctrlKey || event.metaKey) && !event.altKey && (key === 'z' || key === 'y')) {
    if (key === 'y' || event.shiftKey) editor.redo();
    else editor.undo();
    return true;
  }
  if (event.ctrlKey || event.metaKey || event.altKey || !(key in editor.keys)) return false;
  editor.keys[key]();
  return true;
}

export function bindKeys(state, actions) {
  const help = byId('help');
  help.querySelector('dl').replaceChildren(
    ...keys.map(([names, text]) =>
      element('div', {}, element('dt', {}, ...names.split(' ').map((name) => element('kbd', {}, name))), element('dd', {}, text)),
    ),
  );
  const showHelp = () => (help.open ? help.close() : help.showModal());
  byId('help-button').addEventListener('click', showHelp);
  help.addEventListener('click', (event) => event.target === help && help.close());

  const flip = (name) => () => state.set({ [name]: !state.get(name) });
  const step = (name, by) => () => actions.step(name, by);
  const section = (axis) => () => state.set({ sectionAxis: state.get('sectionAxis') === axis ? '' : axis });
  const slide = (by) => () => state.set({ sectionAt: Math.min(1, Math.max(0, state.get('sectionAt') + by)) });
  const bindings = {
    ' ': actions.play,
    ArrowLeft: step('frame', -1),
    ArrowRight: step('frame', 1),
    Home: () => state.set({ frame: 0, playing: false }),
    End: step('frame', Infinity),
    '[': step('level', -1),
    ']': step('level', 1),
    c: () => {
      const usable = colorings.map(([value]) => value).filter(actions.hasColor);
      state.set({ color: usable[(usable.indexOf(state.get('color')) + 1) % usable.length] });
    },
    m: flip('body'),
    s: flip('spheres'),
    b: flip('uncovered'),
    w: flip('facets'),
    x: section('x'),
    y: section('y'),
    z: section('z'),
    ',': slide(-0.02),
    '.': slide(0.02),
    f: actions.fit,
    u: actions.turnUp,
    t: actions.theme,
    Escape: () => state.set({ picked: -1 }),
    '?': showHelp,
  };
  document.addEventListener('keydown', (event) => {
    if (actions.editor.active && editing(event, actions.editor)) {
      event.preventDefault();
      return;
    }
    if (event.ctrlKey || event.metaKey || event.altKey || (help.open && event.key !== '?')) return;
    const at = event.target;
    if (at instanceof HTMLSelectElement || (at instanceof HTMLInputElement && at.type === 'number')) return;
    // A slider keeps its own arrows, a button its own space.
    if (at instanceof HTMLInputElement && at.type === 'range' && /^(Arrow|Home|End)/.test(event.key)) return;
    if (event.key === ' ' && (at instanceof HTMLButtonElement || at instanceof HTMLInputElement && at.type === 'checkbox')) return;
    const act = bindings[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}
