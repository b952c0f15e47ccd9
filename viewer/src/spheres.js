// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The spheres of a level set: one polyhedron drawn many times, in which the shader finds the sphere. Translucent, they
// show the skin of their union only.
import { DoubleSide, DynamicDrawUsage, FrontSide, Group, IcosahedronGeometry, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, NotEqualStencilFunc, PlaneGeometry, ReplaceStencilOp, ShaderMaterial, Vector3 } from 'three';
import { mergeVertices } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

/** A polyhedron around the sphere of radius 1: where it is seen, the shader looks for the sphere itself. */
function hull() {
  const detail = 2; // edges along a side of the icosahedron's facets, less one
  const geometry = new IcosahedronGeometry(1, detail);
  geometry.deleteAttribute('normal');
  geometry.deleteAttribute('uv');
  const angle = (1.107 / (detail + 1)) * 0.58; // from the middle of a facet to its corners
  geometry.scale(1 / Math.cos(angle), 1 / Math.cos(angle), 1 / Math.cos(angle));
  return mergeVertices(geometry, 1e-6);
}

const vertexShader = `
#include <clipping_planes_pars_vertex>
attribute vec4 ball;
attribute vec3 tint;
varying vec3 vCenter, vOffset, vTint;
varying vec2 vDepth;
varying float vRadius;
void main() {
  vCenter = (modelViewMatrix * vec4(ball.xyz, 1.0)).xyz;
  vOffset = (modelViewMatrix * vec4(ball.w * position, 0.0)).xyz;
  vRadius = ball.w;
  vTint = tint;
  vDepth = vec2(projectionMatrix[2][2], projectionMatrix[3][2]);
  vec4 mvPosition = vec4(vCenter + vOffset, 1.0);
  gl_Position = projectionMatrix * mvPosition;
  #include <clipping_planes_vertex>
}`;

// The ray of a pixel meets the sphere itself, and the depth is that of the sphere: polyhedra would pass through the body
// where spheres nearly touch it, another way at every distance. Offsets are about the center, so nothing cancels.
const fragmentShader = `
#include <clipping_planes_pars_fragment>
uniform float opacity, glass;
uniform int part;  // 0: all of the sphere; 1: all but its fringe, the pixels that it covers in part; 2: the fringe
uniform vec3 rim;
varying vec3 vCenter, vOffset, vTint;
varying vec2 vDepth;
varying float vRadius;
void main() {
  #include <clipping_planes_fragment>
  vec3 ray = normalize(vCenter + vOffset);
  vec3 across = vOffset - dot(vOffset, ray) * ray;
  float inside = vRadius * vRadius - dot(across, across);
  float border = fwidth(inside);
  // The fringe of a sphere is see-through: it hides nothing, or the seams of spheres would have specks of the background.
  if (inside <= (part == 1 ? border : 0.0) || (part == 2 && inside > border)) discard;
  vec3 point = across - sqrt(inside) * ray;
  vec3 n = point / vRadius;
  float z = vCenter.z + point.z;
  gl_FragDepth = clamp(0.5 - 0.5 * (vDepth.x * z + vDepth.y) / z, 0.0, 1.0);
  float facing = abs(dot(n, ray));
  float edge = pow(1.0 - facing, 2.6);
  float light = 0.80 + 0.26 * dot(n, normalize(vec3(-0.45, 0.7, 0.6)));
  float gloss = pow(max(0.0, dot(reflect(-normalize(vec3(-0.45, 0.7, 0.6)), n), -ray)), 28.0);
  vec3 color = vTint * light + 0.14 * gloss;
  color = mix(color, rim * (0.35 + 0.65 * vTint), 0.55 * edge * (1.0 - glass));
  float alpha = mix(opacity, min(1.0, opacity + 0.55), edge);
  if (glass > 0.5) alpha = clamp(0.10 + 1.25 * edge, 0.0, 1.0);
  gl_FragColor = vec4(color, alpha * (border > 0.0 ? min(1.0, inside / border) : 1.0));
}`;

