// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Limits of files and meshes, checked before anything larger is read.

export const mostBytes = 128 * 2 ** 20;
export const mostFacets = 200_000;
export const mostSoftVertices = 20_000;
const meshes = ['obj', 'stl', 'ply', 'off'];
export const kinds = [...meshes, 'glb'];

/** An error whose text the reader sees as it is. */
export class InputError extends Error {}

export const endingOf = (name) => name.toLowerCase().split('.').pop();

/** file: {name, size}, not yet read. */
export function checkFile({ name, size }) {
  if (!kinds.includes(endingOf(name))) throw new InputError(`${name}: this page reads ${kinds.map((kind) => `.${kind}`).join(', ')}`);
  if (size === 0) throw new InputError(`${name} is empty`);
  if (size > mostBytes) {
    throw new InputError(`${name} has ${Math.ceil(size / 2 ** 20).toLocaleString('en')} MB; this page reads files up to ${mostBytes / 2 ** 20} MB, and the command morula larger ones`);
  }
}

export function checkFacetCount(count) {
  if (count > mostFacets) {
    throw new InputError(`the mesh has ${count.toLocaleString('en')} facets; this page takes up to ${mostFacets.toLocaleString('en')}, and the command morula more`);
  }
}

/** Looks at the number of facets that the head of a binary STL or PLY file names, before the file is read. */
export function checkMeshBytes(name, bytes) {
  const ending = endingOf(name);
  if (ending === 'stl' && bytes.length >= 84) {
    const count = new DataView(bytes.buffer, bytes.byteOffset).getUint32(80, true);
    if (bytes.length === 84 + 50 * count) checkFacetCount(count);
  }
  if (ending === 'ply') {
    const head = new TextDecoder('latin1').decode(bytes.subarray(0, 4096));
    const faces = /^element face (\d+)/m.exec(head.slice(0, head.indexOf('end_header')));
    if (faces) checkFacetCount(Number(faces[1]));
  }
}
