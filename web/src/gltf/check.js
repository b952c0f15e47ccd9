// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What has to hold in a glTF file before a library reads it: sizes, ranges of bytes, and references.
import {MorulaError} from '../errors.js';

const bytesOfType = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4};
const componentsOfType = {SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT2: 4, MAT3: 9, MAT4: 16};

export function fail(text) {
  throw new MorulaError(`glTF: ${text}`, 'bad_file');
}

/** The JSON and the binary chunk of a .glb, or the JSON of a .gltf and null. */
export function partsOfFile(bytes, maxBytes) {
  if (!(bytes instanceof Uint8Array)) throw new MorulaError('the bytes of a file are a Uint8Array');
  if (bytes.byteLength > maxBytes) fail(`the file has ${bytes.byteLength} bytes, more than the ${maxBytes} of maxBytes`);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const isBinary = bytes.byteLength >= 4 && view.getUint32(0, true) === 0x46546c67;
  let text = bytes;
  let binary = null;
  if (isBinary) {
    if (bytes.byteLength < 20) fail(`the file ends after ${bytes.byteLength} bytes`);
    if (view.getUint32(4, true) !== 2) fail(`version ${view.getUint32(4, true)} of the container is not 2`);
    if (view.getUint32(8, true) !== bytes.byteLength)
      fail(`the header announces ${view.getUint32(8, true)} bytes, and the file has ${bytes.byteLength}`);
    const size = view.getUint32(12, true);
    if (view.getUint32(16, true) !== 0x4e4f534a || size > bytes.byteLength - 20 || size % 4 !== 0)
      fail('the first chunk is no JSON of the size that it announces');
    text = bytes.subarray(20, 20 + size);
    const second = 20 + size;
    if (second < bytes.byteLength) {
      if (second + 8 > bytes.byteLength || view.getUint32(second, true) > bytes.byteLength - second - 8)
        fail('the second chunk goes beyond the file');
      if (view.getUint32(second + 4, true) === 0x004e4942)
        binary = bytes.subarray(second + 8, second + 8 + view.getUint32(second, true));
    }
  }
  let json;
  try {
    json = JSON.parse(new TextDecoder('utf-8', {fatal: true}).decode(text));
  } catch (error) {
    fail(`${isBinary ? 'its JSON' : 'the file'} cannot be read: ${error.message}`);
  }
  if (json?.asset?.version !== '2.0') fail('it has no asset of version 2.0');
  return {json, binary};
}

const whole = (value) => Number.isInteger(value) && value >= 0;
function listOf(json, name) {
  const list = json[name] ?? [];
  if (!Array.isArray(list) || list.some((one) => typeof one !== 'object' || one === null)) fail(`${name} is no list of objects`);
  return list;
}
function requireIndex(value, list, what) {
  if (!whole(value) || value >= list.length) fail(`${what} is ${value}, and there are ${list.length}`);
}

const meshopt = ['EXT_meshopt_compression', 'KHR_meshopt_compression'];

/** The bytes of each buffer: the chunk of a .glb, a data URI, or one of the given files; null for a buffer that only says how much
 * its compressed views take. */
export function dataOfBuffers(json, binary, resources) {
  return listOf(json, 'buffers').map(({uri, extensions}, b) => {
    if (uri === undefined && meshopt.some((name) => extensions?.[name]?.fallback === true)) return null;
    if (uri === undefined && b === 0 && binary) return binary;
    if (typeof uri !== 'string') fail(`buffer ${b} has no bytes`);
    if (uri.startsWith('data:')) {
      const [head, text] = uri.split(',', 2);
      if (!head.endsWith(';base64') || text === undefined) fail(`buffer ${b} has a data URI that is not base64`);
      return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    }
    const given = Object.hasOwn(resources, uri) ? resources[uri] : undefined;
    if (!(given instanceof Uint8Array)) fail(`it needs the file "${uri}": pass its bytes in resources`);
    return given;
  });
}

/** Checks what a view has in place of bytes of its buffer. sizes: of the buffers. */
function checkCompressed({buffer, byteOffset = 0, byteLength, byteStride, count}, view, sizes, what) {
  requireIndex(buffer, sizes, `the buffer of ${what}`);
  if (!whole(byteOffset) || !whole(byteLength) || !(byteOffset + byteLength <= sizes[buffer]) || !whole(count) || !whole(byteStride) ||
    count * byteStride > view.byteLength) fail(`${what} is not in its buffer, or larger than its view`);
}

