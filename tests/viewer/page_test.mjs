// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page in a real browser, from disk: what it draws, what it says, how it fails. Writes screenshots to look at.
import { readFileSync, writeFileSync } from 'node:fs';
import { at, check, claim, equal, finish, morula, packages, run, skip } from './support.mjs';
import { chromiumPath, launch, open, settled, slide } from './browser.mjs';
import { figure } from '../../viewer/src/numbers.js';
import { study } from './study_example.mjs';

if (chromiumPath() === null) skip('there is no Chromium here; the Debian package chromium has it (scripts/setup)');

morula('sample limb -o limb.obj --resolution 32');
morula('build limb.obj -o limb.morula --method grid --branching 8 --depth 3');
morula('deform limb.obj -o bend --bend 90 --frames 13');
morula('update limb.obj limb.morula bend -o spheres --rule approach2 --format json');
morula('view limb.obj limb.morula bend -o limb.html --rule exact --rule approach2');
morula('view limb.obj limb.morula -o still.html --no-measure');
writeFileSync(at('study.json'), JSON.stringify(study));
morula('view limb.obj limb.morula bend -o study.html --rule exact --rule approach2 --study study.json --title Evaluation');

const browser = await launch(packages);
const helper = await (await browser.newContext()).newPage();
const small = { width: 930, height: 360 };

/** Pixels of the picture, without what lies over it. */
async function picture(page) {
  await settled(page);
  const show = (visibility) => page.evaluate((how) => {
    for (const id of ['legend', 'picked', 'fit']) document.getElementById(id).style.visibility = how;
  }, visibility);
  await show('hidden');
  const png = await page.locator('#stage canvas').screenshot();
  await show('');
  return png.toString('base64');
}
/** {changed: share of pixels that differ visibly, red: share of b's that are the red of bare surface} */
function compare(a, b) {
  return helper.evaluate(async ([first, second]) => {
    const data = await Promise.all([first, second].map(async (png) => {
      const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
      const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height).data;
    }));
    let changed = 0;
    let red = 0;
    for (let i = 0; i < data[1].length; i += 4) {
      const differs = [0, 1, 2].some((k) => Math.abs(data[0][i + k] - data[1][i + k]) > 12);
      if (differs) ++changed;
      const [r, g, b] = data[1].subarray(i, i + 3);
      if (r > 150 && r > 1.9 * g && r > 1.9 * b) ++red;
    }
    return { changed: (4 * changed) / data[1].length, red: (4 * red) / data[1].length };
  }, [a, b]);
}
async function opened(name, options, test) {
  const { page, complaints, close } = await open(browser, at(name), { ...small, ...options });
  await settled(page);
  await test(page);
  equal(complaints.join('\n'), '', 'complaints of the browser');
  await close();
}
/** One page for all claims that leave it as they found it; opening one takes longest. */
const shared = await open(browser, at('limb.html'), small);
async function onShared(test) {
  const { page, complaints } = shared;
  await page.selectOption('#choose-rule', 'exact');
  await page.click('#colouring [data-value=level]');
  await page.keyboard.press('Escape');
  await slide(page, 'frame', 0);
  await slide(page, 'level', 3);
  await page.evaluate(() => document.activeElement?.blur());
  await test(page);
  equal(complaints.join('\n'), '', 'complaints of the browser');
}
const words = (page, selector) => page.locator(selector).innerText();

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

await claim('every_colouring_draws_something_else', () =>
  onShared(async (page) => {
    await slide(page, 'frame', 6);
    const seen = [];
    for (const colour of ['level', 'branch', 'empty', 'growth']) {
      await page.click(`#colouring [data-value=${colour}]`);
      const now = await picture(page);
      for (const other of seen) check((await compare(other, now)).changed > 0.01, `${colour} looks like another`);
      seen.push(now);
    }
  }));

await claim('bare_surface_is_red_and_only_bare_surface', () =>
  onShared(async (page) => {
    await slide(page, 'frame', 6);
    const covered = await picture(page);
    equal((await compare(covered, covered)).red, 0, 'red pixels of the rule exact');
    equal(await words(page, '#bare-chip'), 'no surface is bare', 'legend');
    await page.selectOption('#choose-rule', 'approach2');
    const bare = await picture(page);
    check((await compare(bare, bare)).red > 0.002, 'approach2 shows red');
    check(/^bare \d/.test(await words(page, '#bare-chip')), 'the legend says how much');
    await page.uncheck('#show-bare');
    const hidden = await picture(page);
    equal((await compare(hidden, hidden)).red, 0, 'red pixels when it is turned off');
    await page.check('#show-bare');
  }));

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
    await page.click('#measure [data-value=bare_area]');
    const box = await page.locator('#curves .u-over').boundingBox();
    await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
    equal(await page.locator('#frame').inputValue(), '6', 'frame in the middle');
  }));

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

/** Everything that a page should not have done; asked of it after it was drawn. */
const harm = (page) => page.evaluate(() => [
  ...(window.harmed ? ['a script ran'] : []),
  ...[...document.querySelectorAll('script')].filter((s) => /javascript|module|^$/.test(s.type) && s.textContent.includes('harmed')).map(() => 'a script element from data'),
  ...[...document.querySelectorAll('iframe, object, embed, base, form, b.harm, img.harm')].map((e) => `<${e.localName}> from data`),
]);
const hostile = `"'><script>window.harmed=1</script><img class=harm src=x onerror=window.harmed=1><b class=harm>&amp; \u202e\u0000 é 日本`;

