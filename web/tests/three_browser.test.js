// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lines of morula/three as Chromium draws them: pixels of each sphere's outline, and of contacts. MORULA_CHROMIUM: the browser.
// MORULA_WEB_TOOLS: a folder with playwright-core.
import assert from 'node:assert/strict';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {readFile} from 'node:fs/promises';
import test from 'node:test';
import {fileURLToPath} from 'node:url';
import {packageFile} from './package.js';
import {peerFile} from './peers.js';

const tools = process.env.MORULA_WEB_TOOLS ?? fileURLToPath(new URL('../../build/web/npm/', import.meta.url));
const {chromium} = createRequire(`${tools}/package.json`)('playwright-core');
const types = {js: 'text/javascript', wasm: 'application/wasm', html: 'text/html'};
const imports = {three: '/three/build/three.module.js', morula: '/src/index.js', 'morula/three': '/src/three.js'};
const html = `<!doctype html><canvas width="200" height="200"></canvas><script type="importmap">${JSON.stringify({imports})}</script>`;

/** In the page: draws and returns the drawn pixels, as offsets from the middle in units of the scene. */
async function draw() {
  const [three, {load}, {ContactLines, MorulaBounds, SphereLines}] =
    await Promise.all(['three', 'morula', 'morula/three'].map((name) => import(name)));
  const morula = await load();
  const renderer = new three.WebGLRenderer({canvas: document.querySelector('canvas'), preserveDrawingBuffer: true});
  const scene = new three.Scene();
  const camera = new three.OrthographicCamera(-2, 2, 2, -2, 0.1, 10);
  camera.position.z = 5;
  const pixels = () => {
    renderer.render(scene, camera);
    const gl = renderer.getContext();
    const data = new Uint8Array(4 * 200 * 200);
    gl.readPixels(0, 0, 200, 200, gl.RGBA, gl.UNSIGNED_BYTE, data);
    const drawn = [];
    for (let i = 0; i < 200 * 200; ++i) if (data[4 * i] > 100) drawn.push([(i % 200) / 50 - 1.99, Math.floor(i / 200) / 50 - 1.99]);
    return drawn;
  };
  const mesh = new three.Mesh(new three.TorusGeometry(1, 0.3, 16, 48), new three.MeshBasicMaterial({visible: false}));
  scene.add(mesh);
  scene.updateMatrixWorld(true);
  const bounds = new MorulaBounds(morula, mesh).attach();
  const lines = new SphereLines(bounds, 0, {color: 0xff0000, segments: 64});
  mesh.add(lines);
  const steps = [];
  const step = (level) => steps.push({spheres: [...bounds.spheres(level)], drawn: pixels()});
  step(0);
  lines.setLevel(1);
  step(1);
  const {position} = mesh.geometry.attributes;
  for (let i = 0; i < position.count; ++i) position.setX(i, 0.4 * position.getX(i));
  position.needsUpdate = true;
  bounds.update();
  lines.update();
  step(1);
  lines.setLevel(0);
  step(0);
  lines.visible = false;
  const contacts = new ContactLines({length: 1, color: 0xff0000, size: 1});
  scene.add(contacts);
  const counts = [pixels().length];
  for (const n of [1, 40]) {
    contacts.update(Array.from({length: n}, (_, i) => ({point: [-0.5, -1.5 + 0.07 * i, 0], normal: [1, 0, 0]})));
    counts.push(pixels().length);
  }
  return {steps, counts};
}

test('spheres and contacts are drawn where they are', async () => {
  const server = createServer(async ({url}, response) => {
    const name = new URL(url, 'http://localhost').pathname;
    const file = name.startsWith('/three/') ? peerFile(name.slice(1)) : packageFile(name.slice(1));
    const content = name === '/' ? html : await readFile(file).catch(() => null);
    response.writeHead(content === null ? 404 : 200, {'content-type': types[name.split('.').pop()] ?? 'text/html'}).end(content ?? '');
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  const browser = await chromium.launch({executablePath: process.env.MORULA_CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader']});
  try {
    const page = await browser.newPage();
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    const {steps, counts} = await page.evaluate(draw);
    const near = 0.04; // two pixels
    for (const {spheres, drawn} of steps) {
      assert.ok(drawn.length > 50);
      // The circle about the axis of the camera is the outline of the sphere; the other two are seen as lines through its center.
      for (let i = 0; i < spheres.length; i += 4) {
        const [x, y, , r] = spheres.slice(i, i + 4);
        for (let angle = 0; angle < 6.28; angle += 0.1) {
          const [px, py] = [x + r * Math.cos(angle), y + r * Math.sin(angle)];
          if (Math.max(Math.abs(px), Math.abs(py)) < 1.9)
            assert.ok(drawn.some(([u, v]) => Math.hypot(u - px, v - py) < near), `sphere ${i / 4}: nothing at ${px}, ${py}`);
        }
      }
      for (const [u, v] of drawn)
        assert.ok(spheres.some((x, i) => i % 4 === 0 && (Math.abs(Math.hypot(u - x, v - spheres[i + 1]) - spheres[i + 3]) < near ||
          (Math.min(Math.abs(u - x), Math.abs(v - spheres[i + 1])) < near && Math.hypot(u - x, v - spheres[i + 1]) < spheres[i + 3] + near))),
        `a pixel of no sphere at ${u}, ${v}`);
    }
    assert.ok(steps[1].spheres.length > steps[0].spheres.length);
    assert.equal(counts[0], 0);
    assert.ok(counts[1] > 40 && counts[1] < 60); // a line of one unit, 50 pixels
    assert.ok(counts[2] > 38 * counts[1] && counts[2] < 42 * counts[1]);
  } finally {
    await browser.close();
    server.close();
  }
});
