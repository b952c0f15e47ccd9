// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Screenshots of the playground at three widths: a tablet, a desk and a phone.
// usage: node playground/pictures.mjs PACKAGES PAGE FOLDER [VIEW-SIZE]
//   VIEW-SIZE  of one picture, such as beside-desk; otherwise all
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { launch, open, settled } from '../tests/viewer/browser.mjs';

const [packages, file, folder, only] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const sizes = { desk: { width: 1440, height: 900 }, tablet: { width: 820, height: 1180 }, phone: { width: 390, height: 844, scale: 2, touch: true } };
const views = {
  bend: '',
  tour: '#tour=4',
  beside: '#tour=5',
  tool: '#detail=1500&bend=0&touch=tool&place=0,-0.12,0',
  bodies: '#detail=1500&bend=30&touch=body&place=0,-0.1,0',
  hand: '#shape=hand&bend=45&twist=30',
};
const browser = await launch(packages);
for (const [size, options] of Object.entries(sizes)) {
  for (const [view, hash] of Object.entries(views)) {
    if (only && only !== `${view}-${size}`) continue;
    const { page, close } = await open(browser, file, { ...options, dark: view === 'bodies', hash });
    await settled(page);
    await page.waitForFunction(() => document.body.dataset.building === 'false' && document.body.dataset.figures === 'done');
    if (hash.includes('touch')) await page.waitForFunction(() => document.getElementById('figure-tests').textContent !== '–');
    await page.screenshot({ path: join(folder, `${view}-${size}.png`) });
    await close();
  }
}
await browser.close();
