// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Drawings of spheres and of contacts.
import {
  BufferAttribute, BufferGeometry, DynamicDrawUsage, Group, InstancedBufferAttribute, InstancedBufferGeometry, LineBasicMaterial,
  LineSegments, Points, PointsMaterial, Sphere, Vector3,
} from 'three';

/** The segments of three unit circles about the axes. */
function rings(segments) {
  const points = new Float32Array(18 * segments);
  for (let axis = 0; axis < 3; ++axis)
    for (let i = 0; i < segments; ++i)
      for (let end = 0; end < 2; ++end) {
        const angle = (2 * Math.PI * (i + end)) / segments;
        const at = 3 * (2 * (axis * segments + i) + end);
        points[at + ((axis + 1) % 3)] = Math.cos(angle);
        points[at + ((axis + 2) % 3)] = Math.sin(angle);
      }
  return points;
}

const noRaycast = () => {};

export class SphereLines extends LineSegments {
  #bounds;
  #nodes;

  constructor(bounds, level, {segments = 32, color = 0x1a7f5a} = {}) {
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(rings(segments), 3));
    const material = new LineBasicMaterial({color});
    material.onBeforeCompile = (shader) => {
      shader.vertexShader = `attribute vec4 sphere;\n${shader.vertexShader}`
        .replace('#include <begin_vertex>', 'vec3 transformed = sphere.xyz + sphere.w * position;');
    };
    material.customProgramCacheKey = () => 'morula-spheres';
    super(geometry, material);
    this.#bounds = bounds;
    this.raycast = noRaycast;
    this.boundingSphere = new Sphere();
    this.setLevel(level);
  }
  get level() {
    return this.#nodes.level;
  }
  setLevel(level) {
    const numbers = this.#bounds.spheres(level);
    this.#nodes = {level, count: numbers.length / 4};
    this.geometry.dispose(); // of another number of instances
    const attribute = new InstancedBufferAttribute(new Float32Array(numbers.length), 4);
    attribute.setUsage(DynamicDrawUsage);
    this.geometry.setAttribute('sphere', attribute);
    this.geometry.instanceCount = this.#nodes.count;
    return this.update();
  }
  update() {
    const {sphere} = this.geometry.attributes;
    sphere.array.set(this.#bounds.spheres(this.#nodes.level));
    sphere.needsUpdate = true;
    this.computeBoundingSphere();
    return this;
  }
  computeBoundingSphere() {
    const center = this.#bounds.sphere.center;
    let radius = 0;
    const numbers = this.geometry.attributes.sphere.array;
    for (let i = 0; i < numbers.length; i += 4)
      radius = Math.max(radius, Math.hypot(numbers[i] - center.x, numbers[i + 1] - center.y, numbers[i + 2] - center.z) + numbers[i + 3]);
    this.boundingSphere.set(center, radius);
  }
  dispose() {
    this.geometry.dispose();
    this.material.dispose();
  }
}

/** A buffer that grows by halves. */
function room(geometry, count) {
  const old = geometry.getAttribute('position');
  if (old && old.count >= count) return old;
  geometry.dispose();
  const attribute = new BufferAttribute(new Float32Array(3 * Math.max(16, count, old ? Math.ceil(1.5 * old.count) : 0)), 3);
  attribute.setUsage(DynamicDrawUsage);
  geometry.setAttribute('position', attribute);
  return attribute;
}

export class ContactLines extends Group {
  #length;
  #points;
  #lines;

  constructor({length = 0.1, color = 0xd1491f, size = 6} = {}) {
    super();
    this.#length = length;
    this.#points = new Points(new BufferGeometry(), new PointsMaterial({color, size, sizeAttenuation: false}));
    this.#lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color}));
    for (const part of [this.#points, this.#lines]) {
      part.frustumCulled = false; // their positions change in every frame
      part.raycast = noRaycast;
      this.add(part);
    }
    this.update([]);
  }
  update(contacts) {
    const points = room(this.#points.geometry, contacts.length);
    const lines = room(this.#lines.geometry, 2 * contacts.length);
    const end = new Vector3();
    contacts.forEach(({point, normal}, i) => {
      points.setXYZ(i, ...point);
      lines.setXYZ(2 * i, ...point);
      end.fromArray(normal).multiplyScalar(this.#length).add(new Vector3().fromArray(point));
      lines.setXYZ(2 * i + 1, end.x, end.y, end.z);
    });
    points.needsUpdate = lines.needsUpdate = true;
    this.#points.geometry.setDrawRange(0, contacts.length);
    this.#lines.geometry.setDrawRange(0, 2 * contacts.length);
    return this;
  }
  dispose() {
    for (const part of [this.#points, this.#lines]) {
      part.geometry.dispose();
      part.material.dispose();
    }
  }
}
