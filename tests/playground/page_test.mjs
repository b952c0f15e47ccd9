// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The playground in a browser: what it builds and shows, its addresses, tour, keys and layout.
import { claim, morula } from '../viewer/support.mjs';
import { open, settled } from '../viewer/browser.mjs';
import { browser, check, close, download, equal, farthest, file, folder, idle, opened, pose, set, share, vertices, words } from './playground.mjs';

await claim('it_builds_a_tree_and_shows_it', () =>
  opened('', {}, async (page) => {
    equal(await words(page, '#title'), 'Limb', 'title');
    const facets = Number((await words(page, '#figure-facets')).replace(',', ''));
    check(facets > 4000 && facets < 6000, `${facets} facets`);
    check((await page.locator('#level-ticks button').count()) >= 3, 'levels');
    equal(await words(page, '#figure-uncovered'), '0, proven', 'uncovered');
    check(Number.parseFloat(await words(page, '#figure-update')) > 0, 'time of an update');
    check(Number.parseFloat(await words(page, '#figure-looseness')) > 0, 'looseness');
    await page.screenshot({ path: `${folder}/page.png` });
  }));

await claim('exact_covers_where_the_rules_of_the_paper_leave_surface_bare', () =>
  opened('#detail=1500&bend=110&level=2', {}, async (page) => {
    for (const [rule, isBare] of [['exact', false], ['traditional', true], ['approach2', true], ['rest', true], ['exact', false]]) {
      await page.selectOption('#rule', rule);
      await idle(page);
      const text = await words(page, '#figure-uncovered');
      if (isBare) check(share(text) > 0, `${rule}: ${text}`);
      else equal(text, '0, proven', rule);
    }
  }));

await claim('the_command_reads_what_the_page_saves_and_certifies_the_same', () =>
  opened('#bend=120&twist=90&stretch=1.2', {}, async (page) => {
    const [mesh, tree, posed] = [await download(page, '#save-mesh'), await download(page, '#save-tree'), await download(page, '#save-pose')];
    check(farthest(vertices(mesh), vertices(posed)) > 0.3, 'the pose is another shape');
    const told = morula(`update ${mesh} ${tree} ${posed} -o spheres`);
    check(told.length > 0, 'the command updates');
  }));

await claim('an_address_shows_the_same_again', async () => {
  let [address, shape] = ['', []];
  await opened('#detail=1500', {}, async (page) => {
    await set(page, 'bend', -70);
    await set(page, 'stretch', 1.3);
    await page.selectOption('#rule', 'approach1');
    await page.keyboard.press('[');
    await page.click('#coloring [data-value=level]');
    await idle(page);
    shape = await pose(page);
    await page.waitForFunction(() => location.hash.includes('color=level'));
    address = await page.evaluate(() => location.hash);
  });
  await opened(address, {}, async (page) => {
    equal(farthest(await pose(page), shape), 0, 'off the pose');
    equal(await page.locator('#rule').inputValue(), 'approach1', 'rule');
    equal(await page.locator('#level').inputValue(), '1', 'level');
    equal(await page.getAttribute('#coloring [data-value=level]', 'aria-pressed'), 'true', 'color');
  });
  await opened('#bend=x&rule=%3Cb%3E&shape=..&level=1e9&camera=1,2', {}, async (page) => {
    equal(await words(page, '#title'), 'Limb', 'what nonsense shows');
  });
});

await claim('every_step_of_the_tour_is_an_address_and_shows_what_it_says', async () => {
  for (const [step, isBare] of [[1, false], [2, true], [3, true], [4, true], [5, true]]) {
    await opened(`#tour=${step}`, {}, async (page) => {
      equal(await words(page, '#tour-place'), `${step} of 5`, 'place');
      equal(share(await words(page, '#figure-uncovered')) > 0, isBare, `step ${step} is bare`);
      equal(await page.isVisible('#right-name'), step === 5, 'beside exact');
      await page.screenshot({ path: `${folder}/tour${step}.png` });
      if (step !== 4) return;
      await page.click('#tour-next');
      await idle(page);
      await page.waitForFunction(() => location.hash === '#tour=5');
      await page.click('#tour-next');
      check(!(await page.isVisible('#tour')), 'the last step ends it');
    });
  }
});

