// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The numbers of the sphere that the reader pressed.
import { byId, drawn, element } from './dom.js';
import { figure, percent } from './numbers.js';

/** Its radius over the frames, as a small curve with a dot at this frame. */
function sparkline(scene, node, frame) {
  const radii = scene.frames.map((spheres) => spheres[4 * node + 3]);
  const low = Math.min(...radii);
  const span = Math.max(...radii) - low;
  const x = (i) => 4 + (192 * i) / Math.max(1, radii.length - 1);
  const y = (r) => (span > 0 ? 34 - (28 * (r - low)) / span : 20);
  const points = radii.map((r, i) => `${x(i).toFixed(1)},${y(r).toFixed(1)}`).join(' ');
  const place = element('div', { class: 'spark' },
    drawn('svg', { viewBox: '0 0 200 40', preserveAspectRatio: 'none', 'aria-hidden': 'true' }, drawn('polyline', { points })));
  place.append(element('i', { style: `left:${x(frame) / 2}%;top:${y(radii[frame]) / 0.4}%` }));
  return place;
}

export function drawPicked(scene, state) {
  const node = state.get('picked');
  const card = byId('picked');
  card.hidden = node < 0;
  if (node < 0) return;
  const frame = state.get('frame');
  const [x, y, z, r] = scene.frames[frame].subarray(4 * node, 4 * node + 4);
  const children = scene.entry.child_count[node];
  const go = (other) => state.set({ picked: other, level: Math.max(scene.levelOf[other], 0) });
  const row = (name, value, id) => element('div', { class: 'row' }, element('dt', {}, name), element('dd', { id }, value));
  const place = (value, k) => figure(value + scene.origin[k]);
  card.replaceChildren(
    element('header', {},
      element('strong', {}, `Sphere ${node}`),
      element('span', { class: 'muted' }, `level ${scene.levelOf[node]}${children === 0 ? ', leaf' : ''}`),
      element('button', { type: 'button', class: 'icon', 'aria-label': 'Close', onclick: () => state.set({ picked: -1 }) }, '×')),
    element('dl', {},
      row('Center', [place(x, 0), place(y, 1), place(z, 2)].join('  '), 'picked-center'),
      row('Radius', figure(r), 'picked-radius'),
      scene.joints ? row('Link', scene.joints.parts[scene.partOf[node]]?.name ?? 'all', 'picked-link') : null,
      scene.joints ? null : row('Radius at rest', figure(scene.rest[4 * node + 3])),
      scene.joints ? null : row('Growth', `× ${scene.growth(frame, node).toFixed(3)}`, 'picked-growth'),
      scene.emptyShare ? row('Outside the body', percent(scene.empty(frame, node))) : null),
    ...(scene.frameCount > 1 ? [element('div', { class: 'spark-line' }, element('span', { class: 'muted' }, 'radius over the frames'), sparkline(scene, node, frame))] : []),
    element('footer', {},
      element('button', { type: 'button', disabled: scene.parent[node] < 0, onclick: () => go(scene.parent[node]) }, scene.parent[node] < 0 ? 'Root' : `Parent ${scene.parent[node]}`),
      element('button', { type: 'button', disabled: children === 0, onclick: () => go(scene.firstChild[node]) },
        children === 0 ? 'No children' : children === 1 ? '1 child' : `${children} children`)),
  );
}
