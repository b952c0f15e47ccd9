// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Times three-mesh-bvh on a skinned mesh: vertices skinned by StaticGeometryGenerator, then MeshBVH.refit(). Prints
// microseconds per frame, the median over frames of the least of three, and checks all positions. usage: node refit.mjs FILE
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
// The largest distance of a vertex from the weighted sum of its moved rest positions, over the size of the body.
const error = (posed, frame) => {
  const { position, skinIndex, skinWeight } = geometry.attributes;
  let worst = 0, size = 0;
  for (let v = 0; v < vertices; ++v) {
    const sum = [0, 0, 0];
    for (let k = 0; k < 4; ++k) {
      const t = transforms.subarray(12 * (frame * bones + skinIndex.getComponent(v, k)));
      for (let axis = 0; axis < 3; ++axis)
        sum[axis] += skinWeight.getComponent(v, k) * (t[4 * axis] * position.getX(v) + t[4 * axis + 1] * position.getY(v) +
          t[4 * axis + 2] * position.getZ(v) + t[4 * axis + 3]);
    }
    for (let axis = 0; axis < 3; ++axis) {
      worst = Math.max(worst, Math.abs(sum[axis] - posed.attributes.position.getComponent(v, axis)));
      size = Math.max(size, Math.abs(sum[axis]));
    }
  }
  return worst / size;
};

const count = Math.min(frames, 200);
if (count < 2) {
  console.log('{}');
} else {
  pose(0);
  const posed = generator.generate();
  const bvh = new MeshBVH(posed);
  const least = new Array(count).fill(Infinity);
  // Pass after pass over all frames: the generator skips a mesh whose bones have not moved.
  for (let pass = 0; pass < 3; ++pass)
    for (let frame = 0; frame < count; ++frame) {
      pose(frame);
      const start = process.hrtime.bigint();
      generator.generate(posed);
      bvh.refit();
      least[frame] = Math.min(least[frame], Number(process.hrtime.bigint() - start) / 1e3);
      if (pass === 0 && error(posed, frame) > 1e-4) throw new Error(`frame ${frame}: wrong positions`);
    }
  least.sort((a, b) => a - b);
  console.log(JSON.stringify({ refit_us: least[Math.floor(count / 2)] }));
}
