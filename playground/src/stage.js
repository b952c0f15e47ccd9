// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The stage of viewer/ with a second body that touches the first, and on request the same body twice, side by side.
import { Color, Vector2, Raycaster, Vector3, Plane } from 'three';
import { BareView } from '../../viewer/src/bare_view.js';
import { BodyView } from '../../viewer/src/body.js';
import { styleValue } from '../../viewer/src/dom.js';
import { SpheresView } from '../../viewer/src/spheres.js';
import { Stage } from '../../viewer/src/stage.js';

export class PlayStage extends Stage {
  constructor(place) {
    super(place);
    this.renderer.domElement.setAttribute('aria-label', 'A body and its spheres. Drag the body to pull it, tap to poke it; drag the background to turn the view, scroll or pinch to come closer. Arrow keys turn the view, P pokes.');
    this.twin = { body: new BodyView(), spheres: new SpheresView(this.plane) };
    this.other = { body: new BodyView(), spheres: new SpheresView(this.plane) };
    this.crossings = new BareView();
    this.beside = false;
    for (const { body, spheres } of [this.twin, this.other]) {
      body.group.visible = spheres.group.visible = false;
      this.scene.add(body.group, spheres.group);
    }
    // No section plane.
    for (const { spheres } of [this, this.twin, this.other]) spheres.cut([]);
    this.scene.add(this.crossings.mesh);
    /** Takes hold of a body that a ray meets: {move(ray), end(wasMoved)}, or null. */
    this.grasp = () => null;
    this.watchGrasp();
  }

  showTwin(on) {
    if (this.beside === on) return;
    this.beside = on;
    this.resize();
    if (!this.turned) this.fit();
  }
  showOther(on) {
    this.other.body.group.visible = this.other.spheres.group.visible = on;
    this.contacts.group.visible = this.crossings.mesh.visible = on;
  }

  theme() {
    super.theme();
    const asShown = (name) => new Color(styleValue(name)).convertLinearToSRGB();
    for (const { body, spheres } of [this.twin, this.other]) {
      body.theme(new Color(styleValue('--body')), new Color(styleValue('--uncovered')), new Color(styleValue('--cut')));
      spheres.theme(asShown('--accent'), asShown('--rim'), asShown('--panel'));
    }
    this.other.body.material.color.set(styleValue('--other'));
    this.crossings.theme(new Color(styleValue('--crossing')));
  }

  /** Width and height of a half, or of the whole; whether halves lie above each other. */
  halves() {
    const { clientWidth: width, clientHeight: height } = this.place;
    const stacked = width < 1.3 * height;
    if (!this.beside) return { width, height, stacked };
    return stacked ? { width, height: height / 2, stacked } : { width: width / 2, height, stacked };
  }

  resize() {
    super.resize();
    this.place.dataset.stacked = String(this.halves().stacked);
    if (!this.beside || this.place.clientWidth === 0 || this.place.clientHeight === 0) return;
    const { width, height } = this.halves();
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  draw() {
    this.enclose();
    const { width, height, stacked } = this.halves();
    const parts = [this.body.group, this.spheres.group];
    const twins = [this.twin.body.group, this.twin.spheres.group];
    const half = (x, y, shown, hidden) => {
      this.renderer.setViewport(x, y, width, height);
      this.renderer.setScissor(x, y, width, height);
      for (const part of shown) part.visible = true;
      for (const part of hidden) part.visible = false;
      this.renderer.render(this.scene, this.camera);
    };
    this.renderer.setScissorTest(this.beside);
    half(0, this.beside && stacked ? height : 0, parts, twins);
    if (this.beside) half(stacked ? 0 : width, 0, twins, parts);
    this.place.dataset.drawn = String(1 + Number(this.place.dataset.drawn ?? 0));
  }

  rayAt({ clientX, clientY }) {
    const rect = this.renderer.domElement.getBoundingClientRect();
    const { width, height } = this.halves();
    const x = ((clientX - rect.left) % width) / width;
    const y = ((clientY - rect.top) % height) / height;
    const caster = new Raycaster();
    this.camera.updateWorldMatrix(true, false);
    caster.setFromCamera(new Vector2(2 * x - 1, 1 - 2 * y), this.camera);
    return caster.ray;
  }
  /** The ray through the middle of the picture. */
  middleRay() {
    const rect = this.renderer.domElement.getBoundingClientRect();
    const { width, height } = this.halves();
    return this.rayAt({ clientX: rect.left + 0.5 * width, clientY: rect.top + 0.5 * height });
  }

  /** A function from rays to their points of the plane through a point, parallel to the picture. */
  planeThrough(point) {
    const plane = new Plane().setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new Vector3()), new Vector3(...point));
    return (ray) => ray.intersectPlane(plane, new Vector3())?.toArray() ?? null;
  }

  /** Presses on a body, before the camera's controls see them. A second finger lets go: two fingers turn and zoom. */
  watchGrasp() {
    const canvas = this.renderer.domElement;
    let held = null;
    const drop = (event) => {
      if (!held) return;
      held.grip.end(event.type !== 'pointerup' || !held.isTap);
      held = null;
    };
    this.place.addEventListener('pointerdown', (event) => {
      if (held) drop(event);
      if (event.target !== canvas || !event.isPrimary || event.button !== 0 || event.shiftKey) return;
      const grip = this.grasp(this.rayAt(event));
      if (!grip) return;
      held = { grip, id: event.pointerId, x: event.clientX, y: event.clientY, isTap: true };
      canvas.focus({ preventScroll: true });
      canvas.setPointerCapture(event.pointerId);
      event.stopPropagation();
    }, { capture: true });
    this.place.addEventListener('pointermove', (event) => {
      if (event.pointerId !== held?.id) return;
      event.stopPropagation();
      if (Math.hypot(event.clientX - held.x, event.clientY - held.y) > 4) held.isTap = false;
      if (!held.isTap) held.grip.move(this.rayAt(event));
    }, { capture: true });
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      this.place.addEventListener(name, (event) => {
        if (event.pointerId !== held?.id) return;
        event.stopPropagation();
        drop(event);
      }, { capture: true });
    }
  }

  /** Goes back, in the same direction, until all of the box is seen. */
  widen() {
    const [center, radius] = this.frameOfBox();
    const away = this.camera.position.clone().sub(this.controls.target);
    const distance = (0.85 * radius) / Math.sin((0.5 * this.camera.fov * Math.PI) / 180) / Math.min(1, this.camera.aspect);
    this.camera.position.copy(center).addScaledVector(away.normalize(), distance);
    this.controls.target.copy(center);
    this.controls.update();
    this.ask();
  }

  /** Turns the camera about its target, radians: for the keyboard. */
  orbit(across, up) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const side = new Vector3().crossVectors(this.camera.up, offset).normalize();
    offset.applyAxisAngle(this.camera.up, across);
    const tilt = offset.angleTo(this.camera.up);
    if (tilt - up > 0.05 && tilt - up < Math.PI - 0.05) offset.applyAxisAngle(side, -up);
    this.turned = true;
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.ask();
  }
}
