// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page in a real browser: how it fails.
import { readFileSync, writeFileSync } from 'node:fs';
import { at, check, claim, equal, packages } from './support.mjs';
import { launch, open } from './browser.mjs';
import { browser, close, small, words, writeLimb } from './limb.mjs';

writeLimb(12);

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

await claim('without_webgl_the_page_says_so_and_shows_its_figures', async () => {
  const plain = await launch(packages, { webgl: false });
  const { page, close } = await open(plain, at('limb.html'), small);
  const said = await words(page, '#no-picture');
  check(said.includes('WebGL') && said.includes('hardware acceleration'), `the message names WebGL and a remedy: ${said}`);
  check(!/make the file again/i.test(await page.innerText('body')), 'the file is not to blame');
  check((await page.locator('#figures tbody tr').count()) >= 3, 'figures of each level');
  await page.locator('#frame').evaluate((range) => {
    range.value = '3';
    range.dispatchEvent(new Event('input', { bubbles: true }));
  });
  check((await words(page, '#frame-name')).startsWith('3 /'), 'frames still change');
  check(await page.isDisabled('#save-png'), 'there is no picture to save');
  await close();
  await plain.close();
});

await close();
