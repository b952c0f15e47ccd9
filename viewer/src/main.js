// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Starts the page: data in, picture and controls out, failures said where the reader looks.
import './style.css';
import { PageError, readManifest } from './decode.js';
import { SceneList } from './model.js';
import { State } from './state.js';
import { Stage } from './stage.js';
import { Panel } from './panel.js';
import { Sliders } from './sliders.js';
import { Report } from './report.js';
import { Editor } from './editor.js';
import { PairList } from './pair_list.js';
import { sphereAround } from './refit.js';
import { drawPicked } from './picked.js';
import { bindKeys } from './keys.js';
import { bindTheme } from './theme.js';
import { byId, element } from './dom.js';
import { kindColor, levelColors, mapped, rgb } from './colors.js';
import { counted } from './numbers.js';
import { readAddress, writeAddress } from './address.js';
import { canFilm, saveFilm, saveModel, savePicture } from './save.js';

const text = (id) => byId(id)?.textContent ?? null;
const framesPerSecond = 14;
const levelTints = levelColors.map(rgb);
const collidingTint = rgb('#e3262e');
const collidingLinkTint = rgb('#f0948f'); // its spheres that touch no other link

function fail(error) {
  const known = error instanceof PageError;
  byId('main')?.remove();
  byId('failure')?.remove();
  document.body.append(
    element('div', { id: 'failure', role: 'alert' },
      element('h1', {}, 'This page cannot be shown'),
      element('p', {}, `${known ? 'Something is wrong with it' : 'Something went wrong'}: ${error.message}.`),
      element('p', { class: 'muted' }, error.remedy ?? 'Make the file again with morula view, or copy it again from where it is whole.')),
  );
}

/** Color of a node, as the reader chose. */
function coloring(scene, state) {
  const level = state.get('level');
  const frame = state.get('frame');
  const by = state.get('color');
  if (scene.joints) {
    const colliding = scene.collidingNodes;
    const own = by === 'branch' ? (node) => kindColor(scene.branchOf[node]) : (node) => levelTints[scene.levelOf[node] % levelTints.length];
    return (node) => (colliding.has(node) ? collidingTint : colliding.has(scene.parent[node]) ? collidingLinkTint : own(node));
  }
  if (by === 'branch') return (node) => kindColor(scene.branchOf[node]);
  if (by === 'growth' || (by === 'empty' && scene.emptyShare)) {
    const [low, high] = scene.range(by, level);
    return (node) => mapped(high > low ? (scene[by](frame, node) - low) / (high - low) : 0.5);
  }
  return (node) => levelTints[scene.levelOf[node] % levelTints.length];
}

/** The stage, or nothing where the browser gives no WebGL: then its place says so, and all else works. */
function makeStage() {
  const place = byId('stage');
  try {
    return new Stage(place);
  } catch (error) {
    if (!(error instanceof PageError)) throw error;
    console.warn(error);
    place.prepend(element('div', { id: 'no-picture', role: 'alert' },
      element('p', {}, `No picture: ${error.message}.`), element('p', { class: 'muted' }, 'The figures next to it are complete.')));
    document.body.dataset.picture = 'false';
    return null;
  }
}

