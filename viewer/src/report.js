// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A study: its claims with their verdicts, then figures, tables and pictures; curves over frames follow the body's.
import { Curves } from './curves.js';
import { byId, element } from './dom.js';
import { css, kindColor } from './colors.js';
import { counted, figure } from './numbers.js';

const verdicts = { holds: 'holds', better: 'better', partly: 'in part', fails: 'fails', 'not decided': 'not decided' };
/** For the reader: where a claim to the bad of a rule fails, that is better than claimed. */
const verdictOf = (claim) => (claim.adverse && claim.verdict === 'fails' ? 'better' : claim.verdict);
const tallies = { holds: ['holds', 'hold'], better: ['is better than claimed', 'are better than claimed'], partly: ['holds in part', 'hold in part'], fails: ['fails', 'fail'], 'not decided': ['is not decided', 'are not decided'] };
const little = matchMedia('(max-width: 900px)');
const longest = 40; // rows of a table that is not folded
const list = (value) => (Array.isArray(value) ? value : []);
const labeled = ({ label = '', unit = '' } = {}) => (unit ? `${label} (${unit})` : label);

/** Drawings come as text and are shown as images: whatever is in them, it runs nothing and loads nothing. */
function drawing({ svg, title }) {
  const image = element('img', { src: `data:image/svg+xml,${encodeURIComponent(svg)}`, alt: title });
  image.addEventListener('error', () => image.replaceWith(element('p', { class: 'muted' }, 'this picture cannot be read')));
  return image;
}

export class Report {
  constructor(study, sceneList, state) {
    Object.assign(this, { study, sceneList, state, curves: [] });
    const place = byId('report');
    place.hidden = false;
    const sections = [...this.claims(), ...this.figures(), ...this.tables(), ...this.pictures(), this.settings()];
    place.replaceChildren(this.contents(sections), ...sections);
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

  section(id, title, note, ...children) {
    return element('section', { id, 'data-title': title }, element('h2', {}, title), note ? element('p', { class: 'muted' }, note) : null, ...children);
  }
  /** The same, folded where there is little room; long: folded everywhere. */
  folded(id, title, note, long, ...children) {
    return element('section', { id, 'data-title': title },
      element('details', { open: !long && !little.matches },
        element('summary', {}, element('h2', {}, title)), note ? element('p', { class: 'muted' }, note) : null, ...children));
  }
  contents(sections) {
    return element('nav', { id: 'contents', 'aria-label': 'Contents' },
      ...sections.map((section) => element('a', { href: `#${section.id}` }, section.dataset.title)));
  }
  /** Unfolds the section that the address names, and scrolls to it. */
  reveal() {
    const wanted = location.hash.includes('=') ? null : document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!wanted || !byId('report').contains(wanted)) return;
    for (const fold of [wanted.querySelector('details'), wanted.closest('details')]) if (fold) fold.open = true;
    requestAnimationFrame(() => wanted.scrollIntoView({ block: 'start' }));
  }

  claims() {
    const claims = list(this.study.claims);
    if (claims.length === 0) return [];
    const count = Object.keys(verdicts)
      .map((verdict) => [verdict, claims.filter((claim) => verdictOf(claim) === verdict).length])
      .filter(([, n]) => n > 0);
    const figures = new Map(list(this.study.figures).map((spec) => [spec.id, spec.title]));
    const card = (claim) =>
      element('article', { class: 'claim', 'data-verdict': verdictOf(claim), id: `claim-${claim.id}` },
        element('span', { class: 'verdict' }, verdicts[verdictOf(claim)] ?? claim.verdict),
        element('div', {},
          element('h3', {}, claim.claim),
          claim.numbers ? element('p', {}, claim.numbers) : null,
          element('p', { class: 'links' },
            ...list(claim.figures).filter((id) => figures.has(id)).map((id) => element('a', { href: `#figure-${id}` }, figures.get(id))))));
    const trials = list(this.study.settings?.trials).length;
    const note = trials > 1 ? `${trials} trials, which are bodies × seeds. A claim holds if it holds in nine tenths of them.` : null;
    const groups = [['paper', 'Claims of the paper'], ['new', 'Claims of Morula']];
    return [
      this.section('claims', 'Claims', note,
        element('p', { class: 'tally' }, ...count.map(([verdict, n]) => element('span', { 'data-verdict': verdict }, element('b', {}, String(n)), ` ${tallies[verdict][n === 1 ? 0 : 1]}`))),
        ...groups.flatMap(([source, title]) => {
          const its = claims.filter((claim) => (claim.source ?? 'new') === source);
          return its.length === 0 ? [] : [element('h4', {}, title), ...its.map(card)];
        })),
    ];
  }

