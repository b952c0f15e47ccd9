// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
import {MorulaError} from './errors.js';

/** The two numbers of a budget in morula.h: tests, and nanoseconds; -1n: none. */
export function budgetOf(tests, budgetMs) {
  if (tests !== undefined && !(Number.isSafeInteger(tests) && tests >= 0))
    throw new MorulaError(`a budget of ${tests} tests is no whole number from 0`);
  if (budgetMs !== undefined && !(budgetMs >= 0 && budgetMs <= 1e9))
    throw new MorulaError(`budgetMs is ${budgetMs}, not 0 to 1e9`);
  return [BigInt(tests ?? -1), budgetMs === undefined ? -1n : BigInt(Math.round(budgetMs * 1e6))];
}
