// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bundles src/, what it shares with viewer/, and the npm package morula into FOLDER/index.html: one file that loads no other.
// PACKAGES has three and esbuild in node_modules; PACKAGE is build/web/package of scripts/web.
// usage: node playground/build.mjs PACKAGES PACKAGE FOLDER
import { createHash } from 'node:crypto';
import { createRequire } from 'node:module';
import { mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const source = join(dirname(fileURLToPath(import.meta.url)), 'src');
const [packages, morula, folder] = process.argv.slice(2).map((path) => resolve(path));
const { buildSync } = createRequire(join(packages, 'package.json'))('esbuild');

const bundle = (name) =>
  buildSync({
    entryPoints: [join(source, name)],
    outdir: folder,
    bundle: true,
    minify: true,
    write: false,
    format: 'iife',
    target: ['chrome100', 'firefox113', 'safari16.4'],
    nodePaths: [join(packages, 'node_modules')],
    alias: { morula: join(morula, 'src/index.js') },
    // Never imported here: of node, and the package's own modules and worker.
    external: ['node:*', '../dist/*'],
    // The page gives the module to load(); no address of one is ever made.
    define: { 'import.meta.url': '""' },
    legalComments: 'none',
    charset: 'utf8',
    logLevel: 'warning',
  }).outputFiles;
const text = (files, ending) => files.find((file) => file.path.endsWith(ending)).text;
const closed = (script) => script.replace(/<\/script/gi, '<\\/script').replace(/<!--/g, '<\\!--');

const page = bundle('main.js');
const script = closed(text(page, '.js'));
const style = text(page, '.css');
const worker = closed(text(bundle('worker.js'), '.js'));
const module = gzipSync(readFileSync(join(morula, 'dist/morula-full-simd.wasm')), { level: 9 }).toString('base64');
const notices = `three\n${readFileSync(join(packages, 'node_modules/three/LICENSE'), 'utf8').trim()}`.replaceAll('--', '- -');
// The page runs this script and has this style, and no others.
const hash = (content) => `'sha256-${createHash('sha256').update(content, 'utf8').digest('base64')}'`;

const parts = {
  'MORULA SCRIPT HASH': hash(script), 'MORULA STYLE HASH': hash(style), 'MORULA NOTICES': notices,
  '/* MORULA STYLE */': style, '/* MORULA SCRIPT */': script, '/* MORULA WORKER */': worker, '/* MORULA MODULE */': module,
};
let html = readFileSync(join(source, 'page.html'), 'utf8');
for (const [mark, content] of Object.entries(parts)) {
  if (html.split(mark).length !== 2) throw new Error(`page.html needs exactly one ${mark}`);
  html = html.replace(mark, () => content);
}
mkdirSync(folder, { recursive: true });
writeFileSync(join(folder, 'index.html.partial'), html);
renameSync(join(folder, 'index.html.partial'), join(folder, 'index.html'));
const kB = (content) => Math.round(Buffer.byteLength(content) / 1000);
console.log(`playground: index.html has ${kB(html)} kB: page ${kB(script) + kB(style)}, worker ${kB(worker)}, module ${kB(module)}`);
