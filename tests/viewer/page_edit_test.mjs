// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Editing a robot's spheres in a real browser: colliding links, rates, undo, and saved spheres that the command certifies.
import { readFileSync, writeFileSync } from 'node:fs';
import { at, check, claim, equal, run } from './support.mjs';
import { settled, slide } from './browser.mjs';
import { close, compare, opened, picture, words } from './limb.mjs';
import { urdf, writeRobot } from './robot.mjs';

const spheres = writeRobot('arm');
const count = [...spheres.values()].reduce((sum, list) => sum + list.length, 0);
const large = { width: 1100, height: 800 };
const pickSphere = async (page, link) => {
  await page.locator('#figures tbody tr', { hasText: link }).click();
  await page.locator('#picked footer button').nth(1).click();
  await settled(page);
};
const shownCount = async (page) => Number(/(\d+) spheres/.exec(await words(page, '#about'))[1]);
const fields = (page) => page.locator('#edit-fields input').evaluateAll((inputs) => inputs.map((input) => input.valueAsNumber));
const isCovered = (page, covered) => page.waitForFunction((wanted) => document.getElementById('edit-cover').dataset.bare === String(!wanted), covered);

await claim('colliding_links_are_red_and_listed', () =>
  opened('arm/robot.html', large, async (page) => {
    await slide(page, 'level', 2);
    await slide(page, 'opacity', 1);
    equal(await page.locator('#pairs button').count(), 0, 'pairs that collide at rest');
    const before = await picture(page);
    equal((await compare(before, before)).red, 0, 'red at rest');
    await slide(page, 'joint-1', 1.5);
    await slide(page, 'joint-2', 2.6);
    const names = await page.locator('#pairs button[data-collides=true] span:first-child').allInnerTexts();
    check(names.length > 0, 'some collide');
    check((await words(page, '#legend')).includes(names[0]), 'the legend has the first');
    const far = await picture(page);
    await page.locator('#pairs button').first().click();
    const near = await picture(page);
    check((await compare(far, near)).changed > 0.05, 'a press brings them near');
    check((await compare(far, near)).red > 0.002, 'their spheres are red');
    await page.click('#other-pairs summary');
    check((await page.locator('#other-pairs button').first().getAttribute('title')).includes('neighbors'), 'a reason');
  }));

await claim('random_configurations_are_counted_while_the_page_answers', () =>
  opened('arm/robot.html', large, async (page) => {
    // In the page, between two slices of the count: it could end while this program waits for an answer.
    const meanwhile = await page.evaluate(async () => {
      const at = (id) => document.getElementById(id);
      at('rate-count').value = '1000000';
      const counted = new Promise((done) => new MutationObserver(() => at('rate').textContent.includes('%') && done()).observe(at('rate'), { childList: true }));
      at('rate-run').click();
      await counted;
      at('joint-0').value = '0.5';
      at('joint-0').dispatchEvent(new Event('input', { bubbles: true }));
      const seen = { angle: document.querySelector('#joints output').textContent, button: at('rate-run').textContent };
      at('rate-run').click();
      return { ...seen, after: at('rate-run').textContent };
    });
    equal(meanwhile.angle, '28.6°', 'a slider moves meanwhile');
    equal(meanwhile.button, 'Stop', 'it still counts');
    equal(meanwhile.after, 'Count', 'until it is stopped');
    await page.fill('#rate-count', '200');
    await page.click('#rate-run');
    await page.waitForFunction(() => document.getElementById('rate').textContent.includes('of 200 collide') && document.getElementById('rate-run').textContent === 'Count');
  }));

