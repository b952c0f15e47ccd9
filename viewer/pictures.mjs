// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pictures of README and docs, taken from a page with two rules and from a robot's:
// usage: node pictures.mjs PACKAGES PAGE ROBOT_PAGE FOLDER
import { join } from 'node:path';
import { launch, open, settled, slide } from '../tests/viewer/browser.mjs';

const [packages, file, robot, folder] = process.argv.slice(2);
const browser = await launch(packages);
const worst = 12; // the frame in the middle of a motion out and back

/** The body alone, bent, as a PNG in base64. */
async function body(rule, size) {
  const { page, close } = await open(browser, file, { width: size.width + 348, height: size.height + 120, scale: 2 });
  await settled(page);
  await page.selectOption('#choose-rule', rule);
  await slide(page, 'frame', worst);
  await slide(page, 'level', 3);
  await page.click('#coloring [data-value=branch]');
  // The stage without what lies over it and without its background.
  // Element by element: the page's policy takes no other style sheet.
  await page.evaluate((height) => {
    for (const id of ['legend', 'picked', 'fit']) document.getElementById(id).style.setProperty('display', 'none', 'important');
    const stage = document.getElementById('stage').style;
    stage.setProperty('background', '#fff', 'important');
    stage.setProperty('flex', 'none', 'important');
    stage.height = `${height}px`;
  }, size.height);
  await settled(page);
  await page.keyboard.press('f');
  await settled(page);
  const share = await page.locator('#figures .chosen td:nth-child(4)').innerText();
  const loose = await page.locator('#figures .chosen td:nth-child(3)').innerText();
  const png = await page.locator('#stage canvas').screenshot();
  await close();
  return { png: png.toString('base64'), share, loose };
}

const size = { width: 560, height: 360 };
const left = await body('approach2', size);
const right = await body('exact', size);
const context = await browser.newContext({ viewport: { width: 1120, height: 376 } });
const sheet = await context.newPage();
const half = (name, { png, share, loose }, color) => `
  <figure><div><img src="data:image/png;base64,${png}"></div>
  <figcaption><b>${name}</b><span>looseness ${loose}</span><span style="color:${color}">${share === '0' ? 'the whole surface is covered' : `${share} of the surface is uncovered`}</span></figcaption></figure>`;
await sheet.setContent(`<style>
  body { margin: 0; background: #fff; display: flex; font: 16px 'DejaVu Sans', sans-serif; color: #1b2026 }
  figure { margin: 0; width: 560px; white-space: nowrap } figure div { width: 560px; height: 330px; overflow: hidden; position: relative }
  img { position: absolute; width: 690px; left: -65px; top: -46px } figcaption { display: flex; gap: 18px; justify-content: center; padding-top: 8px }
</style>${half('approach 2', left, '#e02d2d')}${half('exact', right, '#1a7f5a')}`);
await sheet.screenshot({ path: join(folder, 'rules.png') });

const { page } = await open(browser, file, { width: 1200, height: 720, dark: true });
await settled(page);
await slide(page, 'frame', worst);
await page.click('#coloring [data-value=growth]');
await slide(page, 'level', 2);
const box = await page.locator('#stage canvas').boundingBox();
await page.mouse.click(box.x + 0.4 * box.width, box.y + 0.62 * box.height);
await page.selectOption('#choose-rule', 'exact');
await page.locator('#title').click();
await settled(page);
await page.screenshot({ path: join(folder, 'page.png') });

const arm = await open(browser, robot, { width: 1200, height: 720 });
await settled(arm.page);
for (const [joint, value] of [[0, 0.9], [1, 1.5], [2, 2.5], [3, 0.02]]) await slide(arm.page, `joint-${joint}`, value);
await arm.page.keyboard.press('f');
// A sphere of the base, made smaller: what it left uncovered is red.
await arm.page.locator('#figures tbody tr', { hasText: 'base' }).click();
await arm.page.locator('#picked footer button').nth(1).click();
const radius = arm.page.locator('#edit-r');
await radius.fill(String(0.75 * (await radius.evaluate((input) => input.valueAsNumber))));
await arm.page.waitForFunction(() => document.getElementById('edit-cover').dataset.bare === 'true');
await arm.page.click('#rate-run');
await arm.page.waitForFunction(() => document.getElementById('rate-run').textContent === 'Count');
await arm.page.locator('#pairs-section').evaluate((section) => section.scrollIntoView());
await settled(arm.page);
await arm.page.screenshot({ path: join(folder, 'robot_page.png') });
await browser.close();