await claim('names_and_results_are_text_whatever_is_in_them', async () => {
  const body = `"'><b class=harm>`; // no slash: it is a file's name
  morula('sample bar -o bar.obj --resolution 4');
  morula('build bar.obj -o bar.morula --method octree --depth 2');
  const mesh = readFileSync(at('bar.obj'));
  for (const name of [`${body}.obj`, '日本 é.obj']) writeFileSync(at(name), mesh);
  const spoilt = structuredClone(study);
  const spoil = (value, key) => {
    if (Array.isArray(value)) return value.map((v) => spoil(v));
    if (value !== null && typeof value === 'object') return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, spoil(v, k)]));
    if (typeof value !== 'string' || ['source', 'role', 'svg', 'verdict'].includes(key)) return value;
    return value + hostile;
  };
  const results = spoil(spoilt);
  results.pictures[0].svg = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9" onload="window.harmed=1"><style>@import "https://example.org/a.css"; body{display:none}</style><script>window.harmed=1</script><image href="https://example.org/a.png"/><foreignObject><iframe xmlns="http://www.w3.org/1999/xhtml" src="https://example.org/"/></foreignObject><rect width="9" height="9"/></svg>`;
  results.pictures.push({ id: 'x', title: hostile, svg: '<svg><not closed' });
  writeFileSync(at('spoilt.json'), JSON.stringify(results));
  for (const [mesh_name, page_name] of [[`${body}.obj`, 'hostile.html'], ['日本 é.obj', 'unicode.html']]) {
    run(['view', mesh_name, 'bar.morula', '-o', page_name, '--no-measure', '--title', hostile.replaceAll('\u0000', ''), '--study', 'spoilt.json']);
    const { page, complaints, close } = await open(browser, at(page_name), small);
    await settled(page);
    equal((await harm(page)).join(', '), '', page_name);
    check((await words(page, '#title')).includes('<script>window.harmed=1</script>'), 'the title is shown as it is written');
    check((await words(page, '#about')).includes(mesh_name.replace('.obj', '')), 'and the name of the body');
    check((await page.locator('.claim h3').first().innerText()).includes('<img class=harm'), 'and a claim');
    equal(await page.locator('#pictures img').count(), 1, 'pictures that can be read');
    equal(complaints.filter((text) => !text.includes('example.org')).join('\n'), '', 'complaints of the browser');
    await close();
  }
});

await claim('the_policy_stops_what_gets_in_all_the_same', async () => {
  const html = readFileSync(at('still.html'), 'utf8');
  const policy = /http-equiv="Content-Security-Policy" content="([^"]*)"/.exec(html)[1];
  check(policy.startsWith("default-src 'none';"), policy);
  check(!/unsafe|\*|https?:|connect-src/.test(policy), policy);
  const smuggled = '<script>window.harmed=1</script><img src="x" onerror="window.harmed=1"><style>#title{color:red}</style>';
  writeFileSync(at('smuggled.html'), html.replace('<div id="main">', `${smuggled}<div id="main">`));
  const { page, complaints, close } = await open(browser, at('smuggled.html'), small);
  await settled(page);
  equal(await page.evaluate(() => window.harmed === undefined), true, 'nothing ran');
  check(complaints.filter((text) => text.includes('Content Security Policy')).length >= 3, complaints.join('\n'));
  // Text as code is tried from a timer: what the test itself evaluates is exempt.
  const got_out = await page.evaluate(async () => {
    setTimeout('window.harmed = 1', 0);
    await new Promise((done) => setTimeout(done, 100));
    return fetch('data:,x').then(() => 'connected', (error) => error.name);
  });
  equal(got_out, 'TypeError', 'no connections');
  equal(await page.evaluate(() => window.harmed === undefined), true, 'no evaluation of text');
  await close();
});

await claim('a_damaged_file_says_so', async () => {
  const html = readFileSync(at('limb.html'), 'utf8');
  const place = html.indexOf('id="morula-motion-0">') + 4000;
  const damaged = {
    'changed.html': [html.slice(0, place) + (html[place] === 'Q' ? 'R' : 'Q') + html.slice(place + 1), 'checksum'],
    'half.html': [html.slice(0, place), 'cut short'],
    'manifest.html': [html.replace('{"format":1', '{"format:1'), 'contents'],
    'newer.html': [html.replace('"format":1', '"format":2'), 'format 2'],
    'empty.html': [html.slice(0, html.indexOf('<script type="application/json"')), 'no data'],
  };
  for (const [name, [content, reason]] of Object.entries(damaged)) {
    writeFileSync(at(name), content);
    const { page, complaints, close } = await open(browser, at(name), small);
    const said = await words(page, '#failure');
    check(said.includes('cannot be shown') && said.includes(reason), `${name}: ${said}`);
    equal(complaints.join('\n'), '', name);
    if (name === 'half.html') await page.screenshot({ path: at('damaged.png') });
    await close();
  }
});

await claim('without_webgl_the_page_says_so', async () => {
  const plain = await launch(packages, { webgl: false });
  const { page, close } = await open(plain, at('limb.html'), small);
  check((await words(page, '#failure')).includes('WebGL'), 'the message names WebGL');
  await close();
  await plain.close();
});

await claim('screenshots_are_written', async () => {
  for (const dark of [false, true]) {
    await opened('limb.html', { width: 1280, height: 800, dark }, async (page) => {
      await page.selectOption('#choose-rule', dark ? 'approach2' : 'exact');
      await slide(page, 'frame', 6);
      await page.click('#colouring [data-value=branch]');
      await settled(page);
      await page.screenshot({ path: at(dark ? 'wide-dark.png' : 'wide-light.png') });
    });
  }
});

await browser.close();
finish();
