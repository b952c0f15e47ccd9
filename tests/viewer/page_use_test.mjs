// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page in a real browser: what readers do with it.
import { readFileSync } from 'node:fs';
import { at, check, claim, equal } from './support.mjs';
import { slide } from './browser.mjs';
import { close, compare, onShared, opened, picture, words, writeLimb } from './limb.mjs';
import { figure } from '../../viewer/src/numbers.js';

writeLimb();

await claim('a_picked_sphere_shows_its_numbers', () =>
  onShared(async (page) => {
    await page.selectOption('#choose-rule', 'approach2');
    await slide(page, 'frame', 5);
    await slide(page, 'level', 2);
    check(!(await page.isVisible('#picked')), 'nothing is picked at first');
    const before = await picture(page);
    const box = await page.locator('#stage canvas').boundingBox();
    for (let y = 0.3; y < 0.8 && !(await page.isVisible('#picked')); y += 0.05) {
      await page.mouse.click(box.x + 0.4 * box.width, box.y + y * box.height);
    }
    const node = Number((await words(page, '#picked strong')).replace('Sphere ', ''));
    const tree = JSON.parse(readFileSync(at('spheres/0005.json'), 'utf8'));
    const sphere = (tree.spheres ?? tree.nodes)[node];
    const radius = Array.isArray(sphere) ? sphere[3] : sphere.radius;
    equal(await words(page, '#picked-radius'), figure(radius), `radius of sphere ${node}`);
    check((await compare(before, await picture(page))).changed > 0.0005, 'its outline is drawn');
    await slide(page, 'frame', 0);
    equal(await words(page, '#picked-growth'), '× 1.000', 'growth at rest');
    await page.keyboard.press('Escape');
    check(!(await page.isVisible('#picked')), 'Escape lets go');
  }));

await claim('the_section_plane_opens_the_body', () =>
  onShared(async (page) => {
    const whole = await picture(page);
    await page.keyboard.press('z');
    const cut = await picture(page);
    check((await compare(whole, cut)).changed > 0.03, 'the plane shows');
    await page.keyboard.press('.');
    check((await compare(cut, await picture(page))).changed > 0.001, 'it moves');
    await page.keyboard.press('z');
    equal((await compare(whole, await picture(page))).changed, 0, 'pixels that stay changed');
  }));

await claim('the_keyboard_does_all', () =>
  onShared(async (page) => {
    const frame = () => page.locator('#frame').inputValue();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('ArrowRight');
    equal(await frame(), '2', 'frame');
    await page.keyboard.press('[');
    equal(await page.locator('#level').inputValue(), '2', 'level');
    await page.keyboard.press('End');
    equal(await frame(), '12', 'last frame');
    await page.keyboard.press('Space');
    while ((await frame()) === '12') await new Promise((done) => setTimeout(done, 20)); // the policy forbids what waitForFunction does
    equal(await page.getAttribute('#play', 'aria-label'), 'Pause', 'play button');
    await page.keyboard.press('Space');
    equal(await page.getAttribute('#play', 'aria-label'), 'Play', 'play button');
    const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
    equal(await theme(), 'light', 'theme');
    await page.keyboard.press('t');
    equal(await theme(), 'dark', 'theme');
    await page.keyboard.press('t');
    await page.keyboard.press('s');
    check(!(await page.isChecked('#show-spheres')), 's hides the spheres');
    await page.keyboard.press('s');
    await page.keyboard.press('?');
    check(await page.isVisible('#help'), 'the list of keys');
    await page.keyboard.press('Escape');
    check(!(await page.isVisible('#help')), 'and away');
  }));

await claim('curves_lead_to_the_frame', () =>
  onShared(async (page) => {
    await page.click('#measure [data-value=uncovered_area]');
    const box = await page.locator('#curves .u-over').boundingBox();
    await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
    equal(await page.locator('#frame').inputValue(), '6', 'frame in the middle');
  }));

await claim('a_motion_plays_at_first_unless_the_address_or_the_reader_says_otherwise', async () => {
  const playing = (page) => page.getAttribute('#play', 'aria-label').then((label) => label === 'Pause');
  const frame = (page) => page.locator('#frame').inputValue();
  await opened('limb.html', { motion: 'no-preference' }, async (page) => {
    check(await playing(page), 'it plays');
    const first = await frame(page);
    while ((await frame(page)) === first) await new Promise((done) => setTimeout(done, 20));
    equal(await page.evaluate(() => location.hash), '', 'address of a page that plays');
    await page.keyboard.press('Space');
    check(!(await playing(page)), 'it stops');
  });
  await opened('limb.html', { motion: 'no-preference', hash: '#frame=6' }, async (page) => {
    check(!(await playing(page)), 'an address that names a frame shows it');
    equal(await frame(page), '6', 'frame');
  });
  await opened('limb.html', {}, async (page) => check(!(await playing(page)), 'a reader who wants no motion sees none'));
});

await close();
