// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of a robot in a real browser: sliders move it, and nothing that a robot's file says becomes markup.
import { readFileSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { at, check, claim, equal, run } from './support.mjs';
import { open, settled, slide } from './browser.mjs';
import { browser, close, compare, opened, picture, small, words } from './limb.mjs';
import { whereLinksAre, writeRobot } from './robot.mjs';
import { figure } from '../../viewer/src/numbers.js';

const spheres = writeRobot('arm', ['--inner', '4']);

await claim('a_slider_for_every_joint_moves_the_robot', () =>
  opened('arm/robot.html', { width: 1100, height: 800 }, async (page) => {
    equal(await page.locator('#joints input').count(), 5, 'sliders');
    equal((await page.locator('#joints span').allInnerTexts()).join(), 'turn,lift,bend,reach,roll', 'names');
    check(!(await page.isVisible('#transport')) && !(await page.isVisible('#over-time')), 'there are no frames');
    const before = await picture(page);
    await slide(page, 'joint-1', 1.0);
    equal(await page.locator('#joints output').nth(1).innerText(), '57.3°', 'its value');
    check((await compare(before, await picture(page))).changed > 0.02, 'the picture changes');
    // The row of a link picks the sphere around it; one of its spheres is told by arithmetic of the test's own.
    await page.locator('#figures tbody tr', { hasText: 'forearm' }).click();
    await page.locator('#picked footer button').nth(1).click();
    equal(await words(page, '#picked-link'), 'forearm', 'link');
    const [x, y, z] = whereLinksAre('arm', { lift: 1.0, bend: 1.55 })('forearm', spheres.get('forearm')[0].slice(0, 3));
    equal(await words(page, '#picked-center'), [x, y, z].map(figure).join('  '), 'center');
    await page.click('#joints-rest');
    await page.keyboard.press('Escape');
    equal((await compare(before, await picture(page))).changed, 0, 'pixels that stay changed');
  }));

await claim('the_address_has_the_joints', async () => {
  let address = '';
  let seen = '';
  await opened('arm/robot.html', {}, async (page) => {
    await page.click('#joints-random');
    // A busy browser tells of the new address late.
    await page.waitForFunction(() => location.hash.includes('joints='));
    address = await page.evaluate(() => location.hash);
    check(address.includes('joints='), address);
    seen = await picture(page);
  });
  for (const [hash, same] of [[address, true], ['#joints=1,2', false], ['#joints=a,b,c,d,e', false]]) {
    const { page, complaints, close: leave } = await open(browser, at('arm/robot.html'), small);
    await page.goto('about:blank');
    await page.goto(pathToFileURL(at('arm/robot.html')).href + hash);
    await settled(page);
    equal((await compare(seen, await picture(page))).changed < 0.003, same, hash);
    equal(complaints.join('\n'), '', 'complaints of the browser');
    await leave();
  }
});

await claim('it_swings_and_stops', () =>
  opened('arm/robot.html', {}, async (page) => {
    const first = () => page.locator('#joint-0').inputValue();
    const before = await first();
    await page.click('#joints-play');
    for (let i = 0; i < 200 && (await first()) === before; ++i) await page.waitForTimeout(20);
    check((await first()) !== before, 'it moves');
    equal(await words(page, '#joints-play'), 'Stop', 'button');
    await page.click('#joints-play');
    await settled(page);
    const still = await first();
    await page.waitForTimeout(200);
    equal(await first(), still, 'it stops');
  }));

await claim('inner_spheres_are_shown_by_a_menu', () =>
  opened('arm/robot.html', {}, async (page) => {
    const before = await picture(page);
    await page.selectOption('#choose-tree', 'inner spheres');
    await settled(page);
    const inner = await picture(page);
    check(!(await page.isChecked('#show-body')), 'the body, which would hide them, is hidden');
    const { changed, red } = await compare(before, inner);
    check(changed > 0.02 && red < 0.002, 'they are smaller, and nothing is called uncovered');
    await page.click('#show-body');
    check((await compare(inner, await picture(page))).red < 0.002, 'with the body, too');
    await page.selectOption('#choose-tree', 'spheres that cover');
    await settled(page);
    check(await page.isChecked('#show-body'), 'and it comes back');
    equal((await compare(before, await picture(page))).changed, 0, 'pixels that stay changed');
  }));

await claim('names_of_links_and_joints_are_text', async () => {
  const bad = `&quot;&lt;script&gt;window.harmed=1&lt;/script&gt;&lt;b class=harm&gt;&lt;img class=harm src=x onerror=window.harmed=1&gt;`;
  writeFileSync(at('bad.urdf'), `<robot name="${bad}"><link name="a${bad}"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
    <link name="b${bad}"><collision><geometry><sphere radius="0.4"/></geometry></collision></link>
    <link name="c${bad}"><collision><geometry><box size="1 2 1"/></geometry></collision></link>
    <joint name="j${bad}" type="revolute"><parent link="a${bad}"/><child link="b${bad}"/><origin xyz="2 0 0"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
    <joint name="k${bad}" type="prismatic"><parent link="b${bad}"/><child link="c${bad}"/><origin xyz="2 0 0"/><axis xyz="1 0 0"/><limit lower="-4" upper="1"/></joint></robot>`);
  run(['robot', 'bad.urdf', '-o', 'bad', '--spheres', '4', '--page', '--format', 'json']);
  check(!readFileSync(at('bad/robot.html'), 'utf8').includes('<b class=harm>'), 'the file has no such element');
  const { page, complaints, close: leave } = await open(browser, at('bad/robot.html'), small);
  await settled(page);
  await slide(page, 'joint-1', -4);
  check((await words(page, '#legend')).includes('<img class=harm'), 'links that meet are named');
  await page.locator('#figures tbody tr').first().click();
  check((await words(page, '#picked-link')).includes('<b class=harm>'), 'as they are written');
  check((await page.locator('#joints span').first().innerText()).includes('<script>'), 'and joints');
  equal(await page.evaluate(() => [window.harmed, document.querySelectorAll('b.harm, img.harm').length].join()), ',0', 'harm');
  equal(complaints.join('\n'), '', 'complaints of the browser');
  await leave();
});

await close();
