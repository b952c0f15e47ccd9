// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Compiled, not run: the types of morula/three and morula/gltf as pages and tools use them.
import {AnimationMixer, Raycaster, Scene, SkinnedMesh, type Intersection} from 'three';
import {WebIO} from '@gltf-transform/core';
import {load, type Morula} from 'morula';
import {readGltf, type GltfPart} from 'morula/gltf';
import {ContactLines, MorulaBounds, SphereLines} from 'morula/three';

export async function page(scene: Scene, hero: SkinnedMesh, other: SkinnedMesh, mixer: AnimationMixer): Promise<Intersection | undefined> {
  const morula: Morula = await load({variant: 'runtime'});
  const bounds = new MorulaBounds(morula, hero, {build: {quality: 'draft'}, weld: true}).attach();
  using second = new MorulaBounds(morula, other, {like: bounds, space: 'world'});
  const lines = new SphereLines(bounds, 2, {color: 'red'});
  hero.add(lines);
  const contacts = new ContactLines({length: 0.2});
  scene.add(contacts);
  const query = new morula.ContactQuery();
  mixer.update(0.016);
  scene.updateMatrixWorld();
  bounds.update();
  second.update();
  lines.update();
  contacts.update(query.run(bounds.placeInWorld().body, second.placeInWorld().body));
  const raycaster = new Raycaster();
  raycaster.far = bounds.sphere.radius + bounds.box.max.x;
  // @ts-expect-error no such space
  new MorulaBounds(morula, hero, {space: 'view'});
  // @ts-expect-error a scene is no mesh
  new MorulaBounds(morula, scene);
  return raycaster.intersectObject(hero)[0];
}

export async function tool(bytes: Uint8Array): Promise<Uint8Array> {
  const morula = await load();
  const file = await readGltf(bytes, {io: new WebIO(), maxBytes: 2 ** 28});
  for (const part of file.parts) part.storeTree(part.storedTree(morula, part.mesh(morula)) ?? morula.build(part.mesh(morula)));
  const part: GltfPart = file.parts[0]!;
  const body = new morula.Body(part.mesh(morula), morula.build(part.mesh(morula)), {rules: 'skinned', skin: part.skin(morula)});
  for (const {duration} of file.animations) body.updateSkinned(part.transforms(file.pose(0, duration)));
  // @ts-expect-error a pose is made by the file
  part.transforms(0);
  return file.toBytes();
}
