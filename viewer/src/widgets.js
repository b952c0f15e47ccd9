// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Buttons, boxes and sliders that follow a State and set it.
import { element } from './dom.js';

/** Buttons of which one is pressed. */
export function segments(place, options, state, name) {
  const buttons = options.map(([value, label, title]) =>
    element('button', { type: 'button', title, 'data-value': value, onclick: () => state.set({ [name]: value }) }, label),
  );
  place.replaceChildren(...buttons);
  place.classList.add('segments');
  place.setAttribute('role', 'group');
  const press = () => buttons.forEach((b) => b.setAttribute('aria-pressed', String(b.dataset.value === state.get(name))));
  state.listen((changed) => changed.has(name) && press());
  press();
  return buttons;
}

/** A checkbox of the state's flag. */
export function bindBox(box, state, name) {
  box.checked = state.get(name);
  box.addEventListener('change', () => state.set({ [name]: box.checked }));
  state.listen((changed) => changed.has(name) && (box.checked = state.get(name)));
}

/** A slider of the state's number; also: values that a reader's move sets with it. range.take() reads the state again. */
export function bindRange(range, state, name, also = {}) {
  range.addEventListener('input', () => state.set({ [name]: range.valueAsNumber, ...also }));
  range.take = () => {
    range.value = String(state.get(name));
    range.style.setProperty('--share', String((range.value - range.min) / (range.max - range.min || 1)));
  };
  state.listen((changed) => (changed.has(name) || changed.has('scene')) && range.take());
}
