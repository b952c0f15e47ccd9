// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
import {Box3, Matrix4, Sphere, Vector3} from 'three';
import {MorulaError} from '../errors.js';
import {Model} from './model.js';
import {boundsInObject, boundsUnderShear} from './object_bounds.js';
import {BonePose, VertexPose} from './poses.js';
import {RayWalk} from './rays.js';

const identity = new Matrix4();
const inverse = new Matrix4();
const point = new Vector3();
const patched = ['raycast', 'computeBoundingSphere', 'computeBoundingBox', 'boundingSphere', 'boundingBox'];

/** The bounds that each object has. */
const attached = new WeakMap();

function requireObject(object) {
  if (!object?.isMesh || object.isInstancedMesh || object.isBatchedMesh)
    throw new MorulaError('bounds are made of a Mesh or a SkinnedMesh, not of an InstancedMesh or a BatchedMesh');
  if (object.isSkinnedMesh && !object.skeleton) throw new MorulaError('the SkinnedMesh has no skeleton: bind one first');
}

export class MorulaBounds {
  #model;
  #pose;
  #walk;
  #spheres;
  #slack = 0;
  #saved = null;
  #toSpace = new Matrix4();
  #geometry = null; // as of the last update

  constructor(morula, object, {build, tree, weld = true, space = 'local', like = null} = {}) {
    requireObject(object);
    if (space !== 'local' && space !== 'world') throw new MorulaError(`space is ${space}, neither local nor world`);
    if (like && (like.object.geometry !== object.geometry || Boolean(like.object.isSkinnedMesh) !== Boolean(object.isSkinnedMesh)))
      throw new MorulaError('like has bounds of another geometry');
    this.object = object;
    this.space = space;
    this.sphere = new Sphere();
    this.box = new Box3();
    this.#model = (like ? like.#live() : new Model(morula, object, {tree, build, weld})).use();
    try {
      this.#pose = new (object.isSkinnedMesh && this.#model.arrays.targets.length === 0 ? BonePose : VertexPose)(object, this.#model);
      this.#walk = new RayWalk(this.#model, this.#pose);
      const isSkinned = this.#pose.rules === 'skinned';
      this.body = new morula.Body(this.#model.mesh, this.#model.tree,
        {rules: this.#pose.rules, skin: isSkinned ? this.#model.skin : null, precision: isSkinned ? 'float' : 'double'});
      this.#spheres = new Float64Array(4 * this.tree.nodeCount);
      this.update();
    } catch (error) {
      this.free();
      throw error;
    }
  }

  get mesh() {
    return this.#live().mesh;
  }
  get tree() {
    return this.#live().tree;
  }

  update() {
    this.#live();
    this.#toSpace.copy(this.space === 'world' ? this.object.matrixWorld : identity);
    this.#pose.update(this.body, this.#toSpace);
    this.#spheres.set(this.body.spheres());
    this.#geometry = this.object.geometry;
    this.#measure();
    if (this.#saved) this.#patchBounds();
    return this;
  }

  spheres(level) {
    const nodes = level === undefined ? Array.from({length: this.tree.nodeCount}, (_, i) => i) : this.tree.levelSet(level);
    const result = new Float64Array(4 * nodes.length);
    nodes.forEach((node, i) => result.set(this.#spheres.subarray(4 * node, 4 * node + 4), 4 * i));
    return result;
  }

  /** An arrow function, so that object.raycast = bounds.raycast works. */
  raycast = (raycaster, intersects) => {
    this.#requireUpdated();
    if (this.object.material === undefined) return;
    const {origin, direction} = raycaster.ray;
    point.copy(origin);
    if (this.space === 'local') {
      inverse.copy(this.object.matrixWorld).invert();
      point.applyMatrix4(inverse);
    }
    const e = inverse.elements;
    const {x, y, z} = direction;
    const turned = this.space === 'world' ? [x, y, z] : [0, 1, 2].map((k) => e[k] * x + e[4 + k] * y + e[8 + k] * z);
    this.#walk.run(this.object, raycaster, [...point.toArray(), ...turned], this.#spheres, this.#slack, intersects);
  };

  attach() {
    this.#live();
    if (this.#saved) return this;
    const {object} = this;
    attached.get(object)?.detach();
    attached.set(object, this);
    this.#saved = patched.map((name) => [name, Object.getOwnPropertyDescriptor(object, name)]);
    object.raycast = this.raycast;
    object.computeBoundingSphere = object.computeBoundingBox = () => this.#patchBounds();
    this.#patchBounds();
    return this;
  }
  detach() {
    for (const [name, descriptor] of this.#saved ?? []) {
      if (descriptor) Object.defineProperty(this.object, name, descriptor);
      else delete this.object[name];
    }
    if (this.#saved) attached.delete(this.object);
    this.#saved = null;
    return this;
  }

  placeInWorld() {
    const rows = [1, 0, 0, 0, 1, 0, 0, 0, 1];
    const shift = [0, 0, 0];
    if (this.space === 'local') {
      const e = this.object.matrixWorld.elements;
      for (let i = 0; i < 3; ++i) for (let k = 0; k < 3; ++k) rows[3 * i + k] = e[4 * k + i];
      for (let i = 0; i < 3; ++i) shift[i] = e[12 + i];
      requireRigid(rows);
    }
    this.body.setTransform(rows, shift);
    return this;
  }

  free() {
    this.detach();
    this.body?.free();
    this.#model?.release();
    this.#model = null;
  }

  #live() {
    if (!this.#model) throw new MorulaError('MorulaBounds: it has been freed');
    return this.#model;
  }

  /** Throws if the facets of the object are no longer those of the last update. */
  #requireUpdated() {
    const {arrays, versions} = this.#live();
    const {geometry} = this.object;
    if (geometry !== this.#geometry || !versions.facets(this.object) ||
      geometry.attributes.position?.count !== arrays.vertexOf.length)
      throw new MorulaError('the geometry of the object has changed since the last update(): rays would hit facets that are gone');
  }

  /** A sphere and a box around the leaves, with what rounding may add. */
  #measure() {
    const s = this.#spheres;
    const {leafNodes} = this.#model;
    const {min, max} = this.box;
    let [x0, y0, z0, x1, y1, z1] = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
    for (let i = 0; i < leafNodes.length; ++i) {
      const at = 4 * leafNodes[i];
      const x = s[at], y = s[at + 1], z = s[at + 2], r = s[at + 3];
      x0 = Math.min(x0, x - r), y0 = Math.min(y0, y - r), z0 = Math.min(z0, z - r);
      x1 = Math.max(x1, x + r), y1 = Math.max(y1, y + r), z1 = Math.max(z1, z + r);
    }
    const [x, y, z, r] = s; // of the root
    min.set(Math.max(x0, x - r), Math.max(y0, y - r), Math.max(z0, z - r));
    max.set(Math.min(x1, x + r), Math.min(y1, y + r), Math.min(z1, z + r));
    const center = this.box.getCenter(point);
    let radius = 0;
    for (let i = 0; i < leafNodes.length; ++i) {
      const at = 4 * leafNodes[i];
      const dx = s[at] - center.x, dy = s[at + 1] - center.y, dz = s[at + 2] - center.z;
      radius = Math.max(radius, Math.sqrt(dx * dx + dy * dy + dz * dz) + s[at + 3]);
    }
    radius = Math.min(radius, max.distanceTo(center));
    if (radius < r) this.sphere.set(center, radius);
    else this.sphere.set(point.set(x, y, z), r);
    // Float positions and weights, and shaders, are right to a few 1e-7 of the coordinates.
    this.#slack = this.#pose.weightSlack + 2e-6 * (Math.max(Math.abs(x), Math.abs(y), Math.abs(z)) + r);
    this.sphere.radius += this.#slack;
    this.box.expandByScalar(this.#slack);
  }

  /** three.js multiplies bounds of an object by its matrix, so they are in its coordinates. */
  #patchBounds() {
    const {object} = this;
    const {sphere, box} = (this.space === 'world' ? boundsInObject : boundsUnderShear)(this.sphere, this.box, object.matrixWorld);
    object.boundingSphere = sphere;
    object.boundingBox = box;
  }
}
Object.defineProperty(MorulaBounds.prototype, Symbol.dispose ?? Symbol.for('Symbol.dispose'), {
  value() {
    this.free();
  },
});

function requireRigid(rows) {
  const [a, b, c] = [0, 3, 6].map((at) => new Vector3().fromArray(rows, at));
  const orthogonal = [[a, a], [b, b], [c, c], [a, b], [b, c], [c, a]].every(([u, v]) => Math.abs(u.dot(v) - (u === v ? 1 : 0)) <= 1e-6);
  if (!orthogonal || a.cross(b).dot(c) < 0)
    throw new MorulaError("the object's world matrix scales or mirrors: make its bounds with {space: 'world'}");
}