// Discs in which the section plane cuts the spheres: dark ones, then slightly smaller ones in color over all of them, so
// that of the circles only the outline of the union stays.
const discVertex = `
attribute vec4 ball;
attribute vec3 tint;
uniform vec3 planeNormal;
uniform float planeConstant;
varying vec2 vAt;
varying vec3 vTint;
void main() {
  float height = dot(planeNormal, ball.xyz) + planeConstant;
  float radius = sqrt(max(0.0, ball.w * ball.w - height * height));
  vec3 u = normalize(abs(planeNormal.x) > 0.5 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0));
  vec3 v = cross(planeNormal, u);
  vec2 at = 2.2 * position.xy;
  vec3 where = ball.xyz - height * planeNormal + radius * (at.x * u + at.y * v);
  vAt = at;
  vTint = tint;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(where, 1.0);
}`;
const discFragment = `
uniform vec3 paper;
uniform float inner;
varying vec2 vAt;
varying vec3 vTint;
void main() {
  float d = length(vAt);
  float width = fwidth(d);
  if (d > 1.0 - inner * 1.7 * width) discard;
  gl_FragColor = vec4(inner > 0.5 ? mix(paper, vTint, 0.42) : mix(vTint, vec3(0.0), 0.25), 1.0);
}`;

export class SpheresView {
  constructor(plane) {
    this.plane = plane;
    this.group = new Group();
    const material = (options, glass = 0, part = 0) =>
      new ShaderMaterial({
        vertexShader,
        fragmentShader,
        clipping: true,
        side: FrontSide,
        uniforms: { opacity: { value: 0.4 }, glass: { value: glass }, part: { value: part }, rim: { value: null } },
        ...options,
      });
    // Depth first, then color where it is nearest: the skin of the union, not a fog of everything behind it. Along a seam
    // two spheres have the same depth, and at an edge a fringe lies on what is behind: the stencil's eighth bit lets one
    // of them color the pixel, or seams and edges are dotted.
    this.depth = material({ colorWrite: false, depthWrite: true }, 0, 1);
    const once = {
      transparent: true, depthWrite: false,
      stencilWrite: true, stencilRef: 0x80, stencilFuncMask: 0x80, stencilWriteMask: 0x80, stencilFunc: NotEqualStencilFunc,
    };
    this.skin = material({ ...once, stencilZPass: ReplaceStencilOp }, 0, 1);
    this.fringe = material(once, 0, 2);
    this.glass = material({ transparent: true, depthWrite: false, depthTest: false }, 1);
    this.disc = [0, 1].map(
      (inner) =>
        new ShaderMaterial({
          vertexShader: discVertex,
          fragmentShader: discFragment,
          side: DoubleSide,
          depthWrite: false,
          uniforms: { planeNormal: { value: plane.normal }, planeConstant: { value: 0 }, paper: { value: null }, inner: { value: inner } },
        }),
    );
    const part = (of, order) => {
      const mesh = new Mesh(undefined, of);
      mesh.frustumCulled = false;
      mesh.renderOrder = order;
      this.group.add(mesh);
      return mesh;
    };
    this.meshes = [part(this.depth, 1), part(this.skin, 2), part(this.fringe, 2.5)];
    // Among the transparent ones, which are drawn last and in this order.
    this.discs = this.disc.map((of, inner) => part(Object.assign(of, { transparent: true }), 3 + inner));
    this.picked = part(this.glass, 8);
    for (const hidden of [...this.discs, this.picked]) hidden.visible = false;
    this.on = true;
    this.nodes = new Int32Array(0);
    this.room = 0;
  }

  theme(accent, rim, paper) {
    this.accent = accent;
    for (const material of [this.skin, this.fringe, this.glass, this.depth]) material.uniforms.rim.value = rim;
    for (const disc of this.disc) disc.uniforms.paper.value = paper;
    this.mark();
  }

  show(scene) {
    this.scene = scene;
    this.pickedNode = -1;
  }

