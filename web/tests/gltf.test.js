// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula/gltf beside the loader of three.js: vertices of every frame are where it puts them. Files that are damaged at every
// place are rejected by a MorulaError.
import assert from 'node:assert/strict';
import test from 'node:test';
import {arm, character, random, three} from './characters.js';
import {packageModule} from './package.js';
import {peer, peerFile} from './peers.js';

const {load, MorulaError} = await packageModule();
const {readGltf} = await packageModule('src/gltf.js');
const {MorulaBounds} = await packageModule('src/three.js');
const {Document, Extension, Primitive, WebIO} = await peer('@gltf-transform/core');
const {GLTFLoader} = await import(peerFile('three/examples/jsm/loaders/GLTFLoader.js'));
const morula = await load();
const {AnimationMixer, Vector3} = three;

/** A file with two nodes: an arm with bones, two morph targets and an animation of all three interpolations, and a strip that a
 * node turns and scales. */
function sampleDocument({hasMorphs = true} = {}) {
  const document = new Document();
  const buffer = document.createBuffer();
  const accessor = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const geometry = arm({round: 8, long: 12});
  const mesh = character(geometry);
  const {position, skinIndex, skinWeight, normal} = geometry.attributes;
  const primitive = document.createPrimitive()
    .setIndices(accessor('SCALAR', Uint16Array.from(geometry.index.array)))
    .setAttribute('POSITION', accessor('VEC3', position.array))
    .setAttribute('NORMAL', accessor('VEC3', normal.array))
    .setAttribute('JOINTS_0', accessor('VEC4', Uint8Array.from(skinIndex.array)))
    .setAttribute('WEIGHTS_0', accessor('VEC4', skinWeight.array));
  for (const j of [1, 2])
    primitive.addTarget(document.createPrimitiveTarget().setAttribute('POSITION', accessor('VEC3',
      Float32Array.from(position.array, (_, i) => 0.2 * Math.sin(j * position.array[3 * Math.floor(i / 3) + 1] + (i % 3))))));
  const skinned = document.createMesh('arm').addPrimitive(primitive).setWeights(hasMorphs ? [0.25, 0] : [0, 0]);
  const joints = mesh.skeleton.bones.map((bone, b) => document.createNode(`bone${b}`).setTranslation(bone.position.toArray()));
  joints.forEach((joint, b) => b > 0 && joints[b - 1].addChild(joint));
  const inverses = mesh.skeleton.boneInverses.flatMap((matrix) => matrix.elements);
  const skin = document.createSkin().setInverseBindMatrices(accessor('MAT4', Float32Array.from(inverses)));
  joints.forEach((joint) => skin.addJoint(joint));
  const holder = document.createNode('holder').setTranslation([0.5, -1, 2]).setRotation([0.5, 0.5, 0.5, 0.5]).addChild(joints[0]);
  const body = document.createNode('body').setMesh(skinned).setSkin(skin).setTranslation([9, 9, 9]);

  const strip = document.createPrimitive().setMode(Primitive.Mode.TRIANGLE_STRIP)
    .setAttribute('POSITION', accessor('VEC3', Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0.1, 1, 1, 0, 0, 2, 0, 1, 2, 0.2)));
  const flag = document.createNode('flag').setMesh(document.createMesh().addPrimitive(strip)).setScale([1, -2, 0.5]);
  const pole = document.createNode('pole').setTranslation([1, 2, 3]).addChild(flag);
  const scene = document.createScene().addChild(holder).addChild(body).addChild(pole);
  document.getRoot().setDefaultScene(scene);

  const animation = document.createAnimation('move');
  const add = (node, path, interpolation, times, type, values) => {
    const sampler = document.createAnimationSampler().setInterpolation(interpolation)
      .setInput(accessor('SCALAR', Float32Array.from(times))).setOutput(accessor(type, Float32Array.from(values)));
    animation.addSampler(sampler).addChannel(document.createAnimationChannel().setSampler(sampler).setTargetNode(node).setTargetPath(path));
  };
  const turn = (x, y, z) => new three.Quaternion().setFromEuler(new three.Euler(x, y, z)).toArray();
  add(joints[1], 'rotation', 'LINEAR', [0.25, 1, 2], 'VEC4', [...turn(0, 0, 0), ...turn(1, 0.5, 0), ...turn(-1, 0, 2)]);
  add(joints[2], 'rotation', 'CUBICSPLINE', [0, 2], 'VEC4',
    [0, 0, 0, 0, ...turn(0, 0, 0), 0.1, 0.4, 0, 0, 0.2, 0, 0.5, 0, ...turn(0.5, 1, 0), 0, 0, 0, 0]);
  add(joints[3], 'scale', 'STEP', [0, 1, 1.5], 'VEC3', [1, 1, 1, 1.5, 0.5, 1, 1, 2, 1]);
  add(holder, 'translation', 'CUBICSPLINE', [0.5, 1.75], 'VEC3', [0, 0, 0, 1, 0, 0, 0, 2, 0, 1, 0, 1, 0, 1, 2, 0, 0, 0]);
  if (hasMorphs) add(body, 'weights', 'LINEAR', [0, 2], 'SCALAR', [0, 0, 1, -0.5]);
  add(pole, 'rotation', 'LINEAR', [0, 2], 'VEC4', [...turn(0, 0, 0), ...turn(0, 3, 1)]);
  return document;
}
const bytes = await new WebIO().writeBinary(sampleDocument());
const inThree = (data) => new GLTFLoader().parseAsync(data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength), '');
const rejected = (text) => (error) => {
  assert.ok(error instanceof MorulaError, String(error.stack));
  assert.match(error.message, text);
  return true;
};

