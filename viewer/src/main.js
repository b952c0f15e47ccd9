// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Starts the page: data in, picture and controls out, failures said where the reader looks.
import './style.css';
import { PageError, readManifest } from './decode.js';
import { SceneList, State } from './model.js';
import { Stage } from './stage.js';
import { Panel } from './panel.js';
import { Report } from './report.js';
import { drawPicked } from './picked.js';
import { bindKeys } from './keys.js';
import { bindTheme } from './theme.js';
import { byId, element } from './dom.js';
import { kindColour, levelColours, mapped, rgb } from './colours.js';
import { counted } from './numbers.js';

const text = (id) => byId(id)?.textContent ?? null;
const framesPerSecond = 14;
const levelTints = levelColours.map(rgb);

function fail(error) {
  const known = error instanceof PageError;
  byId('main')?.remove();
  byId('failure')?.remove();
  document.body.append(
    element('div', { id: 'failure', role: 'alert' },
      element('h1', {}, 'This page cannot be shown'),
      element('p', {}, `${known ? 'Something is wrong with it' : 'Something went wrong'}: ${error.message}.`),
      element('p', { class: 'muted' }, 'Make the file again with morula view, or copy it again from where it is whole.')),
  );
}

/** Colour of a node, as the reader chose. */
function colouring(scene, state) {
  const level = state.get('level');
  const frame = state.get('frame');
  const by = state.get('colour');
  if (by === 'branch') return (node) => kindColour(scene.branchOf[node]);
  if (by === 'growth' || (by === 'empty' && scene.emptyShare)) {
    const [low, high] = scene.range(by, level);
    return (node) => mapped(high > low ? (scene[by](frame, node) - low) / (high - low) : 0.5);
  }
  return (node) => levelTints[scene.levelOf[node] % levelTints.length];
}

function start() {
  const manifest = readManifest(text);
  const sceneList = new SceneList(manifest, text);
  const hasReport = manifest.study !== null && manifest.study !== undefined;
  document.body.dataset.layout = hasReport ? 'report' : 'view';
  const first = sceneList.scene(0);
  document.title = `${manifest.title} · Morula`;
  byId('title').textContent = manifest.title;
  byId('made-by').textContent = `morula ${manifest.morula}`;

  const state = new State({
    scene: -1, frame: 0, level: -1, colour: 'level', measure: first.entry.measured ? 'looseness' : 'growth',
    body: true, spheres: true, bare: true, facets: false, opacity: 0.5,
    sectionAxis: '', sectionAt: 0.5, sectionFlip: false, picked: -1, playing: false,
  });
  let stage = null;
  let scene = null;
  let report = null;
  const panel = new Panel(sceneList, state);
  const toggleTheme = bindTheme(() => {
    stage?.theme();
    panel.curves.retheme();
    report?.retheme();
  });
  stage = new Stage(byId('stage'));

  state.listen((changed) => {
    const has = (...names) => names.some((name) => changed.has(name));
    if (has('scene')) {
      scene = sceneList.scene(state.get('scene'));
      const level = state.get('level');
      // The deepest level that is not a crowd, unless the reader chose one that is there.
      const deepest = scene.levelSets.findLastIndex((nodes) => nodes.length <= 1500);
      state.values.level = level < 0 || level >= scene.levelCount ? Math.max(0, deepest) : level;
      state.values.frame = Math.min(state.get('frame'), scene.frameCount - 1);
      if (state.get('picked') >= scene.nodeCount) state.values.picked = -1;
      for (const name of ['level', 'frame', 'picked']) changed.add(name);
      stage.show(scene);
      panel.show(scene);
      byId('about').textContent = [
        sceneList.describe(state.get('scene')).body,
        counted(scene.motionEntry.facets, 'facet'),
        counted(scene.nodeCount, 'sphere'),
        `rule ${scene.entry.rule}`,
      ].join(' · ');
    }
    if (!scene) return;
    if (has('scene', 'frame')) stage.body.pose(state.get('frame'));
    if (has('scene', 'frame', 'level', 'bare')) stage.body.compare(state.get('frame'), state.get('level'), state.get('bare'));
    if (has('scene', 'frame', 'level', 'colour')) stage.spheres.pose(state.get('frame'), state.get('level'), colouring(scene, state));
    if (has('scene', 'picked')) stage.spheres.mark(state.get('picked'));
    if (has('body')) stage.body.group.visible = state.get('body');
    if (has('facets')) stage.body.facets(state.get('facets'));
    if (has('scene', 'sectionAxis', 'sectionAt', 'sectionFlip')) stage.cut(state.get('sectionAxis'), state.get('sectionAt'), state.get('sectionFlip'));
    if (has('scene', 'spheres', 'opacity', 'sectionAxis')) stage.spheres.look(state.get('spheres'), state.get('opacity'));
    if (has('scene', 'frame', 'picked')) drawPicked(scene, state);
    panel.follow(changed);
    stage.ask();
  });

  stage.onpick = (node) => state.set({ picked: node });
  const play = () => state.set({ playing: !state.get('playing') });
  const ups = { y: 'z', z: 'x', x: 'y' };
  bindKeys(state, {
    play,
    theme: toggleTheme,
    fit: () => stage.fit(),
    turnUp: () => stage.fit(ups[stage.up]),
    hasColour: (colour) => colour !== 'empty' || scene.emptyShare !== null,
    step: (name, by) => {
      const most = (name === 'frame' ? scene.frameCount : scene.levelCount) - 1;
      state.set({ [name]: Math.min(Math.max(state.get(name) + by, 0), most), ...(name === 'frame' ? { playing: false } : {}) });
    },
  });
  byId('fit').addEventListener('click', () => stage.fit());

  let lastStep = 0;
  const tick = (now) => {
    if (!state.get('playing')) return;
    if (now - lastStep >= 1000 / framesPerSecond) {
      lastStep = now;
      state.set({ frame: (state.get('frame') + 1) % scene.frameCount });
    }
    requestAnimationFrame(tick);
  };
  state.listen((changed) => {
    if (!changed.has('playing') || !state.get('playing')) return;
    if (scene.frameCount < 2) state.set({ playing: false });
    else requestAnimationFrame(tick);
  });

  if (hasReport) report = new Report(manifest.study, sceneList, state);
  stage.theme();
  state.set({ scene: 0 });
  document.body.dataset.ready = 'true';
}

addEventListener('DOMContentLoaded', () => {
  try {
    start();
  } catch (error) {
    console.warn(error);
    fail(error);
  }
});
