// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The JavaScript of the package without its modules: what it accepts and rejects before a module is called, and what it does with
// memory, workers and files. scripts/test runs it, for it needs node alone.
import assert from 'node:assert/strict';
import {existsSync, readdirSync, readFileSync} from 'node:fs';
import test from 'node:test';
import {budgetOf} from '../src/budget.js';
import {buildAsyncOf} from '../src/build_async.js';
import {codes, MorulaError} from '../src/errors.js';
import {checkData, checkReferences, dataOfBuffers, partsOfFile} from '../src/gltf/check.js';
import {product, rowsOf, valueAt} from '../src/gltf/motion.js';
import {Handle} from '../src/handle.js';
import {load} from '../src/index.js';
import {libraryOf} from '../src/library.js';
import {Block, Memory} from '../src/memory.js';
import {bytesOf, indices, signed, whole, wide} from '../src/numbers.js';
import {systemCalls} from '../src/system.js';
import {facetsOfLeaves} from '../src/three/leaves.js';
import {completedSkin, distinctRows, welded} from '../src/weld.js';
import {run} from '../src/workers.js';

const root = new URL('../../', import.meta.url);
const textOf = (path) => readFileSync(new URL(path, root), 'utf8');
const thrown = (code, text) => (error) => {
  assert.ok(error instanceof MorulaError, String(error));
  assert.equal(error.code, code, error.message);
  assert.match(error.message, text);
  return true;
};
function random(seed) {
  let state = seed >>> 0;
  return () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;
}

/** Exports of a module whose malloc takes the next bytes; any function that a test has not given throws. */
function exportsOf(functions = {}, pages = 1) {
  const memory = new WebAssembly.Memory({initial: pages, maximum: 16});
  const live = new Map();
  let end = 16;
  return {
    memory,
    live,
    malloc(size) {
      const begin = end;
      end += (size + 7) & ~7;
      if (end > memory.buffer.byteLength) memory.grow(Math.ceil((end - memory.buffer.byteLength) / 65536));
      live.set(begin, size);
      return begin;
    },
    free(begin) {
      if (!live.delete(begin)) throw new Error(`${begin} is freed twice`);
    },
    ...functions,
  };
}

