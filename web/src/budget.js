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

/** Calls act(first, count) on slices of 0 to total - 1, in order, until budgetMs are over, but once at least; returns how many
 * are done. A slice is as large as all before it, so that few calls are made and a budget is exceeded little. */
export function inSlices(total, budgetMs, act) {
  const [, nanoseconds] = budgetOf(undefined, budgetMs);
  const begin = performance.now();
  const isOver = () => nanoseconds >= 0n && performance.now() - begin >= budgetMs;
  let done = 0;
  do {
    const count = nanoseconds < 0n ? total : Math.min(total - done, Math.min(Math.max(done, 8), 512));
    act(done, count);
    done += count;
  } while (done < total && !isOver());
  return done;
}
