// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Times morula/three beside three-mesh-bvh on skinned characters, in one process: each frame both follow the pose, and then find
// the first hits of the same rays. three-mesh-bvh skins all vertices by StaticGeometryGenerator.generate(), and then refits.
// The first two hits of each frame are compared with those of three.js over all facets. Prints medians over the frames of the least of three passes.
// usage: node web/tests/compare_three_mesh_bvh.js [--rays N] [FILE.glb ...]      needs scripts/web; without a file arms by formula
import {readFileSync} from 'node:fs';
import {arm, bruteHits, character, pose, random, three} from './characters.js';
import {packageModule} from './package.js';
import {peer, peerFile} from './peers.js';

const {load} = await packageModule();
const {MorulaBounds} = await packageModule('src/three.js');
const {MeshBVH, StaticGeometryGenerator} = await peer('three-mesh-bvh');
const {DoubleSide, MeshBasicMaterial, Raycaster, Vector3} = three;
const morula = await load();
const frames = 60;
const passes = 3;

const files = process.argv.slice(2);
const at = files.indexOf('--rays');
const rayCount = at < 0 ? 1 : Number(files.splice(at, 2)[1]);
if (!(rayCount >= 1)) throw new Error('--rays takes a number');

/** The largest skinned mesh of a file, without its materials, for images need a browser. */
async function ofFile(path) {
  const {GLTFLoader} = await import(peerFile('three/examples/jsm/loaders/GLTFLoader.js'));
  const bytes = readFileSync(path);
  const size = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + size));
  for (const name of ['images', 'textures', 'materials', 'samplers']) delete json[name];
  for (const mesh of json.meshes) for (const primitive of mesh.primitives) delete primitive.material;
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const file = Buffer.concat([bytes.subarray(0, 12), Buffer.alloc(8), padded, bytes.subarray(20 + size)]);
  file.writeUInt32LE(file.length, 8);
  file.writeUInt32LE(padded.length, 12);
  file.writeUInt32LE(0x4e4f534a, 16);
  const {scene} = await new GLTFLoader().parseAsync(file.buffer.slice(file.byteOffset, file.byteOffset + file.length), '');
  let best = null;
  scene.traverse((object) => {
    const count = object.isSkinnedMesh ? object.geometry.attributes.position.count : 0;
    if (count > (best?.geometry.attributes.position.count ?? 0)) best = object;
  });
  if (!best) throw new Error(`${path} has no skinned mesh`);
  best.material = new MeshBasicMaterial({side: DoubleSide});
  const still = best.skeleton.bones.map((bone) => bone.rotation.clone());
  return {
    mesh: best,
    // Joints turn about their three axes, back and forth, each at a pace of its own.
    pose(frame) {
      best.skeleton.bones.forEach((bone, b) => {
        const angle = (k) => 0.3 * Math.sin((2 * Math.PI * (1 + ((b + k) % 3)) * frame) / frames + b + 2 * k);
        bone.rotation.set(still[b].x + angle(0), still[b].y + angle(1), still[b].z + angle(2));
      });
      scene.updateMatrixWorld(true);
      best.skeleton.update();
    },
  };
}
function ofFormula(round, long) {
  const mesh = character(arm({round, long}), {material: new MeshBasicMaterial({side: DoubleSide})});
  return {
    mesh,
    pose(frame) {
      pose(mesh, 0.7 * Math.sin((2 * Math.PI * frame) / frames), 0.1 * frame);
      mesh.skeleton.update();
    },
  };
}

/** Rays of clicks: from one side at points in the box of the posed vertices; most of them hit. */
function raysOf(mesh, seed) {
  const next = random(seed);
  const box = new three.Box3().setFromObject(mesh, true);
  const size = box.getSize(new Vector3());
  const eye = box.getCenter(new Vector3()).add(new Vector3(0.3, 0.2, 2).multiplyScalar(size.length()));
  return Array.from({length: rayCount}, () => {
    const aim = new Vector3(...[0, 1, 2].map((k) => box.min.getComponent(k) + (0.2 + 0.6 * next()) * size.getComponent(k)));
    const raycaster = new Raycaster(eye, aim.sub(eye).normalize());
    raycaster.firstHitOnly = true;
    return raycaster;
  });
}

