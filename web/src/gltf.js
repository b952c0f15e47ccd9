// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes, skins and motions of glTF files. gltf.d.ts has the contracts.
import {WebIO} from '@gltf-transform/core';
import {MorulaError} from './errors.js';
import {checkData, checkReferences, dataOfBuffers, fail, partsOfFile} from './gltf/check.js';
import {motionOf, Pose} from './gltf/motion.js';
import {GltfPart} from './gltf/part.js';

/** Nodes of the default scene, parents first; without scenes all nodes. */
function nodesOf(root) {
  const scene = root.getDefaultScene() ?? root.listScenes()[0];
  if (!scene) return root.listNodes();
  const nodes = [];
  scene.traverse((node) => nodes.push(node));
  return nodes;
}

/** The library splits matrices into translation, rotation and scale, which loses shear. */
function checkMatrices(json, root) {
  (json.nodes ?? []).forEach(({matrix}, n) => {
    if (matrix === undefined) return;
    const size = Math.max(...matrix.map(Math.abs));
    root.listNodes()[n].getMatrix().forEach((x, i) => {
      if (!(Math.abs(x - matrix[i]) <= 1e-5 * size)) fail(`the matrix of node ${n} has shear`);
    });
  });
}

/** Bytes of the numbers that a part copies. */
const sizeOf = (primitive) => [primitive, ...primitive.listTargets()]
  .flatMap((one) => one.listAttributes())
  .reduce((sum, accessor) => sum + 8 * accessor.getCount() * accessor.getElementSize(), 8 * (primitive.getIndices()?.getCount() ?? 0));

class GltfFile {
  #io;
  #motions;

  constructor(io, document, maxBytes) {
    this.#io = io;
    this.document = document;
    const root = document.getRoot();
    let size = 0;
    this.parts = nodesOf(root).flatMap((node) => (node.getMesh()?.listPrimitives() ?? []).map((primitive, p) => {
      // A file may show one mesh by many nodes.
      size += sizeOf(primitive);
      if (size > maxBytes) fail(`its parts have more than the ${maxBytes} bytes of maxBytes`);
      return GltfPart.of(document, node, primitive, p);
    }).filter((part) => part));
    this.#motions = root.listAnimations().map(motionOf);
    this.animations = this.#motions.map(({name, duration}) => ({name, duration}));
  }
  pose(animation = null, seconds = 0) {
    if (animation !== null && !this.#motions[animation]) throw new MorulaError(`there is no animation ${animation}`);
    return new Pose(this.document, animation === null ? null : this.#motions[animation], seconds);
  }
  async toBytes() {
    for (const texture of this.document.getRoot().listTextures())
      if (!texture.getImage()) throw new MorulaError(`the image "${texture.getURI()}" was not given in resources`);
    return this.#io.writeBinary(this.document);
  }
}

/** Runs a step in which a bad file may throw anything. */
async function guarded(step) {
  try {
    return await step();
  } catch (error) {
    if (error instanceof MorulaError) throw error;
    return fail(error.message);
  }
}

export async function readGltf(bytes, {io = new WebIO(), resources = {}, maxBytes = 2 ** 30} = {}) {
  return guarded(async () => {
    const {json, binary} = partsOfFile(bytes, maxBytes);
    const data = dataOfBuffers(json, binary, resources);
    checkData(json, data, maxBytes);
    checkReferences(json);
    // Buffers under names of their own: the library reads no address again.
    const named = data.map((_, b) => `__buffer${b}.bin`);
    const document = await io.readJSON({
      json: {...json, buffers: json.buffers?.map((buffer, b) => (data[b] ? {...buffer, uri: named[b]} : buffer))},
      resources: {...resources, ...Object.fromEntries(data.flatMap((part, b) => (part ? [[named[b], part]] : [])))},
    });
    checkMatrices(json, document.getRoot());
    return new GltfFile(io, document, maxBytes);
  });
}
