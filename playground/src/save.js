// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that the command reads.
import { offer } from '../../viewer/src/save.js';

/** A number with all its digits, so that a tree of the mesh is one of the file, too. */
const exact = (x) => (Object.is(x, -0) ? '-0' : String(x));

export function objText(positions, facets) {
  const lines = [];
  for (let i = 0; i < positions.length; i += 3) lines.push(`v ${exact(positions[i])} ${exact(positions[i + 1])} ${exact(positions[i + 2])}`);
  for (let i = 0; i < facets.length; i += 3) lines.push(`f ${facets[i] + 1} ${facets[i + 1] + 1} ${facets[i + 2] + 1}`);
  return `${lines.join('\n')}\n`;
}

export const saveMesh = (positions, facets, name) => offer(new Blob([objText(positions, facets)], { type: 'model/obj' }), name);
export const saveTree = (tree, name) => offer(new Blob([tree.toBytes()], { type: 'application/octet-stream' }), name);
