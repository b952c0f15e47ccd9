// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The paper in five steps. Each is an address: #tour=1 to #tour=5.
import { byId } from '../../viewer/src/dom.js';

const rest = { bend: 0, twist: 0, stretch: 1 };
const bent = { ...rest, bend: 110 };
const still = { shape: 'limb', detail: '1500', method: 'optimized', quality: 'fast', depth: 'auto', flat: 0, touch: 'none', beside: false, playing: false, color: 'branch', body: true, spheres: true, uncovered: true, opacity: 0.5 };

export const steps = [
  {
    title: 'A sphere tree',
    text: 'Each level of the tree is a set of spheres that contains the whole surface: level 0 is one sphere, and each further level divides the spheres of the level above. A collision query tests the upper spheres first and opens only those that overlap. Move the slider Level.',
    set: { ...rest, rule: 'exact', level: 2 },
  },
  {
    title: 'Deformation breaks it',
    text: 'The limb bends, and the spheres stay where they were built. The red surface is in no sphere: a query would miss what happens there. To build the tree again in every frame takes too long, so its spheres have to follow the surface.',
    set: { ...bent, rule: 'rest', level: 2 },
  },
  {
    title: 'The traditional update',
    text: 'Every sphere moves by the mean displacement of the vertices that it enclosed, and its radius reaches the farthest of them. The red facets have corners in several spheres and lie in none. Twist the limb: the spheres grow, because the vertices that one sphere has to enclose move apart.',
    set: { ...bent, rule: 'traditional', level: 2 },
  },
  {
    title: 'Approach 2 of the paper',
    text: 'The sphere of a leaf follows the box of its vertices, and the sphere of an inner node follows the box of its child spheres. That takes constant time for each node and keeps spheres small, but a box says little about the surface in it: the figures give the share that is uncovered.',
    set: { ...bent, rule: 'approach2', level: 2 },
  },
  {
    title: 'Exact',
    text: 'Morula binds each sphere to a patch of the surface and encloses the patch in every frame. No level leaves surface uncovered: the certificate checks every triangle. Approach 2 comes first, Exact second. Bend, twist and stretch the limb, or drag it, and compare.',
    set: { ...bent, rule: 'approach2', level: 2, beside: true },
  },
];

/** The values of a step of the tour; none for 0. */
export const stepValues = (step) => (steps[step - 1] ? { ...still, ...steps[step - 1].set, tour: step } : {});

export function bindTour(state) {
  const card = byId('tour');
  const go = (step) => state.set(step === 0 ? { tour: 0 } : stepValues(step));
  const show = () => {
    const step = state.get('tour');
    card.hidden = step === 0;
    byId('tour-button').setAttribute('aria-pressed', String(step > 0));
    if (step === 0) return;
    const { title, text } = steps[step - 1];
    byId('tour-title').textContent = title;
    byId('tour-text').textContent = text;
    byId('tour-place').textContent = `${step} of ${steps.length}`;
    byId('tour-back').disabled = step === 1;
    byId('tour-next').textContent = step === steps.length ? 'Finish' : 'Next';
  };
  byId('tour-button').addEventListener('click', () => go(state.get('tour') > 0 ? 0 : 1));
  byId('tour-close').addEventListener('click', () => go(0));
  byId('tour-back').addEventListener('click', () => go(Math.max(1, state.get('tour') - 1)));
  byId('tour-next').addEventListener('click', () => go((state.get('tour') + 1) % (steps.length + 1)));
  state.listen((changed) => changed.has('tour') && show());
  show();
  return go;
}
