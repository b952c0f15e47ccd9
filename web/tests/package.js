// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
import {pathToFileURL} from 'node:url';

/** A file of the package that scripts/web has made; MORULA_WEB_PACKAGE names another folder. */
export function packageFile(name) {
  const folder = process.env.MORULA_WEB_PACKAGE;
  return folder ? new URL(name, pathToFileURL(`${folder}/`)) : new URL(`../../build/web/package/${name}`, import.meta.url);
}
export const packageModule = (name = 'src/index.js') => import(packageFile(name));
