// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches of a frame: their regions on both surfaces, filled with a color per patch, and the curves in which the
// surfaces cross. They lie over everything else, since the regions are inside the other body.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial } from 'three';
import { levelColors } from './colors.js';

/** Opacity of a facet that lies wholly in a region. */
const fill = 0.5;

export class PatchesView {
  constructor() {
    this.group = new Group();
    const over = { depthTest: false, depthWrite: false, transparent: true };
    this.regions = new Mesh(new BufferGeometry(), new MeshBasicMaterial({ side: DoubleSide, vertexColors: true, ...over }));
    this.curves = new LineSegments(new BufferGeometry(), new LineBasicMaterial(over));
    [this.regions, this.curves].forEach((part, i) => {
      part.frustumCulled = false;
      part.renderOrder = 7 + i;
      this.group.add(part);
    });
  }
  theme(color) {
    this.curves.material.color.copy(color);
  }
  /** patches: {regions, curves} of a frame, or null. facets: three vertices each. positions: of all vertices. */
  pose(patches, facets, positions) {
    const count = (patches?.regions ?? []).reduce((sum, region) => sum + region.facets.length, 0);
    const corners = new Float32Array(9 * count);
    const colors = new Float32Array(12 * count);
    let corner = 0;
    (patches?.regions ?? []).forEach((region, patch) => {
      const { r, g, b } = new Color(levelColors[(patch + 1) % levelColors.length]);
      region.facets.forEach((facet, i) => {
        for (let k = 0; k < 3; ++k, ++corner) {
          const vertex = 3 * facets[3 * facet + k];
          corners.set(positions.subarray(vertex, vertex + 3), 3 * corner);
          colors.set([r, g, b, fill * region.shares[i]], 4 * corner);
        }
      });
    });
    for (const part of [this.regions, this.curves]) {
      part.geometry.dispose();
      part.geometry = new BufferGeometry();
    }
    this.regions.geometry.setAttribute('position', new BufferAttribute(corners, 3));
    this.regions.geometry.setAttribute('color', new BufferAttribute(colors, 4));
    this.curves.geometry.setAttribute('position', new BufferAttribute(patches?.curves ?? new Float32Array(), 3));
  }
}
