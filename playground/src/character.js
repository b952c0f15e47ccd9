// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A GLB file as one mesh that bones and morph targets move: all of its meshes, in the axes of the scene. Pictures and materials are
// left out.
import { AnimationMixer, Matrix3, Matrix4, Vector3 } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { checkFacetCount, InputError } from './limits.js';
import { Morphs } from './morphs.js';

const jsonKind = 0x4e4f534a;
const triangles = 4;

/** {json, rest}: the description and the bytes of the chunks behind it. */
function chunks(name, bytes) {
  const view = new DataView(bytes);
  const isGlb = bytes.byteLength >= 20 && view.getUint32(0, true) === 0x46546c67 && view.getUint32(4, true) === 2;
  const length = isGlb ? view.getUint32(12, true) : 0;
  if (!isGlb || view.getUint32(16, true) !== jsonKind || 20 + length > bytes.byteLength) throw new InputError(`${name} is no GLB file of version 2`);
  try {
    return { json: JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 20, length))), rest: new Uint8Array(bytes, 20 + length) };
  } catch {
    throw new InputError(`${name}: its description is damaged`);
  }
}

/** The file without its pictures, which this page would not show, and which its policy would not let it load. */
function withoutPictures(name, bytes) {
  const { json, rest } = chunks(name, bytes);
  if (json === null || typeof json !== 'object') throw new InputError(`${name}: its description is damaged`);
  const asked = (json.extensionsRequired ?? []).filter((extension) => /compression|EXT_mesh_gpu/.test(extension));
  if (asked.length > 0) throw new InputError(`${name} needs ${asked.join(', ')}, which this page does not read; export it without compression`);
  if ((json.buffers ?? []).some((buffer) => buffer.uri !== undefined)) throw new InputError(`${name} refers to other files; export it as one GLB file`);
  let facets = 0;
  for (const primitive of (json.meshes ?? []).flatMap((mesh) => mesh.primitives ?? [])) {
    const list = json.accessors?.[primitive.indices ?? primitive.attributes?.POSITION];
    if ((primitive.mode ?? triangles) >= triangles) facets += Math.floor((list?.count ?? 0) / 3);
    delete primitive.material;
  }
  if (facets === 0) throw new InputError(`${name} has no triangles`);
  checkFacetCount(facets);
  for (const part of ['materials', 'textures', 'images', 'samplers', 'extensionsRequired', 'extensionsUsed', 'extensions']) delete json[part];
  const text = new TextEncoder().encode(JSON.stringify(json));
  const padded = 4 * Math.ceil(text.length / 4);
  const whole = new Uint8Array(20 + padded + rest.length).fill(0x20);
  const head = new DataView(whole.buffer);
  [0x46546c67, 2, whole.length, padded, jsonKind].forEach((value, i) => head.setUint32(4 * i, value, true));
  whole.set(text, 20);
  whole.set(rest, 20 + padded);
  return whole.buffer;
}

/** Collects vertices, each place with its bones and offsets once, and facets. */
class Collector {
  constructor() {
    Object.assign(this, { positions: [], bones: [], weights: [], facets: [], boneMatrices: [], morphs: new Morphs(), seen: new Map() });
  }
  bone(matrixOf) {
    return this.boneMatrices.push(matrixOf) - 1;
  }
  /** offsets: one per morph target of its mesh, whose first one is `firstTarget`. */
  vertex(place, bones, weights, offsets, firstTarget) {
    const moved = offsets.flatMap((offset) => offset.toArray());
    if (!moved.every(Number.isFinite)) throw new InputError('a morph target has an offset that is no number; the file is damaged');
    const key = `${place.x},${place.y},${place.z},${bones.join()}${moved.some((x) => x !== 0) ? `,${firstTarget},${moved.join()}` : ''}`;
    const found = this.seen.get(key);
    if (found !== undefined) return found;
    const index = this.positions.length / 3;
    offsets.forEach(({ x, y, z }, k) => {
      if (x !== 0 || y !== 0 || z !== 0) this.morphs.offset(firstTarget + k, index, x, y, z);
    });
    this.positions.push(place.x, place.y, place.z);
    this.bones.push(...bones);
    this.weights.push(...weights);
    this.seen.set(key, index);
    return index;
  }

