// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The classes of one module. index.d.ts has their contracts; module.cpp checks the places of fields used here.
import {buildAsyncOf} from './build_async.js';
import {MorulaError} from './errors.js';
import {Handle} from './handle.js';
import {Block} from './memory.js';
import {bytesOf, indices, signed, whole, wide} from './numbers.js';
import {pairsOf} from './pairs.js';
import {queriesOf} from './queries.js';

const noNode = 0xffffffff;

function requireKind(value, Kind, name) {
  if (!(value instanceof Kind)) throw new MorulaError(`${name} is no ${Kind.name} of this module`);
  return value.handle;
}

function requireLength(numbers, length, name) {
  if (numbers.length !== length)
    throw new MorulaError(`${name} has ${numbers.length} numbers instead of ${length}`, 'rejected');
}

function requireMultiple(numbers, width, name) {
  if (numbers.length % width !== 0)
    throw new MorulaError(`${name} has ${numbers.length} numbers, no multiple of ${width}`);
  return numbers.length / width;
}

/** Makes the classes and functions over the exports of a module. state: {progress, failure}, of the import `progress`. module,
 * starts: the compiled module, and functions that start a worker for it. */
export function libraryOf(memory, state, {module, starts}) {
  class Mesh extends Handle {
    constructor(positions, facets) {
      super(memory, 'morula_mesh_destroy', positions instanceof Made ? positions.handle : createMesh(positions, facets));
    }
    static fromBytes(name, bytes) {
      const given = bytesOf(bytes, 'bytes');
      const size = given.length;
      return new Mesh(new Made(memory.withNumbers(Uint8Array, given, (begin) => memory.withTexts([name], (text) =>
        memory.make('morula_mesh_from_bytes', text, begin, size)))));
    }
    static sample(name, resolution) {
      const edges = signed(resolution, 'resolution');
      return new Mesh(new Made(memory.withTexts([name], (text) => memory.make('morula_mesh_sample', text, edges))));
    }
    get vertexCount() {
      return memory.get('morula_mesh_vertex_count', this.handle);
    }
    get facetCount() {
      return memory.get('morula_mesh_facet_count', this.handle);
    }
    get positions() {
      return new Float64Array(memory.buffer, memory.get('morula_mesh_positions', this.handle), 3 * this.vertexCount);
    }
    get facets() {
      return new Uint32Array(memory.buffer, memory.get('morula_mesh_facets', this.handle), 3 * this.facetCount);
    }
  }

  /** A handle that a function has made. */
  class Made {
    constructor(handle) {
      this.handle = handle;
    }
  }

  function createMesh(positions, facets) {
    const vertices = requireMultiple(positions, 3, 'positions');
    const count = requireMultiple(facets, 3, 'facets');
    // Copies of both first: they may be views of the module's memory, which the first block may make grow.
    const points = Float64Array.from(positions);
    const corners = indices(facets, 'facets');
    return memory.withNumbers(Float64Array, points, (at) =>
      memory.withNumbers(Uint32Array, corners, (list) => memory.make('morula_mesh_create', at, vertices, list, count)));
  }

  class Tree extends Handle {
    constructor(made) {
      if (!(made instanceof Made)) throw new MorulaError('a Tree is made by build() or Tree.fromBytes()');
      super(memory, 'morula_model_destroy', made.handle);
    }
    static fromBytes(bytes, mesh) {
      const of = requireKind(mesh, Mesh, 'mesh');
      const given = bytesOf(bytes, 'bytes');
      const size = given.length;
      return new Tree(new Made(memory.withNumbers(Uint8Array, given, (begin) =>
        memory.make('morula_model_from_bytes', begin, size, of))));
    }
    toBytes() {
      const size = memory.withBlock(4, (count) => {
        memory.call('morula_model_to_bytes', this.handle, 0, 0, count);
        return memory.data.getUint32(count, true);
      });
      return memory.withBlock(size + 4, (begin) => {
        memory.call('morula_model_to_bytes', this.handle, begin + 4, size, begin);
        return new Uint8Array(memory.buffer, begin + 4, size).slice();
      });
    }
    get nodeCount() {
      return memory.get('morula_model_node_count', this.handle);
    }
    get levelCount() {
      return memory.get('morula_model_level_count', this.handle);
    }
    get leafCount() {
      return memory.get('morula_model_leaf_count', this.handle);
    }
    get spheres() {
      return new Float64Array(memory.buffer, memory.get('morula_model_spheres', this.handle), 4 * this.nodeCount);
    }
    get parent() {
      return this.#nodes('morula_model_parent');
    }
    get firstChild() {
      return this.#nodes('morula_model_first_child');
    }
    get childCount() {
      return this.#nodes('morula_model_child_count');
    }
    levelSet(level) {
      const number = whole(level, 'level');
      return indicesFrom((list, capacity, count) =>
        memory.call('morula_model_level_set', this.handle, number, list, capacity, count), 1);
    }
    #nodes(name) {
      return new Uint32Array(memory.buffer, memory.get(name, this.handle), this.nodeCount);
    }
  }

  /** A list whose length is known only after the call, which is repeated if there is too little room. */
  function indicesFrom(call, width, capacity = 4096) {
    const [size, list] = memory.withBlock(4 * width * capacity + 4, (begin) => {
      call(begin + 4, capacity, begin);
      const count = memory.data.getUint32(begin, true);
      return [count, new Uint32Array(memory.buffer, begin + 4, width * Math.min(count, capacity)).slice()];
    });
    return size <= capacity ? list : indicesFrom(call, width, size);
  }

  class Skin extends Handle {
    constructor(influences, bones, weights, boneCount) {
      const vertices = requireMultiple(bones, whole(influences, 'influences', 1), 'bones');
      const count = whole(boneCount, 'boneCount');
      requireLength(weights, bones.length, 'weights');
      const copy = Float64Array.from(weights);
      super(memory, 'morula_skin_destroy', memory.withNumbers(Uint32Array, indices(bones, 'bones'), (list) =>
        memory.withNumbers(Float64Array, copy, (numbers) =>
          memory.make('morula_skin_create', vertices, influences, list, numbers, count))));
    }
    get boneCount() {
      return memory.get('morula_skin_bone_count', this.handle);
    }
  }

  class Body extends Handle {
    #isDouble;
    #vertexCount;
    #positions;
    #transforms = null;
    #spheres;

    constructor(mesh, tree, {rules = 'exact', conservative = false, skin = null, precision = 'float'} = {}) {
      if (precision !== 'float' && precision !== 'double')
        throw new MorulaError(`precision is ${precision}, neither float nor double`);
      const options = {rules: [rules].flat().join(','), conservative, skin: skin && requireKind(skin, Skin, 'skin')};
      super(memory, 'morula_body_destroy',
        createBody(requireKind(mesh, Mesh, 'mesh'), requireKind(tree, Tree, 'tree'), options));
      this.#isDouble = precision === 'double';
      this.#vertexCount = mesh.vertexCount;
      const rest = mesh.positions.slice();
      this.#positions = this.own(new Block(memory, this.#isDouble ? Float64Array : Float32Array, rest.length));
      this.#positions.view.set(rest);
      this.#spheres = this.own(new Block(memory, Float64Array, 4 * this.nodeCount));
      if (skin) {
        this.#transforms = this.own(new Block(memory, Float64Array, 12 * skin.boneCount));
        for (let i = 0; i < this.#transforms.length; ++i) this.#transforms.view[i] = [0, 5, 10].includes(i % 12) ? 1 : 0;
      }
    }
    get nodeCount() {
      return memory.get('morula_body_node_count', this.handle);
    }
    get positions() {
      this.handle;
      return this.#positions.view;
    }
    get transforms() {
      this.handle;
      return this.#transforms?.view ?? null;
    }
    update(positions) {
      this.#move(this.#positions, positions, 'positions', () =>
        memory.call(this.#isDouble ? 'morula_body_update_double' : 'morula_body_update_float', this.handle,
          this.#positions.begin, this.#vertexCount, 0));
    }
    updateSkinned(transforms) {
      if (this.#transforms === null) throw new MorulaError('the body has no skin');
      this.#move(this.#transforms, transforms, 'transforms', () =>
        memory.call('morula_body_update_skinned', this.handle, this.#transforms.begin, this.#transforms.length / 12));
    }
    setTransform(rotation, translation) {
      requireLength(rotation, 9, 'rotation');
      requireLength(translation, 3, 'translation');
      memory.withNumbers(Float64Array, [rotation, translation].flatMap((numbers) => Array.from(numbers)), (begin) =>
        memory.call('morula_body_set_transform', this.handle, begin, begin + 72));
    }
    spheres() {
      memory.call('morula_body_spheres', this.handle, this.#spheres.begin);
      return this.#spheres.view;
    }
    certify(positions = this.positions) {
      requireLength(positions, 3 * this.#vertexCount, 'positions');
      return memory.withNumbers(Float64Array, positions, (begin) => memory.withBlock(4, (covered) => {
        memory.call('morula_body_certify', this.handle, begin, this.#vertexCount, covered);
        return memory.data.getInt32(covered, true) === 1;
      }));
    }
    /** Copies numbers, if there are any, into a block, and moves the body. If that fails, the block has its old numbers. */
    #move(block, numbers, name, run) {
      this.handle;
      if (numbers === undefined || numbers === block.view) return run();
      requireLength(numbers, block.length, name);
      const before = block.view.slice();
      try {
        block.view.set(numbers);
        run();
      } catch (error) {
        block.view.set(before);
        throw error;
      }
    }
    selfCrossings() {
      return indicesFrom((list, capacity, count) =>
        memory.call('morula_self_crossings', this.handle, list, capacity, count), 2);
    }
  }

  function createBody(mesh, tree, {rules, conservative, skin}) {
    return memory.withTexts([rules], (text) => memory.withBlock(20, (options) => {
      memory.get('morula_body_options_defaults', options, 20);
      memory.data.setUint32(options + 4, text, true);
      memory.data.setInt32(options + 8, conservative ? 1 : 0, true);
      memory.data.setUint32(options + 16, skin ?? 0, true);
      return memory.make('morula_body_create', mesh, tree, options);
    }));
  }

  function build(mesh, options = {}) {
    const {method = 'optimized', quality = 'default', progress = null, budgetMs} = options;
    if (budgetMs !== undefined && options.timeLimitSeconds !== undefined)
      throw new MorulaError('budgetMs and timeLimitSeconds are both set: one limit at a time');
    const seconds = budgetMs === undefined ? options.timeLimitSeconds : budgetMs / 1000;
    const of = requireKind(mesh, Mesh, 'mesh');
    return new Tree(new Made(memory.withTexts([method, quality], (methodText, qualityText) =>
      memory.withBlock(64, (place) => {
        memory.get('morula_build_options_defaults', place, 64);
        const data = memory.data;
        data.setUint32(place + 4, methodText, true);
        data.setUint32(place + 8, qualityText, true);
        if (options.branching !== undefined) data.setInt32(place + 12, signed(options.branching, 'branching'), true);
        if (options.depth !== undefined) data.setInt32(place + 16, signed(options.depth, 'depth'), true);
        if (options.spheres !== undefined) data.setUint32(place + 20, whole(options.spheres, 'spheres'), true);
        if (options.maxProtrusion !== undefined) data.setFloat64(place + 24, options.maxProtrusion, true);
        if (seconds !== undefined) data.setFloat64(place + 32, seconds, true);
        if (options.seed !== undefined) data.setBigUint64(place + 40, wide(options.seed, 'seed'), true);
        data.setInt32(place + 52, options.nested ? 1 : 0, true);
        return withProgress(progress, () => memory.make('morula_web_build', of, place, progress ? 1 : 0));
      }))));
  }

  /** Runs a build; an exception of the caller's function stops it, and is thrown when the module has cleaned up. */
  function withProgress(progress, run) {
    const outer = {...state};
    state.progress = progress;
    state.failure = null;
    try {
      return run();
    } catch (error) {
      throw state.failure ? state.failure.reason : error;
    } finally {
      Object.assign(state, outer);
    }
  }

  function requireBuilder(mesh) {
    requireKind(mesh, Mesh, 'mesh');
    memory.require('morula_web_build');
  }

  return {
    version: memory.text(memory.get('morula_version')),
    noNode,
    memory: () => memory.buffer,
    Mesh,
    Tree,
    Skin,
    Body,
    build,
    buildAsync: buildAsyncOf(module, starts, {requireBuilder, Tree}),
    ...queriesOf(memory, Body, {requireKind, requireLength, requireMultiple, indicesFrom}),
    ...pairsOf(memory, Body, requireKind),
  };
}
