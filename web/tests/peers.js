// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Packages of others that the tests need, from the folder node_modules beside the package: its own imports find the same files.
import {readFileSync} from 'node:fs';
import {packageFile} from './package.js';

export const peerFile = (name) => new URL(`../node_modules/${name}`, packageFile('package.json'));
export function peer(name) {
  const {exports, module} = JSON.parse(readFileSync(peerFile(`${name}/package.json`), 'utf8'));
  let entry = exports?.['.'] ?? module;
  while (typeof entry === 'object') entry = entry.import ?? entry.default;
  return import(peerFile(`${name}/${entry}`));
}
