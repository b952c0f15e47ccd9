// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts of a frame: a dot where two bodies touch, and a line along the normal, as long as the contact is deep. They
// lie over everything else, since what they mark is inside both bodies.
import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial } from 'three';

export class ContactsView {
  constructor() {
    this.group = new Group();
    const over = { depthTest: false, depthWrite: false, transparent: true };
    this.dot = new PointsMaterial({ size: 7, sizeAttenuation: false, ...over });
    this.line = new LineBasicMaterial(over);
    this.points = new Points(new BufferGeometry(), this.dot);
    this.lines = new LineSegments(new BufferGeometry(), this.line);
    for (const part of [this.lines, this.points]) {
      part.frustumCulled = false;
      part.renderOrder = 9;
      this.group.add(part);
    }
  }
  theme(color) {
    this.dot.color.copy(color);
    this.line.color.copy(color);
  }
  /** contacts: seven numbers each, or null. reach: the shortest line that can be seen, mesh units. */
  pose(contacts, reach) {
    const count = (contacts?.length ?? 0) / 7;
    const ends = new Float32Array(6 * count);
    const dots = new Float32Array(3 * count);
    for (let i = 0; i < count; ++i) {
      const along = 0.5 * Math.max(contacts[7 * i + 6], reach);
      for (let k = 0; k < 3; ++k) {
        const [at, normal] = [contacts[7 * i + k], contacts[7 * i + 3 + k]];
        dots[3 * i + k] = at;
        ends[6 * i + k] = at - along * normal;
        ends[6 * i + 3 + k] = at + along * normal;
      }
    }
    for (const [part, values] of [[this.points, dots], [this.lines, ends]]) {
      part.geometry.dispose();
      part.geometry = new BufferGeometry();
      part.geometry.setAttribute('position', new BufferAttribute(values, 3));
    }
  }
}
