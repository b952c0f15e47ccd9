// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files of the view: a picture, a film of all frames, the body and its spheres for other programs.
import { Color, Group, IcosahedronGeometry, Mesh, MeshStandardMaterial, BufferAttribute, BufferGeometry } from 'three';
import { GLTFExporter } from 'three/examples/jsm/exporters/GLTFExporter.js';
import { element, styleValue } from './dom.js';

/** Offers a file. */
export function offer(blob, name) {
  const link = element('a', { href: URL.createObjectURL(blob), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** The picture on the color of the page, into a canvas. */
function paint(stage, canvas) {
  stage.draw();
  const from = stage.renderer.domElement;
  if (canvas.width !== from.width || canvas.height !== from.height) Object.assign(canvas, { width: from.width, height: from.height });
  const context = canvas.getContext('2d');
  context.fillStyle = styleValue('--paper');
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(from, 0, 0);
}

export async function savePicture(stage, name) {
  const canvas = element('canvas');
  paint(stage, canvas);
  offer(await new Promise((done) => canvas.toBlob(done, 'image/png')), `${name}.png`);
}

export const canFilm = () => typeof MediaRecorder === 'function' && MediaRecorder.isTypeSupported('video/webm');

const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
/** Bytes: more than a film without a frame has. */
const leastFilm = 200;

/** All frames, as fast as they are played. show(frame): poses the body. ontold(frame): how far it is. */
export async function saveFilm(stage, name, frameCount, framesPerSecond, show, ontold) {
  const canvas = element('canvas');
  paint(stage, canvas);
  const stream = canvas.captureStream(0);
  const [track] = stream.getVideoTracks();
  const recorder = new MediaRecorder(stream, { mimeType: 'video/webm', videoBitsPerSecond: 12_000_000 });
  const chunks = [];
  let size = 0;
  recorder.addEventListener('dataavailable', ({ data }) => {
    chunks.push(data);
    size += data.size;
  });
  const [begun, ended] = ['start', 'stop'].map((name) => new Promise((done) => recorder.addEventListener(name, done)));
  recorder.start();
  await begun;
  for (let frame = 0; frame < frameCount; ++frame) {
    ontold(frame);
    show(frame);
    paint(stage, canvas);
    track.requestFrame();
    await pause(1000 / framesPerSecond);
  }
  // On a busy machine the encoder is behind, and a stop would leave out what it has not read: stop once nothing more comes.
  for (let looks = 0, quiet = 0, before = -1; looks < 100 && (quiet < 2 || size < leastFilm); ++looks) {
    quiet = size === before ? quiet + 1 : 0;
    before = size;
    recorder.requestData();
    await pause(150);
  }
  recorder.stop();
  await ended;
  track.stop();
  if (size < leastFilm) throw new Error('the browser encoded no picture');
  offer(new Blob(chunks, { type: 'video/webm' }), `${name}.webm`);
}

/** The body of a frame and the spheres of a level set, a node each, in a glTF binary. color(node): [r, g, b] of the screen. */
export async function saveModel(scene, frame, nodes, color, name) {
  const root = new Group();
  root.name = name;
  const place = (x, k) => x + scene.origin[k];
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(scene.positions(frame).map((x, i) => place(x, i % 3)), 3));
  geometry.setIndex(new BufferAttribute(scene.motion.facets, 1));
  geometry.computeVertexNormals();
  const body = new Mesh(geometry, new MeshStandardMaterial({ color: new Color(styleValue('--body')), roughness: 0.6 }));
  body.name = 'body';
  root.add(body);
  const ball = new IcosahedronGeometry(1, 6);
  ball.deleteAttribute('uv');
  const materials = new Map();
  for (const node of nodes) {
    const tint = color(node);
    const key = tint.map((c) => Math.round(255 * c)).join();
    if (!materials.has(key)) {
      materials.set(key, new MeshStandardMaterial({ color: new Color().setRGB(...tint, 'srgb'), transparent: true, opacity: 0.5, roughness: 0.5 }));
    }
    const sphere = new Mesh(ball, materials.get(key));
    const [x, y, z, radius] = scene.frames[frame].subarray(4 * node, 4 * node + 4);
    sphere.position.set(place(x, 0), place(y, 1), place(z, 2));
    sphere.scale.setScalar(radius);
    sphere.name = `sphere ${node}`;
    root.add(sphere);
  }
  const bytes = await new GLTFExporter().parseAsync(root, { binary: true, onlyVisible: false });
  offer(new Blob([bytes], { type: 'model/gltf-binary' }), `${name}.glb`);
}
