// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page in a real browser: what it keeps. Its state in the address; pictures, films and models as files.
import { readFileSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { at, check, claim, equal, morula } from './support.mjs';
import { open, settled, slide } from './browser.mjs';
import { browser, close, compare, opened, picture, small, words, writeLimb } from './limb.mjs';
import { readAddress, writeAddress } from '../../viewer/src/address.js';

writeLimb(12);

await claim('addresses_read_back_and_nonsense_is_passed_over', async () => {
  const first = { scene: 0, frame: 0, level: 2, color: 'branch', opacity: 0.5, body: true, sectionAxis: '', picked: -1 };
  const now = { ...first, frame: 7, level: 3, color: 'growth', opacity: 0.25, body: false, sectionAxis: 'x', picked: 12 };
  equal(writeAddress(first, first, ''), '', 'nothing changed');
  const { values, camera } = readAddress(writeAddress(now, first, '1,2,3,0,0,0,y'));
  for (const name of ['frame', 'level', 'color', 'opacity', 'body', 'sectionAxis', 'picked']) equal(values[name], now[name], name);
  equal(camera, '1,2,3,0,0,0,y', 'camera');
  equal(readAddress('#figure-fig2a'), null, 'a link into the report');
  const odd = readAddress('#frame=-1&level=1.5&color=%3Cb%3E&opacity=7&body=yes&picked=1e99&frame2=3&sectionAt=').values;
  equal(Object.keys(odd).length, 0, 'values that are none');
});

await claim('the_page_begins_with_the_second_level_by_branch', () =>
  opened('limb.html', {}, async (page) => {
    equal(await page.locator('#level').inputValue(), '2', 'level');
    equal(await page.getAttribute('#coloring [data-value=branch]', 'aria-pressed'), 'true', 'color');
    check(!page.url().includes('#'), 'the address says nothing of it');
  }));

await claim('a_copied_address_shows_the_same', async () => {
  let address = '';
  let seen = '';
  await opened('limb.html', {}, async (page) => {
    await page.selectOption('#choose-rule', 'approach2');
    await slide(page, 'frame', 5);
    await slide(page, 'level', 1);
    await page.click('#coloring [data-value=growth]');
    await page.keyboard.press('z');
    const box = await page.locator('#stage canvas').boundingBox();
    await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.6 * box.width, box.y + 0.4 * box.height, { steps: 5 });
    await page.mouse.up();
    await settled(page);
    await page.waitForTimeout(500);
    address = new URL(page.url()).hash;
    for (const part of ['scene=1', 'frame=5', 'level=1', 'color=growth', 'sectionAxis=z', 'camera=']) {
      check(address.includes(part), `${address} has ${part}`);
    }
    seen = await picture(page);
  });
  const { page, close: leave } = await open(browser, at('limb.html'), small);
  await page.goto('about:blank');
  await page.goto(pathToFileURL(at('limb.html')).href + address);
  await settled(page);
  equal(await page.locator('#choose-rule').inputValue(), 'approach2', 'rule');
  equal(await page.locator('#frame').inputValue(), '5', 'frame');
  check((await compare(seen, await picture(page))).changed < 0.002, 'the same picture');
  await leave();
});

await claim('what_is_shown_is_saved_as_files', () =>
  opened('limb.html', {}, async (page) => {
    const file = async (id) => {
      const [download] = await Promise.all([page.waitForEvent('download'), page.click(`#${id}`)]);
      const path = at(download.suggestedFilename());
      await download.saveAs(path);
      return [download.suggestedFilename(), readFileSync(path)];
    };
    await slide(page, 'frame', 6);
    const [picture_name, png] = await file('save-png');
    check(/\.png$/.test(picture_name), picture_name);
    equal(png.subarray(1, 4).toString('latin1'), 'PNG', 'signature');
    const canvas = await page.locator('#stage canvas').evaluate((c) => [c.width, c.height]);
    equal([png.readUInt32BE(16), png.readUInt32BE(20)].join(), canvas.join(), 'size of the picture');
    check(png.length > 8000, 'the picture is not empty');

    const [, glb] = await file('save-gltf');
    equal(glb.subarray(0, 4).toString('latin1'), 'glTF', 'signature');
    equal(glb.readUInt32LE(8), glb.length, 'length');
    const json = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)).toString('utf8'));
    const spheres = json.nodes.filter((node) => /^sphere/.test(node.name));
    equal(`2 · ${spheres.length} spheres`, await words(page, '#level-name'), 'spheres of the level');
    const scale = spheres.map((node) => node.scale?.[0] ?? node.matrix?.[0]);
    check(scale.every((s) => s > 0), 'radii');
    const body = json.meshes[json.nodes.find((node) => node.name === 'body').mesh].primitives[0];
    equal(json.accessors[body.indices].count % 3, 0, 'facets of the body');

    const [film_name, webm] = await file('save-webm');
    check(/\.webm$/.test(film_name), film_name);
    equal(webm.subarray(0, 4).toString('hex'), '1a45dfa3', 'signature of the film');
    check(webm.length > 4000, `the film has ${webm.length} bytes`);
    equal(await page.locator('#frame').inputValue(), '6', 'the frame is as before');
  }));

