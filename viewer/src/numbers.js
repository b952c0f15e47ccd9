// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Numbers for people: as toolbox/numbers.cpp writes them.

export function figure(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) return value.toExponential(1).replace('e+', 'e').replace('-', '\u2212');
  const text = size >= 1000 ? Math.round(value).toString() : String(Number(value.toPrecision(3)));
  return text.replace('-', '\u2212');
}
export function percent(share) {
  if (share === null || share === undefined || !Number.isFinite(share)) return '–';
  if (share === 0) return '0';
  return share < 1e-4 ? '< 0.01 %' : `${Number((100 * share).toPrecision(share < 0.1 ? 2 : 3))} %`;
}
export function counted(count, one, many = one + 's') {
  return `${count.toLocaleString('en')} ${count === 1 ? one : many}`;
}
