// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
/// <reference lib="esnext.disposable" />
// Morula for browsers, workers and node: sphere trees that cover triangle meshes while they deform.
//
// Lengths are in mesh units, indices start at 0, coordinates are x, y, z. Every function throws a MorulaError for bad
// input, and then nothing has changed. After a rejected update the queries of a body throw, until an update is not rejected.
//
// Views. Properties such as Body.positions are arrays over the module's own memory: nothing is copied. When the memory
// grows, which any call that allocates may cause, the engine detaches old views: their length becomes 0. So read the
// property again instead of keeping its value; that costs nothing. A view is valid until its object is freed, so keep the
// object, too: the garbage collector does not see that a view needs it.

/** An array of numbers: a typed array or a plain one. */
export type Numbers = ArrayLike<number>;

export class MorulaError extends Error {
  readonly code: 'bad_argument' | 'bad_file' | 'rejected' | 'stopped' | 'out_of_memory' | 'internal' | 'no_worker';
}

export interface LoadOptions {
  /** `runtime` is smaller: Mesh.fromBytes, Mesh.sample, build, buildAsync, Tree.toBytes and rules other than `exact` and `skinned`
   * then throw. */
  variant?: 'full' | 'runtime';
  /** Whether to load the module with vector instructions; by default, if the engine has them. Results are the same. */
  simd?: boolean;
  /** Where the module is: an address (relative to the page, or in node to the working directory), a response, bytes or a
   * compiled module; by default the package's file. */
  source?: URL | string | Response | BufferSource | WebAssembly.Module;
}

/** Compiles and starts a module. Each call makes a module of its own, with its own memory. */
export function load(options?: LoadOptions): Promise<Morula>;

/** An object in the module's memory. free(), the end of its `using` block or the garbage collector frees it. An object keeps
 * the data of the objects from which it was made: a mesh may be freed before its tree. */
export interface Handle {
  /** Frees the object. Later calls of its methods throw; a second free() does nothing. */
  free(): void;
  [Symbol.dispose](): void;
}

/** A triangle mesh, closed or open. */
export interface Mesh extends Handle {
  readonly vertexCount: number;
  readonly facetCount: number;
  /** View: 3 per vertex. Do not write. */
  readonly positions: Float64Array;
  /** View: 3 vertex indices per facet, counter-clockwise seen from outside. Do not write. */
  readonly facets: Uint32Array;
}
export interface MeshConstructor {
  /** positions: 3 per vertex. facets: 3 vertex indices per facet. Both are copied. Cost: linear. */
  new (positions: Numbers, facets: Numbers): Mesh;
  /** Reads the bytes of an OBJ, OFF, PLY, STL, VTK (.vtk, .vtp, .vtu) or Gmsh (.msh) file; the extension of the name is
   * the format. */
  fromBytes(name: string, bytes: ArrayBufferLike | ArrayBufferView): Mesh;
  /** Generates a sample: bar, capsule, limb, torus, blob, plate, two, tool, hand or vessel. resolution: edges around it,
   * 3 to 4096. */
  sample(name: string, resolution: number): Mesh;
}

/** A sphere tree, and the part of the surface that each sphere owns. Nodes are numbered level by level from the root, which
 * is node 0; children of a node are adjacent. */
export interface Tree extends Handle {
  readonly nodeCount: number;
  readonly levelCount: number;
  readonly leafCount: number;
  /** View: x, y, z, radius per node, at rest. Do not write. */
  readonly spheres: Float64Array;
  /** Views: one node per node; Morula.noNode where there is none. Do not write. */
  readonly parent: Uint32Array;
  readonly firstChild: Uint32Array;
  readonly childCount: Uint32Array;
  /** The nodes whose spheres cover the surface at a level: nodes of the level, and leaves above it. */
  levelSet(level: number): Uint32Array;
  /** The bytes of a .morula file. */
  toBytes(): Uint8Array;
}
export interface TreeStatic {
  /** Reads the bytes of a .morula file that was built for exactly this mesh, by any build of Morula. */
  fromBytes(bytes: ArrayBufferLike | ArrayBufferView, mesh: Mesh): Tree;
}

export interface BuildOptions {
  method?: 'octree' | 'grid' | 'hubbard' | 'spawn' | 'medial' | 'combined' | 'optimized';
  /** Quality of the method optimized. */
  quality?: 'draft' | 'fast' | 'default' | 'best';
  /** Largest number of children of a node, 2 to 64. */
  branching?: number;
  /** Levels below the root, 0 to 8; by default chosen by the number of facets. */
  depth?: number;
  /** Largest size of a flat set of spheres instead of a tree. */
  spheres?: number;
  /** Largest protrusion of a leaf, mesh units. */
  maxProtrusion?: number;
  /** Time limit, by at most one of the two: nodes that are not divided then stay leaves, and cover. */
  timeLimitSeconds?: number;
  budgetMs?: number;
  /** 0 to 2^64 - 1; a number to 2^53 - 1. */
  seed?: number | bigint;
  /** Whether every sphere contains its children's. */
  nested?: boolean;
  /** Called at intervals with the completed share, 0 to 1. If it returns false, the build stops and throws a MorulaError with
   * the code stopped. If it throws, the build stops and throws that exception. It must not call the module. */
  progress?: ((share: number) => boolean | void) | null;
}