test('vertices of every frame are where the loader of three.js puts them', async () => {
  const file = await readGltf(bytes);
  const loaded = await inThree(bytes);
  assert.deepEqual(file.animations, [{name: 'move', duration: 2}]);
  assert.deepEqual(file.parts.map(({name}) => name), ['body', 'flag']);
  const mixer = new AnimationMixer(loaded.scene);
  const action = mixer.clipAction(loaded.animations[0]).setLoop(three.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  const vertex = new Vector3();
  for (const seconds of [0, 0.1, 0.25, 0.6, 1, 1.3, 1.75, 1.99, 2]) {
    mixer.setTime(seconds);
    loaded.scene.updateMatrixWorld(true);
    const at = file.pose(0, seconds);
    for (const part of file.parts) {
      const object = loaded.scene.getObjectByName(part.name);
      const points = part.positionsAt(at);
      for (let i = 0; i < object.geometry.attributes.position.count; ++i) {
        object.getVertexPosition(i, vertex).applyMatrix4(object.matrixWorld);
        assert.ok(vertex.distanceTo(new Vector3().fromArray(points, 3 * part.vertexOf[i])) < 1e-5, `${part.name} ${i} at ${seconds}`);
      }
    }
  }
  const rest = file.pose();
  assert.deepEqual([...file.parts[1].transforms(rest)], [1, 0, 0, 1, 0, -2, 0, 2, 0, 0, 0.5, 3]);
  assert.throws(() => file.pose(1), MorulaError);
  assert.throws(() => file.pose(0, NaN), MorulaError);
});

test('a body of a part follows the animation, and covers', async () => {
  const file = await readGltf(await new WebIO().writeBinary(sampleDocument({hasMorphs: false})));
  const [part] = file.parts;
  const mesh = part.mesh(morula);
  const body = new morula.Body(mesh, morula.build(mesh, {quality: 'fast'}), {rules: 'skinned', skin: part.skin(morula)});
  for (const seconds of [0, 0.7, 1.6]) {
    body.updateSkinned(part.transforms(file.pose(0, seconds)));
    assert.equal(body.certify(part.positionsAt(file.pose(0, seconds))), true);
    assert.equal(body.certify(part.positionsAt(file.pose(0, seconds + 0.3))), false);
  }
  const other = await readGltf(bytes);
  assert.deepEqual([...other.parts[0].morphWeights(other.pose(0, 1))], [0.5, -0.25]);
  assert.deepEqual([...other.parts[0].morphWeights(other.pose())], [0.25, 0]);
  assert.throws(() => part.transforms(other.pose()), rejected(/another file/));
});

test('a vertex without weight is rejected only if a triangle has it', async () => {
  const fileWith = (isUsed) => {
    const document = new Document();
    const buffer = document.createBuffer();
    const accessor = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
    const primitive = document.createPrimitive()
      .setIndices(accessor('SCALAR', Uint16Array.of(1, 2, isUsed ? 0 : 3)))
      .setAttribute('POSITION', accessor('VEC3', Float32Array.of(9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0)))
      .setAttribute('JOINTS_0', accessor('VEC4', Uint8Array.from({length: 16}, (_, i) => (i < 4 ? 1 : i % 2))))
      .setAttribute('WEIGHTS_0', accessor('VEC4', Float32Array.from({length: 16}, (_, i) => (i < 4 ? 0 : 0.25))));
    const joints = ['a', 'b'].map((name) => document.createNode(name));
    const skin = document.createSkin().addJoint(joints[0]).addJoint(joints[1]);
    const scene = document.createScene().addChild(joints[0]).addChild(joints[1])
      .addChild(document.createNode('body').setMesh(document.createMesh().addPrimitive(primitive)).setSkin(skin));
    document.getRoot().setDefaultScene(scene);
    return new WebIO().writeBinary(document);
  };
  const file = await readGltf(await fileWith(false));
  const [part] = file.parts;
  assert.deepEqual([part.boneCount, part.facets.length, part.positions.length], [2, 3, 12]);
  const body = new morula.Body(part.mesh(morula), morula.build(part.mesh(morula), {method: 'octree'}),
    {rules: 'skinned', skin: part.skin(morula)});
  body.updateSkinned(part.transforms(file.pose()));
  assert.ok(body.certify(part.positionsAt(file.pose())));
  await assert.rejects(readGltf(await fileWith(true)), rejected(/vertex 0 of .* has no weight/));
});

test('a tree that a tool stores in the file is read by a page', async () => {
  const file = await readGltf(bytes);
  for (const part of file.parts) {
    const mesh = part.mesh(morula);
    assert.equal(part.storedTree(morula, mesh), null);
    part.storeTree(morula.build(mesh, {quality: 'draft'}));
  }
  const stored = await file.toBytes();
  const again = await readGltf(stored);
  const [part] = again.parts;
  const tree = part.storedTree(morula, part.mesh(morula));
  assert.deepEqual(tree.toBytes(), file.parts[0].storedTree(morula, file.parts[0].mesh(morula)).toBytes());
  const runtime = await load({variant: 'runtime'});
  const loaded = await inThree(stored);
  loaded.scene.updateMatrixWorld(true);
  for (const name of ['body', 'flag']) {
    const bounds = new MorulaBounds(runtime, loaded.scene.getObjectByName(name));
    assert.ok(bounds.tree.nodeCount >= 1);
  }
  part.storeTree(morula.build(morula.Mesh.sample('bar', 3), {method: 'octree'}));
  assert.throws(() => part.storedTree(morula, part.mesh(morula)), rejected(/another mesh/));
});

test('a .gltf with data URIs, and with files beside it', async () => {
  const {json, resources} = await new WebIO().writeJSON(sampleDocument(), {basename: 'arm'});
  const [[uri, data]] = Object.entries(resources);
  const textOf = (one) => new TextEncoder().encode(JSON.stringify(one));
  const whole = await readGltf(bytes);
  const expected = whole.parts[0].positionsAt(whole.pose());
  const check = async (file) => assert.deepEqual(file.parts[0].positionsAt(file.pose()), expected);
  await check(await readGltf(textOf(json), {resources: {[uri]: data}}));
  const inside = {...json, buffers: [{...json.buffers[0], uri: `data:application/octet-stream;base64,${Buffer.from(data).toString('base64')}`}]};
  await check(await readGltf(textOf(inside)));
  await assert.rejects(readGltf(textOf(json)), rejected(/needs the file "arm.bin"/));
  await assert.rejects(readGltf(textOf(json), {resources: {[uri]: data.subarray(0, 100)}}), rejected(/100 are there/));
});

test('views in compressed form, of a buffer without bytes', async () => {
  const name = 'EXT_meshopt_compression';
  /** Reads views that are stored as they are. */
  class Stored extends Extension {
    static EXTENSION_NAME = name;
    extensionName = name;
    prereadTypes = ['Buffer'];
    preread(context) {
      const {json, resources} = context.jsonDoc;
      json.bufferViews.forEach(({extensions}, v) => {
        const {buffer, byteOffset, byteLength} = extensions[name];
        context.bufferViews[v] = resources[json.buffers[buffer].uri].slice(byteOffset, byteOffset + byteLength);
      });
      return this;
    }
    read() {
      return this;
    }
    write() {
      return this;
    }
  }
  const io = new WebIO().registerExtensions([Stored]);
  const {json, resources} = await new WebIO().writeJSON(sampleDocument(), {basename: 'arm'});
  const text = (change = () => {}) => {
    const copy = structuredClone(json);
    copy.extensionsUsed = copy.extensionsRequired = [name];
    const {byteLength} = copy.buffers[0];
    copy.buffers.push({byteLength, extensions: {[name]: {fallback: true}}});
    for (const view of copy.bufferViews) {
      const {byteOffset = 0, byteLength: size} = view;
      Object.assign(view, {buffer: 1, extensions: {[name]: {buffer: 0, byteOffset, byteLength: size, byteStride: 1, count: size}}});
    }
    change(copy);
    return new TextEncoder().encode(JSON.stringify(copy));
  };
  const whole = await readGltf(bytes);
  const file = await readGltf(text(), {io, resources});
  assert.deepEqual(file.parts[0].positionsAt(file.pose()), whole.parts[0].positionsAt(whole.pose()));
  await assert.rejects(readGltf(text(), {resources}), rejected(/extension/));
  const faults = [
    [(j) => (j.buffers[1].byteLength = 2 ** 31), /announces/],
    [(j) => (j.buffers[1].extensions = {}), /no bytes/],
    [(j) => delete j.bufferViews[0].extensions, /no bytes/],
    [(j) => (j.bufferViews[0].extensions[name].buffer = 1), /not in its buffer/],
    [(j) => (j.bufferViews[0].extensions[name].buffer = 9), /there are 2/],
    [(j) => (j.bufferViews[0].extensions[name].byteOffset = 1e7), /not in its buffer/],
    [(j) => (j.bufferViews[0].extensions[name].count = 1e9), /larger than its view/],
  ];
  for (const [change, message] of faults) await assert.rejects(readGltf(text(change), {io, resources}), rejected(message), String(change));
});

test('images may be missing until the file is written', async () => {
  const document = sampleDocument();
  const texture = document.createTexture().setURI('skin.png').setMimeType('image/png').setImage(new Uint8Array([1, 2, 3]));
  for (const mesh of document.getRoot().listMeshes())
    for (const primitive of mesh.listPrimitives()) primitive.setMaterial(document.createMaterial().setBaseColorTexture(texture));
  const {json, resources} = await new WebIO().writeJSON(document, {basename: 'arm'});
  const text = new TextEncoder().encode(JSON.stringify(json));
  const {'skin.png': image, ...buffers} = resources;
  await assert.rejects((await readGltf(text, {resources: buffers})).toBytes(), rejected(/skin\.png/));
  const whole = await readGltf(await (await readGltf(text, {resources})).toBytes());
  assert.deepEqual([...whole.document.getRoot().listTextures()[0].getImage()], [...image]);
});

test('one mesh that many nodes show counts each time', async () => {
  const document = sampleDocument();
  const [mesh] = document.getRoot().listMeshes();
  for (let i = 0; i < 50; ++i) document.getRoot().getDefaultScene().addChild(document.createNode().setMesh(mesh));
  const many = await new WebIO().writeBinary(document);
  assert.equal((await readGltf(many)).parts.length, 52);
  await assert.rejects(readGltf(many, {maxBytes: 500000}), rejected(/parts/));
});

test('files that are none, too large or damaged are rejected', async () => {
  await assert.rejects(readGltf(new Uint8Array(0)), rejected(/cannot be read/));
  await assert.rejects(readGltf(new TextEncoder().encode('solid')), rejected(/cannot be read/));
  await assert.rejects(readGltf('text'), rejected(/Uint8Array/));
  await assert.rejects(readGltf(bytes, {maxBytes: 1000}), rejected(/maxBytes/));
  await assert.rejects(readGltf(bytes.subarray(0, bytes.length - 4)), rejected(/announces/));
  const size = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + size)));
  const binary = Buffer.from(bytes.subarray(28 + size)).toString('base64');
  /** The file with a change of its JSON. */
  const changed = (change) => {
    const copy = structuredClone(json);
    copy.buffers[0].uri = `data:application/octet-stream;base64,${binary}`;
    change(copy);
    return new TextEncoder().encode(JSON.stringify(copy));
  };
  await readGltf(changed(() => {}));
  const faults = [
    [(j) => (j.asset.version = '1.0'), /version/],
    [(j) => (j.accessors[0].count = 2 ** 40), /maxBytes|beyond/],
    [(j) => (j.accessors[0].count = -1), /count/],
    [(j) => (j.accessors[0].byteOffset = 1e6), /beyond/],
    [(j) => delete j.accessors[0].bufferView && (j.accessors[0].count = 1e9), /maxBytes/],
    [(j) => (j.bufferViews[0].byteLength = 1e7), /beyond/],
    [(j) => (j.bufferViews[0].buffer = 3), /there are 1/],
    [(j) => (j.buffers[0].byteLength = 1e7), /are there/],
    [(j) => (j.nodes[0].children = [0]), /own ancestor|two parents/],
    [(j) => (j.nodes[0].children = [99]), /there are/],
    [(j) => (j.nodes.find((n) => n.skin === 0).skin = 5), /there are 1/],
    [(j) => (j.skins[0].joints = [77]), /joint/],
    [(j) => (j.skins[0].joints = [0]), /follows bone/],
    [(j) => (j.meshes[0].primitives[0].attributes.POSITION = 400), /POSITION/],
    [(j) => delete j.meshes[0].primitives[0].attributes.POSITION, /no positions/],
    [(j) => delete j.meshes[0].primitives[0].attributes.JOINTS_0, /no joints/],
    [(j) => (j.animations[0].samplers[0].output = 0), /keys have/],
    [(j) => (j.animations[0].samplers[0].interpolation = 'MAGIC'), /MAGIC/],
    [(j) => (j.animations[0].channels[0].sampler = 9), /sampler/],
    [(j) => (j.extensionsUsed = j.extensionsRequired = ['KHR_draco_mesh_compression']), /extension/],
    [(j) => (j.nodes[0] = {...j.nodes[0], matrix: [1, 0.5, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}), /shear/],
    [(j) => (j.nodes = 7), /no list/],
  ];
  for (const [change, text] of faults) await assert.rejects(readGltf(changed(change)), rejected(text), String(change));
});

test('a file with any byte changed is read, or rejected by a MorulaError', async () => {
  const next = random(11);
  const quiet = console.warn;
  console.warn = () => {};
  let read = 0;
  let bad = 0;
  const size = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  for (let i = 0; i < 600; ++i) {
    const copy = bytes.slice();
    for (let k = 0; k < 1 + (i % 4); ++k) {
      const end = i % 3 ? 20 + size : copy.length;
      copy[Math.floor(next() * end)] = i % 2 ? 256 * next() : 48 + 10 * next(); // any byte, or a digit
    }
    try {
      const file = await readGltf(copy, {maxBytes: 2 ** 24});
      for (const part of file.parts) part.positionsAt(file.pose(file.animations.length > 0 ? 0 : null, 1));
      ++read;
    } catch (error) {
      rejected(/./)(error);
      ++bad;
    }
  }
  console.warn = quiet;
  assert.ok(read > 50 && bad > 100, `${read} read, ${bad} rejected`);
});
