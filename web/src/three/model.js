// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
import {MorulaError} from '../errors.js';
import {arraysOf, Versions} from './geometry.js';
import {facetsOfLeaves} from './leaves.js';

function bytesOfText(text) {
  try {
    return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  } catch {
    throw new MorulaError('geometry.userData.morula_tree is no base64 text', 'bad_file');
  }
}

/** An octree whose update costs about as much as one ray on its facets. */
function balanced(facetCount) {
  const depth = Math.round(Math.log(5.4 * facetCount) / (2 * Math.log(8)));
  return {method: 'octree', depth: Math.min(8, Math.max(1, depth))};
}

/** What bodies of one geometry share: the mesh, the tree, the facets of its leaves. It is freed with its last user. */
export class Model {
  #users = 0;

  constructor(morula, object, {tree, build, weld}) {
    const {geometry} = object;
    this.geometry = geometry;
    this.arrays = arraysOf(object, weld);
    this.versions = new Versions(object);
    this.mesh = new morula.Mesh(this.arrays.positions, this.arrays.facets);
    this.tree = null;
    this.skin = null;
    try {
      const stored = tree ?? geometry.userData.morula_tree;
      this.tree = stored === undefined
        ? morula.build(this.mesh, build ?? balanced(this.mesh.facetCount))
        : morula.Tree.fromBytes(typeof stored === 'string' ? bytesOfText(stored) : stored, this.mesh);
      const {skin} = this.arrays;
      if (skin) this.skin = new morula.Skin(skin.influences, skin.bones, skin.weights, skin.boneCount);
      this.leaves = facetsOfLeaves(this.tree, this.mesh);
      this.firstChild = this.tree.firstChild.slice();
      this.childCount = this.tree.childCount.slice();
      this.leafNodes = Uint32Array.from(this.childCount.keys()).filter((node) => this.childCount[node] === 0);
    } catch (error) {
      this.#free();
      throw error;
    }
  }
  use() {
    ++this.#users;
    return this;
  }
  release() {
    if (--this.#users === 0) this.#free();
  }
  #free() {
    for (const object of [this.skin, this.tree, this.mesh]) object?.free();
  }
}