export interface AsyncBuildOptions extends BuildOptions {
  /** Ends the worker at once; the promise is then rejected with the signal's reason. */
  signal?: AbortSignal | null;
}

/** Vertices that follow bones. */
export interface Skin extends Handle {
  readonly boneCount: number;
}
export interface SkinConstructor {
  /** bones, weights: `influences` of each vertex, one vertex after another, as in a vertex buffer. Influences of weight 0
   * are left out; the weights of a vertex are divided by their sum. Both are copied. */
  new (influences: number, bones: Numbers, weights: Numbers, boneCount: number): Skin;
}

export interface BodyOptions {
  /** One rule per level from the root; the last serves deeper levels: exact (default), wrapped, approach1, approach2,
   * traditional, weighted; and skinned, with a skin. */
  rules?: string | string[];
  /** Whether radii grow until every level covers, with any rule. */
  conservative?: boolean;
  /** The skin that updateSkinned() follows; copied. */
  skin?: Skin | null;
  /** The type of Body.positions; float by default. */
  precision?: 'float' | 'double';
}

/** Spheres that follow a mesh. */
export interface Body extends Handle {
  readonly nodeCount: number;
  /** View: 3 per vertex, in mesh order; the mesh's at first. Write the new positions here and call update(). Queries read
   * them, so do not write between update() and the queries of a frame. */
  readonly positions: Float32Array | Float64Array;
  /** View: 12 numbers per bone, the rows of [A | t], x -> A x + t, relative to rest: the world matrix of the bone times its
   * inverse bind matrix. null without a skin. */
  readonly transforms: Float64Array | null;
  /** Moves every sphere to the positions: those of Body.positions, or the given ones, which are copied there. Cost: linear
   * in vertices. */
  update(positions?: Numbers): void;
  /** Moves every sphere to the transforms of the bones: those of Body.transforms, or the given ones. With the rule skinned no
   * vertex is read. */
  updateSkinned(transforms?: Numbers): void;
  /** Sets the rigid transform after the deformation: x -> R x + t. rotation: 9, by rows. translation: 3. */
  setTransform(rotation: Numbers, translation: Numbers): void;
  /** View: x, y, z, radius of each node, without the transform; valid until the next call. */
  spheres(): Float64Array;
  /** Whether the spheres of every level are proven to contain the surface at these positions. Copies them. */
  certify(positions?: Numbers): boolean;
  /** Pairs of facets of the body that intersect, 2 indices each, without pairs that share a vertex. */
  selfCrossings(): Uint32Array;
}
export interface BodyConstructor {
  new (mesh: Mesh, tree: Tree, options?: BodyOptions): Body;
}

export type Vector = [number, number, number];

export interface Contact {
  nodeA: number;
  nodeB: number;
  /** false: the budget ended before the pair was opened. */
  finished: boolean;
  /** Center of the overlap, or of the gap. */
  point: Vector;
  /** Unit vector from b to a. */
  normal: Vector;
  /** Depth of the spheres; negative for a gap. */
  depth: number;
  /** No common point of both regions is farther from the point. */
  errorBound: number;
}

export interface ContactOptions {
  /** Largest gap that counts as a contact. */
  margin?: number;
  /** Level of both trees; by default the leaves. */
  level?: number;
  /** Budget in tests, or in milliseconds; at most one of the two. A query that a budget ends misses no contact. */
  pairTests?: number;
  budgetMs?: number;
}

/** A budget, at most one of the two. */
export interface ContactBudget {
  pairTests?: number;
  budgetMs?: number;
}

/** Contacts of two bodies, with memory that is kept from run to run. */
export interface ContactQuery extends Handle {
  /** If the rules cover, every crossing of the surfaces lies within one of the contacts. */
  run(a: Body, b: Body, options?: ContactOptions): Contact[];
  /** Continues a run that its budget ended, with a new budget or to the end, and returns all contacts so far. Throws if the
   * bodies have moved since. */
  resume(budget?: ContactBudget): Contact[];
  readonly count: number;
  /** Whether the last run is complete. */
  readonly finished: boolean;
  contacts(): Contact[];
}

export interface Distance {
  /** lower <= distance <= upper; both 0 if facets intersect. */
  lower: number;
  upper: number;
  pointA: Vector;
  pointB: Vector;
  facetA: number;
  facetB: number;
  crossing: boolean;
  /** Whether the spheres of both bodies cover, so lower is proven. */
  certified: boolean;
  /** false: the budget ended the search; lower and upper then hold, too. */
  complete: boolean;
}

export interface DistanceOptions extends ContactBudget {
  /** Largest upper - lower of a complete result. */
  tolerance?: number;
  /** Stops when lower exceeds this. */
  stopAbove?: number;
  /** Stops when upper does not exceed this. */
  stopBelow?: number;
}

/** Two features: vertices and facets of the meshes, and edges, which are numbered. Numbers stay the same while the bodies
 * exist. */
