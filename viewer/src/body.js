// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The mesh: shaded, red where no sphere reaches, and its inside where the section plane opens it.
import {
  AlwaysDepth, BackSide, BufferAttribute, BufferGeometry, DataTexture, DecrementWrapStencilOp, DoubleSide, DynamicDrawUsage, FloatType,
  FrontSide, Group, IncrementWrapStencilOp, Mesh, MeshBasicMaterial, MeshStandardMaterial, NotEqualStencilFunc, PlaneGeometry, RedFormat,
  ReplaceStencilOp, RGBAFormat, Vector3,
} from 'three';
import { distanceOutsideShader, sphereGrid, textureWidth } from './uncovered.js';

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

/** A row of numbers as a texture that shaders fetch from, large enough for `texels`. */
function numbersTexture(texels, channels) {
  const rows = Math.max(1, Math.ceil(texels / textureWidth));
  return new DataTexture(new Float32Array(textureWidth * rows * channels), textureWidth, rows, channels === 1 ? RedFormat : RGBAFormat, FloatType);
}

export class BodyView {
  constructor() {
    this.group = new Group();
    this.uncoveredUniforms = {
      uncoveredOn: { value: 0 }, uncoveredFrom: { value: 0 }, uncoveredColor: { value: null },
      gridFirst: { value: numbersTexture(1, 1) }, gridItems: { value: numbersTexture(1, 4) },
      gridLow: { value: new Vector3() }, gridEdge: { value: 1 }, gridSize: { value: [1, 1, 1] },
    };
    this.material = new MeshStandardMaterial({ roughness: 0.6, metalness: 0, side: FrontSide });
    this.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uncoveredUniforms);
      shader.vertexShader = shader.vertexShader
        .replace('#include <common>', '#include <common>\nvarying vec3 vPlace;')
        .replace('#include <begin_vertex>', '#include <begin_vertex>\nvPlace = position;');
      shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', `#include <common>\nuniform float uncoveredOn, uncoveredFrom;\nuniform vec3 uncoveredColor;\nvarying vec3 vPlace;\n${distanceOutsideShader}`)
        .replace(
          '#include <color_fragment>',
          `#include <color_fragment>
          float uncoveredShare = 0.0;
          if (uncoveredOn > 0.5) {
            float outside = distanceOutside(vPlace) - uncoveredFrom;
            float pixel = min(fwidth(outside), length(fwidth(vPlace))) + 1e-20;
            uncoveredShare = smoothstep(0.0, pixel, outside);  // from the spheres on, not half a pixel inside them
          }
          diffuseColor.rgb = mix(diffuseColor.rgb, uncoveredColor, uncoveredShare);`,
        )
        .replace('#include <emissivemap_fragment>', '#include <emissivemap_fragment>\ntotalEmissiveRadiance += 0.22 * uncoveredShare * uncoveredColor;');
    };
    // Well behind the front, which is itself set back: at an outline both have nearly the same depth, and the dark inside would dot it.
    this.inside = new MeshBasicMaterial({ side: BackSide, polygonOffset: true, polygonOffsetFactor: 8, polygonOffsetUnits: 8 });
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

    // The part of the plane inside the body: back faces count up, front faces down, and pixels that are not zero are
    // filled. The count has seven bits: the spheres' skin has the eighth.
    const counting = (side, op) =>
      new MeshBasicMaterial({
        side, colorWrite: false, depthWrite: false, depthFunc: AlwaysDepth,
        stencilWrite: true, stencilWriteMask: 0x7f, stencilFail: op, stencilZFail: op, stencilZPass: op,
      });
    this.counts = [counting(BackSide, IncrementWrapStencilOp), counting(FrontSide, DecrementWrapStencilOp)];
    for (const material of this.counts) {
      const mesh = new Mesh(undefined, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = 0.1;
      this.parts.push(mesh);
      this.group.add(mesh);
    }
    this.cap = new Mesh(
      new PlaneGeometry(1, 1),
      new MeshBasicMaterial({
        side: DoubleSide, transparent: true, depthWrite: false,
        stencilWrite: true, stencilRef: 0, stencilFuncMask: 0x7f, stencilFunc: NotEqualStencilFunc,
        stencilFail: ReplaceStencilOp, stencilZFail: ReplaceStencilOp, stencilZPass: ReplaceStencilOp,
      }),
    );
    this.cap.renderOrder = 6;
    this.group.add(this.cap);
    this.cut([]);
  }

  theme(body, uncovered, cut) {
    this.material.color.copy(body);
    this.uncoveredUniforms.uncoveredColor.value = uncovered;
    this.inside.color.copy(cut);
    this.cap.material.color.copy(cut);
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
    geometry.setIndex(new BufferAttribute(scene.motion.facets, 1));
    this.geometry = geometry;
    for (const part of this.parts) part.geometry = geometry;
    this.material.flatShading = scene.motion.facets.length / 3 < 400;
    this.material.needsUpdate = true;
    this.uncoveredUniforms.uncoveredFrom.value = scene.tolerance;
  }

  pose(frame) {
    const positions = this.scene.positions(frame);
    const { position, normal } = this.geometry.attributes;
    position.array.set(positions);
    position.needsUpdate = true;
    normalsInto(normal.array, positions, this.scene.motion.facets);
    normal.needsUpdate = true;
  }

  /** Red surface where the spheres of the level set leave it uncovered; on: whether to show it. */
  compare(frame, level, on) {
    this.uncoveredUniforms.uncoveredOn.value = on ? 1 : 0;
    if (!on) return;
    const grid = sphereGrid(this.scene.positions(frame), this.scene.frames[frame], this.scene.levelSets[level]);
    const fill = (uniform, values, channels) => {
      const room = uniform.value.image.data.length;
      if (values.length > room || values.length < room / 8) {
        uniform.value.dispose();
        uniform.value = numbersTexture((1.25 * values.length) / channels, channels);
      }
      uniform.value.image.data.set(values);
      uniform.value.needsUpdate = true;
    };
    fill(this.uncoveredUniforms.gridFirst, grid.first, 1);
    fill(this.uncoveredUniforms.gridItems, grid.items, 4);
    this.uncoveredUniforms.gridLow.value.set(...grid.low);
    this.uncoveredUniforms.gridEdge.value = grid.edge;
    this.uncoveredUniforms.gridSize.value = grid.size;
  }

  facets(on) {
    this.parts[2].visible = on;
  }
  /** box: {low, high} of the body in all frames. */
  cut(planes, box) {
    for (const material of [this.material, this.inside, this.lines, ...this.counts]) material.clippingPlanes = planes;
    const on = planes.length > 0;
    this.cap.visible = this.parts[3].visible = this.parts[4].visible = on;
    if (!on) return;
    const middle = new Vector3(...box.low.map((low, k) => 0.5 * (low + box.high[k])));
    planes[0].projectPoint(middle, this.cap.position);
    this.cap.lookAt(this.cap.position.clone().add(planes[0].normal));
    this.cap.scale.setScalar(3 * Math.hypot(...box.low.map((low, k) => box.high[k] - low)));
  }
}
