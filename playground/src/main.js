// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Starts the page: controls first, then the worker with the module, then the body that the address names.
import './style.css';
import { load } from 'morula';
import { PageError } from '../../viewer/src/decode.js';
import { byId, element } from '../../viewer/src/dom.js';
import { readAddress, writeAddress } from '../../viewer/src/address.js';
import { State } from '../../viewer/src/state.js';
import { bindTheme } from '../../viewer/src/theme.js';
import { Builder } from './builder.js';
import { beginning, kinds, shapes, within } from './choices.js';
import { readCharacter } from './character.js';
import { Deformer } from './deform.js';
import { bindKeys } from './keys.js';
import { checkFile, endingOf, InputError } from './limits.js';
import { Figures } from './live.js';
import { Panel } from './panel.js';
import { saveMesh, saveTree } from './save.js';
import { PlayStage } from './stage.js';
import { bindTour, stepValues } from './tour.js';
import { World } from './world.js';

const treeNames = ['method', 'quality', 'depth', 'flat'];
const meshNames = ['shape', 'detail'];
const poseNames = ['bend', 'twist', 'stretch'];

function fail(error) {
  document.getElementById('main')?.remove();
  document.body.append(
    element('div', { id: 'failure', role: 'alert' },
      element('h1', {}, 'This page cannot run here'),
      element('p', {}, `${error.message}.`),
      element('p', { class: 'muted' }, 'It needs WebGL and WebAssembly: a browser of 2023 or later has both.')),
  );
}

class Playground {
  constructor() {
    const wanted = readAddress(location.hash, kinds);
    this.state = new State({ ...beginning, ...this.valuesOf(wanted) });
    this.panel = new Panel(this.state);
    this.goStep = bindTour(this.state);
    this.stage = new PlayStage(byId('stage'));
    this.camera = wanted?.camera ?? null;
    this.file = null; // that the reader opened: {name, blob} or {name, character}
    this.world = new World(this.state, this.stage, () => this.figures.ask());
    this.figures = new Figures(this.world, this.state, this.panel);
    this.stage.grasp = (ray) => this.world.grasp(ray);
    this.stage.onlook = () => this.remember();
    this.toggleTheme = bindTheme(() => this.stage.theme());
    this.stage.theme();
    this.stage.showTwin(this.state.get('beside'));
    this.state.listen((changed) => this.follow(changed));
    addEventListener('hashchange', () => this.goTo(location.hash));
    this.bindButtons();
    this.bindFiles();
  }

  /** The values of an address: those of a step of the tour, and over them single ones. */
  valuesOf(wanted) {
    const values = within(wanted?.values ?? {});
    return { ...stepValues(values.tour ?? 0), ...values };
  }
  goTo(hash) {
    const wanted = readAddress(hash, kinds);
    if (!wanted) return;
    const values = { ...beginning, ...this.valuesOf(wanted) };
    if (values.rule === 'skinned' && !this.world.character?.followsBones) values.rule = 'exact';
    this.state.set(values);
    if (wanted.camera) this.stage.lookAs(wanted.camera);
  }
  remember() {
    clearTimeout(this.remembering);
    this.remembering = setTimeout(() => {
      const step = this.state.get('tour');
      const first = { ...beginning, ...stepValues(step), tour: 0 };
      const hash = writeAddress(this.state.values, first, this.stage.turned ? this.stage.look() : '', kinds);
      history.replaceState(null, '', hash || location.pathname + location.search);
    }, 250);
  }

  /** The module, compressed, in the page: the worker unpacks it. */
  begin() {
    const text = (id) => {
      const content = byId(id).textContent;
      byId(id).remove();
      return content;
    };
    this.builder = new Builder(text('worker-source'), text('module-packed'), async (module) => {
      try {
        this.world.morula = await load({ source: module });
        await this.rebuild();
        document.body.dataset.ready = 'true';
      } catch (error) {
        fail(error);
      }
    }, fail);
  }

  follow(changed) {
    const has = (names) => names.some((name) => changed.has(name));
    if (!this.isGoingBack) {
      if (has(meshNames)) this.takeSample();
      if (has(meshNames) || has(treeNames)) this.rebuild();
    }
    this.stage.showTwin(this.state.get('beside'));
    if (!this.world.model) return;
    if (changed.has('level')) this.panel.level(this.world.model);
    if (changed.has('touch')) this.touch();
    if (changed.has('place')) this.world.movedOther();
    this.press();
    this.remember();
    this.world.ask(has(poseNames) || changed.has('playing'));
  }

