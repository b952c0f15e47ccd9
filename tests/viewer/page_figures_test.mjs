// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A study by the command in a real browser: its figures as files, and its page in three widths. Writes screenshots.
import { readFileSync, readdirSync } from 'node:fs';
import { at, check, claim, equal, morula } from './support.mjs';
import { open, settled } from './browser.mjs';
import { browser, close } from './limb.mjs';

morula('sample limb -o body.obj --resolution 8');
morula('study --quick --mesh body.obj --frames 4 --resolution 32 --branching 4 --methods medial,grid -o study');

await claim('no_text_of_a_figure_leaves_its_page', async () => {
  const { page, close: done } = await open(browser, at('study/fig2a.svg'));
  await page.goto('about:blank');
  const figures = readdirSync(at('study')).filter((name) => name.endsWith('.svg'));
  check(figures.length > 10, `${figures.length} figures`);
  for (const name of figures) {
    await page.setContent(readFileSync(at(`study/${name}`), 'utf8'));
    const out = await page.evaluate(() => {
      const svg = document.querySelector('svg');
      const { width, height } = svg.viewBox.baseVal;
      return [...svg.querySelectorAll('text')].filter((text) => {
        const box = text.getBBox();
        return box.x < 0 || box.y < 0 || box.x + box.width > width || box.y + box.height > height;
      }).map((text) => text.textContent);
    });
    equal(out.join('; '), '', name);
  }
  await done();
});

for (const [width, height, screens] of [[1400, 900, 15], [800, 900, 25], [390, 844, 40]]) {
  for (const dark of [false, true]) {
    await claim(`a_study_on_${width}_pixels_${dark ? 'dark' : 'light'}_fits`, async () => {
      const { page, complaints, close: done } = await open(browser, at('study/index.html'), { width, height, dark });
      await settled(page);
      equal(complaints.join(), '', 'complaints');
      const [wide, high, told] = await page.evaluate(() => {
        const report = document.getElementById('report');
        return [document.documentElement.scrollWidth - innerWidth + report.scrollWidth - report.clientWidth, report.scrollHeight / innerHeight, document.querySelectorAll('.told').length];
      });
      equal(wide, 0, 'pixels that stick out at the side');
      check(high <= screens, `the column has ${high} screens`);
      equal(told, 3, 'sentences');
      await page.screenshot({ path: at(`${width}-${dark ? 'dark' : 'light'}.png`) });
      await page.evaluate(() => document.getElementById('claims').scrollIntoView({ behavior: 'instant' }));
      await settled(page);
      await page.screenshot({ path: at(`${width}-${dark ? 'dark' : 'light'}-claims.png`) });
      await done();
    });
  }
}

await close();
