// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The view in the page's address: '#frame=3&level=1&color=growth&camera=…'. A copied address shows the same view.
// Only values that the reader changed are there. Links to places of a report have no '=' and are left alone.
const kindsOfView = {
  scene: 'count', frame: 'count', level: 'count', picked: 'count',
  color: ['level', 'branch', 'empty', 'growth'],
  measure: ['looseness', 'uncovered_area', 'uncovered_distance', 'growth'],
  body: 'flag', spheres: 'flag', uncovered: 'flag', facets: 'flag', contacts: 'flag', patches: 'flag',
  opacity: 'share', sectionAxis: ['', 'x', 'y', 'z'], sectionAt: 'share', sectionFlip: 'flag',
  joints: 'list',
};

function read(kind, text) {
  if (Array.isArray(kind)) return kind.includes(text) ? text : undefined;
  if (kind === 'flag') return text === '1' ? true : text === '0' ? false : undefined;
  if (kind === 'list') {
    const numbers = text.split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
    return numbers.every(Number.isFinite) ? numbers : undefined;
  }
  const value = text.trim() === '' ? NaN : Number(text);
  if (kind === 'count') return Number.isInteger(value) && value >= 0 && value < 2 ** 31 ? value : undefined;
  if (kind === 'number') return Math.abs(value) <= 1e6 ? value : undefined;
  return value >= 0 && value <= 1 ? value : undefined;
}
const brief = (value, digits) => String(Number(value.toFixed(digits)));
const written = (kind, value) =>
  kind === 'flag' ? (value ? '1' : '0') : kind === 'share' || kind === 'number' ? brief(value, 3) : kind === 'list' ? value.map((x) => brief(x, 4)).join(',') : String(value);

/** {values: of the state, camera: text or null}; null when the address has neither. Unknown names are skipped. kinds: of each value
 * 'count', 'flag', 'share' of 1, 'number', 'list' of numbers, or the texts that it may be. */
export function readAddress(hash, kinds = kindsOfView) {
  if (!hash.includes('=')) return null;
  const parameters = new URLSearchParams(hash.replace(/^#/, ''));
  const values = {};
  for (const [name, kind] of Object.entries(kinds)) {
    const value = parameters.has(name) ? read(kind, parameters.get(name)) : undefined;
    if (value !== undefined) values[name] = value;
  }
  return { values, camera: parameters.get('camera') };
}

/** values, first: the current state and the state at the page's start. camera: '' when it was not moved. */
export function writeAddress(values, first, camera, kinds = kindsOfView) {
  const parameters = Object.entries(kinds)
    .filter(([name, kind]) => values[name] !== undefined && (first[name] === undefined || written(kind, values[name]) !== written(kind, first[name])) && !(name === 'picked' && values[name] < 0))
    .map(([name, kind]) => `${name}=${written(kind, values[name])}`);
  if (camera) parameters.push(`camera=${camera}`);
  return parameters.length === 0 ? '' : `#${parameters.join('&')}`;
}