await claim('two_bodies_show_where_they_touch', async () => {
  morula('sample capsule -o tool.obj --resolution 10');
  morula('collide limb.obj tool.obj --tree-a limb.morula --motion-a bend --translate-b 0,0.9,0 --page touch.html -o contacts.csv');
  const rows = readFileSync(at('contacts.csv'), 'utf8').trim().split('\n').map((line) => line.split(','));
  const column = (name) => rows[0].indexOf(name);
  const frames = [...new Set(rows.slice(1).map((row) => row[column('frame_a')]))];
  check(frames.length > 1, 'they touch in more than one frame');
  const touching = rows.slice(1).filter((row) => row[column('frame_a')] === frames[0] && Number(row[column('surface_depth')]) > 0);
  await opened('touch.html', {}, async (page) => {
    equal(await page.title(), 'limb and tool · Morula', 'title');
    const at_frame = await page.evaluate((name) => JSON.parse(document.getElementById('morula-manifest').textContent).motions[0].frames.findIndex((f) => f.startsWith(name)), frames[0]);
    await slide(page, 'frame', at_frame);
    check((await words(page, '#contacts-chip')).startsWith(`${touching.length.toLocaleString('en')} contact`), `${await words(page, '#contacts-chip')}: ${touching.length} rows have a depth`);
    const marked = await picture(page);
    await page.uncheck('#show-contacts');
    check((await compare(marked, await picture(page))).changed > 0.0003, 'contacts are drawn');
    await page.check('#show-contacts');
    await page.screenshot({ path: at('touch.png') });
  });
});

await claim('contact_patches_are_filled_on_both_bodies', async () => {
  morula('sample capsule -o tool.obj --resolution 10');
  const found = JSON.parse(morula('collide limb.obj tool.obj --tree-a limb.morula --motion-a bend --translate-b 0,0.9,0 --patches --page patches.html --json'));
  const frame = found.frames.findIndex((f) => f.patches.length > 0);
  check(frame >= 0, 'they overlap');
  await opened('patches.html', {}, async (page) => {
    await slide(page, 'frame', frame);
    const { patches } = found.frames[frame];
    const points = patches.reduce((sum, patch) => sum + patch.points.length, 0);
    const chip = await words(page, '#patches-chip');
    check(chip.startsWith(`${patches.length} patch`) && chip.includes('volume'), chip);
    check((await words(page, '#contacts-chip')).startsWith(`${points} point`), await words(page, '#contacts-chip'));
    const marked = await picture(page);
    await page.uncheck('#show-patches');
    check((await compare(marked, await picture(page))).changed > 0.0003, 'patches are drawn');
    equal(await page.locator('#patches-chip').count(), 0, 'chip of patches that are not shown');
    await page.check('#show-patches');
    check((await compare(marked, await picture(page))).changed < 0.0001, 'the same picture');
    await page.screenshot({ path: at('patches.png') });
  });
});

await claim('a_scene_shows_all_bodies_and_where_they_touch', async () => {
  morula('sample capsule -o tool.obj --resolution 10');
  writeFileSync(at('room.json'), JSON.stringify({ bodies: [
    { name: 'limb', mesh: 'limb.obj', tree: 'limb.morula', motion: 'bend' },
    { name: 'tool', mesh: 'tool.obj', translate: [0, 0.9, 0] },
    { name: 'far', mesh: 'tool.obj', path: [[5, 0, 0], [4, 0, 0], [3, 0, 0]] },
  ] }));
  morula('collide --scene room.json --page room.html -o room.csv');
  const touching = readFileSync(at('room.csv'), 'utf8').trim().split('\n').slice(1).map((line) => line.split(','))
    .filter((row) => row[0] === '0' && Number(row[row.length - 1]) > 0);
  check(touching.length > 0, 'they touch');
  await opened('room.html', {}, async (page) => {
    equal(await page.title(), 'room · Morula', 'title');
    await slide(page, 'frame', 0);
    check((await words(page, '#contacts-chip')).startsWith(`${touching.length.toLocaleString('en')} contact`), await words(page, '#contacts-chip'));
    await page.screenshot({ path: at('room.png') });
  });
});

await close();