await claim('a_build_leaves_the_page_free_and_can_be_canceled', () =>
  opened('#detail=1500', {}, async (page) => {
    const before = await words(page, '#figure-facets');
    await page.evaluate(() => {
      const count = () => {
        if (document.body.dataset.building === 'true') window.drawn = (window.drawn ?? 0) + 1;
        requestAnimationFrame(count);
      };
      count();
    });
    await page.selectOption('#quality', 'best');
    await page.click('#details [data-value="20000"]');
    await page.waitForFunction(() => window.drawn > 20);
    await page.keyboard.press('r');
    await page.waitForFunction(() => window.drawn > 40 && document.getElementById('rule').value === 'approach2');
    check(await page.isVisible('#share'), 'progress');
    await page.keyboard.press('Escape');
    await idle(page);
    equal(await words(page, '#figure-facets'), before, 'the mesh before');
    await page.selectOption('#quality', 'draft');
    await page.click('#details [data-value="5000"]');
    await idle(page);
    check((await words(page, '#figure-facets')) !== before, 'the next build');
  }));

await claim('a_drag_pulls_the_body_and_a_release_lets_it_come_back', () =>
  opened('#bend=0&detail=1500&camera=0,0,4,0,0,0,y', {}, async (page) => {
    const rest = await pose(page);
    const box = await page.locator('#stage canvas').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2 + 45]; // the limb bends down
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let i = 1; i <= 8; ++i) await page.mouse.move(x, y - 12 * i);
    await page.waitForTimeout(600);
    const pulled = farthest(await pulledPose(page), rest);
    check(pulled > 0.05, `pulled by ${pulled}`);
    equal(await words(page, '#figure-uncovered'), '0, proven', 'while it is pulled');
    await page.mouse.up();
    await page.waitForFunction(() => document.body.dataset.figures === 'done', null, { timeout: 120_000 });
    await waitUntil(async () => farthest(await pose(page), rest) === 0);
    await page.keyboard.press('p');
    await page.waitForTimeout(200);
    check(farthest(await pose(page), rest) > 0, 'a poke by the keyboard');
  }));
/** The pose while the mouse holds the body: the button by its key. */
async function pulledPose(page) {
  const [saved] = await Promise.all([page.waitForEvent('download'), page.locator('#save-pose').evaluate((button) => button.click())]);
  return vertices(await saved.path());
}
async function waitUntil(holds) {
  for (let round = 0; round < 60; ++round) {
    if (await holds()) return;
    await new Promise((done) => setTimeout(done, 500));
  }
  check(false, 'it did not happen');
}

await claim('the_keyboard_does_all', () =>
  opened('#detail=1500', {}, async (page) => {
    const level = await page.locator('#level').inputValue();
    await page.keyboard.press('[');
    equal(Number(await page.locator('#level').inputValue()), Number(level) - 1, 'level');
    await page.keyboard.press('r');
    equal(await page.locator('#rule').inputValue(), 'approach2', 'rule');
    await page.keyboard.press('e');
    check(await page.isVisible('#right-name'), 'beside');
    await page.keyboard.press('n');
    equal(await words(page, '#tour-place'), '1 of 5', 'tour');
    await page.keyboard.press('?');
    check(await page.isVisible('#help'), 'keys');
    await page.keyboard.press('Escape');
    const drawn = Number(await page.getAttribute('#stage', 'data-drawn'));
    await page.keyboard.press('ArrowLeft');
    await settled(page);
    check(Number(await page.getAttribute('#stage', 'data-drawn')) > drawn, 'arrows turn the view');
    // Every control can be reached by Tab, and has a name.
    const found = await page.evaluate(() => {
      const usable = [...document.querySelectorAll('button, select, input, canvas')].filter((e) => e.checkVisibility() && !e.disabled);
      return usable.filter((e) => e.tabIndex < 0 || !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.[0]?.textContent.trim() || e.title)).map((e) => e.outerHTML);
    });
    equal(found.join('\n'), '', 'controls without a name or a place in the order');
  }));

await claim('a_phone_has_all_of_it', () =>
  opened('#tour=5', { width: 390, height: 844, touch: true }, async (page) => {
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    check(wide <= 390, `the page is ${wide} wide`);
    const small = await page.evaluate(() => [...document.querySelectorAll('button')].filter((e) => e.checkVisibility()).map((e) => [e.id || e.textContent, e.getBoundingClientRect()]).filter(([, r]) => Math.min(r.width, r.height) < 22).map(([name]) => name));
    equal(small.join(), '', 'buttons too small for a finger');
    await page.locator('#tour-back').tap();
    equal(await words(page, '#tour-place'), '4 of 5', 'a tap');
    await page.screenshot({ path: `${folder}/phone.png` });
  }));

await claim('no_other_script_runs_and_nothing_is_fetched', async () => {
  const { page, close: shut } = await open(browser, file, {});
  await settled(page);
  const ran = await page.evaluate(async () => {
    const script = document.createElement('script');
    script.textContent = 'window.foreign = true';
    document.body.append(script);
    const fetched = await fetch('data:,x').then(() => true, () => false);
    return [window.foreign === true, fetched].join();
  });
  equal(ran, 'false,false', 'foreign script, fetch');
  await shut();
});

await close();
