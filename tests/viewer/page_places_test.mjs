// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page in a real browser: on narrow screens, without a motion, below a study. Writes screenshots to look at.
import { writeFileSync } from 'node:fs';
import { at, check, claim, equal, morula } from './support.mjs';
import { settled, slide } from './browser.mjs';
import { close, opened, words, writeLimb, writeStill, writeStudy } from './limb.mjs';
import { study } from './study_example.mjs';

writeLimb();
writeStill();
writeStudy();

await claim('touch_and_a_narrow_screen_work', () =>
  opened('limb.html', { width: 390, height: 700, touch: true }, async (page) => {
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(wide <= 0, `${wide} pixels stick out at the side`);
    await slide(page, 'level', 1);
    const box = await page.locator('#stage canvas').boundingBox();
    for (let y = 0.3; y < 0.8 && !(await page.isVisible('#picked')); y += 0.05) {
      await page.touchscreen.tap(box.x + 0.5 * box.width, box.y + y * box.height);
    }
    check(await page.isVisible('#picked'), 'a tap picks');
    await settled(page);
    await page.screenshot({ path: at('narrow-light.png') });
  }));

await claim('a_body_at_rest_has_no_time', () =>
  opened('still.html', {}, async (page) => {
    check(!(await page.isVisible('#transport')), 'no frame slider');
    check((await words(page, '#figures')).includes('Largest growth'), 'what is not measured is not shown');
  }));

await claim('a_study_comes_first_and_its_curves_pose_the_body', () =>
  opened('study.html', { width: 1440, height: 900 }, async (page) => {
    equal(await page.locator('.claim').count(), study.claims.length, 'claims');
    equal(await words(page, '.claim:first-of-type .verdict'), 'holds', 'verdict');
    equal(await words(page, '#claim-uncovered .verdict'), 'better', 'a rule that is better than claimed');
    equal(await page.getAttribute('#claim-uncovered', 'data-verdict'), 'better', 'and its color');
    const box = await page.locator('#figure-fig2a .u-over').boundingBox();
    await page.locator('#figure-fig2a').scrollIntoViewIfNeeded();
    const now = (await page.locator('#figure-fig2a .u-over').boundingBox()) ?? box;
    await page.mouse.click(now.x + now.width - 1, now.y + 20);
    equal(await page.locator('#frame').inputValue(), '12', 'frame at the end of the curve');
    equal(await page.locator('#pictures img').count(), 1, 'the picture');
    check((await page.locator('#pictures img').evaluate((image) => image.decode().then(() => image.naturalWidth))) > 0, 'it is drawn');
    equal(await page.locator('#report script, #report svg script').count(), 0, 'scripts in the report');
    equal(await page.title(), 'Evaluation · Morula', 'title');
    await page.locator('#report').evaluate((report) => (report.scrollTop = 0));
    await slide(page, 'frame', 6);
    await page.screenshot({ path: at('study-light.png') });
    await page.locator('#study-figures').evaluate((section) => section.scrollIntoView());
    await page.keyboard.press('t');
    await settled(page);
    await page.screenshot({ path: at('study-dark.png') });
  }));

await claim('a_quick_study_decides_what_holds_for_every_body', async () => {
  const quick = { ...study, settings: { ...study.settings, quick: true }, claims: study.claims.map((c) => ({ ...c, guarantee: c.id === 'exact' })) };
  writeFileSync(at('quick.json'), JSON.stringify(quick));
  morula('view limb.obj limb.morula -o quick.html --no-measure --study quick.json --title Quick');
  await opened('quick.html', { width: 1440, height: 900 }, async (page) => {
    equal(await words(page, '#claim-exact .verdict'), 'holds', 'what holds always');
    equal(await words(page, '#claim-covers .verdict'), 'not decided', 'what a full study decides');
    equal(await words(page, '.tally'), '1 holds\n4 not decided\n1 not tested', 'tally');
  });
});

for (const width of [390, 800]) {
  await claim(`a_study_on_${width}_pixels_has_the_body_on_top_and_long_parts_folded`, () =>
    opened('study.html', { width, height: 800, touch: true }, async (page) => {
      const top = async (selector) => (await page.locator(selector).boundingBox()).y;
      check((await top('#view')) < (await top('#report')), 'the body is above the report');
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      check(wide <= 0, `${wide} pixels stick out at the side`);
      const high = await page.evaluate(() => document.documentElement.scrollHeight);
      check(high < 8 * 800, `the page is ${high} pixels high`);
      check(!(await page.isVisible('#figure-fig2a .plot')), 'figures are folded');
      await page.screenshot({ path: at(`study-${width}.png`), fullPage: true });
      await page.click('#contents a[href="#study-figures"]');
      // The browser tells the page of a new hash when it comes to it: the list of contents unfolds them.
      await page.waitForSelector('#figure-fig2a .plot');
      await page.waitForSelector('#figure-fig2a .u-over');
      await settled(page);
      await page.screenshot({ path: at(`study-${width}-figures.png`) });
    }));
}

await claim('screenshots_are_written', async () => {
  for (const dark of [false, true]) {
    await opened('limb.html', { width: 1280, height: 800, dark }, async (page) => {
      await page.selectOption('#choose-rule', dark ? 'approach2' : 'exact');
      await slide(page, 'frame', 6);
      await page.click('#coloring [data-value=branch]');
      await settled(page);
      await page.screenshot({ path: at(dark ? 'wide-dark.png' : 'wide-light.png') });
    });
  }
});

await close();
