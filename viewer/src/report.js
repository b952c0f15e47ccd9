// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A study: its claims with their verdicts, then figures, tables and pictures; curves over frames follow the body's.
import { Curves } from './curves.js';
import { byId, element } from './dom.js';
import { legend, looks } from './look.js';
import { counted, figure } from './numbers.js';

/** For the reader: where a claim to the bad of a rule fails, that is better than claimed. */
const verdictOf = (claim) => (claim.adverse && claim.verdict === 'fails' ? 'better' : String(claim.verdict));
const order = ['holds', 'better', 'partly', 'fails'];
const list = (value) => (Array.isArray(value) ? value : []);
const labeled = ({ label = '', unit = '' } = {}) => (unit ? `${label} (${unit})` : label);

/** The first sentences of a text. */
const sentences = (text, most) => String(text ?? '').split(/(?<=[.!?])\s+(?=[A-Z])/).slice(0, most).join(' ');

/** "in 14 of 18": the verdicts of single bodies and seeds, where the study has them. */
function spread({ counts, trials }) {
  const told = list(trials).reduce((sum, { verdict }) => ({ ...sum, [verdict]: (sum[verdict] ?? 0) + 1 }), {});
  const count = list(trials).length > 0 ? told : counts && typeof counts === 'object' ? counts : {};
  const known = Object.entries(count).filter(([word, n]) => word !== 'trials' && Number.isFinite(n) && n > 0);
  const total = known.reduce((sum, [, n]) => sum + n, 0);
  return total > 1 ? known.map(([verdict, n]) => `${verdict} in ${n} of ${total}`).join(', ') : null;
}

/** Drawings come as text and are shown as images: whatever is in them, it runs nothing and loads nothing. */
function drawing({ svg, title }) {
  const image = element('img', { src: `data:image/svg+xml,${encodeURIComponent(svg)}`, alt: title });
  image.addEventListener('error', () => image.replaceWith(element('p', { class: 'muted' }, 'this picture cannot be read')));
  return image;
}

export class Report {
  constructor(study, sceneList, state) {
    Object.assign(this, { study, sceneList, state, curves: [], legends: [] });
    const place = byId('report');
    place.hidden = false;
    const lead = this.lead();
    const sections = [...this.claims(), ...this.figures(), ...this.pictures(), ...this.tables(), this.settings()];
    place.replaceChildren(...lead, this.contents(sections), ...sections);
    addEventListener('hashchange', () => this.reveal());
    this.reveal();
    state.listen((changed) => {
      if (!changed.has('frame') && !changed.has('scene')) return;
      for (const { curves, spec } of this.curves) {
        if (!spec.frame_axis) continue;
        curves.hidden = !this.matches(spec);
        curves.moveTo(state.get('frame'));
      }
    });
  }

  /** Whether the body shown is in the motion that the figure is about. */
  matches(spec) {
    const its = this.sceneList.describe(this.state.get('scene'));
    return (!spec.motion || its.motion.includes(spec.motion)) && (!spec.body || its.body === spec.body);
  }
  /** Shows frame `frame` of the body and motion that a figure is about. */
  go(spec, frame) {
    let scene = this.state.get('scene');
    if (!this.matches(spec)) {
      const all = this.sceneList.manifest.scenes.map((_, index) => index);
      const rule = this.sceneList.describe(scene).rule;
      const fits = (index) => {
        const its = this.sceneList.describe(index);
        return (!spec.motion || its.motion.includes(spec.motion)) && (!spec.body || its.body === spec.body);
      };
      scene = all.find((index) => fits(index) && this.sceneList.describe(index).rule === rule) ?? all.find(fits) ?? scene;
    }
    const frames = this.sceneList.motionEntry(scene).frames.length;
    this.state.set({ scene, frame: Math.min(frame, frames - 1), playing: false });
  }