await claim('spheres_are_moved_added_and_removed_and_all_is_undone', () =>
  opened('arm/robot.html', large, async (page) => {
    equal(await shownCount(page), count, 'spheres of the files');
    await pickSphere(page, 'base');
    const first = spheres.get('base')[0];
    equal((await fields(page)).join(), first.join(), 'exact numbers');
    await isCovered(page, true);
    await page.fill('#edit-r', String(first[3] / 4));
    await page.locator('#edit-r').blur();
    await isCovered(page, false);
    check((await words(page, '#edit-cover')).startsWith('Uncovered (estimate)'), 'it says so');
    await page.click('#edit-copy');
    equal(await shownCount(page), count + 1, 'one more');
    await page.click('#edit-add');
    equal(await shownCount(page), count + 2, 'two more');
    await page.locator('#stage canvas').focus();
    await page.keyboard.press('Delete');
    equal(await shownCount(page), count + 1, 'one less');
    for (let k = 0; k < 4; ++k) await page.keyboard.press('Control+z');
    equal(await shownCount(page), count, 'as it was');
    await isCovered(page, true);
    check(await page.isDisabled('#edit-undo'), 'nothing is left to undo');
    await page.keyboard.press('Control+y');
    await isCovered(page, false);
    await page.keyboard.press('Control+z');
    await isCovered(page, true);
    // An estimate that has not begun counts for Add.
    await page.evaluate((r) => {
      const radius = document.getElementById('edit-r');
      radius.value = String(r);
      radius.dispatchEvent(new Event('input', { bubbles: true }));
      document.getElementById('edit-add').click();
    }, first[3] / 4);
    const added = await fields(page);
    check(Math.hypot(...[0, 1, 2].map((k) => added[k] - first[k])) > first[3] / 4, 'added where it is uncovered');
    for (let k = 0; k < 2; ++k) await page.keyboard.press('Control+z');
    await page.fill('#edit-r', '-1');
    equal(await page.getAttribute('#edit-r', 'aria-invalid'), 'true', 'no sphere');
    check(await page.isDisabled('#edit-undo'), 'and no change');
  }));

await claim('a_drag_moves_the_picked_sphere_and_a_drag_elsewhere_turns', () =>
  opened('arm/robot.html', large, async (page) => {
    await pickSphere(page, 'elbow');
    await page.check('#edit-drag');
    // Somewhere in the picture is the elbow's only sphere; a drag beside it turns the view, which fits again then.
    const box = await page.locator('#stage canvas').boundingBox();
    const before = await fields(page);
    let moved = false;
    for (let y = 0.2; y < 0.9 && !moved; y += 0.05) {
      for (let x = 0.2; x < 0.8 && !moved; x += 0.05) {
        const [px, py] = [box.x + x * box.width, box.y + y * box.height];
        if ((await page.evaluate(([u, v]) => document.elementFromPoint(u, v)?.tagName, [px, py])) !== 'CANVAS') continue;
        await page.mouse.move(px, py);
        await page.mouse.down();
        await page.mouse.move(px + 20, py + 10, { steps: 3 });
        await page.mouse.up();
        moved = (await fields(page)).join() !== before.join();
        if (!moved) await page.click('#fit');
      }
    }
    check(moved, 'it moved');
    await page.locator('#stage canvas').focus();
    await page.keyboard.press('Control+z');
    equal((await fields(page)).join(), before.join(), 'one undo for the whole drag');
  }));

await claim('edits_are_saved_and_the_shown_command_certifies_them', () =>
  opened('arm/robot.html', large, async (page) => {
    await pickSphere(page, 'base');
    const first = spheres.get('base')[0];
    await page.fill('#edit-x', String(first[0] + 0.02));
    await page.locator('#edit-x').blur();
    await page.click('#edit-add');
    await page.click('#edit-refit');
    await page.waitForFunction(() => !document.getElementById('edit-refit').disabled);
    await isCovered(page, true);
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#edit-save')]);
    equal(download.suggestedFilename(), 'spheres.json', 'name');
    await download.saveAs(at('spheres.json'));
    const saved = new Map(JSON.parse(readFileSync(at('spheres.json'), 'utf8')).links.map(({ link, spheres: list }) => [link, list]));
    equal(saved.get('base').length, spheres.get('base').length + 1, 'spheres of the base');
    equal(saved.get('base')[0].center[0], first[0] + 0.02, 'the edited one was kept');
    equal(JSON.stringify(saved.get('forearm').map(({ center, radius }) => [...center, radius])), JSON.stringify(spheres.get('forearm')), 'others are as they were');
    const line = (await words(page, '#edit-command')).trim();
    equal(line, 'morula robot arm.urdf -o edited --keep spheres.json --all-formats --page', 'command');
    const args = line.split(' ').slice(1).map((word) => (word === 'arm.urdf' ? urdf('arm') : word));
    const report = JSON.parse(run([...args, '--samples', '20', '--json']));
    check(report.covered, 'covered');
    equal(report.spheres, count + 1, 'spheres');
    // The same file without one sphere is not covered: the command does look.
    const less = JSON.parse(readFileSync(at('spheres.json'), 'utf8'));
    less.links[0].spheres.pop();
    writeFileSync(at('less.json'), JSON.stringify(less));
    let refused = false;
    try {
      run(['robot', urdf('arm'), '-o', 'less', '--keep', 'less.json', '--format', 'json', '--samples', '20', '--json']);
    } catch (error) {
      refused = error.status === 1;
    }
    check(refused, 'an uncovered link is told');
  }));

