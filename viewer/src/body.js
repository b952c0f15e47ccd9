// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The mesh: shaded, red where no sphere reaches, and its inside where the section plane opens it.
import { BackSide, BufferAttribute, BufferGeometry, DynamicDrawUsage, FrontSide, Group, Mesh, MeshBasicMaterial, MeshStandardMaterial } from 'three';
import { distanceOutside } from './bare.js';

/** Smooth normals, weighted by area. */
function normalsInto(normals, positions, facets) {
  normals.fill(0);
  for (let i = 0; i < facets.length; i += 3) {
    const a = 3 * facets[i];
    const b = 3 * facets[i + 1];
    const c = 3 * facets[i + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const at of [a, b, c]) {
      normals[at] += x;
      normals[at + 1] += y;
      normals[at + 2] += z;
    }
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    normals[i] /= length;
    normals[i + 1] /= length;
    normals[i + 2] /= length;
  }
}

export class BodyView {
  constructor() {
    this.group = new Group();
    this.bareness = { bareOn: { value: 0 }, bareFrom: { value: 0 }, bareColour: { value: null } };
    this.material = new MeshStandardMaterial({ roughness: 0.6, metalness: 0, side: FrontSide });
    this.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.bareness);
      shader.vertexShader = shader.vertexShader
        .replace('#include <common>', '#include <common>\nattribute float outside;\nvarying float vOutside;')
        .replace('#include <begin_vertex>', '#include <begin_vertex>\nvOutside = outside;');
      shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', '#include <common>\nuniform float bareOn, bareFrom;\nuniform vec3 bareColour;\nvarying float vOutside;')
        .replace(
          '#include <color_fragment>',
          `#include <color_fragment>
          float bareEdge = 0.7 * fwidth(vOutside) + 1e-20;
          float bareShare = bareOn * smoothstep(-bareEdge, bareEdge, vOutside - bareFrom);
          diffuseColor.rgb = mix(diffuseColor.rgb, bareColour, bareShare);`,
        )
        .replace('#include <emissivemap_fragment>', '#include <emissivemap_fragment>\ntotalEmissiveRadiance += 0.22 * bareShare * bareColour;');
    };
    this.inside = new MeshBasicMaterial({ side: BackSide });
    this.lines = new MeshBasicMaterial({ wireframe: true, transparent: true, opacity: 0.16, color: 0x000000, depthWrite: false });
    this.material.polygonOffset = true;
    this.material.polygonOffsetFactor = 1;
    this.material.polygonOffsetUnits = 1;
    this.parts = [this.material, this.inside, this.lines].map((material) => {
      const mesh = new Mesh(undefined, material);
      mesh.frustumCulled = false;
      this.group.add(mesh);
      return mesh;
    });
    this.parts[2].visible = false;
  }

  theme(body, bare, cut) {
    this.material.color.copy(body);
    this.bareness.bareColour.value = bare;
    this.inside.color.copy(cut);
    this.lines.color.copy(cut).multiplyScalar(0.2);
  }

  show(scene) {
    this.scene = scene;
    this.geometry?.dispose();
    const vertices = scene.motion.frames[0].length / 3;
    const geometry = new BufferGeometry();
    const attribute = (name, size) => {
      const made = new BufferAttribute(new Float32Array(size * vertices), size).setUsage(DynamicDrawUsage);
      geometry.setAttribute(name, made);
    };
    attribute('position', 3);
    attribute('normal', 3);
    attribute('outside', 1);
    geometry.setIndex(new BufferAttribute(scene.motion.facets, 1));
    this.geometry = geometry;
    for (const part of this.parts) part.geometry = geometry;
    this.material.flatShading = scene.motion.facets.length / 3 < 400;
    this.material.needsUpdate = true;
    this.bareness.bareFrom.value = scene.tolerance;
  }

  pose(frame) {
    const positions = this.scene.positions(frame);
    const { position, normal } = this.geometry.attributes;
    position.array.set(positions);
    position.needsUpdate = true;
    normalsInto(normal.array, positions, this.scene.motion.facets);
    normal.needsUpdate = true;
  }

  /** Red where the spheres of the level set leave the surface bare; on: whether to show it. */
  compare(frame, level, on) {
    this.bareness.bareOn.value = on ? 1 : 0;
    if (!on) return;
    const { outside } = this.geometry.attributes;
    distanceOutside(this.scene.positions(frame), this.scene.frames[frame], this.scene.levelSets[level], outside.array);
    outside.needsUpdate = true;
  }

  facets(on) {
    this.parts[2].visible = on;
  }
  cut(planes) {
    for (const material of [this.material, this.inside, this.lines]) material.clippingPlanes = planes;
  }
}