  add(mesh) {
    const { position, skinIndex, skinWeight } = mesh.geometry.attributes;
    const isSkinned = mesh.isSkinnedMesh && skinIndex && skinWeight;
    // At rest a vertex lies where the bones of the bind pose, or its mesh, put it; a bone moves it from there.
    const atRest = mesh.matrixWorld.clone();
    if (isSkinned) atRest.multiply(mesh.bindMatrixInverse).multiply(mesh.bindMatrix);
    const back = atRest.clone().invert();
    const turn = new Matrix3().setFromMatrix4(atRest);
    const first = isSkinned
      ? mesh.skeleton.bones.map((bone, i) => {
          const restToBone = mesh.skeleton.boneInverses[i].clone().multiply(mesh.bindMatrix).multiply(back);
          const leave = new Matrix4();
          return this.bone((out) => {
            leave.copy(mesh.matrixWorld).multiply(mesh.bindMatrixInverse);
            return out.copy(leave).multiply(bone.matrixWorld).multiply(restToBone);
          });
        })[0]
      : this.bone((out) => out.copy(mesh.matrixWorld).multiply(back));
    const targets = mesh.geometry.morphAttributes.position ?? [];
    if (targets.some((target) => target.count !== position.count)) throw new InputError('a morph target has not one offset per vertex; the file is damaged');
    const firstTarget = this.morphs.targets.length;
    targets.forEach((_, k) => this.morphs.add(() => mesh.morphTargetInfluences?.[k] ?? 0));
    const offsets = targets.map(() => new Vector3());
    const place = new Vector3();
    const index = Array.from({ length: position.count }, (_, i) => {
      place.fromBufferAttribute(position, i);
      offsets.forEach((offset, k) => {
        offset.fromBufferAttribute(targets[k], i);
        place.addScaledVector(offset, this.morphs.targets[firstTarget + k].atRest);
        offset.applyMatrix3(turn);
      });
      place.applyMatrix4(atRest);
      const slots = [0, 1, 2, 3];
      const weights = isSkinned ? slots.map((k) => skinWeight.getComponent(i, k)) : [1, 0, 0, 0];
      const whole = weights.reduce((sum, weight) => sum + weight, 0);
      const bones = slots.map((k) => first + (isSkinned && weights[k] > 0 ? skinIndex.getComponent(i, k) : 0));
      return this.vertex(place, bones, whole > 0 ? weights.map((weight) => weight / whole) : [1, 0, 0, 0], offsets, firstTarget);
    });
    const list = mesh.geometry.index;
    const count = list ? list.count : position.count;
    for (let i = 0; i + 2 < count; i += 3) {
      const corners = [0, 1, 2].map((k) => index[list ? list.getX(i + k) : i + k]);
      if (new Set(corners).size === 3) this.facets.push(...corners);
    }
    checkFacetCount(this.facets.length / 3); // a scene may place one mesh many times
  }
}

export class Character {
  constructor(scene, clips, collector) {
    this.scene = scene;
    this.clips = clips;
    this.mixer = new AnimationMixer(scene);
    this.rest = Float64Array.from(collector.positions);
    this.facets = Uint32Array.from(collector.facets);
    this.bones = Uint32Array.from(collector.bones);
    this.weights = Float64Array.from(collector.weights);
    this.morphs = collector.morphs;
    this.followsBones = !collector.morphs.moves; // by which the spheres of the rule skinned cover
    this.boneMatrices = collector.boneMatrices;
    this.boneCount = collector.boneMatrices.length;
    this.transforms = new Float64Array(12 * this.boneCount);
    this.matrix = new Matrix4();
    this.duration = 0;
    this.play(0);
  }

  play(clip) {
    this.mixer.stopAllAction();
    this.duration = this.clips[clip]?.duration ?? 0;
    if (this.duration > 0) this.mixer.clipAction(this.clips[clip]).play();
  }

  /** The pose of the clip at a time, seconds: into `transforms`, and vertices into `out`. */
  pose(time, out) {
    if (this.duration > 0) this.mixer.setTime(time % this.duration);
    this.scene.updateMatrixWorld(true);
    const t = this.transforms;
    this.boneMatrices.forEach((matrixOf, bone) => {
      const e = matrixOf(this.matrix).elements;
      for (let row = 0; row < 3; ++row) for (let k = 0; k < 4; ++k) t[12 * bone + 4 * row + k] = e[4 * k + row];
    });
    const { bones, weights } = this;
    const rest = this.morphs.applied(this.rest);
    for (let v = 0; 3 * v < rest.length; ++v) {
      const [x, y, z] = [rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]];
      let [px, py, pz] = [0, 0, 0];
      for (let k = 4 * v; k < 4 * v + 4; ++k) {
        const weight = weights[k];
        if (weight === 0) continue;
        const b = 12 * bones[k];
        px += weight * (t[b] * x + t[b + 1] * y + t[b + 2] * z + t[b + 3]);
        py += weight * (t[b + 4] * x + t[b + 5] * y + t[b + 6] * z + t[b + 7]);
        pz += weight * (t[b + 8] * x + t[b + 9] * y + t[b + 10] * z + t[b + 11]);
      }
      out[3 * v] = px;
      out[3 * v + 1] = py;
      out[3 * v + 2] = pz;
    }
  }
}

/** bytes: of a GLB file. Throws an InputError for one that is none, or that has no triangles. */
export async function readCharacter(name, bytes) {
  const clean = withoutPictures(name, bytes);
  let gltf;
  try {
    gltf = await new GLTFLoader().parseAsync(clean, '');
  } catch (error) {
    throw new InputError(`${name} is damaged: ${error.message}`);
  }
  gltf.scene.updateMatrixWorld(true);
  const collector = new Collector();
  gltf.scene.traverse((node) => node.isMesh && node.geometry.attributes.position && collector.add(node));
  if (collector.facets.length === 0) throw new InputError(`${name} has no triangles`);
  return new Character(gltf.scene, gltf.animations, collector);
}
