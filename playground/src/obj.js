// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The text of an OBJ file.

/** A number with all its digits, so that a tree of the mesh also fits the file. */
const exact = (x) => (Object.is(x, -0) ? '-0' : String(x));

export function objText(positions, facets) {
  const lines = [];
  for (let i = 0; i < positions.length; i += 3) lines.push(`v ${exact(positions[i])} ${exact(positions[i + 1])} ${exact(positions[i + 2])}`);
  for (let i = 0; i < facets.length; i += 3) lines.push(`f ${facets[i] + 1} ${facets[i + 1] + 1} ${facets[i + 2] + 1}`);
  return `${lines.join('\n')}\n`;
}
