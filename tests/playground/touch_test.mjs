// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The playground in a browser: a tool and a second body that press, their contacts and figures.
import { claim } from '../viewer/support.mjs';
import { check, close, equal, farthest, folder, idle, opened, pose, words } from './playground.mjs';

const number = async (page, id) => Number((await words(page, `#${id}`)).replace(/[, ]|or fewer/g, ''));

await claim('a_tool_presses_the_body_and_the_figures_tell', () =>
  opened('#bend=0&detail=1500', {}, async (page) => {
    const rest = await pose(page);
    await page.click('#touching [data-value=tool]');
    await page.waitForFunction(() => document.getElementById('figure-tests').textContent !== '–');
    equal(await number(page, 'figure-crossings'), 0, 'crossings at first');
    let [crossings, contacts] = [0, 0];
    for (let press = 0; press <= 0.2; press += 0.02) {
      await page.locator('#press').evaluate((range, value) => {
        range.value = String(value);
        range.dispatchEvent(new Event('input', { bubbles: true }));
      }, press);
      await page.waitForTimeout(250);
      crossings = Math.max(crossings, await number(page, 'figure-crossings'));
      contacts = Math.max(contacts, await number(page, 'figure-contacts'));
    }
    check(crossings > 0 && contacts > 0, `${crossings} crossings, ${contacts} contacts`);
    check((await number(page, 'figure-tests')) > contacts, 'tests of a query');
    check(farthest(await pose(page), rest) > 0.02, 'the body is dented');
    equal(await words(page, '#figure-uncovered'), '0, proven', 'under the tool');
    await page.screenshot({ path: `${folder}/tool.png` });
    await page.click('#touching [data-value=none]');
    await idle(page);
    equal(farthest(await pose(page), rest), 0, 'it comes back without the tool');
  }));

await claim('two_bodies_press_each_other_apart', () =>
  opened('#bend=0&detail=1500&touch=body&place=0,-0.12,0', {}, async (page) => {
    await page.waitForFunction(() => document.getElementById('figure-tests').textContent !== '–');
    await page.waitForTimeout(1500);
    const pressed = await pose(page);
    await page.screenshot({ path: `${folder}/bodies.png` });
    await page.click('#touching [data-value=none]');
    await idle(page);
    check(farthest(await pose(page), pressed) > 0.01, 'the first body was dented');
  }));

await claim('the_tool_is_dragged_by_the_pointer_and_its_place_is_in_the_address', () =>
  opened('#bend=0&detail=1500&touch=tool', {}, async (page) => {
    await page.waitForFunction(() => document.getElementById('figure-tests').textContent !== '–');
    await page.locator('#stage canvas').focus();
    await page.keyboard.press('Shift+ArrowDown');
    await page.waitForFunction(() => location.hash.includes('place='));
    await idle(page);
    // The tool stands on the middle of the body.
    const box = await page.locator('#stage canvas').boundingBox();
    const before = await page.evaluate(() => location.hash);
    const [x, y] = [box.x + 0.5 * box.width, box.y + 0.36 * box.height];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 40, y + 5, { steps: 3 });
    await page.mouse.up();
    await page.waitForFunction((hash) => location.hash !== hash, before);
    const place = /place=([^&]*)/.exec(await page.evaluate(() => location.hash))[1].split(',').map(Number);
    check(Math.abs(place[0]) + Math.abs(place[2]) > 0.02, `${before} to ${place}`);
  }));

await close();