  /** Room for so many spheres. */
  reserve(count) {
    if (count <= this.room) return;
    this.room = Math.max(count, 64);
    const instanced = (base) => {
      const made = new InstancedBufferGeometry();
      made.setIndex(base.index);
      made.setAttribute('position', base.attributes.position);
      return made;
    };
    this.geometry?.dispose();
    this.discGeometry?.dispose();
    this.geometry = instanced(hull());
    this.discGeometry = instanced(new PlaneGeometry(1, 1));
    this.ball = new InstancedBufferAttribute(new Float32Array(4 * this.room), 4).setUsage(DynamicDrawUsage);
    this.tint = new InstancedBufferAttribute(new Float32Array(3 * this.room), 3).setUsage(DynamicDrawUsage);
    for (const geometry of [this.geometry, this.discGeometry]) {
      geometry.setAttribute('ball', this.ball);
      geometry.setAttribute('tint', this.tint);
    }
    for (const mesh of this.meshes) mesh.geometry = this.geometry;
    for (const mesh of this.discs) mesh.geometry = this.discGeometry;
  }

  /** The spheres of a level set in a frame; color(node): [r, g, b]. */
  pose(frame, level, color) {
    Object.assign(this, { frame, color, nodes: this.scene.levelSets[level] });
    this.reserve(this.nodes.length);
    this.fill();
    this.mark();
  }

  /** Copies the current spheres into the attributes. */
  fill() {
    const { frame, color } = this;
    const spheres = this.scene.frames[frame];
    this.nodes.forEach((node, i) => {
      this.ball.array.set(spheres.subarray(4 * node, 4 * node + 4), 4 * i);
      this.tint.array.set(color(node), 3 * i);
    });
    this.ball.needsUpdate = this.tint.needsUpdate = true;
    this.geometry.instanceCount = this.discGeometry.instanceCount = this.nodes.length;
  }

  /** Outlines one node's sphere; -1: none. */
  mark(node = this.pickedNode) {
    this.pickedNode = node;
    this.picked.visible = node >= 0;
    if (!(node >= 0) || this.frame === undefined) return;
    const geometry = new InstancedBufferGeometry();
    const base = hull();
    geometry.setIndex(base.index);
    geometry.setAttribute('position', base.attributes.position);
    const sphere = this.scene.frames[this.frame].slice(4 * node, 4 * node + 4);
    geometry.setAttribute('ball', new InstancedBufferAttribute(sphere, 4));
    geometry.setAttribute('tint', new InstancedBufferAttribute(new Float32Array(this.accent.toArray()), 3));
    geometry.instanceCount = 1;
    this.picked.geometry?.dispose();
    this.picked.geometry = geometry;
  }

  look(on, opacity) {
    this.on = on;
    const solid = opacity >= 0.995;
    for (const material of [this.skin, this.fringe]) material.uniforms.opacity.value = opacity;
    this.skin.transparent = !solid;
    for (const mesh of this.meshes) mesh.visible = on;
    for (const mesh of this.discs) mesh.visible = on && this.cutting;
  }

  cut(planes) {
    this.cutting = planes.length > 0;
    for (const material of [this.depth, this.skin, this.fringe, this.glass]) material.clippingPlanes = planes;
    for (const disc of this.disc) disc.uniforms.planeConstant.value = this.plane.constant;
    for (const mesh of this.discs) mesh.visible = this.on && this.cutting;
  }

  /** The node whose sphere the ray meets first, in front of the section plane; -1 for none. */
  hit(ray, planes) {
    if (!this.on) return -1;
    const { origin: o, direction: d } = ray;
    const spheres = this.scene.frames[this.frame];
    let nearest = Infinity;
    let found = -1;
    const point = new Vector3();
    for (const node of this.nodes) {
      const x = spheres[4 * node] - o.x;
      const y = spheres[4 * node + 1] - o.y;
      const z = spheres[4 * node + 2] - o.z;
      const along = x * d.x + y * d.y + z * d.z;
      const apart = x * x + y * y + z * z - along * along;
      const inside = spheres[4 * node + 3] ** 2 - apart;
      if (inside < 0) continue;
      for (const t of [along - Math.sqrt(inside), along + Math.sqrt(inside)]) {
        if (t <= 0 || t >= nearest) continue;
        point.copy(o).addScaledVector(d, t);
        if (planes.some((plane) => plane.distanceToPoint(point) < 0)) continue;
        [nearest, found] = [t, node];
        break;
      }
    }
    return found;
  }
}
