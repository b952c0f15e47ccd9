// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Morula for glTF files, read by @gltf-transform/core (4.5 or later): meshes, skins and motions, and trees in files. Every
// function throws, or rejects with, a MorulaError; for a bad file its code is bad_file.
import type {Document, PlatformIO} from '@gltf-transform/core';
import type {Mesh, Morula, Skin, Tree} from './index.js';

export interface GltfOptions {
  /** Reads and writes documents; by default a WebIO. Register extensions here, such as quantization and compression: a file
   * that requires an extension that is not registered is rejected. */
  io?: PlatformIO;
  /** Files that the file names, by their names in it. Images may be missing until toBytes(). */
  resources?: Record<string, Uint8Array>;
  /** Largest size of the file in bytes, of all numbers in it, and of those of all parts; 2^30 by default. */
  maxBytes?: number;
}

/** Reads the bytes of a .glb or .gltf. Sizes and references are checked before memory is allocated for them. */
export function readGltf(bytes: Uint8Array, options?: GltfOptions): Promise<GltfFile>;

export interface GltfFile {
  readonly document: Document;
  /** The triangles of each primitive of each node of the default scene. */
  readonly parts: GltfPart[];
  /** Durations in seconds. */
  readonly animations: {readonly name: string; readonly duration: number}[];
  /** The pose of an animation at a time, or without one that of the file. */
  pose(animation?: number | null, seconds?: number): GltfPose;
  /** The file as a .glb, with the trees that were stored. */
  toBytes(): Promise<Uint8Array>;
}

/** Where the nodes of a file are; for the methods of its parts. */
export interface GltfPose {
  /** 12 numbers, the rows of [A | t], from the coordinates of a node to those of the scene. */
  matrix(node: import('@gltf-transform/core').Node): Float64Array;
}

/** One primitive of one node. Vertices that are equal in position, morph targets, joints and weights are welded, as by
 * MorulaBounds. */
export interface GltfPart {
  /** Of the node. */
  readonly name: string;
  /** 3 per vertex, as in the file: before bones and nodes move them. */
  readonly positions: Float64Array;
  readonly facets: Uint32Array;
  /** The vertex that each vertex of the file became. */
  readonly vertexOf: Uint32Array;
  /** Displacements of each morph target, 3 per vertex. */
  readonly targets: Float64Array[];
  /** `influences` bones and weights per vertex; the weights of a vertex add up to 1. Without a skin the node is the one bone. */
  readonly influences: number;
  readonly bones: Uint32Array;
  readonly weights: Float64Array;
  readonly boneCount: number;
  readonly boneNames: string[];
  mesh(morula: Morula): Mesh;
  skin(morula: Morula): Skin;
  /** 12 numbers per bone, for Body.updateSkinned(): from positions to the coordinates of the scene. */
  transforms(pose: GltfPose): Float64Array;
  /** A weight per morph target. A body of bones does not follow them: pass positionsAt() to Body.update(). */
  morphWeights(pose: GltfPose): Float64Array;
  /** Vertices in the scene, moved by morph targets and bones. */
  positionsAt(pose: GltfPose): Float64Array;
  /** Writes a tree into the extras of the primitive, as `morula_tree`: the bytes of a .morula in base64. It has to be one of mesh(). */
  storeTree(tree: Tree): void;
  /** Reads it; null if there is none. */
  storedTree(morula: Morula, mesh: Mesh): Tree | null;
}
