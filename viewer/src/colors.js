// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Colors: a perceptual map for quantities, and hues of equal lightness for kinds.

const viridis = [
  [68, 1, 84], [72, 40, 120], [62, 73, 137], [49, 104, 142], [38, 130, 142],
  [31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37],
];

/** share: 0 to 1. Returns [r, g, b], each 0 to 1, as the screen has them. */
export function mapped(share) {
  const place = Math.min(Math.max(share, 0), 1) * (viridis.length - 1);
  const below = Math.min(Math.floor(place), viridis.length - 2);
  return [0, 1, 2].map((k) => (viridis[below][k] + (place - below) * (viridis[below + 1][k] - viridis[below][k])) / 255);
}

export function mapGradient() {
  return `linear-gradient(to right, ${viridis.map((c) => `rgb(${c.join(' ')})`).join(', ')})`;
}

/** One color per level, the root first. */
export const levelColors = [
  '#7c8796', '#9467d1', '#e0912f', '#2f7fd6', '#17a08b', '#d4577f', '#7a9a2e', '#a5744a', '#5b6bd6',
];

export function rgb(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}
export function css([r, g, b]) {
  return `rgb(${Math.round(255 * r)} ${Math.round(255 * g)} ${Math.round(255 * b)})`;
}

/** A color of Björn Ottosson's OKLab space: lightness, chroma, hue in degrees. */
function oklch(lightness, chroma, hue) {
  const a = chroma * Math.cos((hue * Math.PI) / 180);
  const b = chroma * Math.sin((hue * Math.PI) / 180);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const linear = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return linear.map((c) => {
    const x = Math.min(Math.max(c, 0), 1);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
  });
}

/** The k-th of many kinds: the golden angle keeps neighbors apart, and so does their lightness. Red is left for uncovered surface and for links that collide. */
export function kindColor(k) {
  const hue = 62 + ((k * 191.6) % 310);
  return oklch([0.76, 0.64, 0.7][k % 3], 0.12, hue);
}