  figures() {
    const specs = list(this.study.figures);
    if (specs.length === 0) return [];
    const cards = specs.map((spec) => {
      const place = element('div', { class: 'plot' });
      const colors = list(spec.series).map((s, k) => (s.role === 'reference' ? 'var(--muted)' : css(kindColor(k))));
      const legend = element('p', { class: 'kinds' },
        ...list(spec.series).map((s, k) => element('span', { class: 'kind' }, element('i', { class: 'line', style: `background:${colors[k]}` }), s.name)));
      const card = element('article', { class: 'figure', id: `figure-${spec.id}` },
        element('h3', {}, spec.title), legend, place,
        spec.note ? element('p', { class: 'muted' }, spec.note) : null,
        spec.frame_axis ? element('p', { class: 'muted hint' }, 'Press or drag in the curves to pose the body.') : null);
      const curves = new Curves(place, 230, (frame) => this.go(spec, frame));
      const content = () => ({
        series: list(spec.series).map((s, k) => ({
          name: s.name, x: list(s.x), y: list(s.y), role: s.role,
          color: s.role === 'reference' ? getComputedStyle(document.documentElement).getPropertyValue('--muted').trim() : colors[k],
        })),
        xLabel: labeled(spec.x), yLabel: labeled(spec.y), log: Boolean(spec.y?.log), frames: Boolean(spec.frame_axis), names: spec.x?.names,
      });
      this.curves.push({ curves, spec, content });
      curves.content = content(); // drawn as soon as it has a width
      return card;
    });
    return [this.folded('study-figures', 'Figures', null, false, element('div', { class: 'cards' }, ...cards))];
  }

  tables() {
    return list(this.study.tables).map((table) => {
      const numeric = list(table.columns).map((_, k) => list(table.rows).every((row) => typeof row[k] !== 'string'));
      const cell = (value, k) => element('td', { class: numeric[k] ? 'number' : null }, typeof value === 'number' ? figure(value) : (value ?? '–'));
      return this.folded(`table-${table.id}`, table.title, table.note, list(table.rows).length > longest,
        element('div', { class: 'wide' },
          element('table', { class: 'figures' },
            element('thead', {}, element('tr', {}, ...list(table.columns).map((name, k) => element('th', { scope: 'col', class: numeric[k] ? 'number' : null }, name)))),
            element('tbody', {}, ...list(table.rows).map((row) => element('tr', {}, ...row.map(cell)))))));
    });
  }

  pictures() {
    const pictures = list(this.study.pictures);
    if (pictures.length === 0) return [];
    return [
      this.folded('pictures', 'Pictures', null, false,
        element('div', { class: 'cards' },
          ...pictures.map((picture) => element('article', { class: 'figure', id: `picture-${picture.id}` }, element('h3', {}, picture.title), element('div', { class: 'drawing' }, drawing(picture)))))),
    ];
  }

  settings() {
    const bodies = list(this.study.bodies).map((body) =>
      element('li', {}, `${body.name}: ${counted(body.vertices, 'vertex', 'vertices')}, ${counted(body.facets, 'facet')}, volume ${figure(body.volume)}`));
    return this.folded('settings', 'Settings', null, true,
      bodies.length ? element('ul', {}, ...bodies) : null,
      element('pre', {}, JSON.stringify(this.study.settings ?? {}, null, 2)));
  }

  retheme() {
    for (const { curves, content } of this.curves) curves.draw(content());
  }
}