/** Checks buffers, views and accessors. data: the bytes of each buffer, or null. */
export function checkData(json, data, maxBytes) {
  const buffers = listOf(json, 'buffers');
  const sizes = data.map((bytes) => bytes?.byteLength ?? 0);
  const views = listOf(json, 'bufferViews');
  buffers.forEach((buffer, b) => {
    if (data[b] === null && whole(buffer.byteLength) && buffer.byteLength <= maxBytes) return;
    if (!whole(buffer.byteLength) || buffer.byteLength > sizes[b])
      fail(`buffer ${b} announces ${buffer.byteLength} bytes, and ${sizes[b]} are there`);
  });
  views.forEach((view, v) => {
    requireIndex(view.buffer, buffers, `the buffer of view ${v}`);
    if (!whole(view.byteOffset ?? 0) || !whole(view.byteLength) || (view.byteOffset ?? 0) + view.byteLength > buffers[view.buffer].byteLength)
      fail(`view ${v} goes beyond its buffer`);
    if (view.byteStride !== undefined && !(whole(view.byteStride) && view.byteStride >= 4 && view.byteStride <= 252))
      fail(`view ${v} has the stride ${view.byteStride}`);
    const packed = meshopt.map((name) => view.extensions?.[name]).filter((one) => one);
    for (const one of packed) checkCompressed(one, view, sizes, `the compressed view ${v}`);
    if (packed.length === 0 && data[view.buffer] === null) fail(`view ${v} has no bytes`);
  });
  const requireRange = (at, count, size, stride, what) => {
    requireIndex(at.bufferView, views, `the view of ${what}`);
    const end = (at.byteOffset ?? 0) + (count - 1) * stride + size;
    if (!whole(at.byteOffset ?? 0) || end > views[at.bufferView].byteLength) fail(`${what} goes beyond its view`);
  };
  let total = 0;
  listOf(json, 'accessors').forEach((accessor, a) => {
    const component = bytesOfType[accessor.componentType];
    const components = componentsOfType[accessor.type];
    if (!component || !components) fail(`accessor ${a} has no type of glTF`);
    if (!whole(accessor.count) || accessor.count === 0) fail(`accessor ${a} has the count ${accessor.count}`);
    const size = component * components;
    total += accessor.count * size;
    if (total > maxBytes) fail(`its accessors have more than the ${maxBytes} bytes of maxBytes`);
    if (accessor.bufferView !== undefined) {
      requireIndex(accessor.bufferView, views, `the view of accessor ${a}`);
      const {byteStride = size} = views[accessor.bufferView];
      if (byteStride < size) fail(`the elements of accessor ${a} overlap`);
      requireRange(accessor, accessor.count, size, byteStride, `accessor ${a}`);
    }
    const {sparse} = accessor;
    if (sparse === undefined) return;
    if (!whole(sparse?.count) || sparse.count > accessor.count || !sparse.indices || !sparse.values || ![1, 2, 4].includes(bytesOfType[sparse.indices.componentType]))
      fail(`accessor ${a} has no sparse values of glTF`);
    const width = bytesOfType[sparse.indices.componentType];
    requireRange(sparse.indices, Math.max(1, sparse.count), width, width, `the sparse indices of accessor ${a}`);
    requireRange(sparse.values, Math.max(1, sparse.count), size, size, `the sparse values of accessor ${a}`);
  });
}

/** Checks that nodes are trees, and that what they and their parts name is there. */
export function checkReferences(json) {
  const [nodes, meshes, skins, accessors] = ['nodes', 'meshes', 'skins', 'accessors'].map((name) => listOf(json, name));
  const list = (value, what) => {
    if (value !== undefined && !Array.isArray(value)) fail(`${what} are no list`);
    return value ?? [];
  };
  const parent = new Int32Array(nodes.length).fill(-1);
  nodes.forEach((node, n) => {
    for (const child of list(node.children, `the children of node ${n}`)) {
      requireIndex(child, nodes, `a child of node ${n}`);
      if (parent[child] !== -1) fail(`node ${child} has two parents`);
      parent[child] = n;
    }
    if (node.mesh !== undefined) requireIndex(node.mesh, meshes, `the mesh of node ${n}`);
    if (node.skin !== undefined) requireIndex(node.skin, skins, `the skin of node ${n}`);
  });
  const state = new Uint8Array(nodes.length); // 1: on the way up from the present node, 2: leads to a root
  nodes.forEach((_, n) => {
    const way = [];
    for (let at = n; at !== -1 && state[at] !== 2; at = parent[at]) {
      if (state[at] === 1) fail(`node ${at} is its own ancestor`);
      state[at] = 1;
      way.push(at);
    }
    for (const at of way) state[at] = 2;
  });
  meshes.forEach((mesh, m) => list(mesh.primitives, `the primitives of mesh ${m}`).forEach((primitive, p) => {
    const what = `primitive ${p} of mesh ${m}`;
    if (primitive?.indices !== undefined) requireIndex(primitive.indices, accessors, `the indices of ${what}`);
    for (const group of [primitive?.attributes, ...list(primitive?.targets, `the targets of ${what}`)])
      for (const [name, index] of Object.entries(group ?? {})) requireIndex(index, accessors, `${name} of ${what}`);
  }));
  skins.forEach((skin, s) => {
    if (skin.inverseBindMatrices !== undefined) requireIndex(skin.inverseBindMatrices, accessors, `the matrices of skin ${s}`);
    if (!Array.isArray(skin.joints) || skin.joints.length === 0) fail(`skin ${s} has no joints`);
    for (const joint of skin.joints) requireIndex(joint, nodes, `a joint of skin ${s}`);
  });
  listOf(json, 'animations').forEach((animation, i) => {
    const samplers = list(animation.samplers, `the samplers of animation ${i}`);
    for (const sampler of samplers) {
      requireIndex(sampler?.input, accessors, `the times of animation ${i}`);
      requireIndex(sampler?.output, accessors, `the values of animation ${i}`);
    }
    for (const channel of list(animation.channels, `the channels of animation ${i}`)) {
      requireIndex(channel?.sampler, samplers, `a sampler of animation ${i}`);
      if (channel.target?.node !== undefined) requireIndex(channel.target.node, nodes, `a node of animation ${i}`);
    }
  });
}
