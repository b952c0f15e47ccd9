// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The choices of the page, and the values that its address keeps.

export const shapes = [
  ['limb', 'Limb'], ['hand', 'Hand'], ['torus', 'Torus'], ['bar', 'Bar'], ['capsule', 'Capsule'], ['blob', 'Blob'], ['vessel', 'Vessel'], ['two', 'Two parts'],
];
export const methods = [
  ['optimized', 'Optimized'], ['octree', 'Octree'], ['grid', 'Grid'], ['hubbard', 'Hubbard'], ['spawn', 'Spawning'], ['medial', 'Medial axis'], ['combined', 'Combined'],
];
export const qualities = [['draft', 'Draft'], ['fast', 'Fast'], ['default', 'Default'], ['best', 'Best']];
export const depths = [['auto', 'Automatic'], ...[1, 2, 3, 4, 5].map((depth) => [String(depth), String(depth)])];
export const details = [['1500', '1.5k', 'About 1,500 facets'], ['5000', '5k', 'About 5,000 facets'], ['20000', '20k', 'About 20,000 facets']];
export const rules = [
  ['exact', 'Exact', 'Every sphere encloses its part of the surface: the figures say whether it is proven'],
  ['approach2', 'Approach 2', 'The paper: a sphere follows the box of its vertices'],
  ['approach1', 'Approach 1', 'The paper: a sphere follows the mean of its vertices, and grows with the farthest'],
  ['traditional', 'Traditional', 'A sphere follows the vertices that it enclosed at rest'],
  ['skinned', 'Skinned', 'Spheres follow the bones, and no vertex is read: covers as long as only the bones move the body'],
  ['rest', 'Not updated', 'Spheres stay where they were at rest'],
];
export const coverRules = ['exact', 'skinned'];
export const touches = [['none', 'Nothing'], ['tool', 'Tool'], ['body', 'Second body']];

const names = (list) => list.map(([value]) => value);
export const kinds = {
  tour: 'count',
  shape: names(shapes), detail: names(details), method: names(methods), quality: names(qualities), depth: names(depths), flat: 'count',
  bend: 'number', twist: 'number', stretch: 'number', rule: names(rules), beside: 'flag',
  level: 'count', color: ['level', 'branch'], opacity: 'share', body: 'flag', spheres: 'flag', uncovered: 'flag', facets: 'flag',
  touch: names(touches), place: 'list',
};

export const beginning = {
  tour: 0,
  shape: 'limb', detail: '5000', method: 'optimized', quality: 'fast', depth: 'auto', flat: 0,
  bend: 60, twist: 0, stretch: 1, rule: 'exact', beside: false,
  level: 2, color: 'branch', opacity: 0.5, body: true, spheres: true, uncovered: true, facets: false,
  touch: 'none', place: [0, 0, 0], playing: false,
};

/** Values of an address that the page can use: numbers within what its controls can set. */
export function within(values) {
  const clamp = (name, low, high) => (values[name] === undefined ? {} : { [name]: Math.min(high, Math.max(low, values[name])) });
  return {
    ...values,
    ...clamp('bend', -180, 180), ...clamp('twist', -360, 360), ...clamp('stretch', 0.5, 2), ...clamp('level', 0, 8), ...clamp('flat', 0, 2000), ...clamp('tour', 0, 5),
    ...(values.opacity === undefined ? {} : { opacity: Math.max(0.05, values.opacity) }),
    ...(values.place ? { place: values.place.length === 3 ? values.place.map((x) => Math.min(10, Math.max(-10, x))) : [0, 0, 0] } : {}),
  };
}
