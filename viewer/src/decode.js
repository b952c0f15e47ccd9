// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Reads what extras/page/src/page.cpp wrote; extras/page/docs/view.md describes it. No page and no drawing in here: tests run it alone.

/** A fault of the file, with a message for the reader. */
export class PageError extends Error {}

const newestFormat = 1;

export function checksum(bytes) {
  let state = 0x811c9dc5;
  for (let i = 0; i < bytes.length; ++i) state = Math.imul(state ^ bytes[i], 0x01000193);
  return state >>> 0;
}

export function fromBase64(text, length) {
  const value = new Int8Array(128).fill(-1);
  'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/'
    .split('')
    .forEach((digit, i) => (value[digit.charCodeAt(0)] = i));
  const bytes = new Uint8Array(length);
  let filled = 0;
  let bits = 0;
  let held = 0;
  for (let i = 0; i < text.length; ++i) {
    const digit = value[text.charCodeAt(i) & 127];
    if (digit < 0) continue; // padding and white space
    held = (held << 6) | digit;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      if (filled < length) bytes[filled] = (held >> bits) & 255;
      ++filled;
    }
  }
  if (filled !== length) throw new PageError(`${filled} bytes of data where ${length} should be`);
  return bytes;
}

/** Numbers of either sign, seven bits a byte. */
export class Varints {
  constructor(bytes) {
    this.bytes = bytes;
    this.place = 0;
  }
  next() {
    let value = 0;
    let scale = 1;
    for (;;) {
      if (this.place >= this.bytes.length || scale > 2 ** 42) throw new PageError('the data ends inside a number');
      const byte = this.bytes[this.place++];
      value += (byte & 127) * scale;
      if (byte < 128) break;
      scale *= 128;
    }
    return value % 2 === 0 ? value / 2 : -(value + 1) / 2;
  }
}

/** {facets: Uint32Array, frames: [Uint16Array of x, y, z in steps]} */
export function decodeMotion(bytes, motion) {
  const numbers = new Varints(bytes);
  const facets = new Uint32Array(3 * motion.facets);
  let previous = 0;
  for (let i = 0; i < facets.length; i += 3) {
    const first = previous + numbers.next();
    facets[i] = first;
    facets[i + 1] = first + numbers.next();
    facets[i + 2] = first + numbers.next();
    previous = first;
  }
  for (const vertex of facets) {
    if (vertex >= motion.vertices) throw new PageError(`a facet names vertex ${vertex} of ${motion.vertices}`);
  }
  const frames = [];
  let last = new Uint16Array(3 * motion.vertices);
  for (let frame = 0; frame < motion.frames.length; ++frame) {
    const now = new Uint16Array(last.length);
    const moved = [0, 0, 0];
    for (let i = 0; i < now.length; i += 3) {
      for (let axis = 0; axis < 3; ++axis) {
        moved[axis] += numbers.next();
        now[i + axis] = last[i + axis] + moved[axis];
      }
    }
    frames.push(now);
    last = now;
  }
  if (numbers.place !== bytes.length) throw new PageError('there is more data than the frames need');
  return { facets, frames };
}

/**
 * {rest: Float32Array of x, y, z, r, frames: [the same], emptyShare: [Uint16Array] or null, contacts: [Float32Array] or
 * null, patches: [{regions, curves}] or null}
 */
export function decodeScene(bytes, scene, frameCount) {
  const nodes = scene.child_count.length;
  const floats = 4 * nodes;
  const counts = scene.contacts ?? null;
  if (counts && counts.length !== frameCount) throw new PageError('contacts miss a frame');
  const marks = counts ? counts.reduce((sum, count) => sum + count, 0) : 0;
  const overlaps = scene.patches ?? null;
  if (overlaps && overlaps.length !== frameCount) throw new PageError('patches miss a frame');
  const patchBytes = (overlaps ?? []).reduce(
    (sum, { facets, curves }) => sum + 6 * facets.reduce((most, count) => most + count, 0) + 24 * curves, 0,
  );
  const need = 4 * floats * (frameCount + 1) + (scene.empty_share ? 2 * nodes * frameCount : 0) + 28 * marks + patchBytes;
  if (bytes.length !== need) throw new PageError(`${bytes.length} bytes of spheres where ${need} should be`);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  let place = 0;
  const spheres = () => {
    const block = new Float32Array(floats);
    for (let i = 0; i < floats; ++i, place += 4) block[i] = view.getFloat32(place, true);
    return block;
  };
  const rest = spheres();
  const frames = Array.from({ length: frameCount }, spheres);
  let emptyShare = null;
  if (scene.empty_share) {
    emptyShare = Array.from({ length: frameCount }, () => {
      const block = new Uint16Array(nodes);
      for (let i = 0; i < nodes; ++i, place += 2) block[i] = view.getUint16(place, true);
      return block;
    });
  }
  // Per frame seven numbers a contact: point, normal, depth.
  const contacts = counts && counts.map((count) => Float32Array.from({ length: 7 * count }, () => {
    place += 4;
    return view.getFloat32(place - 4, true);
  }));
  const short = () => view.getUint16((place += 2) - 2, true);
  const float = () => view.getFloat32((place += 4) - 4, true);
  // Per frame the regions, one per patch with facets and their shares, and six numbers a segment of the curves.
  const patches = overlaps && overlaps.map(({ facets, curves }) => ({
    regions: facets.map((count) => {
      const region = { facets: new Uint32Array(count), shares: new Float32Array(count) };
      for (let i = 0; i < count; ++i) {
        const low = short();
        region.facets[i] = low + 65536 * short();
        region.shares[i] = short() / 65535;
      }
      return region;
    }),
    curves: Float32Array.from({ length: 6 * curves }, float),
  }));
  return { rest, frames, emptyShare, contacts, patches };
}

/** The manifest of a page. text(id): what stands in the element of that name, or null. */
export function readManifest(text) {
  const manifest = text('morula-manifest');
  if (manifest === null) throw new PageError('there is no data in it');
  if (text('morula-end') === null) throw new PageError('it is cut short: its end is missing');
  let content;
  try {
    content = JSON.parse(manifest);
  } catch {
    throw new PageError('its list of contents cannot be read');
  }
  if (content.format !== newestFormat) {
    throw new PageError(`it has format ${content.format}, and this page reads ${newestFormat}`);
  }
  const whole = Array.isArray(content.motions) && Array.isArray(content.scenes) && content.scenes.length > 0;
  if (!whole) throw new PageError('its list of contents is not complete');
  return content;
}

/** The bytes of one entry of the manifest, checked. */
export function readBytes(text, entry) {
  const packed = text(entry.id);
  if (packed === null) throw new PageError(`the data ${entry.id} is missing`);
  const bytes = fromBase64(packed, entry.bytes);
  if (checksum(bytes) !== entry.checksum) throw new PageError(`the data ${entry.id} has been changed: its checksum differs`);
  return bytes;
}