const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];

async function compare(name, {mesh, pose: moveTo}) {
  moveTo(0);
  const bounds = new MorulaBounds(morula, mesh);
  const generator = new StaticGeometryGenerator([mesh]);
  generator.attributes = ['position'];
  const posed = generator.generate();
  const bvh = new MeshBVH(posed);
  const least = Object.fromEntries(['refit', 'pick', 'update', 'find'].map((key) => [key, new Array(frames).fill(Infinity)]));
  const clock = (key, frame, run) => {
    const start = process.hrtime.bigint();
    const result = run();
    least[key][frame] = Math.min(least[key][frame], Number(process.hrtime.bigint() - start) / 1e3);
    return result;
  };
  let hits = 0;
  let apart = 0;
  for (let pass = 0; pass < passes; ++pass)
    for (let frame = 0; frame < frames; ++frame) {
      moveTo(frame);
      const rays = raysOf(mesh, frame);
      // In turn, so that neither always meets warm caches.
      const theirs = () => {
        clock('refit', frame, () => {
          generator.generate(posed);
          bvh.refit();
        });
        return clock('pick', frame, () => rays.map((raycaster) => bvh.raycastFirst(raycaster.ray, DoubleSide)));
      };
      const ours = () => {
        clock('update', frame, () => bounds.update());
        return clock('find', frame, () => rays.map((raycaster) => {
          const list = [];
          bounds.raycast(raycaster, list);
          return list[0] ?? null;
        }));
      };
      let own, other;
      if ((pass + frame) % 2) [other, own] = [theirs(), ours()];
      else [own, other] = [ours(), theirs()];
      if (pass > 0) continue;
      rays.slice(0, 2).forEach((raycaster, r) => {
        const [expected] = bruteHits(raycaster, mesh);
        if ((own[r]?.faceIndex ?? -1) !== (expected?.faceIndex ?? -1) || own[r]?.distance !== expected?.distance)
          throw new Error(`${name}, frame ${frame}: another hit than three.js has`);
        if (!expected) return;
        ++hits;
        // Positions of the peer are floats, so a ray along an edge may have another facet there.
        if (!other[r] || Math.abs(other[r].distance - expected.distance) > 1e-4 * bounds.sphere.radius) ++apart;
      });
    }
  if (hits === 0 || apart > 0.01 * hits) throw new Error(`${name}: ${hits} hits, of which three-mesh-bvh has ${apart} elsewhere`);
  const sum = (a, b) => least[a].map((time, i) => time + least[b][i]);
  const [refit, update, both, all] = [median([...least.refit]), median([...least.update]), median(sum('refit', 'pick')), median(sum('update', 'find'))];
  const facets = bounds.mesh.facetCount.toLocaleString('en-US');
  console.log(`| ${name} | ${facets} | ${mesh.skeleton.bones.length} | ${refit.toFixed(0)} | ${update.toFixed(1)} | ${(refit / update).toFixed(0)} | ` +
    `${(median(least.pick) / rayCount).toFixed(1)} | ${(median(least.find) / rayCount).toFixed(1)} | ${both.toFixed(0)} | ${all.toFixed(1)} | ${(both / all).toFixed(1)} |`);
  bounds.free();
}

console.log(`${frames} frames, ${rayCount} ${rayCount === 1 ? 'ray' : 'rays'} a frame; microseconds\n`);
console.log('| character | facets | bones | skin + refit | update | ratio | their ray | our ray | their frame | our frame | ratio |');
console.log(`| --- ${'| ---: '.repeat(10)}|`);
if (files.length > 0) for (const path of files) await compare(path.split('/').pop(), await ofFile(path));
else for (const [round, long] of [[24, 40], [48, 100], [96, 220]]) await compare(`arm ${round} x ${long}`, ofFormula(round, long));
