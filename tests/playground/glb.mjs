// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A GLB file of a bar with two bones, of which the second swings, or with a morph target: written by hand.

/** options: {image: true} refers to a picture; {morph: true}: a target at full influence doubles the radius, and its influence goes
 * from 0 to 1 and back in 2 s, while the bones rest. Returns the bytes of the file. */
export function barGlb({ image = false, morph = false } = {}) {
  const [rings, around] = [24, 16];
  const positions = [];
  const joints = [];
  const weights = [];
  for (let i = 0; i <= rings; ++i) {
    for (let j = 0; j < around; ++j) {
      const angle = (2 * Math.PI * j) / around;
      positions.push(-2 + (4 * i) / rings, 0.4 * Math.cos(angle), 0.4 * Math.sin(angle));
      joints.push(0, 1, 0, 0);
      const second = Math.min(1, Math.max(0, (i / rings - 0.3) / 0.4));
      weights.push(1 - second, second, 0, 0);
    }
  }
  const indices = [];
  for (let i = 0; i < rings; ++i) {
    for (let j = 0; j < around; ++j) {
      const [a, b] = [i * around + j, i * around + ((j + 1) % around)];
      indices.push(a, b, a + around, b, b + around, a + around);
    }
  }
  const times = [0, 1, 2];
  const half = Math.SQRT1_2;
  const turns = [0, 0, 0, 1, 0, 0, half, half, 0, 0, 0, 1]; // a quarter about z and back
  const arrays = [Float32Array.from(positions), Uint8Array.from(joints), Float32Array.from(weights), Uint16Array.from(indices), Float32Array.from(times), Float32Array.from(turns)];
  const types = [['VEC3', 5126], ['VEC4', 5121], ['VEC4', 5126], ['SCALAR', 5123], ['SCALAR', 5126], ['VEC4', 5126]];
  if (morph) {
    arrays.push(Float32Array.from(positions.map((x, i) => (i % 3 === 0 ? 0 : x))), Float32Array.from([0, 1, 0]));
    types.push(['VEC3', 5126], ['SCALAR', 5126]);
  }
  const widths = { SCALAR: 1, VEC3: 3, VEC4: 4 };
  let length = 0;
  const bufferViews = [];
  const accessors = arrays.map((array, i) => {
    bufferViews.push({ buffer: 0, byteOffset: length, byteLength: array.byteLength });
    length += 4 * Math.ceil(array.byteLength / 4);
    return { bufferView: i, componentType: types[i][1], type: types[i][0], count: array.length / widths[types[i][0]], ...(i === 0 || i === 4 ? { min: [-2, -0.4, -0.4].slice(0, widths[types[i][0]]), max: [2, 0.4, 0.4].slice(0, widths[types[i][0]]) } : {}) };
  });
  const bytes = new Uint8Array(length);
  arrays.forEach((array, i) => bytes.set(new Uint8Array(array.buffer), bufferViews[i].byteOffset));
  const json = {
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0, 1] }],
    nodes: [{ mesh: 0, skin: 0 }, { children: [2] }, {}],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, JOINTS_0: 1, WEIGHTS_0: 2 }, indices: 3, ...(morph ? { targets: [{ POSITION: 6 }] } : {}), ...(image ? { material: 0 } : {}) }] }],
    skins: [{ joints: [1, 2] }],
    animations: [morph
      ? { name: 'Swell', channels: [{ sampler: 0, target: { node: 0, path: 'weights' } }], samplers: [{ input: 4, output: 7 }] }
      : { name: 'Swing', channels: [{ sampler: 0, target: { node: 2, path: 'rotation' } }], samplers: [{ input: 4, output: 5 }] }],
    accessors, bufferViews, buffers: [{ byteLength: length }],
    ...(image ? { images: [{ uri: 'https://example.invalid/skin.png' }], textures: [{ source: 0 }], materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }] } : {}),
  };
  return packed(json, bytes);
}

/** A GLB file of a description and bytes. */
export function packed(json, bytes) {
  const text = Buffer.from(JSON.stringify(json));
  const size = 4 * Math.ceil(text.length / 4);
  const head = Buffer.alloc(20);
  [0x46546c67, 2, 28 + size + bytes.length, size, 0x4e4f534a].forEach((value, i) => head.writeUInt32LE(value, 4 * i));
  const second = Buffer.alloc(8);
  [bytes.length, 0x004e4942].forEach((value, i) => second.writeUInt32LE(value, 4 * i));
  return Buffer.concat([head, text, Buffer.alloc(size - text.length, 0x20), second, bytes]);
}
