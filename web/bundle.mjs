// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Makes the files of a package's dist that are neither sources nor modules: modules as text, the worker as text, and the script for
// pages without modules. scripts/web runs it. usage: node bundle.mjs PACKAGE FOLDER_WITH_NODE_MODULES
import {createRequire} from 'node:module';
import {readdirSync, readFileSync, writeFileSync} from 'node:fs';
import {join, resolve} from 'node:path';

const [folder, tools] = process.argv.slice(2).map((path) => resolve(path));
const {buildSync} = createRequire(join(tools, 'package.json'))('esbuild');
const dist = (name) => join(folder, 'dist', name);

for (const file of readdirSync(dist('')).filter((name) => name.endsWith('.wasm'))) {
  const name = file.replace(/^morula-(.*)\.wasm$/, '$1');
  const text = readFileSync(dist(file)).toString('base64');
  writeFileSync(dist(`morula-${name}.js`), `(globalThis.morulaModules ??= {})['${name}'] = '${text}';\n`);
}

function bundle(entry) {
  const [{text}] = buildSync({
    entryPoints: [join(folder, 'src', entry)],
    bundle: true,
    minify: true,
    write: false,
    format: 'iife',
    target: ['chrome95', 'firefox100', 'safari15.2'],
    external: ['node:*'],
    charset: 'utf8',
    logLevel: 'warning',
  }).outputFiles;
  return text;
}
writeFileSync(dist('worker-text.js'), `export default ${JSON.stringify(bundle('worker.js'))};\n`);
writeFileSync(dist('morula.global.js'), bundle('global.js'));
