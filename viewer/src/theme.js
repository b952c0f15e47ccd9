// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Light or dark: as the system has it, until the reader chooses.
import { byId } from './dom.js';

const system = matchMedia('(prefers-color-scheme: dark)');
// A page from disk may not be allowed to remember anything.
const remembered = () => {
  try {
    return localStorage.getItem('morula-theme');
  } catch {
    return null;
  }
};

export function bindTheme(onchange) {
  const apply = (theme) => {
    document.documentElement.dataset.theme = theme;
    onchange();
  };
  const toggle = () => {
    const theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    try {
      localStorage.setItem('morula-theme', theme);
    } catch {
      // Then it lasts as long as the page.
    }
    apply(theme);
  };
  system.addEventListener('change', () => remembered() === null && apply(system.matches ? 'dark' : 'light'));
  byId('theme-button').addEventListener('click', toggle);
  document.documentElement.dataset.theme = remembered() ?? (system.matches ? 'dark' : 'light');
  return toggle;
}