export interface FeaturePair {
  kind: 'vertex-facet' | 'facet-vertex' | 'edge-edge' | 'facet-facet';
  a: number;
  b: number;
  verticesA: number[];
  verticesB: number[];
}
export interface NearPair extends FeaturePair {
  /** Of the nearest points. */
  distance: number;
  /** Nearest points, and the weights of the vertices in them. */
  pointA: Vector;
  pointB: Vector;
  weightsA: number[];
  weightsB: number[];
}

/** A budget, at most one of the two. */
export interface PairBudget {
  boxTests?: number;
  budgetMs?: number;
}
export interface PairOptions extends PairBudget {
  /** For one body with itself, which never has pairs that share a vertex: skips pairs with two vertices at most this many
   * edges apart. */
  rings?: number;
  /** For one body with itself: skips pairs that are at most this far apart at rest. */
  restDistance?: number;
  /** For one body with itself: skips pairs of one component. */
  sameComponent?: boolean;
}
export interface NearOptions extends PairOptions {
  /** Largest distance of a pair, 0 or more. */
  distance: number;
  /** Whether a pair of nearest features that several facets and edges find is kept once. */
  nearestFeaturesOnce?: boolean;
}

/** Pairs of features of two bodies, or of one with itself (b null), with memory that is kept from run to run. The first
 * search of a body sorts its facets. Pairs are ordered by kind, a, b; a search that its budget ends has some of them. */
export interface PairQuery extends Handle {
  /** Vertex-facet and edge-edge pairs within a distance; complete for any rules. */
  near(a: Body, b: Body | null, options: NearOptions): NearPair[];
  /** Pairs of facets that intersect, decided exactly. */
  crossing(a: Body, b: Body | null, options?: PairOptions): FeaturePair[];
  /** Continues a search that its budget ended, with a new budget or to the end, and returns all pairs so far. Throws if the
   * bodies have moved since, or have been freed. */
  resume(budget?: PairBudget): FeaturePair[] | NearPair[];
  readonly count: number;
  /** Whether the last search is complete. */
  readonly finished: boolean;
  pairs(): FeaturePair[] | NearPair[];
}

/** Milliseconds after which a query over many things returns the results of those that are done. It can exceed them by the
 * time of 512 of them. */
export interface TimeBudget {
  budgetMs?: number;
}

export interface RayHit {
  /** Distance from the origin in lengths of the direction. */
  t: number;
  point: Vector;
  barycentric: Vector;
  /** Outward unit normal of the facet; 0 for a facet without area. */
  normal: Vector;
  facet: number;
}

export interface Location {
  inside: boolean;
  onSurface: boolean;
  /** Winding number of the surface around the point; 0 outside, on the surface, or without orientation. */
  winding: number;
}

/** The classes and functions of one module. Objects of different modules do not mix. */
export interface Morula {
  readonly version: string;
  /** Stands for a missing node. */
  readonly noNode: number;
  /** The memory of the module; its byteLength is the memory in use. It grows, and never shrinks. */
  memory(): ArrayBuffer;
  readonly Mesh: MeshConstructor;
  readonly Tree: TreeStatic;
  readonly Skin: SkinConstructor;
  readonly Body: BodyConstructor;
  readonly ContactQuery: new () => ContactQuery;
  readonly PairQuery: new () => PairQuery;
  /** Builds a tree in which every level covers the surface, with the bits of a native build. It blocks this thread until the
   * end: see buildAsync(). */
  build(mesh: Mesh, options?: BuildOptions): Tree;
  /** The same build in a worker of its own, which leaves this thread free; the tree has the same bits. Copies the mesh, which
   * must not be freed before the promise settles. Starts the package's worker by its address, or else from text in a blob,
   * for pages that cannot fetch it. Rejects with the code no_worker where neither starts. */
  buildAsync(mesh: Mesh, options?: AsyncBuildOptions): Promise<Tree>;
  /** Whether leaf spheres overlap; if the rules cover, false proves that the surfaces have no common point. */
  overlap(a: Body, b: Body): boolean;
  /** Pairs of facets that intersect, decided exactly: 2 indices each, of a and of b, ascending. */
  crossings(a: Body, b: Body): Uint32Array;
  distance(a: Body, b: Body, options?: DistanceOptions): Distance;
  /** PairQuery.near() by a query that is freed at once. */
  proximity(a: Body, b: Body | null, options: NearOptions): NearPair[];
  /** The first facet that a ray hits, in world coordinates; null: none. tEnd: the ray ends at origin + tEnd direction. */
  firstHit(body: Body, origin: Numbers, direction: Numbers, tEnd?: number): RayHit | null;
  /** The same for many rays: origin and direction, 6 numbers each. With a budget: the hits of the first rays, of some at least. */
  firstHits(body: Body, rays: Numbers, tEnd?: number, budget?: TimeBudget): (RayHit | null)[];
  /** Whether points, 3 numbers each, are inside the closed surface of a body, exactly. With a budget: of the first points, of some
   * at least. */
  locate(body: Body, points: Numbers, budget?: TimeBudget): Location[];
}