  options() {
    const { method, quality, depth, flat } = this.state.values;
    return { method, ...(method === 'optimized' ? { quality } : {}), ...(flat > 0 ? { spheres: flat } : depth === 'auto' ? {} : { depth: Number(depth) }) };
  }
  source() {
    const { file } = this;
    if (file?.character) return { mesh: { positions: file.character.rest, facets: file.character.facets } };
    if (file) return { file: { name: file.name, blob: file.blob } };
    return { shape: this.state.get('shape'), detail: Number(this.state.get('detail')) };
  }

  takeSample() {
    this.file = null;
    this.opens = (this.opens ?? 0) + 1; // a file that is still read comes too late
  }
  /** To mesh and choices of the tree that is shown, after a build that failed or was canceled. */
  goBack() {
    if (!this.world.model) return;
    this.file = this.shownFile;
    this.isGoingBack = true;
    this.state.set(this.shownValues);
    this.isGoingBack = false;
    this.showSample();
  }
  showSample() {
    byId('shape').value = this.shownFile ? '' : this.state.get('shape');
  }

  /** Builds the tree of the present mesh; the one before stays until then, and where the build fails or is canceled. */
  async rebuild() {
    if (!this.world.morula) return;
    const { panel, world } = this;
    const file = this.file;
    const values = Object.fromEntries([...meshNames, ...treeNames].map((name) => [name, this.state.get(name)]));
    this.building = true;
    document.body.dataset.building = 'true';
    panel.message('');
    panel.status('Building the tree', 0, world.model !== null);
    const mine = (this.builds = (this.builds ?? 0) + 1);
    try {
      const made = await this.builder.build(this.source(), this.options(), (share) => panel.status('Building the tree', share, world.model !== null));
      if (mine !== this.builds) return;
      if (made) this.adopt(made, file, values);
      else this.goBack();
    } catch (error) {
      if (mine !== this.builds) return;
      panel.message(`${file ? `${file.name}: ` : ''}${error.message}`);
      this.goBack();
    }
    this.building = false;
    if (world.model && this.touched !== this.state.get('touch')) this.touch();
    document.body.dataset.building = 'false';
    panel.status('');
    document.body.dataset.builds = String(mine);
  }

  adopt(made, file, values) {
    const { world, panel, stage } = this;
    const character = file?.moves ? file.character : null;
    if (!character?.followsBones && this.state.get('rule') === 'skinned') this.state.set({ rule: 'exact' });
    const isSame = world.made && world.made.positions.length === made.positions.length && world.made.positions.every((x, i) => x === made.positions[i]);
    world.adopt(made, character);
    this.shownFile = file;
    this.shownValues = values;
    this.touched = 'none';
    this.showSample();
    const shape = shapes.find(([value]) => value === this.state.get('shape'));
    panel.show(world.model, made, world.character, file ? file.name : shape[1], (stretch) => world.deformer.bendLimit(stretch));
    if (!isSame) stage.fit();
    if (this.camera) stage.lookAs(this.camera);
    this.camera = null;
    this.figures.restart();
  }

  /** The tool, built on first use, or the body's own tree once more; after the build of a body, if there is one. */
  async touch() {
    if (this.building) return;
    const { world, state } = this;
    const kind = state.get('touch');
    const mine = (this.touches = (this.touches ?? 0) + 1);
    if (kind === 'none') {
      world.dropOther();
      world.ask();
    } else {
      const made = kind === 'body' ? world.made : await this.tool();
      if (mine !== this.touches || this.building) return;
      if (!made) {
        state.set({ touch: 'none' });
        return;
      }
      world.touchWith(made, kind);
    }
    this.touched = kind;
    this.stage.surround(world.box());
    if (!this.stage.turned) {
      if (kind === 'none') this.stage.fit();
      else this.stage.widen();
    }
    this.press();
    this.figures.ask();
  }
  async tool() {
    const size = 0.5 * this.world.size;
    const press = this.world.axisOfPress();
    if (this.madeTool?.size === size && this.madeTool.press === press) return this.madeTool.made;
    const trial = this.world.morula.Mesh.sample('tool', 16);
    const positions = trial.positions.slice();
    const facets = trial.facets.slice();
    trial.free();
    const scale = size / new Deformer(positions).size;
    // Upright, with the tip down.
    const along = new Deformer(positions).along;
    for (let i = 0; i < positions.length; i += 3) {
      for (let k = 0; k < 3; ++k) positions[i + k] *= scale;
      if (along !== press) [positions[i + along], positions[i + press]] = [positions[i + press], -positions[i + along]];
    }
    let made = null;
    try {
      made = await this.builder.build({ mesh: { positions, facets } }, { quality: 'draft' }, () => {});
    } catch (error) {
      this.panel.message(`The tool: ${error.message}`);
    }
    if (made) this.madeTool = { size, press, made };
    return made;
  }
  press() {
    const range = byId('press');
    const value = -(this.state.get('place')[this.world.pressAxis ?? 1] ?? 0);
    range.value = String(value);
    range.style.setProperty('--share', String((Math.max(-1, Math.min(1, value)) + 1) / 2));
  }

