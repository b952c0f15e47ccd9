// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page in a real browser: names and results that are meant to do harm, and code that got in.
import { readFileSync, writeFileSync } from 'node:fs';
import { at, check, claim, equal, morula, run } from './support.mjs';
import { open, settled } from './browser.mjs';
import { browser, close, small, words, writeStill } from './limb.mjs';
import { study } from './study_example.mjs';

morula('sample bar -o bar.obj --resolution 4');
morula('build bar.obj -o bar.morula --method octree --depth 2');
writeStill('bar');

/** Everything that a page should not have done; asked of it after it was drawn. */
const harm = (page) => page.evaluate(() => [
  ...(window.harmed ? ['a script ran'] : []),
  ...[...document.querySelectorAll('script')].filter((s) => /javascript|module|^$/.test(s.type) && s.textContent.includes('harmed')).map(() => 'a script element from data'),
  ...[...document.querySelectorAll('iframe, object, embed, base, form, b.harm, img.harm')].map((e) => `<${e.localName}> from data`),
]);
const hostile = `"'><script>window.harmed=1</script><img class=harm src=x onerror=window.harmed=1><b class=harm>&amp; \u202e\u0000 é 日本`;

await claim('names_and_results_are_text_whatever_is_in_them', async () => {
  const body = `"'><b class=harm>`; // no slash: it is a file's name
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
    equal(await page.locator('#pictures img').count(), results.pictures.length - 1, 'pictures that can be read');
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

await close();