/** many/robot.html: a link with a mesh of more than 10,000 facets, and a small one that turns on it. */
function writeManyFacets() {
  const rings = 100;
  const point = (i, k) => {
    const [u, v] = [(Math.PI * (i + 0.5)) / rings, (Math.PI * k) / rings];
    return `v ${Math.sin(u) * Math.cos(v)} ${Math.sin(u) * Math.sin(v)} ${2 * Math.cos(u)}\n`;
  };
  const corner = (i, k) => 1 + 2 * rings * i + (k % (2 * rings));
  const each = (count, f) => Array.from({ length: count }, (_, i) => Array.from({ length: 2 * rings }, (__, k) => f(i, k)).join('')).join('');
  const sides = each(rings - 1, (i, k) => `f ${corner(i, k)} ${corner(i + 1, k)} ${corner(i + 1, k + 1)} ${corner(i, k + 1)}\n`);
  const ends = [0, rings - 1].map((i) => `f ${Array.from({ length: 2 * rings }, (_, k) => corner(i, i === 0 ? k : 2 * rings - k)).join(' ')}\n`);
  writeFileSync(at('egg.obj'), each(rings, point) + sides + ends.join(''));
  const shape = (inside) => `<collision><geometry>${inside}</geometry></collision>`;
  writeFileSync(at('many.urdf'), `<robot name="many"><link name="egg">${shape('<mesh filename="egg.obj"/>')}</link><link name="knob">${shape('<box size="0.2 0.2 0.2"/>')}</link>
    <joint name="turn" type="revolute"><parent link="egg"/><child link="knob"/><origin xyz="0 0 3"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>`);
  run(['robot', 'many.urdf', '-o', 'many', '--link', 'egg=48', '--samples', '20', '--page', '--format', 'json']);
}
await claim('the_cover_of_many_facets_is_estimated_while_the_page_answers', () => {
  writeManyFacets();
  return opened('many/robot.html', large, async (page) => {
    await pickSphere(page, 'egg');
    await isCovered(page, true);
    const radius = (await fields(page))[3];
    // Said in the page, as the radius is typed: no other program has to be in time.
    const seen = await page.evaluate(async (r) => {
      const cover = document.getElementById('edit-cover');
      const type = (id, value) => {
        const input = document.getElementById(id);
        input.value = String(value);
        input.dispatchEvent(new Event('input', { bubbles: true }));
      };
      const verdicts = [];
      const changed = () => cover.dataset.bare !== undefined && verdicts.push(cover.dataset.bare);
      const observer = new MutationObserver(changed);
      observer.observe(cover, { attributes: true, attributeFilter: ['data-bare'] });
      const rest = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
      type('edit-r', 0.5 * r);
      const at = { once: [cover.dataset.bare, cover.textContent] };
      let turns = 0;
      while (cover.dataset.bare === undefined) {
        await rest(0);
        if (cover.dataset.bare === undefined) type('joint-0', 0.01 * (++turns % 50));
      }
      // Another change ends an estimate that has begun, and its verdict is never told.
      await rest(0);
      at.first = verdicts.splice(0).join();
      type('edit-r', 0.4 * r);
      await rest(60);
      at.begun = cover.dataset.bare === undefined;
      type('edit-r', r);
      while (cover.dataset.bare === undefined) await rest(0);
      await rest(100);
      observer.disconnect();
      return { ...at, turns, second: verdicts.join() };
    }, radius);
    equal(seen.once.join(), ',Estimating the cover…', 'no verdict of other spheres remains');
    check(seen.turns > 5, `the joint turned ${seen.turns} times meanwhile`);
    equal(seen.first, 'true', 'uncovered');
    check(seen.begun, 'the second estimate takes longer than it was given');
    equal(seen.second, 'false', 'covered');
  });
});

await claim('a_phone_has_room_for_it', () =>
  opened('arm/robot.html', { width: 390, height: 844, touch: true }, async (page) => {
    await pickSphere(page, 'base');
    await page.click('#edit-copy');
    await settled(page);
    equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, 'nothing sticks out');
    await page.click('#edit-undo');
  }));

await close();
