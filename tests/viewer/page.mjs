// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A page's data without a browser.
import { PageError } from '../../viewer/src/decode.js';

/** text(id) of a page: what its data elements hold. */
export function elements(html) {
  return (id) => {
    const found = new RegExp(`<script [^>]*id="${id}">([^<]*)</script>`).exec(html);
    return found ? found[1] : null;
  };
}

/** Does f refuse, in words that are meant for whoever opens the page? */
export const isRefused = (f) => {
  try {
    f();
  } catch (error) {
    return error instanceof PageError;
  }
  return false;
};
