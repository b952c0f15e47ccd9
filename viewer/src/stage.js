// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The three-dimensional picture: camera, light, section plane and objects. It draws only on request.
import { Color, DirectionalLight, Group, HemisphereLight, PerspectiveCamera, Plane, Raycaster, Scene, Vector2, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { PageError } from './decode.js';
import { BodyView } from './body.js';
import { SpheresView } from './spheres.js';
import { ContactsView } from './contacts.js';
import { PatchesView } from './patches.js';
import { BareView } from './bare_view.js';
import { styleValue } from './dom.js';

const axes = { x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0, 0, 1) };

export class Stage {
  constructor(place) {
    this.place = place;
    try {
      this.renderer = new WebGLRenderer({ antialias: true, alpha: true, stencil: true, powerPreference: 'high-performance' });
    } catch {
      throw new PageError('this browser gives no WebGL: turn on hardware acceleration or try another browser');
    }
    this.renderer.setClearColor(0, 0);
    this.renderer.localClippingEnabled = true;
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'The body and its spheres. Drag to turn, scroll or pinch to come closer, press a sphere for its numbers.');
    place.prepend(canvas);

    this.scene = new Scene();
    this.camera = new PerspectiveCamera(32, 1, 0.01, 100);
    this.scene.add(this.camera);
    this.lights = new Group();
    const key = new DirectionalLight(0xfff8f0, 1.75);
    key.position.set(-0.7, 1.1, 1.2);
    const fill = new DirectionalLight(0xe6eeff, 0.7);
    fill.position.set(1.4, -0.3, 0.8);
    const rim = new DirectionalLight(0xffffff, 0.9);
    rim.position.set(0.5, 0.9, -1.6);
    this.lights.add(key, fill, rim, key.target, fill.target, rim.target);
    this.camera.add(this.lights);
    this.sky = new HemisphereLight(0xffffff, 0xcfc9c2, 1.35);
    this.scene.add(this.sky);

    this.plane = new Plane(new Vector3(-1, 0, 0), 0);
    this.planes = [];
    this.body = new BodyView();
    this.spheres = new SpheresView(this.plane);
    this.contacts = new ContactsView();
    this.patches = new PatchesView();
    this.bare = new BareView();
    this.scene.add(this.bare.mesh, this.body.group, this.spheres.group, this.patches.group, this.contacts.group);

