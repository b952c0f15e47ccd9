// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A limb that bends, as files and as pages, in a real browser from disk: what tests of the page share.
import { writeFileSync } from 'node:fs';
import { at, equal, finish, morula, packages, skip } from './support.mjs';
import { chromiumPath, launch, open, settled, slide } from './browser.mjs';
import { study } from './study_example.mjs';

if (chromiumPath() === null) skip('there is no Chromium here; the Debian package chromium has it (scripts/setup)');

/** limb.html, and the spheres that it shows of approach 2 in the folder spheres. */
export function writeLimb(resolution = 32) {
  morula(`sample limb -o limb.obj --resolution ${resolution}`);
  morula('build limb.obj -o limb.morula --method grid --branching 8 --depth 3');
  morula('deform limb.obj -o bend --bend 90 --frames 13');
  morula('update limb.obj limb.morula bend -o spheres --rule approach2 --format json');
  morula('view limb.obj limb.morula bend -o limb.html --rule exact --rule approach2');
}
/** still.html: the limb, or what else there is, without a motion. */
export function writeStill(body = 'limb') {
  morula(`view ${body}.obj ${body}.morula -o still.html --no-measure`);
}
/** study.html: the limb below a study. */
export function writeStudy() {
  writeFileSync(at('study.json'), JSON.stringify(study));
  morula('view limb.obj limb.morula bend -o study.html --rule exact --rule approach2 --study study.json --title Evaluation');
}

export const browser = await launch(packages);
export const small = { width: 930, height: 360 };
let helper = null;

/** Pixels of the picture, without what lies over it. */
export async function picture(page) {
  await settled(page);
  const show = (visibility) => page.evaluate((how) => {
    for (const id of ['legend', 'picked', 'fit']) document.getElementById(id).style.visibility = how;
  }, visibility);
  await show('hidden');
  const png = await page.locator('#stage canvas').screenshot();
  await show('');
  return png.toString('base64');
}
/** Calls judge(pixels of each picture, width) in a page that can decode pictures. */
async function judged(pictures, judge) {
  helper ??= await (await browser.newContext()).newPage();
  return helper.evaluate(async ([pngs, body]) => {
    let width = 0;
    const data = await Promise.all(pngs.map(async (png) => {
      const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
      width = image.width;
      const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height).data;
    }));
    return new Function(`return ${body}`)()(data, width);
  }, [pictures, judge.toString()]);
}
/** {changed: share of pixels that differ visibly, red: share of b's that are the red of uncovered surface} */
export const compare = (a, b) => judged([a, b], (data) => {
  let changed = 0;
  let red = 0;
  for (let i = 0; i < data[1].length; i += 4) {
    const differs = [0, 1, 2].some((k) => Math.abs(data[0][i + k] - data[1][i + k]) > 12);
    if (differs) ++changed;
    const [r, g, b] = data[1].subarray(i, i + 3);
    if (r > 150 && r > 1.9 * g && r > 1.9 * b) ++red;
  }
  return { changed: (4 * changed) / data[1].length, red: (4 * red) / data[1].length };
});
/** How many pixels are visibly darker than all four beside them, where the body and its spheres fill the picture. */
export const specks = (png) => judged([png], ([data], width) => {
  const at = (pixel) => data.subarray(4 * pixel, 4 * pixel + 3);
  const light = (pixel) => at(pixel).reduce((sum, value) => sum + value);
  const isColored = (pixel) => Math.max(...at(pixel)) - Math.min(...at(pixel)) > 30;
  const steps = [-1, 1, -width, width];
  let found = 0;
  for (let pixel = 2 * width; pixel < data.length / 4 - 2 * width; ++pixel)
    if (steps.every((step) => isColored(pixel + 2 * step) && light(pixel + step) - light(pixel) > 12)) ++found;
  return found;
});
export async function opened(name, options, test) {
  const { page, complaints, close } = await open(browser, at(name), { ...small, ...options });
  await settled(page);
  await test(page);
  equal(complaints.join('\n'), '', 'complaints of the browser');
  await close();
}
/** One page for all claims that leave it as they found it; opening one takes longest. */
let shared = null;
export async function onShared(test) {
  shared ??= await open(browser, at('limb.html'), small);
  const { page, complaints } = shared;
  await page.selectOption('#choose-rule', 'exact');
  await page.click('#coloring [data-value=level]');
  await page.keyboard.press('Escape');
  await slide(page, 'frame', 0);
  await slide(page, 'level', 3);
  await page.evaluate(() => document.activeElement?.blur());
  await test(page);
  equal(complaints.join('\n'), '', 'complaints of the browser');
}
export const words = (page, selector) => page.locator(selector).innerText();

export async function close() {
  await browser.close();
  finish();
}
