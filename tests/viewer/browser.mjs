// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The system's Chromium, drawing in software, opened on a page from disk.
import { createRequire } from 'node:module';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

export function chromiumPath() {
  const names = ['chromium', 'chromium-browser', 'google-chrome'];
  const folders = (process.env.PATH ?? '').split(':');
  return names.flatMap((name) => folders.map((folder) => join(folder, name))).find((path) => existsSync(path)) ?? null;
}

/** packages: the folder with node_modules. options: {webgl: false} to do without. */
export async function launch(packages, options = {}) {
  const { chromium } = createRequire(join(packages, 'package.json'))('playwright-core');
  const drawing = options.webgl === false ? ['--disable-gpu', '--disable-3d-apis'] : ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
  return chromium.launch({ executablePath: chromiumPath(), timeout: 180_000, args: ['--no-sandbox', '--disable-dev-shm-usage', '--hide-scrollbars', ...drawing] });
}

/** A page from disk. Returns {page, complaints}: what it wrote as errors, and what it asked the network for. */
export async function open(browser, file, { width = 1440, height = 900, dark = false, scale = 1, touch = false, motion = 'reduce', hash = '' } = {}) {
  const context = await browser.newContext({
    viewport: { width, height }, colorScheme: dark ? 'dark' : 'light', deviceScaleFactor: scale, hasTouch: touch, reducedMotion: motion,
  });
  context.setDefaultTimeout(180_000); // other work may share the processors; ctest has a limit for all
  const page = await context.newPage();
  const complaints = [];
  page.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('request', (request) => /^https?:|^wss?:/.test(request.url()) && complaints.push(`asks the network for ${request.url()}`));
  await page.goto(pathToFileURL(file).href + hash);
  return { page, complaints, close: () => context.close() };
}

/** Once what was asked for has been drawn. */
export async function settled(page) {
  await page.waitForSelector('body[data-ready="true"]');
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))));
}

/** Moves a slider as a reader would leave it. */
export async function slide(page, id, value) {
  await page.locator(`#${id}`).evaluate((range, to) => {
    range.value = String(to);
    range.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
  await settled(page);
}
