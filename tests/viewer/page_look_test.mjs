// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page in a real browser: what it draws.
import { check, claim, equal } from './support.mjs';
import { slide } from './browser.mjs';
import { close, compare, onShared, picture, specks, words, writeLimb } from './limb.mjs';

writeLimb();

await claim('sliders_change_what_is_drawn_and_back_again_draws_the_same', () =>
  onShared(async (page) => {
    const leaves = await words(page, '#figures tbody tr:last-child td:nth-child(2)');
    equal(await words(page, '#level-name'), `3 · ${leaves} spheres`, 'level');
    const first = await picture(page);
    for (const [id, value, least] of [['frame', 6, 0.05], ['level', 1, 0.05], ['opacity', 0.05, 0.05]]) {
      const before = await page.locator(`#${id}`).inputValue();
      await slide(page, id, value);
      const { changed } = await compare(first, await picture(page));
      check(changed > least, `#${id} changes ${changed} of the pixels`);
      await slide(page, id, before);
      equal((await compare(first, await picture(page))).changed, 0, `pixels that #${id} does not put back`);
    }
  }));

await claim('every_coloring_draws_something_else', () =>
  onShared(async (page) => {
    await slide(page, 'frame', 6);
    const seen = [];
    for (const color of ['level', 'branch', 'empty', 'growth']) {
      await page.click(`#coloring [data-value=${color}]`);
      const now = await picture(page);
      for (const other of seen) check((await compare(other, now)).changed > 0.01, `${color} looks like another`);
      seen.push(now);
    }
  }));

await claim('uncovered_surface_is_red_and_only_uncovered_surface', () =>
  onShared(async (page) => {
    await slide(page, 'frame', 6);
    const covered = await picture(page);
    equal((await compare(covered, covered)).red, 0, 'red pixels of the rule exact');
    equal(await words(page, '#uncovered-chip'), 'the whole surface is covered', 'legend');
    await page.selectOption('#choose-rule', 'approach2');
    const uncovered = await picture(page);
    check((await compare(uncovered, uncovered)).red > 0.002, 'approach2 shows red');
    check(/^uncovered \d/.test(await words(page, '#uncovered-chip')), 'the legend says how much');
    await page.uncheck('#show-uncovered');
    const hidden = await picture(page);
    equal((await compare(hidden, hidden)).red, 0, 'red pixels when it is turned off');
    await page.check('#show-uncovered');
  }));

// Where two spheres have the same depth, one of them colors the pixel.
await claim('seams_between_spheres_have_no_specks', () =>
  onShared(async (page) => {
    for (const frame of [0, 6]) {
      await slide(page, 'frame', frame);
      const found = await specks(await picture(page));
      check(found < 40, `frame ${frame} has ${found} specks`);
    }
  }));

await close();
