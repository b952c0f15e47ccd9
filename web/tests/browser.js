// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Chromium on pages of a server with the files of the package. MORULA_CHROMIUM: the browser. MORULA_WEB_TOOLS: a folder with
// playwright-core, which scripts/web installs.
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {readFile} from 'node:fs/promises';
import {extname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {packageFile} from './package.js';

const tools = process.env.MORULA_WEB_TOOLS ?? fileURLToPath(new URL('../../build/web/npm', import.meta.url));
const types = {'.js': 'text/javascript', '.wasm': 'application/wasm', '.html': 'text/html'};

/** Runs use(page, address) in a new browser, in an empty page of the server with a content security policy. */
export async function inBrowser(use, policy = '') {
  const {chromium} = createRequire(join(tools, 'package.json'))('playwright-core');
  const browser = await chromium.launch({executablePath: process.env.MORULA_CHROMIUM || '/usr/bin/chromium', args: ['--no-sandbox']});
  const server = createServer(async ({url}, response) => {
    const name = new URL(url, 'http://localhost').pathname;
    const head = {'content-type': types[extname(name)] ?? 'text/plain', ...(policy && {'content-security-policy': policy})};
    const file = fileURLToPath(packageFile(`.${name}`));
    const content = name === '/empty.html' ? '<!doctype html>' : await readFile(file).catch(() => null);
    response.writeHead(content === null ? 404 : 200, head).end(content ?? '');
  });
  try {
    await new Promise((done) => server.listen(0, '127.0.0.1', done));
    const address = `http://127.0.0.1:${server.address().port}`;
    const page = await browser.newPage();
    await page.goto(`${address}/empty.html`);
    return await use(page, address);
  } finally {
    await browser.close();
    server.close();
  }
}
