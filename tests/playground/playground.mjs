// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The playground in a real browser, bundled anew: what its tests share.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, statSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, equal, finish, folder, packages, skip } from '../viewer/support.mjs';
import { chromiumPath, launch, open, settled } from '../viewer/browser.mjs';

const morula = resolve(process.argv[5]);
if (chromiumPath() === null) skip('there is no Chromium here; the Debian package chromium has it (scripts/setup)');
const isWhole = (path) => existsSync(path) && statSync(path).size > 0;
if (!isWhole(join(morula, 'dist/morula-full-simd.wasm'))) skip(`there is no package in ${morula}; scripts/web makes it`);

const made = join(folder, 'playground');
const build = fileURLToPath(new URL('../../playground/build.mjs', import.meta.url));
console.log(execFileSync(process.execPath, [build, packages, morula, made], { encoding: 'utf8' }).trim());
export const file = join(made, 'index.html');
export const browser = await launch(packages);

/** Runs act(page) in a page with the address; nothing may be written as an error, or asked of the network. */
export async function opened(hash, options, act) {
  const { page, complaints, close } = await open(browser, file, { width: 1200, height: 760, ...options, hash });
  await settled(page);
  await idle(page);
  await act(page);
  equal(complaints.join('\n'), '', 'complaints');
  await close();
}
/** Once no tree is built, nothing moves, and the figures are those of what is seen. */
export async function idle(page) {
  await page.waitForFunction(() => document.body.dataset.building === 'false' && document.body.dataset.moving === 'false' && document.body.dataset.figures === 'done');
}
export const words = (page, selector) => page.locator(selector).innerText();
export async function set(page, id, value) {
  await page.locator(`#${id}`).evaluate((range, to) => {
    range.value = String(to);
    range.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
  await idle(page);
}
export async function download(page, button) {
  const [saved] = await Promise.all([page.waitForEvent('download'), page.click(button)]);
  const path = join(folder, `${Date.now()}-${saved.suggestedFilename()}`);
  await saved.saveAs(path);
  return path;
}
/** Vertices of an OBJ file. */
export const vertices = (path) => readFileSync(path, 'utf8').split('\n').filter((line) => line.startsWith('v ')).map((line) => line.split(' ').slice(1).map(Number));
export async function pose(page) {
  return vertices(await download(page, '#save-pose'));
}
/** Largest distance of corresponding vertices. */
export function farthest(a, b) {
  equal(a.length, b.length, 'vertices');
  return Math.max(...a.map((p, i) => Math.hypot(...p.map((x, k) => x - b[i][k]))));
}
/** A share such as '1.2 %' as a number. */
export const share = (text) => (text.startsWith('0') && !text.includes('%') ? 0 : Number.parseFloat(text.replace('<', '')) / 100);
export async function close() {
  await browser.close();
  finish();
}
export { check, equal, folder };
