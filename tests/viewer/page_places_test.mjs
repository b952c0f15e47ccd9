// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page in a real browser: on narrow screens, without a motion, below a study. Writes screenshots to look at.
import { at, check, claim, equal } from './support.mjs';
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
    equal(await words(page, '#claim-later .verdict'), 'not decided', 'a claim without cases, in the word of the study');
    equal(await page.getAttribute('#claim-uncovered', 'data-verdict'), 'better', 'and its color');
    const curves = page.locator('#claim-approach2-below-approach1 .u-over');
    await curves.scrollIntoViewIfNeeded();
    const now = await curves.boundingBox();
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

await claim('the_first_screen_has_the_study_in_three_sentences_and_its_figures', () =>
  opened('study.html', { width: 1400, height: 900 }, async (page) => {
    equal((await page.locator('.told').allInnerTexts()).join(' '), study.summary.join(' '), 'sentences');
    const bottom = async (selector) => page.locator(selector).last().evaluate((e) => e.getBoundingClientRect().bottom);
    for (const selector of ['.told', '#fig1 img', '.smalls .u-over', '.pair .kinds', '#stage canvas']) check((await bottom(selector)) <= 900, `${selector} ends at ${await bottom(selector)}`);
    equal((await page.locator('.small h3').allInnerTexts()).join(), ['a', 'b', 'c', 'd'].map((part) => `Fig. 2 ${part}. Looseness`).join(), 'Fig. 2');
    const high = await page.locator('#report').evaluate((report) => report.scrollHeight / innerHeight);
    check(high <= 15, `the column has ${high} screens`);
    check(!(await page.isVisible('#claim-approach2-below-approach1 table')), 'statistics are folded');
    equal(await words(page, '#claim-approach2-below-approach1 .spread'), 'holds in 1 of 2, partly in 1 of 2', 'spread');
    equal(await words(page, '#claim-approach2-below-approach1 .place'), 'results, Fig. 2 a', 'the place in the paper');
    check((await page.locator('#claim-approach2-below-approach1 table').textContent()).includes('3 of 6'), 'cases of a trial');
    equal(await words(page, '.tally'), 'holds 2\nbetter 1\npartly 1\nfails 1\nnot decided 1', 'tally, in the words of the study');
  }));

await claim('rules_look_the_same_in_all_figures_of_either_theme_and_no_two_look_alike', () =>
  opened('study.html', { width: 1400, height: 900 }, async (page) => {
    for (const theme of ['light', 'dark']) {
      if (theme === 'dark') await page.keyboard.press('t');
      await settled(page);
      const seen = await page.evaluate(() => [...document.querySelectorAll('.kind:has(.swatch)')].map((kind) => [kind.innerText, [...kind.querySelectorAll('.swatch path')].map((p) => ['stroke', 'fill', 'stroke-dasharray', 'd'].map((a) => p.getAttribute(a)).join()).join(' ')]));
      const looks = new Map(seen);
      for (const [name, look] of seen) if (['approach 1', 'approach 2', 'exact', 'built anew'].includes(name)) equal(look, looks.get(name), name);
      const ours = ['approach 1', 'approach 2', 'exact', 'built anew', 'surface uncovered'].map((name) => looks.get(name));
      equal(new Set(ours).size, 5, 'looks');
      check(ours[0].includes(theme === 'light' ? '#911a01' : '#e86f0a'), `${theme}: ${ours[0]}`);
    }
  }));

await claim('titles_take_one_line_and_nothing_sticks_out', async () => {
  for (const width of [1400, 800, 390]) {
    await opened('study.html', { width, height: 900 }, async (page) => {
      await page.evaluate(() => document.querySelectorAll('#report details').forEach((fold) => (fold.open = true)));
      await settled(page);
      const found = await page.evaluate(() => {
        const place = document.getElementById('report').getBoundingClientRect();
        const out = [...document.querySelectorAll('#report *')].filter((e) => !e.closest('.wide, pre, svg') && e.getBoundingClientRect().right > place.right + 0.5);
        const tall = [...document.querySelectorAll('.one-line')].filter((e) => e.getClientRects().length > 0 && e.clientHeight > 1.7 * parseFloat(getComputedStyle(e).fontSize));
        return [...out, ...tall].map((e) => `${e.localName}.${e.className}`);
      });
      equal(found.join(), '', `at ${width} pixels`);
    });
  }
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