  section(id, title, ...children) {
    return element('section', { id, 'data-title': title }, element('h2', {}, title), ...children);
  }
  folded(id, title, ...children) {
    return element('section', { id, 'data-title': title }, element('details', {}, element('summary', {}, element('h2', {}, title)), ...children));
  }
  contents(sections) {
    return element('nav', { id: 'contents', 'aria-label': 'Contents' },
      ...sections.map((section) => element('a', { href: `#${section.id}` }, section.dataset.title)));
  }
  /** Unfolds the section that the address names, and scrolls to it. */
  reveal() {
    const wanted = location.hash.includes('=') ? null : document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!wanted || !byId('report').contains(wanted)) return;
    if (wanted.localName === 'section') wanted.querySelector('details')?.setAttribute('open', '');
    for (let fold = wanted.closest('details'); fold; fold = fold.parentElement.closest('details')) fold.open = true;
    requestAnimationFrame(() => wanted.scrollIntoView({ block: 'start' }));
  }

  /** Curves of a figure in an element of that height. plain: without names of axes. */
  plot(spec, height, plain = false) {
    const place = element('div', { class: 'plot', style: `min-height:${height}px` });
    const curves = new Curves(place, height, (frame) => this.go(spec, frame));
    const content = () => {
      const its = looks(list(spec.series));
      return {
        series: list(spec.series).map((s, k) => ({ name: s.name, x: list(s.x), y: list(s.y), ...its[k] })),
        xLabel: plain ? undefined : labeled(spec.x), yLabel: plain ? undefined : labeled(spec.y),
        log: Boolean(spec.y?.log), frames: Boolean(spec.frame_axis), names: spec.x?.names,
      };
    };
    this.curves.push({ curves, spec, content });
    curves.content = content(); // drawn as soon as it has a width
    return place;
  }
  legend(...specs) {
    const made = legend(specs.map((spec) => list(spec.series)));
    this.legends.push(made);
    return made.place;
  }
  /** The words of a title before its colon, and those after it. */
  heading(spec, tag = 'h3') {
    const [head, ...rest] = String(spec.title).split(': ');
    return [element(tag, { class: 'one-line', title: spec.title }, head), rest.length ? element('p', { class: 'muted one-line' }, rest.join(': ')) : null];
  }

  /** The study in three sentences, Fig. 1, and Fig. 2 a to d. */
  lead() {
    const told = list(this.study.summary);
    const first = list(this.study.pictures).find(({ id }) => id === 'fig1');
    const specs = [/^fig2a$/, /^fig2b$/, /^fig2c-[^-]+$/, /^fig2d-[^-]+$/].map((id) => list(this.study.figures).find((spec) => id.test(spec.id)));
    const small = (spec) => element('article', { class: 'small' }, ...this.heading(spec), this.plot(spec, 132, true));
    const pairs = [specs.slice(0, 2), specs.slice(2)].map((pair) => pair.filter(Boolean)).filter((pair) => pair.length > 0);
    if (told.length === 0 && !first && pairs.length < 2) return [];
    return [
      element('section', { id: 'summary' },
        ...told.map((text) => element('p', { class: 'told' }, text)),
        first ? element('div', { class: 'drawing', id: 'fig1' }, drawing(first)) : null,
        pairs.length === 0 ? null : element('div', { class: 'pairs' },
          ...pairs.map((pair) => element('div', { class: 'pair' }, element('div', { class: 'smalls' }, ...pair.map(small)), this.legend(...pair))))),
    ];
  }

  claims() {
    const claims = list(this.study.claims);
    if (claims.length === 0) return [];
    const words = [...new Set([...order, ...claims.map(verdictOf)])];
    const count = words.map((word) => [word, claims.filter((claim) => verdictOf(claim) === word).length]).filter(([, n]) => n > 0);
    const groups = [['paper', 'Claims of the paper'], ['new', 'Claims of Morula']];
    return [
      this.section('claims', 'Claims',
        element('p', { class: 'tally' }, ...count.map(([word, n]) => element('span', { 'data-verdict': word }, `${word} `, element('b', {}, String(n))))),
        ...groups.flatMap(([source, title]) => {
          const its = claims.filter((claim) => (claim.source ?? 'new') === source);
          return its.length === 0 ? [] : [element('h4', {}, title), ...its.map((claim) => this.claim(claim))];
        })),
    ];
  }

  claim(claim) {
    const specs = list(claim.figures).map((id) => list(this.study.figures).find((spec) => spec.id === id)).filter(Boolean);
    const why = sentences(claim.why ?? claim.numbers, 2);
    const numbers = claim.numbers && claim.numbers !== why ? claim.numbers : null;
    const trials = list(claim.trials);
    const more = [
      numbers ? element('p', {}, numbers) : null,
      trials.length > 1 ? this.trials(trials) : null,
      specs.length > 1 ? element('p', { class: 'links' }, ...specs.slice(1).map((spec) => element('a', { href: `#figure-${spec.id}` }, spec.title))) : null,
    ].filter(Boolean);
    const text = [
      element('h3', {}, claim.claim),
      claim.place ? element('p', { class: 'place' }, claim.place) : null,
      spread(claim) ? element('p', { class: 'spread' }, spread(claim)) : null,
      why ? element('p', { class: 'why' }, why) : null,
      more.length ? element('details', { class: 'more' }, element('summary', {}, 'Numbers'), ...more) : null,
    ];
    return element('article', { class: 'claim', 'data-verdict': verdictOf(claim), id: `claim-${claim.id}` },
      element('div', { class: 'claim-text' }, element('span', { class: 'verdict' }, verdictOf(claim)), ...text),
      specs.length ? element('div', { class: 'claim-figure' }, ...this.heading(specs[0], 'h4'), this.legend(specs[0]), this.plot(specs[0], 150, true)) : null);
  }
  trials(trials) {
    const row = (trial) => element('tr', {},
      ...[trial.body, trial.seed, trial.verdict, Number.isFinite(trial.cases) ? `${trial.true ?? '–'} of ${trial.cases}` : '–', Number.isFinite(trial.value) ? figure(trial.value) : '–']
        .map((value) => element('td', {}, String(value ?? '–'))));
    return element('div', { class: 'wide' }, element('table', { class: 'figures' },
      element('thead', {}, element('tr', {}, ...['body', 'seed', 'verdict', 'cases', 'value'].map((name) => element('th', { scope: 'col' }, name)))),
      element('tbody', {}, ...trials.map(row))));
  }

  figures() {
    const specs = list(this.study.figures);
    if (specs.length === 0) return [];
    const cards = specs.map((spec) =>
      element('article', { class: 'figure', id: `figure-${spec.id}` },
        ...this.heading(spec), this.legend(spec), this.plot(spec, 230),
        spec.note ? element('p', { class: 'muted' }, spec.note) : null,
        spec.frame_axis ? element('p', { class: 'muted hint' }, 'Press or drag in the curves to pose the body.') : null));
    return [this.folded('study-figures', 'All figures', element('div', { class: 'cards' }, ...cards))];
  }

  tables() {
    const tables = list(this.study.tables).map((table) => {
      const numeric = list(table.columns).map((_, k) => list(table.rows).every((row) => typeof row[k] !== 'string'));
      const cell = (value, k) => element('td', { class: numeric[k] ? 'number' : null }, typeof value === 'number' ? figure(value) : (value ?? '–'));
      return element('details', { id: `table-${table.id}` }, element('summary', {}, element('h3', {}, table.title)),
        table.note ? element('p', { class: 'muted' }, table.note) : null,
        element('div', { class: 'wide' },
          element('table', { class: 'figures' },
            element('thead', {}, element('tr', {}, ...list(table.columns).map((name, k) => element('th', { scope: 'col', class: numeric[k] ? 'number' : null }, name)))),
            element('tbody', {}, ...list(table.rows).map((row) => element('tr', {}, ...row.map(cell)))))));
    });
    return tables.length === 0 ? [] : [this.section('tables', 'Tables', ...tables)];
  }

  pictures() {
    const pictures = list(this.study.pictures).filter(({ id }) => id !== 'fig1');
    if (pictures.length === 0) return [];
    return [
      this.section('pictures', 'Pictures',
        element('div', { class: 'cards' },
          ...pictures.map((picture) => element('article', { class: 'figure', id: `picture-${picture.id}` }, element('h3', {}, picture.title), element('div', { class: 'drawing' }, drawing(picture)))))),
    ];
  }

  settings() {
    const bodies = list(this.study.bodies).map((body) =>
      element('li', {}, `${body.name}: ${counted(body.vertices, 'vertex', 'vertices')}, ${counted(body.facets, 'facet')}, volume ${figure(body.volume)}`));
    return this.folded('settings', 'Settings',
      bodies.length ? element('ul', {}, ...bodies) : null,
      element('pre', {}, JSON.stringify(this.study.settings ?? {}, null, 2)));
  }

  retheme() {
    for (const { curves, content } of this.curves) curves.draw(content());
    for (const { fill } of this.legends) fill();
  }
}