/** 'liver, twisted' as the beginning of a file's name. */
const fileName = (title) => title.replace(/[^\p{L}\p{N}._-]+/gu, '-').replace(/^[-.]+|-+$/g, '').slice(0, 60) || 'morula';

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
    scene: -1, frame: 0, level: -1, color: 'branch', measure: first.entry.measured ? 'looseness' : 'growth',
    body: true, spheres: true, uncovered: true, facets: false, contacts: true, patches: true, opacity: 0.5,
    sectionAxis: '', sectionAt: 0.5, sectionFlip: false, picked: -1, playing: false, joints: [], edits: 0,
  });
  let stage = null;
  let scene = null;
  let begun = null; // the values that the page began with
  let report = null;
  let tellAbout = () => {};
  const panel = new Panel(sceneList, state);
  const sliders = new Sliders(state);
  const pairs = new PairList((parts) => {
    const together = scene.overlapping.find((pair) => pair.parts.join() === parts.join());
    const ballOf = (node) => [...scene.frames[0].subarray(4 * node, 4 * node + 4)];
    const heads = [...scene.levelSets[1]].filter((node) => parts.includes(scene.partOf[node])).map(ballOf);
    const shown = together ? [...together.nodes] : [];
    const others = [...scene.levelSets[scene.levelCount - 1]].filter((node) => !shown.includes(node)).map(ballOf);
    stage?.focus(sphereAround(together ? shown.map(ballOf) : heads), others);
  });
  const editor = new Editor(state, manifest.title, (triangles, part) => {
    if (!stage) return;
    stage.bare.show(state.get('uncovered') ? triangles : []);
    if (part >= 0) stage.bare.pose(scene.poseOf(part));
    stage.ask();
  });
  const toggleTheme = bindTheme(() => {
    stage?.theme();
    panel.curves.retheme();
    report?.retheme();
  });
  stage = makeStage();

  state.listen((changed) => {
    const has = (...names) => names.some((name) => changed.has(name));
    if (has('scene')) {
      const wasInside = scene?.entry.inside === true;
      scene = sceneList.scene(state.get('scene'));
      // The body would hide what is inside. Once all have heard of the scene.
      if (wasInside !== (scene.entry.inside === true)) queueMicrotask(() => state.set({ body: wasInside }));
      const level = state.get('level');
      // The second level, which is few spheres and yet the body's shape, unless the reader chose one that is there.
      state.values.level = level < 0 || level >= scene.levelCount ? Math.min(2, scene.levelCount - 1) : level;
      state.values.frame = Math.min(state.get('frame'), scene.frameCount - 1);
      if (state.get('picked') >= scene.nodeCount) state.values.picked = -1;
      for (const name of ['level', 'frame', 'picked']) changed.add(name);
      if (scene.joints && state.get('joints').length !== scene.joints.own.length) state.values.joints = scene.joints.rest;
      stage?.show(scene);
      sliders.show(scene.joints);
      panel.show(scene);
      pairs.show(scene);
      editor.show(scene);
      const { body } = sceneList.describe(state.get('scene'));
      tellAbout = () => (byId('about').textContent = [
        ...(body === manifest.title ? [] : [body]),
        counted(scene.motionEntry.facets, 'facet'),
        counted(scene.sphereCount, 'sphere'),
        scene.joints ? counted(scene.joints.own.length, 'joint') : `rule ${scene.entry.rule}`,
      ].join(' · '));
      tellAbout();
    }
    if (!scene) return;
    if (has('edits')) {
      pairs.reset();
      tellAbout();
    }
    if (scene.joints && has('scene', 'joints', 'edits')) {
      scene.pose(state.get('joints'));
      changed.add('frame');
      pairs.draw();
      panel.meeting = scene.meeting();
      sliders.follow(panel.meeting);
      stage?.surround(scene.bounds());
    }
    if (stage) {
      if (has('scene', 'frame')) stage.body.pose(state.get('frame'));
      if (has('scene', 'frame', 'level', 'uncovered')) stage.body.compare(state.get('frame'), state.get('level'), state.get('uncovered') && !scene.entry.inside);
      if (has('scene', 'frame', 'level', 'color')) stage.spheres.pose(state.get('frame'), state.get('level'), coloring(scene, state));
      if (has('scene', 'picked')) stage.spheres.mark(state.get('picked'));
      if (has('scene', 'frame')) stage.contacts.pose(scene.contacts?.[state.get('frame')], 0.02 * stage.frameOfBox()[1]);
      if (has('scene', 'frame')) stage.patches.pose(scene.patches?.[state.get('frame')], scene.motion.facets, scene.positions(state.get('frame')));
      if (has('patches')) stage.patches.group.visible = state.get('patches');
      if (has('contacts')) stage.contacts.group.visible = state.get('contacts');
      if (has('body')) stage.body.group.visible = state.get('body');
      if (has('facets')) stage.body.facets(state.get('facets'));
      if (has('scene', 'sectionAxis', 'sectionAt', 'sectionFlip')) stage.cut(state.get('sectionAxis'), state.get('sectionAt'), state.get('sectionFlip'));
      if (has('scene', 'spheres', 'opacity', 'sectionAxis')) stage.spheres.look(state.get('spheres'), state.get('opacity'));
      stage.ask();
    }
    if (has('scene', 'frame', 'picked')) drawPicked(scene, state);
    if (has('scene', 'joints', 'edits', 'picked', 'uncovered')) editor.follow();
    panel.follow(changed);
    remember();
  });

  // The address follows what is shown, a moment later: browsers allow so many changes and no more.
  let waiting = 0;
  function remember() {
    if (!begun) return;
    clearTimeout(waiting);
    if (state.get('playing')) return;
    waiting = setTimeout(() => {
      const hash = writeAddress(state.values, begun, stage?.turned ? stage.look() : '');
      if (hash === '' && !location.hash.includes('=')) return; // a link into a report stays
      history.replaceState(null, '', hash || location.pathname + location.search);
    }, 250);
  }
  function goTo(hash) {
    const wanted = readAddress(hash);
    if (!wanted) return;
    const { scene: index = state.get('scene'), ...rest } = wanted.values;
    if (index < manifest.scenes.length) state.set({ scene: Math.max(0, index) });
    for (const [name, most] of [['frame', scene.frameCount], ['level', scene.levelCount], ['picked', scene.nodeCount]]) {
      if (rest[name] >= most) rest[name] = most - 1;
    }
    if (rest.color === 'empty' && scene.emptyShare === null) delete rest.color;
    if (rest.joints?.length !== scene.joints?.own.length) delete rest.joints;
    else if (rest.joints) rest.joints = rest.joints.map((value, k) => scene.joints.within(k, value));
    state.set(rest);
    if (wanted.camera) stage?.lookAs(wanted.camera);
  }
  addEventListener('hashchange', () => goTo(location.hash));

  if (stage) {
    stage.onpick = (node) => state.set({ picked: node });
    stage.onlook = remember;
    stage.grip = { sphere: () => editor.grabbed(), move: (sphere) => editor.dragged(sphere), end: () => editor.edits.seal() };
  }
  const play = () => state.set({ playing: !state.get('playing') });
  const ups = { y: 'z', z: 'x', x: 'y' };
  bindKeys(state, {
    play,
    theme: toggleTheme,
    editor,
    fit: () => stage?.fit(),
    turnUp: () => stage?.fit(ups[stage.up]),
    hasColor: (color) => (color !== 'empty' || scene.emptyShare !== null) && (color !== 'growth' || scene.joints === null),
    step: (name, by) => {
      const most = (name === 'frame' ? scene.frameCount : scene.levelCount) - 1;
      state.set({ [name]: Math.min(Math.max(state.get(name) + by, 0), most), ...(name === 'frame' ? { playing: false } : {}) });
    },
  });
  byId('fit')?.addEventListener('click', () => stage.fit());

  const name = fileName(manifest.title);
  const swingFrames = () => 3 * framesPerSecond * scene.joints.own.length;
  const save = (id, how) => {
    const button = byId(id);
    button.disabled = !stage;
    button.addEventListener('click', async () => {
      const label = button.textContent;
      button.disabled = true;
      state.set({ playing: false });
      try {
        await how((text) => (button.textContent = text));
      } catch (error) {
        console.warn(error);
        button.title = `Not saved: ${error.message}`;
      }
      button.textContent = label;
      button.disabled = false;
    });
  };
  save('save-png', () => savePicture(stage, name));
  save('save-webm', async (tell) => {
    const before = { frame: state.get('frame'), joints: state.get('joints') };
    const count = scene.joints ? swingFrames() : scene.frameCount;
    const show = scene.joints ? (frame) => state.set({ joints: scene.joints.swing(before.joints, frame / (count - 1)) }) : (frame) => state.set({ frame });
    try {
      await saveFilm(stage, name, count, framesPerSecond, show, (frame) => tell(`${frame + 1} / ${count}`));
    } finally {
      state.set(before);
    }
  });
  save('save-gltf', () =>
    saveModel(scene, state.get('frame'), scene.levelSets[state.get('level')], coloring(scene, state), name));
  byId('save-webm').hidden = !canFilm();

  let lastStep = 0;
  let swung = 0; // frames since a robot began to swing
  let swungFrom = [];
  const tick = (now) => {
    if (!state.get('playing')) return;
    if (now - lastStep >= 1000 / framesPerSecond) {
      lastStep = now;
      if (scene.joints) state.set({ joints: scene.joints.swing(swungFrom, (++swung % swingFrames()) / swingFrames()) });
      else state.set({ frame: (state.get('frame') + 1) % scene.frameCount });
    }
    requestAnimationFrame(tick);
  };
  state.listen((changed) => {
    if (changed.has('playing')) sliders.playing(state.get('playing'));
    if (!changed.has('playing') || !state.get('playing')) return;
    [swung, swungFrom] = [0, state.get('joints')];
    if (scene.joints ? scene.joints.own.length === 0 : scene.frameCount < 2) state.set({ playing: false });
    else requestAnimationFrame(tick);
  });

  if (hasReport) report = new Report(manifest.study, sceneList, state);
  stage?.theme();
  state.set({ scene: 0 });
  begun = { ...state.values };
  goTo(location.hash);
  // A body that moves is shown moving, unless the address says what to show, or the reader wants no motion.
  const moves = scene.joints === null && scene.frameCount > 1;
  if (moves && location.hash === '' && !matchMedia('(prefers-reduced-motion: reduce)').matches) play();
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