    this.onpick = () => {};
    this.onlook = () => {};
    /** The sphere that the reader can drag: {sphere() returns [x, y, z, r] or null, move(sphere), end()}. */
    this.grip = null;
    this.steer();
    this.watchPresses(canvas);
    this.watchDrags(canvas);
    new ResizeObserver(() => this.resize()).observe(place);
    canvas.addEventListener('webglcontextrestored', () => this.ask());
    this.box = { low: [0, 0, 0], high: [1, 1, 1] };
    this.resize();
  }

  /** Controls take their idea of up from the camera, once: another up, other controls. */
  steer() {
    this.controls?.dispose();
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => {
      this.ask();
      this.onlook();
    });
  }

  /** Near and far planes close around what is there: depths that nearly agree stay in order. */
  enclose() {
    const { low, high } = this.box;
    const center = new Vector3(...low.map((x, k) => 0.5 * (x + high[k])));
    const reach = 1.5 * Math.hypot(...low.map((x, k) => high[k] - x)) || 1; // spheres stick out of the body
    const distance = this.camera.position.distanceTo(center);
    this.camera.near = Math.max(distance - reach, 0.004 * reach);
    this.camera.far = distance + reach;
    this.camera.updateProjectionMatrix();
  }

  /** Draws in the next frame of the screen, once for any number of calls. */
  ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.draw();
    });
  }

  draw() {
    this.enclose();
    // Seen from the side that is cut away, nothing is in front of the plane; what is cut along it has depths too
    // uncertain to compare with.
    const open = this.plane.distanceToPoint(this.camera.position) < 0;
    for (const material of [this.body.cap.material, ...this.spheres.disc]) material.depthTest = !open;
    this.renderer.render(this.scene, this.camera);
    this.place.dataset.drawn = String(1 + Number(this.place.dataset.drawn ?? 0));
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width === 0 || height === 0) return;
    const wasNarrow = this.camera.aspect < 1;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (wasNarrow !== this.camera.aspect < 1 && !this.turned) this.fit();
    this.ask();
  }

  theme() {
    this.body.theme(new Color(styleValue('--body')), new Color(styleValue('--uncovered')), new Color(styleValue('--cut')));
    this.bare.theme(new Color(styleValue('--uncovered')));
    this.contacts.theme(new Color(styleValue('--ink')));
    this.patches.theme(new Color(styleValue('--ink')));
    // The spheres' shaders write colors as the screen has them.
    const asShown = (name) => new Color(styleValue(name)).convertLinearToSRGB();
    this.spheres.theme(asShown('--accent'), asShown('--rim'), asShown('--panel'));
    this.ask();
  }

  /** A new mesh: its box over all frames decides where the camera stands. */
  show(scene) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (const frame of scene.motion.frames) {
      for (const vertex of scene.motion.facets) {
        for (let k = 0; k < 3; ++k) {
          const x = frame[3 * vertex + k] * scene.step[k];
          if (x < low[k]) low[k] = x;
          if (x > high[k]) high[k] = x;
        }
      }
    }
    const same = this.shown === scene.motion;
    this.shown = scene.motion;
    this.box = { low, high };
    this.body.show(scene);
    this.spheres.show(scene);
    // A robot stands on its z.
    if (!same) this.fit(scene.joints ? 'z' : undefined);
    this.ask();
  }

  /** The same mesh in another pose, as large as this. */
  surround(box) {
    this.box = box;
  }

  /** Puts the camera where the two longer sides of the box are seen, a little from above. up: 'y', 'z' or 'x'. */
  fit(up = this.up ?? 'y') {
    if (up !== (this.up ?? 'y')) {
      this.camera.up.copy(axes[up]);
      this.steer();
    }
    this.up = up;
    this.turned = false;
    const size = this.box.low.map((low, k) => this.box.high[k] - low);
    const center = new Vector3(...this.box.low.map((low, k) => 0.5 * (low + this.box.high[k])));
    const vertical = 'xyz'.indexOf(up);
    const [a, b] = [0, 1, 2].filter((k) => k !== vertical);
    const [across, along] = size[a] >= size[b] ? [a, b] : [b, a];
    const direction = [0, 0, 0];
    direction[along] = along === 2 || across === 2 ? 1 : -1;
    direction[vertical] = 0.34;
    direction[across] = 0.32;
    const toward = new Vector3(...direction).normalize();
    const radius = 0.5 * Math.hypot(...size) || 1;
    const angle = 0.5 * this.camera.fov * (Math.PI / 180);
    const high = 0.5 * size[vertical] + 0.3 * size[along];
    const wide = 0.5 * size[across] + 0.15 * size[along];
    const distance = 0.5 * size[along] + Math.max(high, wide / this.camera.aspect, 0.3 * radius) * (1.08 / Math.tan(angle));
    this.camera.position.copy(center).addScaledVector(toward, distance);
    this.controls.target.copy(center);
    this.controls.minDistance = 0.15 * radius;
    this.controls.maxDistance = 20 * radius;
    this.controls.update();
    this.ask();
  }

  /** Middle and half diagonal of the box. */
  frameOfBox() {
    const { low, high } = this.box;
    return [new Vector3(...low.map((x, k) => 0.5 * (x + high[k]))), 0.5 * Math.hypot(...low.map((x, k) => high[k] - x)) || 1];
  }
  /** The camera's position, target and up axis: 'x,y,z,x,y,z,up', about the middle of the box, in half diagonals. */
  look() {
    const [center, radius] = this.frameOfBox();
    const numbers = [this.camera.position, this.controls.target].flatMap((p) => p.clone().sub(center).divideScalar(radius).toArray());
    return [...numbers.map((x) => String(Number(x.toFixed(4)))), this.up].join(',');
  }
  /** Takes a text that look() returned, for this body or another; ignores any other text. */
  lookAs(text) {
    const parts = String(text).split(',');
    const numbers = parts.slice(0, 6).map((part) => (part.trim() === '' ? NaN : Number(part)));
    if (parts.length !== 7 || !(parts[6] in axes) || !numbers.every((x) => Math.abs(x) <= 1e4)) return;
    const [center, radius] = this.frameOfBox();
    this.fit(parts[6]);
    this.turned = true;
    this.camera.position.fromArray(numbers, 0).multiplyScalar(radius).add(center);
    this.controls.target.fromArray(numbers, 3).multiplyScalar(radius).add(center);
    this.controls.update();
    this.ask();
  }

  /** axis: '', 'x', 'y' or 'z'; share: 0 to 1 of the box. Objects beyond the plane are not drawn. */
  cut(axis, share, flip) {
    if (axis) {
      const k = 'xyz'.indexOf(axis);
      const reach = 0.02 * (this.box.high[k] - this.box.low[k]);
      const at = this.box.low[k] - reach + share * (this.box.high[k] - this.box.low[k] + 2 * reach);
      const sign = flip ? 1 : -1;
      this.plane.normal.copy(axes[axis]).multiplyScalar(sign);
      this.plane.constant = -sign * at;
    }
    const planes = axis ? [this.plane] : [];
    this.body.cut(planes, this.box);
    this.spheres.cut(planes);
    this.bare.cut(planes);
    this.planes = planes;
    this.ask();
  }

  /** A press that is not a turn picks: the first sphere along the ray, by its equation. */
  watchPresses(canvas) {
    let from = null;
    canvas.addEventListener('pointerdown', (event) => (from = event.isPrimary ? [event.clientX, event.clientY] : null));
    canvas.addEventListener('pointerup', (event) => {
      const moved = from && Math.hypot(event.clientX - from[0], event.clientY - from[1]);
      if (moved === null || moved > 5) {
        this.turned = true;
        return;
      }
      this.onpick(this.spheres.hit(this.rayAt(event), this.planes));
    });
  }
  rayAt(event) {
    const rect = this.renderer.domElement.getBoundingClientRect();
    const x = ((event.clientX - rect.left) / rect.width) * 2 - 1;
    const y = 1 - ((event.clientY - rect.top) / rect.height) * 2;
    const caster = new Raycaster();
    // Where the camera stands since it was drawn last.
    this.camera.updateWorldMatrix(true, false);
    caster.setFromCamera(new Vector2(x, y), this.camera);
    return caster.ray;
  }

  /** A drag of the gripped sphere, before the camera's controls see it: in the plane of the picture, or of its rim. */
  watchDrags(canvas) {
    let drag = null;
    const onPlane = (event, plane) => this.rayAt(event).intersectPlane(plane, new Vector3());
    this.place.addEventListener('pointerdown', (event) => {
      const sphere = event.target === canvas && event.isPrimary && event.button === 0 ? this.grip?.sphere() : null;
      if (!sphere) return;
      const center = new Vector3(...sphere);
      const plane = new Plane().setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new Vector3()), center);
      const from = onPlane(event, plane);
      if (!from || from.distanceTo(center) > 1.1 * sphere[3]) return;
      drag = { id: event.pointerId, plane, from, center, radius: sphere[3], isRim: from.distanceTo(center) > 0.75 * sphere[3] };
      canvas.setPointerCapture(event.pointerId);
      event.stopPropagation();
    }, { capture: true });
    this.place.addEventListener('pointermove', (event) => {
      if (event.pointerId !== drag?.id) return;
      const at = onPlane(event, drag.plane);
      event.stopPropagation();
      if (!at) return;
      const { center, from, radius, isRim } = drag;
      const moved = isRim ? center : at.clone().sub(from).add(center);
      const size = isRim ? Math.max(radius + at.distanceTo(center) - from.distanceTo(center), 0.02 * radius) : radius;
      this.grip.move([...moved.toArray(), size]);
    }, { capture: true });
    for (const name of ['pointerup', 'pointercancel']) {
      this.place.addEventListener(name, (event) => {
        if (event.pointerId !== drag?.id) return;
        drag = null;
        event.stopPropagation();
        this.grip.end();
      }, { capture: true });
    }
  }

  /** Brings a ball of the picture near, from where the fewest other balls hide it. */
  focus([x, y, z, size], others) {
    const center = new Vector3(x, y, z);
    const r = Math.max(size, 0.2 * this.frameOfBox()[1]);
    const away = this.camera.position.clone().sub(this.controls.target);
    away.normalize();
    const steps = [-1, 0, 1];
    const directions = steps.flatMap((i) => steps.flatMap((j) => steps.map((k) => new Vector3(i, j, k)))).filter((d) => d.length() > 0).map((d) => d.normalize());
    const hides = (direction) => ([p, q, s, radius]) => {
      const to = new Vector3(p, q, s).sub(center);
      const along = to.dot(direction);
      return along > 0 && to.lengthSq() - along * along < radius * radius;
    };
    const cost = (direction) => others.filter(hides(direction)).length - 0.5 * direction.dot(away);
    away.copy([away.clone(), ...directions].reduce((a, b) => (cost(b) < cost(a) ? b : a)));
    const angle = 0.5 * this.camera.fov * (Math.PI / 180);
    const distance = (1.6 * r) / Math.sin(angle) / Math.min(1, this.camera.aspect);
    this.turned = true;
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(away, Math.max(distance, this.controls.minDistance));
    this.controls.update();
    this.ask();
  }
}
