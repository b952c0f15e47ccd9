// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Morula for three.js (0.187 or later): bounds and picking of meshes that deform, and drawings of spheres and contacts. Every
// function throws a MorulaError for bad input, and then nothing has changed.
import type {Box3, ColorRepresentation, Group, Intersection, LineSegments, Mesh as ThreeMesh, Raycaster, Sphere} from 'three';
import type {Body, BuildOptions, Contact, Mesh, Morula, Tree} from './index.js';

declare module 'three' {
  interface Raycaster {
    firstHitOnly?: boolean;
  }
}

export interface MorulaBoundsOptions {
  /** The tree: bytes of Tree.toBytes(), made from bounds of an equal geometry, or the same bytes as base64 text. By default
   * geometry.userData.morula_tree, where GLTFLoader puts the tree that morula/gltf has stored; without it the tree is built,
   * which blocks this thread and needs the variant `full`. */
  tree?: ArrayBuffer | Uint8Array | string;
  /** For a tree that is built; by default an octree of a depth at which an update costs about as much as one ray. For
   * many rays a frame take a larger depth, for tight spheres {quality: 'fast'}. */
  build?: BuildOptions;
  /** Whether vertices that are equal in position, morph targets, bones and weights become one, so the seams of texture
   * coordinates do not open the surface; true by default. With false positions may move apart at seams. */
  weld?: boolean;
  /** The coordinates of body, spheres, sphere and box: those of the object, or those of the world, which needs an update for every
   * movement of the object. `local` by default. For collisions of objects that scale take `world`. */
  space?: 'local' | 'world';
  /** Bounds of the same geometry: both share mesh and tree. */
  like?: MorulaBounds | null;
}

/** Spheres that cover a Mesh or a SkinnedMesh in every pose, and rays on it.
 *
 * A SkinnedMesh without morph targets follows its bones: update() reads no vertex, and rays compute the vertices of the facets
 * that they may hit. For all others, such as morph targets and positions that the program writes, update() computes every
 * vertex. The skin has the four influences of three.js, with weights of any sum. Positions may be interleaved, quantized,
 * normalized and of half precision, with an index or without. InstancedMesh and BatchedMesh are rejected; shaders that move
 * vertices are not followed. */
export class MorulaBounds {
  /** object: a mesh with up to date world matrices. The whole index is read, whatever the draw range. If index or skin change,
   * update() throws. */
  constructor(morula: Morula, object: ThreeMesh, options?: MorulaBoundsOptions);
  readonly object: ThreeMesh;
  readonly space: 'local' | 'world';
  readonly mesh: Mesh;
  readonly tree: Tree;
  /** For contacts and distances, after placeInWorld(). */
  readonly body: Body;
  /** A sphere and a box around the surface as of the last update. */
  readonly sphere: Sphere;
  readonly box: Box3;
  /** Follows bones, morph targets and positions. Call it every frame, after updateMatrixWorld() of the scene. Cost: linear in
   * bones and spheres for a skin without morph targets, else also in vertices. */
  update(): this;
  /** x, y, z, radius of the nodes of a level, in the order of Tree.levelSet(); without a level of all nodes. */
  spheres(level?: number): Float64Array;
  /** Appends the hits of a ray as Mesh.raycast does: hits and all their numbers are equal to its. With
   * raycaster.firstHitOnly, as three-mesh-bvh has it, the nearest alone. May be assigned: object.raycast = bounds.raycast.
   * Throws if a draw range or a group begins inside of a facet, if the geometry was replaced or its index, its skin or its number of
   * vertices has changed since the last update(), and after free(). */
  raycast: (raycaster: Raycaster, intersects: Intersection[]) => void;
  /** Sets raycast, boundingSphere and boundingBox of the object, so Raycaster, frustum culling and Box3.setFromObject() use these
   * bounds. Detaches other bounds of the object. Under a world matrix that flattens the object, such as a scale of 0, they cover
   * what is left of it. */
  attach(): this;
  /** Sets them back. */
  detach(): this;
  /** Puts the body where the object is in the world, for queries of two bodies. If space is `local`, throws unless the world
   * matrix rotates and moves alone. */
  placeInWorld(): this;
  /** Detaches, and frees body, tree and mesh, the last two with their last user. A second free() does nothing. */
  free(): void;
  [Symbol.dispose](): void;
}

/** The spheres of a level, as three circles each, in one draw call of WebGLRenderer. Add it to the object if space is `local`, to the
 * scene if it is `world`. */
export class SphereLines extends LineSegments {
  /** segments: of each circle. */
  constructor(bounds: MorulaBounds, level: number, options?: {segments?: number; color?: ColorRepresentation});
  readonly level: number;
  setLevel(level: number): this;
  /** Reads the spheres; call it after bounds.update(). */
  update(): this;
  dispose(): void;
}

/** Contacts as points, and their normals as lines, in world coordinates. */
export class ContactLines extends Group {
  /** length: of the normals, mesh units. size: of the points, pixels. */
  constructor(options?: {length?: number; color?: ColorRepresentation; size?: number});
  update(contacts: readonly Contact[]): this;
  dispose(): void;
}