test('codes of errors are those of the C header, in its order', () => {
  const declared = textOf('include/morula/morula.h').match(/typedef enum morula_status \{(.*?)\}/s)[1]
    .replace(/\/\*.*?\*\//gs, '').match(/MORULA_[A-Z_]+/g).map((name) => name.replace('REFUSED', 'REJECTED'));
  assert.deepEqual(codes.map((code) => `MORULA_${code.toUpperCase()}`), declared);
  const error = new MorulaError('text');
  assert.ok(error instanceof Error && error.name === 'MorulaError' && error.code === 'bad_argument');
});

test('every function that a script calls is one of the C header or of module.cpp', () => {
  const declared = textOf('include/morula/morula.h') + textOf('web/module.cpp');
  let named = 0;
  for (const file of readdirSync(new URL('web/src/', root)).filter((name) => name.endsWith('.js')))
    for (const [, name] of textOf(`web/src/${file}`).matchAll(/'(morula_[a-z_]+)'/g)) {
      assert.match(declared, new RegExp(`\\b${name}\\(`), `${file}: ${name}`);
      ++named;
    }
  assert.ok(named > 40);
});

test('files that package.json names are there', () => {
  for (const places of Object.values(JSON.parse(textOf('web/package.json')).exports))
    for (const path of typeof places === 'string' ? [] : Object.values(places))
      assert.ok(existsSync(new URL(`web/${path}`, root)), path);
});

test('numbers are whole and fit, or are rejected by name', () => {
  assert.equal(whole(0xffffffff, 'x'), 0xffffffff);
  assert.equal(signed(-(2 ** 31), 'x'), -(2 ** 31));
  for (const bad of [-1, 1.5, 2 ** 32, NaN, Infinity, '1', null, undefined, 1n, [1]])
    assert.throws(() => whole(bad, 'depth'), thrown('bad_argument', /^depth is /));
  assert.throws(() => whole(0, 'influences', 1), thrown('bad_argument', /from 1 to/));
  for (const bad of [2 ** 31, -(2 ** 31) - 1, 0.5]) assert.throws(() => signed(bad, 'level'), MorulaError);
  assert.equal(wide(2n ** 64n - 1n, 'seed'), 2n ** 64n - 1n);
  assert.equal(wide(Number.MAX_SAFE_INTEGER, 'seed'), BigInt(Number.MAX_SAFE_INTEGER));
  for (const bad of [2n ** 64n, -1n, -1, 2 ** 53, 0.5, '7', NaN]) assert.throws(() => wide(bad, 'seed'), thrown('bad_argument', /^seed is /));
  assert.deepEqual(indices([0, 2, 0xffffffff], 'facets'), Uint32Array.of(0, 2, 0xffffffff));
  for (const bad of [-1, 1.5, 2 ** 32, NaN, '1']) assert.throws(() => indices([0, bad], 'facets'), thrown('bad_argument', /^facets\[1\]/));
  const bytes = Uint8Array.of(1, 2, 3, 4);
  assert.deepEqual(bytesOf(new Uint16Array(bytes.buffer, 2, 1), 'bytes'), Uint8Array.of(3, 4));
  assert.deepEqual(bytesOf(bytes.buffer, 'bytes'), bytes);
  for (const bad of [null, 'abc', [1], 7]) assert.throws(() => bytesOf(bad, 'bytes'), MorulaError);
});

test('budgets become tests and nanoseconds', () => {
  assert.deepEqual(budgetOf(), [-1n, -1n]);
  assert.deepEqual(budgetOf(0, 0), [0n, 0n]);
  assert.deepEqual(budgetOf(7, 2.5), [7n, 2500000n]);
  for (const tests of [-1, 0.5, NaN, '3', null]) assert.throws(() => budgetOf(tests), MorulaError);
  for (const ms of [-1, NaN, Infinity, 2e9]) assert.throws(() => budgetOf(undefined, ms), MorulaError);
});

test('blocks of memory are freed, also after exceptions; views follow growth', () => {
  const exports = exportsOf();
  const memory = new Memory(exports);
  assert.throws(() => memory.withTexts(['é', ''], (first, second) => {
    assert.deepEqual([memory.text(first), memory.text(second)], ['é', '']);
    throw new Error('of the caller');
  }), /of the caller/);
  assert.equal(exports.live.size, 0);
  const block = new Block(memory, Float32Array, 3);
  block.view.set([1, 2, 3]);
  const old = block.view;
  memory.free(memory.allocate(200000));
  assert.equal(old.length, 0);
  assert.deepEqual(block.view, Float32Array.of(1, 2, 3));
  // Numbers that are a view of this memory survive a block that makes it grow.
  memory.withNumbers(Float32Array, block.view, (begin) => assert.equal(memory.data.getFloat32(begin + 8, true), 3));
  assert.throws(() => memory.allocate(2 ** 32), thrown('out_of_memory', /4294967296 bytes/));
});

test('a status becomes an error with the text of the module; after a trap nothing is called', () => {
  let calls = 0;
  const exports = exportsOf({
    morula_message: () => 4,
    morula_overlap: () => 3,
    morula_crossings() {
      ++calls;
      throw new WebAssembly.RuntimeError('unreachable');
    },
  });
  const memory = new Memory(exports);
  new Uint8Array(memory.buffer).set(new TextEncoder().encode('no mesh\0'), 4);
  assert.throws(() => memory.call('morula_overlap'), thrown('rejected', /^no mesh$/));
  assert.throws(() => memory.get('morula_web_build'), thrown('bad_argument', /variant "full"/));
  assert.throws(() => memory.get('morula_crossings'), thrown('internal', /unreachable/));
  assert.throws(() => memory.get('morula_crossings'), thrown('internal', /failed before/));
  memory.free(12345); // asks a failed module for nothing
  assert.equal(calls, 1);
});

test('handles are freed once, with their blocks, by hand and by using', () => {
  const destroyed = [];
  const exports = exportsOf({morula_mesh_destroy: (handle) => void destroyed.push(handle)});
  const memory = new Memory(exports);
  const make = (handle) => new Handle(memory, 'morula_mesh_destroy', handle);
  const one = make(40);
  one.own(new Block(memory, Float64Array, 2));
  assert.equal(one.handle, 40);
  one.free();
  one.free();
  assert.throws(() => one.handle, thrown('bad_argument', /has been freed/));
  make(48)[Symbol.dispose ?? Symbol.for('Symbol.dispose')]();
  assert.deepEqual(destroyed, [40, 48]);
  assert.equal(exports.live.size, 0);
});

test('arguments of the wrong kind, length or option are rejected before the module is called', () => {
  const memory = new Memory(exportsOf({morula_version: () => 0}));
  const {Mesh, Tree, Skin, Body, ContactQuery, build, distance, firstHit, locate, proximity} =
    libraryOf(memory, {progress: null, failure: null}, {module: null, starts: []});
  assert.equal(typeof ContactQuery, 'function');
  for (const [call, text] of [
    [() => new Mesh([1, 2], []), /positions has 2 numbers/],
    [() => new Mesh([0, 0, 0], [0, 0]), /facets has 2 numbers/],
    [() => new Mesh([0, 0, 0], [0, 0, -1]), /facets\[2\]/],
    [() => Mesh.sample('limb', 1.5), /resolution/],
    [() => Mesh.fromBytes('a.obj', 'text'), /bytes/],
    [() => new Tree(7), /build\(\) or Tree\.fromBytes/],
    [() => Tree.fromBytes(new Uint8Array(1), {}), /mesh is no Mesh/],
    [() => new Skin(0, [], [], 1), /influences/],
    [() => new Skin(2, [0, 1, 0], [1, 1, 1], 2), /bones has 3 numbers/],
    [() => new Body({}, {}), /is no Mesh|is no Tree/],
    [() => new Body({}, {}, {precision: 'half'}), /precision is half/],
    [() => build({}), /mesh is no Mesh/],
    [() => build({}, {budgetMs: 1, timeLimitSeconds: 1}), /one limit at a time/],
    [() => distance({}, {}), /a is no Body/],
    [() => firstHit({}, [0, 0], [0, 0, 1]), /origin has 2 numbers/],
    [() => locate({}, [0, 0, 0]), /body is no Body/],
  ]) assert.throws(call, (error) => error instanceof MorulaError && text.test(error.message), String(text));
  assert.equal(typeof proximity, 'function');
});

test('rows are equal if all their numbers are: beside a search of all pairs', () => {
  const next = random(5);
  const count = 300;
  const positions = Float64Array.from({length: 3 * count}, () => Math.floor(3 * next()) - 1);
  positions[3 * 17] = NaN;
  positions[0] = -0;
  const labels = Float64Array.from({length: count}, () => Math.floor(2 * next()));
  const {numbers, first} = distinctRows(count, [{array: positions, width: 3}, {array: labels, width: 1}]);
  const same = (i, j) => labels[i] === labels[j] && [0, 1, 2].every((k) => positions[3 * i + k] === positions[3 * j + k]);
  for (let i = 0; i < count; ++i) {
    for (let j = 0; j < i; ++j) assert.equal(numbers[i] === numbers[j], same(i, j), `${i}, ${j}`);
    assert.ok(first[numbers[i]] <= i);
  }
  const corners = Uint32Array.from({length: 30}, () => Math.floor(count * next()));
  for (const weld of [true, false]) {
    const mesh = welded(positions, corners, [], weld);
    corners.forEach((corner, i) => {
      for (let k = 0; k < 3; ++k) assert.ok(mesh.positions[3 * mesh.facets[i] + k] === positions[3 * corner + k] || corner === 17);
    });
    assert.throws(() => welded(positions, Uint32Array.of(0, 1, count), [], weld), thrown('bad_argument', /corner 2 of facet 0 is vertex 300/));
  }
});

test('weights of any sum are completed to 1 by one bone more', () => {
  const exact = completedSkin(2, [0, 1, 1, 0], [0.25, 0.75, 1, 0], 2);
  assert.deepEqual([exact.influences, exact.boneCount, exact.isCompleted], [2, 2, false]);
  const short = completedSkin(2, [0, 1, 9, 9], [0.25, 0.5, 0, 0], 2);
  assert.deepEqual([short.influences, short.boneCount, short.missing], [3, 3, 1]);
  assert.deepEqual([...short.bones], [0, 1, 2, 0, 0, 2]);
  assert.deepEqual([...short.weights], [0.25, 0.5, 0.25, 0, 0, 1]);
  assert.throws(() => completedSkin(1, [2], [1], 2), thrown('bad_argument', /bone 2 of 2/));
  assert.throws(() => completedSkin(1, [0], [NaN], 2), thrown('bad_argument', /weight NaN/));
});

test('the facets of a leaf are at least those with a point in it', () => {
  const next = random(11);
  const positions = Float64Array.from({length: 120}, () => 2 * next() - 1);
  const facets = Uint32Array.from({length: 90}, () => Math.floor(40 * next()));
  const nodes = [[0, 0, 0, 2], ...Array.from({length: 8}, (_, k) => [(k & 1) - 0.5, ((k >> 1) & 1) - 0.5, (k >> 2) - 0.5, 0.9])];
  const tree = {nodeCount: 9, spheres: nodes.flat(), firstChild: [1, ...Array(8).fill(0)], childCount: [8, ...Array(8).fill(0)]};
  const {begin, facets: lists} = facetsOfLeaves(tree, {positions, facets});
  let inside = 0;
  for (let f = 0; f < 30; ++f)
    for (let s = 0; s < 200; ++s) {
      const [a, b] = [next(), next()].sort((x, y) => x - y);
      const weights = [a, b - a, 1 - b];
      const point = [0, 1, 2].map((i) => weights.reduce((sum, w, k) => sum + w * positions[3 * facets[3 * f + k] + i], 0));
      for (let node = 1; node < 9; ++node) {
        if (Math.hypot(...point.map((x, i) => x - nodes[node][i])) > nodes[node][3]) continue;
        assert.ok(lists.subarray(begin[node], begin[node + 1]).includes(f), `facet ${f}, leaf ${node}`);
        ++inside;
      }
    }
  assert.ok(inside > 1000 && lists.length < 8 * 30 && begin[1] === 0);
});

/** A worker as a page has it, which does what a test says when it gets a job. */
function fakeWorker(answer) {
  const worker = {ended: 0, terminate: () => ++worker.ended, postMessage: (job) => answer(worker, job)};
  return worker;
}

test('a worker ends once, by its answer, an error, a message that cannot be read, or an abort', async () => {
  for (const [answer, expected] of [
    [(worker) => worker.onmessage({data: {bytes: 1}}), null],
    [(worker) => worker.onerror({message: 'full'}), thrown('internal', /full/)],
    [(worker) => worker.onmessageerror(), thrown('internal', /cannot be read/)],
    [() => { throw new TypeError('no clone'); }, TypeError],
  ]) {
    const worker = fakeWorker((...given) => {
      answer(...given);
      worker.onmessage({data: {bytes: 2}}); // too late
    });
    const result = run(worker, {}, [], null, () => true);
    if (expected) await assert.rejects(result, expected);
    else assert.deepEqual(await result, {bytes: 1});
    assert.equal(worker.ended, 1);
  }
  const stop = new AbortController();
  const worker = fakeWorker(() => {});
  const result = run(worker, {}, [], stop.signal, () => true);
  stop.abort(new RangeError('enough'));
  await assert.rejects(result, RangeError);
  assert.equal(worker.ended, 1);
});

test('a worker that cannot read its job fails aloud', async () => {
  globalThis.postMessage = () => {};
  try {
    await import('../src/worker.js');
    assert.throws(() => globalThis.onmessageerror(), /cannot be read/);
  } finally {
    for (const name of ['postMessage', 'onmessage', 'onmessageerror']) delete globalThis[name];
  }
});

test('buildAsync tries each kind of worker, and says so if none starts', async () => {
  const mesh = {positions: new Float64Array(9), facets: new Uint32Array(3)};
  const Tree = {fromBytes: (bytes) => ({bytes})};
  const parts = {requireBuilder() {}, Tree};
  const broken = () => { throw new Error('no such file'); };
  const silent = () => fakeWorker((worker) => worker.onerror({message: 'blocked'}));
  const good = () => fakeWorker((worker, job) => {
    worker.onmessage({data: {isReady: true}});
    worker.onmessage({data: {share: 0.5}});
    worker.onmessage({data: {bytes: job.facets.length}});
  });
  const shares = [];
  const tree = await buildAsyncOf({}, [broken, silent, good], parts)(mesh, {progress: (share) => void shares.push(share)});
  assert.deepEqual([tree, shares], [{bytes: 3}, [0.5]]);
  await assert.rejects(buildAsyncOf({}, [broken, silent], parts)(mesh), thrown('no_worker', /no such file; blocked/));
  await assert.rejects(buildAsyncOf({}, [good], parts)(mesh, {progress: () => false}), thrown('stopped', /stopped/));
});

test('load says what is wrong with its options', async () => {
  await assert.rejects(load({variant: 'both'}), thrown('bad_argument', /neither full nor runtime/));
  // A relative text is a path from the working directory of node.
  await assert.rejects(load({source: 'no/such file.wasm'}), (error) => error.code === 'ENOENT' && error.path.endsWith('no/such file.wasm'));
  await assert.rejects(load({source: Uint8Array.of(0, 1, 2)}), WebAssembly.CompileError);
  await assert.rejects(load({source: new Response('', {status: 404})}), thrown('bad_file', /404/));
  const {versions} = process;
  Object.defineProperty(process, 'versions', {value: {...versions, node: undefined}}); // a page without an address
  try {
    await assert.rejects(load({source: 'relative.wasm'}), thrown('bad_argument', /no address/));
  } finally {
    Object.defineProperty(process, 'versions', {value: versions});
  }
});

test('a module writes texts and reads a clock, and has no files', (context) => {
  const memory = new WebAssembly.Memory({initial: 1});
  const calls = systemCalls(() => memory);
  const lines = [];
  context.mock.method(console, 'error', (line) => void lines.push(line));
  new Uint8Array(memory.buffer).set(new TextEncoder().encode('one two\n'), 64);
  new Uint32Array(memory.buffer, 0, 4).set([64, 4, 68, 4]);
  assert.equal(calls.fd_write(2, 0, 2, 32), 0);
  assert.deepEqual([lines, new DataView(memory.buffer).getUint32(32, true)], [['one two'], 8]);
  assert.equal(calls.fd_write(7, 0, 2, 32), 8);
  assert.equal(calls.clock_time_get(0, 0n, 40), 0);
  assert.ok(Math.abs(Number(new DataView(memory.buffer).getBigUint64(40, true)) / 1e6 - Date.now()) < 60000);
  assert.deepEqual([calls.fd_read(), calls.path_open()], [8, 52]);
});

test('glTF files are checked before a library reads them', () => {
  const asset = {version: '2.0'};
  const bytes = (json) => new TextEncoder().encode(JSON.stringify(json));
  assert.deepEqual(partsOfFile(bytes({asset}), 1000), {json: {asset}, binary: null});
  for (const [file, text] of [
    [bytes({asset: {version: '1.0'}}), /asset of version 2\.0/],
    [new TextEncoder().encode('glTF'), /ends after 4 bytes/],
    [new TextEncoder().encode('{'), /cannot be read/],
    [new Uint8Array(2000), /maxBytes/],
  ]) assert.throws(() => partsOfFile(file, 1000), thrown('bad_file', text));
  assert.throws(() => partsOfFile('text', 1000), thrown('bad_argument', /Uint8Array/));

  const data = (json) => checkData(json, dataOfBuffers(json, null, {'a.bin': new Uint8Array(24)}), 1000);
  const good = () => ({
    buffers: [{uri: 'a.bin', byteLength: 24}], bufferViews: [{buffer: 0, byteLength: 24}],
    accessors: [{bufferView: 0, componentType: 5126, type: 'VEC3', count: 2}],
  });
  data(good());
  for (const [change, text] of [
    [(json) => { json.buffers[0].uri = 'b.bin'; }, /needs the file "b.bin"/],
    [(json) => { json.buffers[0].uri = '__proto__'; }, /needs the file/],
    [(json) => { json.buffers[0].byteLength = 25; }, /announces 25 bytes/],
    [(json) => { json.bufferViews[0].byteOffset = 1; }, /beyond its buffer/],
    [(json) => { json.accessors[0].count = 3; }, /beyond its view/],
    [(json) => { json.accessors[0].count = 1e9; }, /maxBytes/],
    [(json) => { json.accessors[0].type = 'VEC9'; }, /no type of glTF/],
    [(json) => { json.accessors[0].bufferView = 1; }, /and there are 1/],
  ]) {
    const json = good();
    change(json);
    assert.throws(() => data(json), thrown('bad_file', text));
  }
  checkReferences({nodes: [{children: [1]}, {mesh: 0}], meshes: [{primitives: []}]});
  for (const [json, text] of [
    [{nodes: [{children: [1]}, {children: [0]}]}, /own ancestor/],
    [{nodes: [{children: [2]}, {children: [2]}, {}]}, /two parents/],
    [{nodes: [{mesh: 0}]}, /mesh of node 0/],
    [{skins: [{joints: []}]}, /no joints/],
    [{nodes: 'all'}, /no list/],
  ]) assert.throws(() => checkReferences(json), thrown('bad_file', text));
});

test('poses: matrices and keys', () => {
  const turn = rowsOf([0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]); // x to y, and a move
  assert.deepEqual([...turn], [0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7]);
  assert.deepEqual([...product(turn, turn)], [-1, 0, 0, -1, 0, -1, 0, 11, 0, 0, 1, 14]);
  const keys = {times: [1, 3], values: Float64Array.of(0, 0, 0, 2, 4, 8), interpolation: 'LINEAR'};
  for (const [seconds, expected] of [[0, [0, 0, 0]], [1.5, [0.5, 1, 2]], [9, [2, 4, 8]]])
    assert.deepEqual(valueAt(keys, 'translation', seconds), expected);
  assert.deepEqual(valueAt({...keys, interpolation: 'STEP'}, 'translation', 2.9), [0, 0, 0]);
  // Half of a quarter turn about z, on the shorter arc though the signs differ.
  const half = valueAt({times: [0, 1], values: Float64Array.of(0, 0, 0, 1, 0, 0, -Math.SQRT1_2, -Math.SQRT1_2), interpolation: 'LINEAR'}, 'rotation', 0.5);
  [0, 0, Math.sin(Math.PI / 8), Math.cos(Math.PI / 8)].forEach((x, i) => assert.ok(Math.abs(half[i] - x) < 1e-12));
});
