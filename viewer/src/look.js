// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The look of a curve, as the study gives it: color, dashes, marker, hatch. The files of the figures have the same.
import { css, kindColor } from './colors.js';
import { drawn, element, styleValue } from './dom.js';

/** Outlines of markers in units of their size; cross and plus are strokes. */
const shapes = {
  circle: [],
  square: [[-0.8, -0.8], [0.8, -0.8], [0.8, 0.8], [-0.8, 0.8]],
  triangle: [[0, -1.15], [1, 0.75], [-1, 0.75]],
  diamond: [[0, -1.2], [1.05, 0], [0, 1.2], [-1.05, 0]],
  down: [[0, 1.15], [1, -0.75], [-1, -0.75]],
  pentagon: [[0, -1.1], [1.05, -0.34], [0.65, 0.9], [-0.65, 0.9], [-1.05, -0.34]],
};
const strokes = {
  cross: [[[-0.8, -0.8], [0.8, 0.8]], [[-0.8, 0.8], [0.8, -0.8]]],
  plus: [[[-1.05, 0], [1.05, 0]], [[0, -1.05], [0, 1.05]]],
};

/** An SVG path of a marker around (x, y). */
export function markerPath(marker, x, y, r) {
  const point = ([dx, dy]) => `${x + dx * r} ${y + dy * r}`;
  if (strokes[marker]) return strokes[marker].map(([a, b]) => `M${point(a)}L${point(b)}`).join('');
  const corners = shapes[marker] ?? shapes.circle;
  if (corners.length === 0) return `M${x + 0.9 * r} ${y}a${0.9 * r} ${0.9 * r} 0 1 0 ${-1.8 * r} 0a${0.9 * r} ${0.9 * r} 0 1 0 ${1.8 * r} 0z`;
  return `M${corners.map(point).join('L')}z`;
}
export const isStroked = (marker) => marker in strokes;

/** The looks of a figure's series in the present theme; for a study without them, colors by order. */
export function looks(series) {
  const dark = document.documentElement.dataset.theme === 'dark';
  return series.map((s, k) => {
    const { light, dark: other, dash, marker, strong, hollow, dots } = s.style ?? {};
    const given = dark ? other : light;
    const plain = s.role === 'reference' ? styleValue('--muted') : css(kindColor(k));
    return {
      color: /^#[0-9a-f]{6}$/i.test(given) ? given : plain,
      dash: Array.isArray(dash) ? dash.filter(Number.isFinite) : s.role === 'reference' ? [6, 4] : [],
      marker: marker in shapes || marker in strokes ? marker : null,
      strong: s.style ? strong === true : undefined,
      hollow: hollow === true,
      dots: dots === true,
      hatched: Array.isArray(s.uncovered) ? s.uncovered : [],
    };
  });
}

/** A short line with its marker, for legends. */
export function swatch(look, hatched = false) {
  const svg = drawn('svg', { viewBox: '0 0 30 12', width: 30, height: 12, 'aria-hidden': 'true', class: 'swatch' });
  if (hatched) for (let x = 4; x < 28; x += 5) svg.append(drawn('path', { d: `M${x} 4l-3 7`, stroke: look.color, fill: 'none' }));
  if (!look.dots) {
    svg.append(drawn('path', { d: `M0 ${hatched ? 4 : 6}H28`, stroke: look.color, 'stroke-width': look.strong === false ? 1.4 : 2.2, 'stroke-dasharray': look.dash.join(' '), fill: 'none' }));
  }
  if (look.marker) {
    const stroked = isStroked(look.marker);
    svg.append(drawn('path', {
      d: markerPath(look.marker, look.dots ? 15 : 25, 6, 4),
      fill: stroked ? 'none' : look.hollow ? 'var(--panel)' : look.color,
      stroke: stroked || look.hollow ? look.color : 'none', 'stroke-width': stroked ? 2 : 1.3,
    }));
  }
  return svg;
}

/** The names of the series of several figures, each once, and the meaning of the hatch where there is one. */
export function legend(figures) {
  const place = element('p', { class: 'kinds' });
  const fill = () => {
    const seen = new Map();
    for (const series of figures) {
      const its = looks(series);
      series.forEach((s, k) => seen.has(s.name) || seen.set(s.name, its[k]));
    }
    const hatched = figures.some((series) => series.some((s) => Array.isArray(s.uncovered) && s.uncovered.includes(true)));
    place.replaceChildren(
      ...[...seen].map(([name, look]) => element('span', { class: 'kind' }, swatch(look), name)),
      ...(hatched ? [element('span', { class: 'kind muted' }, swatch({ color: styleValue('--muted'), dash: [], marker: null }, true), 'surface uncovered')] : []),
    );
  };
  fill();
  return { place, fill };
}
