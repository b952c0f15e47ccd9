// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Objects of three.js for tests: made by formula, with what files of others have.
import {peer} from './peers.js';

export const three = await peer('three');
const {Bone, BufferAttribute, CylinderGeometry, Float32BufferAttribute, InterleavedBuffer, InterleavedBufferAttribute, Matrix4,
  MeshBasicMaterial, Skeleton, SkinnedMesh, TorusKnotGeometry, Vector3} = three;

/** Numbers from 0 to 1 that are the same in every run. */
export function random(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** An arm along y from 0 to 4, closed, with seams of texture coordinates and hard edges, as an index or without. */
export function arm({round = 12, long = 24, bones = 4, isIndexed = true} = {}) {
  const geometry = new CylinderGeometry(0.4, 0.5, 4, round, long).translate(0, 2, 0);
  const {position} = geometry.attributes;
  const indices = [];
  const weights = [];
  for (let v = 0; v < position.count; ++v) {
    const at = Math.min(Math.max((position.getY(v) / 4) * bones - 0.5, 0), bones - 1);
    const low = Math.min(Math.floor(at), bones - 2);
    const side = Math.round(12 * (1 + Math.sin(5 * position.getX(v)))) / 256;
    const main = Math.round(256 * (1 - (at - low)) * (1 - side)) / 256;
    indices.push(low, low + 1, (low + 2) % bones, 0);
    weights.push(main, 1 - side - main, side, 0); // floats that add up to 1
    // The sides of three's seam differ in the last place.
    for (const k of [0, 2]) position.setComponent(v, k, Math.round(1e6 * position.getComponent(v, k)) / 1e6 + 0);
  }
  geometry.setAttribute('skinIndex', new BufferAttribute(new Uint16Array(indices), 4));
  geometry.setAttribute('skinWeight', new Float32BufferAttribute(weights, 4));
  return isIndexed ? geometry : geometry.toNonIndexed();
}

/** A SkinnedMesh on an arm, bound where `parent` puts it. */
export function character(geometry = arm(), {bones = 4, material = new MeshBasicMaterial(), place = new Matrix4()} = {}) {
  const chain = Array.from({length: bones}, () => new Bone());
  chain.forEach((bone, b) => {
    bone.position.y = b === 0 ? 0 : 4 / bones;
    if (b > 0) chain[b - 1].add(bone);
  });
  const mesh = new SkinnedMesh(geometry, material);
  mesh.add(chain[0]);
  mesh.applyMatrix4(place);
  mesh.updateMatrixWorld(true);
  mesh.bind(new Skeleton(chain));
  return mesh;
}

/** Bends, turns and stretches the bones; amount 0 is at rest. */
export function pose(mesh, amount, phase = 0) {
  mesh.skeleton.bones.forEach((bone, b) => {
    bone.rotation.set(amount * Math.sin(b + phase), 0.5 * amount * Math.cos(2 * b + phase), amount * Math.cos(b + 2 * phase));
    bone.scale.setScalar(1 + 0.2 * amount * Math.sin(3 * b + phase));
    bone.position.x = 0.2 * amount * Math.sin(phase);
  });
  mesh.updateMatrixWorld(true);
}

/** A knot without bones. */
export const knot = () => new TorusKnotGeometry(1, 0.35, 64, 10);

/** Positions, normals and texture coordinates of a geometry in one buffer. */
export function interleaved(geometry) {
  const {position, normal, uv} = geometry.attributes;
  const numbers = new Float32Array(8 * position.count);
  for (let v = 0; v < position.count; ++v)
    numbers.set([position.getX(v), position.getY(v), position.getZ(v), normal.getX(v), normal.getY(v), normal.getZ(v),
      uv.getX(v), uv.getY(v)], 8 * v);
  const buffer = new InterleavedBuffer(numbers, 8);
  const result = geometry.clone();
  result.setAttribute('position', new InterleavedBufferAttribute(buffer, 3, 0));
  result.setAttribute('normal', new InterleavedBufferAttribute(buffer, 3, 3));
  result.setAttribute('uv', new InterleavedBufferAttribute(buffer, 2, 6));
  return result;
}

/** Positions as normalized 16-bit numbers of a box of -1 to 1, weights as bytes. */
export function quantized(geometry, scale) {
  const result = geometry.clone();
  const {position, skinWeight} = geometry.attributes;
  const shorts = Int16Array.from({length: 3 * position.count}, (_, i) =>
    Math.round((32767 * position.getComponent(Math.floor(i / 3), i % 3)) / scale));
  result.setAttribute('position', new BufferAttribute(shorts, 3, true));
  if (skinWeight)
    result.setAttribute('skinWeight', new BufferAttribute(Uint8Array.from({length: 4 * skinWeight.count}, (_, i) =>
      Math.floor(255 * skinWeight.getComponent(Math.floor(i / 4), i % 4))), 4, true)); // the sums are below 255
  return result;
}

/** The vertices of an object by three.js, in its coordinates, 3 numbers each. */
export function verticesOf(object) {
  const target = new Vector3();
  const result = [];
  for (let v = 0; v < object.geometry.attributes.position.count; ++v) result.push(...object.getVertexPosition(v, target).toArray());
  return result;
}

/** The hits of all facets by three.js alone: bounds that could hide one are put out of its way. */
export function bruteHits(raycaster, object) {
  const {geometry} = object;
  const kept = [geometry.boundingSphere, geometry.boundingBox];
  geometry.boundingSphere = new three.Sphere(new Vector3(), Infinity);
  geometry.boundingBox = null;
  const bare = Object.create(object);
  bare.boundingSphere = object.isSkinnedMesh ? geometry.boundingSphere : undefined;
  bare.boundingBox = null;
  const hits = [];
  Object.getPrototypeOf(object).raycast.call(bare, raycaster, hits);
  [geometry.boundingSphere, geometry.boundingBox] = kept;
  for (const hit of hits) hit.object = object;
  return hits.sort((a, b) => a.distance - b.distance);
}
