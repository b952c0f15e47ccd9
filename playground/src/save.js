// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that the command reads.
import { offer } from '../../viewer/src/save.js';
import { objText } from './obj.js';

export const saveMesh = (positions, facets, name) => offer(new Blob([objText(positions, facets)], { type: 'model/obj' }), name);
export const saveTree = (tree, name) => offer(new Blob([tree.toBytes()], { type: 'application/octet-stream' }), name);