  bindButtons() {
    const { state, stage, panel, world } = this;
    const level = (by) => world.model && state.set({ level: Math.max(0, Math.min(world.model.levelCount - 1, world.level() + by)) });
    const fit = () => {
      if (world.model) stage.surround(world.box());
      stage.fit();
      this.remember();
    };
    const cancel = () => {
      panel.message('');
      if (world.model) this.builder.cancel();
    };
    const zoom = (by) => {
      stage.camera.position.sub(stage.controls.target).multiplyScalar(by).add(stage.controls.target);
      stage.controls.update();
      stage.ask();
    };
    byId('fit').addEventListener('click', fit);
    byId('cancel').addEventListener('click', cancel);
    byId('message-close').addEventListener('click', () => panel.message(''));
    byId('press').addEventListener('input', () => state.set({ place: state.get('place').map((x, k) => (k === world.pressAxis ? -byId('press').valueAsNumber : x)) }));
    byId('clip').addEventListener('change', () => {
      world.character.play(Number(byId('clip').value));
      world.time = 0;
      world.ask();
    });
    byId('save-mesh').addEventListener('click', () => world.model && saveMesh(world.model.rest, world.model.facets, 'body.obj'));
    byId('save-tree').addEventListener('click', () => world.model && saveTree(world.model.tree, 'body.morula'));
    byId('save-pose').addEventListener('click', () => world.model && saveMesh(world.soft ? world.soft.x : world.goal, world.model.facets, 'pose.obj'));
    byId('share-button').addEventListener('click', () => this.share());
    bindKeys(state, {
      level, fit, cancel, zoom, theme: this.toggleTheme, hasSkin: () => Boolean(world.character?.followsBones),
      poke: () => world.poke(stage.middleRay()), open: () => byId('file').click(),
      orbit: (x, y) => stage.orbit(0.12 * x, 0.12 * y),
      moveOther: (x, y) => {
        const [right, up] = [0, 1].map((column) => stage.camera.matrixWorld.elements.slice(4 * column, 4 * column + 3));
        state.set({ place: state.get('place').map((at, k) => at + 0.02 * (x * right[k] + y * up[k])) });
      },
      nextStep: () => this.goStep((state.get('tour') + 1) % 6),
    });
  }
  async share() {
    const button = byId('share-button');
    clearTimeout(this.remembering);
    this.remember();
    await new Promise((done) => setTimeout(done, 300));
    try {
      await navigator.clipboard.writeText(location.href);
      button.textContent = 'Copied';
    } catch {
      this.panel.message(`Copy this address: ${location.href}`);
    }
    setTimeout(() => (button.textContent = 'Copy link'), 2000);
  }

  bindFiles() {
    const stage = byId('stage');
    // The same sample as before the file: no value of the state changes.
    byId('shape').addEventListener('change', () => {
      if (!this.file) return;
      this.takeSample();
      this.rebuild();
    });
    byId('open').addEventListener('click', () => byId('file').click());
    byId('file').addEventListener('change', () => {
      const [file] = byId('file').files;
      if (file) this.open(file);
      byId('file').value = '';
    });
    const drop = (on) => (event) => {
      event.preventDefault();
      byId('drop').hidden = !on;
      if (event.type === 'drop' && event.dataTransfer.files.length > 0) this.open(event.dataTransfer.files[0]);
    };
    addEventListener('dragover', drop(true));
    addEventListener('dragleave', drop(false));
    addEventListener('drop', drop(false));
    stage.addEventListener('drop', (event) => event.preventDefault());
  }
  async open(file) {
    this.panel.message('');
    const mine = (this.opens = (this.opens ?? 0) + 1);
    try {
      checkFile(file);
      const isScene = endingOf(file.name) === 'glb';
      const character = isScene ? await readCharacter(file.name, await file.arrayBuffer()) : null;
      if (mine !== this.opens) return;
      const moves = character !== null && character.duration > 0;
      this.file = { name: file.name, character, moves, blob: isScene ? null : file };
      this.state.set({ tour: 0, ...(moves ? { playing: true } : {}) });
      await this.rebuild();
    } catch (error) {
      if (mine !== this.opens) return;
      this.panel.message(error instanceof InputError ? error.message : `${file.name} cannot be read: ${error.message}`);
    }
  }
}

addEventListener('DOMContentLoaded', () => {
  try {
    window.playground = new Playground(); // for a look from the console
    window.playground.begin();
  } catch (error) {
    if (!(error instanceof PageError)) console.warn(error);
    fail(error);
  }
});
