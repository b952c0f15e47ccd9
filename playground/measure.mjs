// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Times of the playground in the system's Chromium, which draws in software here: what a reader's machine does is quicker.
// usage: node playground/measure.mjs PACKAGES PAGE
import { createServer } from 'node:http';
import { readFileSync } from 'node:fs';
import { launch } from '../tests/viewer/browser.mjs';

const [packages, file] = process.argv.slice(2);
const browser = await launch(packages);
const bytes = readFileSync(file);
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const rows = [];
const row = (name, value, unit) => rows.push(`| ${name} | ${Number(value.toPrecision(3))} ${unit} |`);

/** The longest task of the page's thread in a trace, milliseconds: of the clock, and of the processor alone. */
function longestTask(trace) {
  const { traceEvents } = JSON.parse(trace.toString());
  const names = new Map(traceEvents.filter((event) => event.name === 'thread_name').map((event) => [`${event.pid}:${event.tid}`, event.args.name]));
  const tasks = traceEvents.filter((event) => event.name.endsWith('RunTask') && names.get(`${event.pid}:${event.tid}`) === 'CrRendererMain');
  const most = (of) => Math.max(...tasks.map((task) => (task[of] ?? 0) / 1000));
  return { clock: most('dur'), processor: most('tdur') };
}
const isReady = () => document.body.dataset.building === 'false' && document.body.dataset.figures === 'done';

// A file service that neither compresses nor keeps a connection quick.
const server = createServer((_, response) => response.setHeader('content-type', 'text/html').end(bytes)).listen(0, '127.0.0.1');
await new Promise((done) => server.once('listening', done));
const paints = [];
const readies = [];
for (let run = 0; run < 3; ++run) {
  const context = await browser.newContext({ viewport: { width: 1200, height: 760 } });
  const page = await context.newPage();
  const session = await context.newCDPSession(page);
  await session.send('Network.enable');
  await session.send('Network.emulateNetworkConditions', { offline: false, latency: 20, downloadThroughput: 20e6 / 8, uploadThroughput: 20e6 / 8 });
  const begin = performance.now();
  await page.goto(`http://127.0.0.1:${server.address().port}/`, { waitUntil: 'commit' });
  await page.waitForFunction(isReady, null, { timeout: 120_000 });
  readies.push(performance.now() - begin);
  paints.push(await page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0].startTime));
  await context.close();
}
server.close();
row('page, not compressed', bytes.length / 1e6, 'MB');
row('first contentful paint at 20 Mbit/s', median(paints), 'ms');
row('first tree and its figures at 20 Mbit/s', median(readies), 'ms');

const context = await browser.newContext({ viewport: { width: 1200, height: 760 } });
const page = await context.newPage();
await page.goto(`file://${file.startsWith('/') ? '' : `${process.cwd()}/`}${file}`);
await page.waitForFunction(isReady, null, { timeout: 120_000 });
const builds = [];
const longest = { clock: 0, processor: 0 };
for (const shape of ['capsule', 'torus', 'limb']) {
  await browser.startTracing(page, { categories: ['devtools.timeline', 'toplevel'] });
  await page.selectOption('#shape', shape);
  await page.waitForFunction(() => document.body.dataset.building === 'true');
  await page.waitForFunction(() => document.body.dataset.building === 'false', null, { timeout: 120_000 });
  const text = await page.locator('#figure-build').innerText();
  builds.push(Number.parseFloat(text) * (text.endsWith('ms') ? 1 : 1000));
  const { clock, processor } = longestTask(await browser.stopTracing());
  Object.assign(longest, { clock: Math.max(longest.clock, clock), processor: Math.max(longest.processor, processor) });
}
row('build of 5,000 facets, fast (median of three bodies)', median(builds), 'ms');
row('longest task of the page meanwhile, by the clock', longest.clock, 'ms');
row('the same, time of the processor', longest.processor, 'ms');

await page.waitForFunction(isReady, null, { timeout: 120_000 });
await page.locator('#stage canvas').focus();
await page.keyboard.press('p');
const frames = await page.evaluate(async () => {
  const { world } = window.playground;
  const times = [];
  for (let i = 0; i < 120; ++i) {
    await new Promise((done) => requestAnimationFrame(done));
    if (i === 60) document.dispatchEvent(new KeyboardEvent('keydown', { key: 'p', bubbles: true }));
    times.push(world.milliseconds);
  }
  return times;
});
row('soft body of 5,000 facets: step, update and geometry of a frame, median', median(frames), 'ms');
row('update of all levels', Number.parseFloat(await page.locator('#figure-update').innerText()), 'µs');
console.log(['| figure | here |', '| --- | ---: |', ...rows].join('\n'));
await browser.close();
