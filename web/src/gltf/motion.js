// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Poses of the nodes of a glTF file. Matrices are the 12 numbers of [A | t] by rows: x -> A x + t.
import {MorulaError} from '../errors.js';
import {fail} from './check.js';

/** The product that applies b first. */
export function product(a, b) {
  const result = new Float64Array(12);
  for (let i = 0; i < 3; ++i)
    for (let k = 0; k < 4; ++k)
      result[4 * i + k] = a[4 * i] * b[k] + a[4 * i + 1] * b[4 + k] + a[4 * i + 2] * b[8 + k] + (k === 3 ? a[4 * i + 3] : 0);
  return result;
}

/** The rows of a matrix that glTF writes by columns. */
export const rowsOf = (e) => Float64Array.from({length: 12}, (_, i) => e[4 * (i % 4) + Math.floor(i / 4)]);

function rowsOfParts([tx, ty, tz], [x, y, z, w], [sx, sy, sz]) {
  return Float64Array.of(
    (1 - 2 * (y * y + z * z)) * sx, 2 * (x * y - w * z) * sy, 2 * (x * z + w * y) * sz, tx,
    2 * (x * y + w * z) * sx, (1 - 2 * (x * x + z * z)) * sy, 2 * (y * z - w * x) * sz, ty,
    2 * (x * z - w * y) * sx, 2 * (y * z + w * x) * sy, (1 - 2 * (x * x + y * y)) * sz, tz);
}

function unit(q) {
  const size = Math.hypot(...q);
  return size > 0 ? q.map((x) => x / size) : [0, 0, 0, 1];
}
/** The rotation on the shorter arc from a to b. */
function slerp(a, b, s) {
  const dot = a.reduce((sum, x, i) => sum + x * b[i], 0);
  const sign = dot < 0 ? -1 : 1;
  const angle = Math.acos(Math.min(1, Math.abs(dot)));
  const sine = Math.sin(angle);
  const [u, v] = sine < 1e-9 ? [1 - s, s] : [Math.sin((1 - s) * angle) / sine, Math.sin(s * angle) / sine];
  return a.map((x, i) => u * x + sign * v * b[i]);
}

/** The values of an animation's sampler at a time; before the first key those of the first, after the last those of the last. */
export function valueAt(sampler, path, seconds) {
  const {times, values, interpolation} = sampler;
  const isCubic = interpolation === 'CUBICSPLINE';
  const width = values.length / times.length / (isCubic ? 3 : 1);
  const key = (i, part = isCubic ? 1 : 0) => {
    const at = width * (isCubic ? 3 * i + part : i);
    return Array.from(values.subarray(at, at + width));
  };
  const clean = (value) => (path === 'rotation' ? unit(value) : value);
  // The last key that is not later.
  let low = -1;
  for (let high = times.length; high - low > 1;) {
    const middle = (low + high) >> 1;
    if (times[middle] <= seconds) low = middle;
    else high = middle;
  }
  if (low < 0) return clean(key(0));
  if (low === times.length - 1 || interpolation === 'STEP') return clean(key(low));
  const step = times[low + 1] - times[low];
  const s = (seconds - times[low]) / step;
  const [a, b] = [key(low), key(low + 1)];
  if (isCubic) {
    const [out, into] = [key(low, 2), key(low + 1, 0)];
    const [h00, h10] = [(1 + 2 * s) * (1 - s) ** 2, s * (1 - s) ** 2];
    return clean(a.map((x, i) => h00 * x + h10 * step * out[i] + s * s * (3 - 2 * s) * b[i] + s * s * (s - 1) * step * into[i]));
  }
  return path === 'rotation' ? unit(slerp(unit(a), unit(b), s)) : a.map((x, i) => x + s * (b[i] - x));
}

/** The numbers of an accessor in double, integers of normalized ones as glTF decodes them. */
export function numbersOf(accessor, what) {
  const width = accessor.getElementSize();
  const numbers = new Float64Array(width * accessor.getCount());
  const element = [];
  for (let i = 0; i < accessor.getCount(); ++i) numbers.set(accessor.getElement(i, element), width * i);
  if (!numbers.every(Number.isFinite)) fail(`${what} has a number that is not finite`);
  return numbers;
}

const widths = {translation: 3, rotation: 4, scale: 3};

/** The channels of an animation: {node, path, times, values, interpolation}, and its duration in seconds. */
export function motionOf(animation, number) {
  const channels = [];
  for (const channel of animation.listChannels()) {
    const node = channel.getTargetNode();
    const path = channel.getTargetPath();
    const sampler = channel.getSampler();
    if (!node || !(path in widths || path === 'weights')) continue; // of an extension
    const what = `animation ${number}, ${path} of node "${node.getName()}"`;
    const times = numbersOf(sampler.getInput(), what);
    const values = numbersOf(sampler.getOutput(), what);
    const interpolation = sampler.getInterpolation();
    if (!['LINEAR', 'STEP', 'CUBICSPLINE'].includes(interpolation)) fail(`${what}: the interpolation is ${interpolation}`);
    const width = values.length / times.length / (interpolation === 'CUBICSPLINE' ? 3 : 1);
    if (!Number.isInteger(width) || width < 1 || (path in widths && width !== widths[path]))
      fail(`${what}: ${times.length} keys have ${values.length} numbers`);
    if (times.some((t, i) => i > 0 && t < times[i - 1])) fail(`${what}: times go down`);
    channels.push({node, path, times, values, interpolation});
  }
  return {
    name: animation.getName(),
    duration: channels.reduce((end, {times}) => Math.max(end, times[times.length - 1]), 0),
    channels,
  };
}

/** Where nodes are at a time of a motion: their global matrices, and the weights of morph targets. motion: null for the file's
 * own pose. */
export class Pose {
  #parts = new Map();
  #globals = new Map();
  #document;

  constructor(document, motion, seconds) {
    this.#document = document;
    if (!Number.isFinite(seconds)) throw new MorulaError(`the time ${seconds} is not finite`);
    for (const {node, path, ...sampler} of motion?.channels ?? []) {
      const parts = this.#parts.get(node) ?? {};
      parts[path] = valueAt(sampler, path, seconds);
      this.#parts.set(node, parts);
    }
  }
  /** Throws unless the pose is one of this document. */
  requireOf(document) {
    if (document !== this.#document) throw new MorulaError('the pose is one of another file');
  }
  /** Rows of the matrix from the node's coordinates to those of the scene. */
  matrix(node) {
    const way = [];
    for (let at = node; at && !this.#globals.has(at); at = at.getParentNode()) way.push(at);
    for (const at of way.reverse()) {
      const {translation = at.getTranslation(), rotation = at.getRotation(), scale = at.getScale()} = this.#parts.get(at) ?? {};
      const local = rowsOfParts(translation, rotation, scale);
      const above = at.getParentNode();
      this.#globals.set(at, above ? product(this.#globals.get(above), local) : local);
    }
    return this.#globals.get(node);
  }
  weights(node, count) {
    const own = node.getWeights();
    const given = this.#parts.get(node)?.weights ?? (own.length > 0 ? own : node.getMesh().getWeights());
    return Float64Array.from({length: count}, (_, j) => given[j] ?? 0);
  }
}
