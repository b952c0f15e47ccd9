// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The playground in a browser: what a reader asks for in an order that nobody planned, and the outlines of the picture.
import { writeFileSync } from 'node:fs';
import { open } from '../viewer/browser.mjs';
import { at, claim } from '../viewer/support.mjs';
import { browser, check, close, equal, file, idle, opened, words } from './playground.mjs';

const small = '#detail=1500';
const tetrahedron = 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n';
const isBuilding = (page) => page.waitForFunction(() => document.body.dataset.building === 'true');
/** Presses a button while a build runs, without a wait in between. */
const press = (page, selector) => page.locator(selector).evaluate((button) => button.click());

await claim('a_canceled_build_leaves_the_choices_of_the_tree_that_is_shown', () =>
  opened(small, {}, async (page) => {
    await page.selectOption('#quality', 'best');
    await press(page, '#details [data-value="20000"]');
    await isBuilding(page);
    await press(page, '#touching [data-value="tool"]');
    await page.focus('#method');
    await page.keyboard.press('Escape'); // a choice that has the focus does not keep it
    await page.waitForFunction(() => document.getElementById('figure-tests').textContent !== '–');
    await idle(page);
    check(Number((await words(page, '#figure-facets')).replace(',', '')) < 2000, 'the mesh before');
    equal(await page.getAttribute('#details [data-value="1500"]', 'aria-pressed'), 'true', 'its number of facets');
    check(await page.evaluate(() => window.playground.world.other !== null), 'the tool comes after all');
    await page.waitForFunction(() => location.hash === '#detail=1500&touch=tool' || location.hash === '#detail=1500&quality=best&touch=tool');

    await press(page, '#details [data-value="20000"]');
    await isBuilding(page);
    await press(page, '#touching [data-value="none"]');
    await page.keyboard.press('Escape');
    await idle(page);
    check(await page.evaluate(() => window.playground.world.other === null), 'the tool goes');
  }));

await claim('an_address_with_the_rule_of_a_character_shows_a_sample_all_the_same', () =>
  opened(small, {}, async (page) => {
    await page.evaluate(() => (location.hash = '#detail=1500&rule=skinned&bend=20'));
    await page.waitForFunction(() => document.getElementById('bend').value === '20');
    await idle(page);
    equal(await page.inputValue('#rule'), 'exact', 'rule');
    equal(await words(page, '#figure-uncovered'), '0, proven', 'cover');
  }));

await claim('a_place_out_of_reach_in_an_address_does_no_harm', () =>
  opened('#detail=1500&touch=body&place=1e300,-1e300,0', {}, async (page) => {
    equal(await words(page, '#figure-crossings'), '0', 'crossings');
    equal(await words(page, '#figure-uncovered'), '0, proven', 'cover');
  }));

await claim('the_sample_comes_back_after_a_file', () =>
  opened(small, {}, async (page) => {
    const title = await words(page, '#title');
    writeFileSync(at('tetrahedron.obj'), tetrahedron);
    await page.setInputFiles('#file', at('tetrahedron.obj'));
    await page.waitForFunction(() => document.getElementById('title').textContent === 'tetrahedron.obj');
    equal(await page.inputValue('#shape'), '', 'no sample is chosen');
    await page.selectOption('#shape', 'limb');
    await page.waitForFunction((text) => document.getElementById('title').textContent === text, title);
    await idle(page);
  }));

await claim('a_number_of_spheres_out_of_range_is_put_right_every_time', () =>
  opened(small, {}, async (page) => {
    for (let round = 0; round < 2; ++round) {
      await page.locator('#flat').fill('-3');
      await page.keyboard.press('Tab');
      equal(await page.inputValue('#flat'), '0', 'flat set');
    }
  }));

await claim('a_job_waits_for_a_module_that_takes_its_time', async () => {
  const { page, complaints, close: shut } = await open(browser, file, { width: 900, height: 600 });
  await page.addInitScript(() => {
    const slow = 'const made = WebAssembly.instantiate; WebAssembly.instantiate = async (...all) => (await new Promise((done) => setTimeout(done, 300)), made(...all));\n';
    const Plain = Blob;
    window.Blob = class extends Plain {
      constructor(parts, options) {
        super(options?.type === 'text/javascript' ? [slow, ...parts] : parts, options);
      }
    };
  });
  await page.reload();
  await page.waitForSelector('body[data-ready="true"]');
  await idle(page);
  await page.locator('#shape').evaluate((choice) => {
    for (const shape of ['torus', 'capsule']) { // the second ends the build of the first, and its worker
      choice.value = shape;
      choice.dispatchEvent(new Event('change'));
    }
  });
  await idle(page);
  equal(await words(page, '#title'), 'Capsule', 'body');
  check(!(await page.isVisible('#message')), await words(page, '#message-text'));
  equal(complaints.join('\n'), '', 'complaints');
  await shut();
});

await claim('the_inside_of_a_closed_body_does_not_dot_its_outlines', () =>
  opened('#tour=5', { width: 1440, height: 900 }, async (page) => {
    const [dots, all] = await page.evaluate(() => {
      const { stage } = window.playground;
      const insides = [stage.body, stage.twin.body].map((body) => body.parts[1]);
      const gl = stage.renderer.getContext();
      const picture = (isOn) => {
        for (const inside of insides) inside.visible = isOn;
        stage.draw();
        const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
        gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return pixels;
      };
      const [without, without2, withIt] = [picture(false), picture(false), picture(true)];
      const differs = (a, b) => a.reduce((count, value, i) => count + (Math.abs(value - b[i]) > 6 ? 1 : 0), 0);
      return [differs(without, withIt), differs(without, without2), without.some((value) => value > 0)];
    });
    equal(all, 0, 'the same picture twice');
    check(dots < 600, `${dots} values of pixels differ`);
  }));

await close();
