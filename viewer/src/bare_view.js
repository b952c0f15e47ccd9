// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Uncovered facets of one link, drawn over the body: its own spheres alone count, whatever other links cover.
import { BufferAttribute, BufferGeometry, DoubleSide, Matrix4, Mesh, MeshBasicMaterial } from 'three';

export class BareView {
  constructor() {
    this.mesh = new Mesh(new BufferGeometry(), new MeshBasicMaterial({ side: DoubleSide, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 }));
    this.mesh.frustumCulled = false;
    this.mesh.matrixAutoUpdate = false;
    this.mesh.visible = false;
    this.shown = null;
  }
  theme(color) {
    this.mesh.material.color.copy(color);
  }
  /** triangles: [[a, b, c], …] in the link's axes. */
  show(triangles) {
    if (triangles === this.shown) return;
    this.shown = triangles;
    this.mesh.geometry.dispose();
    this.mesh.geometry = new BufferGeometry();
    this.mesh.geometry.setAttribute('position', new BufferAttribute(new Float32Array(triangles.flat(2)), 3));
    this.mesh.visible = triangles.length > 0;
  }
  /** rows: of the link's pose in the axes of the picture. */
  pose(rows) {
    this.mesh.matrix = new Matrix4().set(...rows, 0, 0, 0, 1);
    this.mesh.matrixWorldNeedsUpdate = true;
  }
  cut(planes) {
    this.mesh.material.clippingPlanes = planes;
  }
}
