// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Times three-mesh-bvh on a skinned mesh: vertices skinned by StaticGeometryGenerator, then MeshBVH.refit(). Prints
// microseconds per frame, the median over frames of the least of three. usage: node refit.mjs FILE
// FILE is that of morula_characters --peer.
import { readFileSync } from 'node:fs';
import * as three from 'three';
import { MeshBVH, StaticGeometryGenerator } from 'three-mesh-bvh';

const bytes = readFileSync(process.argv[2]);
const data = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
const [vertices, facets, bones, frames] = new Uint32Array(data, 0, 4);
let offset = 16;
const take = (Type, count) => {
  const values = new Type(data, offset, count);
  offset += count * Type.BYTES_PER_ELEMENT;
  return values;
};
const geometry = new three.BufferGeometry();
geometry.setAttribute('position', new three.BufferAttribute(take(Float32Array, 3 * vertices), 3));
geometry.setIndex(new three.BufferAttribute(take(Uint32Array, 3 * facets), 1));
geometry.setAttribute('skinIndex', new three.BufferAttribute(take(Uint16Array, 4 * vertices), 4));
geometry.setAttribute('skinWeight', new three.BufferAttribute(take(Float32Array, 4 * vertices), 4));
const transforms = take(Float32Array, 12 * bones * frames);

// Bones stand in the world by themselves, bound at the identity.
const skeleton = new three.Skeleton(Array.from({ length: bones }, () => new three.Bone()),
  Array.from({ length: bones }, () => new three.Matrix4()));
const mesh = new three.SkinnedMesh(geometry);
mesh.bind(skeleton, new three.Matrix4());
const generator = new StaticGeometryGenerator([mesh]);
generator.attributes = ['position'];
const pose = (frame) => {
  skeleton.bones.forEach((bone, b) => {
    const t = transforms.subarray(12 * (frame * bones + b), 12 * (frame * bones + b + 1));
    bone.matrixWorld.set(...t, 0, 0, 0, 1);
  });
  skeleton.update();
};
if (frames > 0) {
  pose(0);
  const posed = generator.generate();
  const bvh = new MeshBVH(posed);
  const times = [];
  for (let frame = 0; frame < Math.min(frames, 200); ++frame) {
    pose(frame);
    let least = Infinity;
    for (let repeat = 0; repeat < 3; ++repeat) {
      const start = process.hrtime.bigint();
      generator.generate(posed);
      bvh.refit();
      least = Math.min(least, Number(process.hrtime.bigint() - start) / 1e3);
    }
    times.push(least);
  }
  times.sort((a, b) => a - b);
  console.log(JSON.stringify({ refit_us: times[Math.floor(times.length / 2)] }));
} else {
  console.log('{}');
}
