// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bundles src/ and the packages under BINARY into BINARY/page.html, one file, and that into BINARY/page_template.cpp.
// usage: node build.mjs BINARY
import { createHash } from 'node:crypto';
import { createRequire } from 'node:module';
import { mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const source = join(dirname(fileURLToPath(import.meta.url)), 'src');
const binary = resolve(process.argv[2]);
const { buildSync } = createRequire(join(binary, 'package.json'))('esbuild');
const mark = '<!-- MORULA DATA -->';

const bundle = buildSync({
  entryPoints: [join(source, 'main.js')],
  outdir: binary,
  bundle: true,
  minify: true,
  write: false,
  format: 'iife',
  target: ['chrome100', 'firefox100', 'safari15'],
  nodePaths: [join(binary, 'node_modules')],
  legalComments: 'none',
  charset: 'utf8',
  logLevel: 'warning',
});
const text = (ending) => bundle.outputFiles.find((file) => file.path.endsWith(ending)).text;

// The page contains the licenses of the libraries in it.
const license = (name) => readFileSync(join(binary, 'node_modules', name, 'LICENSE'), 'utf8').trim();
const notices = ['three', 'uplot'].map((name) => `${name}\n${license(name)}`).join('\n\n').replaceAll('--', '- -');

const script = text('.js').replace(/<\/script/gi, '<\\/script');
// The page runs this script and has this style, and no others: not one that came in with the data.
const hash = (content) => `'sha256-${createHash('sha256').update(content, 'utf8').digest('base64')}'`;
const page = readFileSync(join(source, 'page.html'), 'utf8')
  .replace('MORULA SCRIPT HASH', () => hash(script))
  .replace('MORULA STYLE HASH', () => hash(text('.css')))
  .replace('/* MORULA STYLE */', () => text('.css'))
  .replace('/* MORULA SCRIPT */', () => script)
  .replace('MORULA NOTICES', () => notices);
if (page.split(mark).length !== 2) throw new Error(`page.html needs exactly one ${mark}`);

// String literals of at most 8000 bytes: compilers need not take longer ones than 65536.
const bytes = Buffer.from(page, 'utf8');
const literals = [];
for (let begin = 0; begin < bytes.length; begin += 8000) {
  let literal = '';
  for (const byte of bytes.subarray(begin, begin + 8000)) {
    if (byte === 0x0a) literal += '\\n';
    else if (byte === 0x22 || byte === 0x5c || byte === 0x3f) literal += '\\' + String.fromCharCode(byte);
    else if (byte >= 0x20 && byte < 0x7f) literal += String.fromCharCode(byte);
    else literal += '\\' + byte.toString(8).padStart(3, '0');
  }
  literals.push(`    "${literal}",\n`);
}
const cpp = `// Made by viewer/build.mjs.
#include "template.hpp"

namespace morula::page {
namespace {

const char* const parts[] = {
${literals.join('')}};

}  // namespace

std::string page_template() {
  std::string page;
  for (const char* part : parts) page += part;
  return page;
}

std::string why_no_template() {
  return {};
}

}  // namespace morula::page
`;
mkdirSync(binary, { recursive: true });
for (const [name, content] of [['page.html', page], ['page_template.cpp', cpp]]) {
  writeFileSync(join(binary, `${name}.partial`), content);
  renameSync(join(binary, `${name}.partial`), join(binary, name));
}
