// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Builds in a worker of their own, so that the thread of the page stays free.
import {MorulaError} from './errors.js';
import {reasonOf, run} from './workers.js';

function requireGoing(signal) {
  if (signal && typeof signal.addEventListener !== 'function') throw new MorulaError('signal is no AbortSignal');
  if (signal?.aborted) throw reasonOf(signal);
}

/** Runs a job in the first of the given kinds of workers that starts here. */
async function runInAny(starts, jobOf, signal, heard) {
  const reasons = [];
  for (const start of starts) {
    requireGoing(signal);
    let worker = null;
    try {
      worker = await start();
    } catch (reason) {
      reasons.push(reason.message);
      continue;
    }
    let work = null;
    try {
      requireGoing(signal);
      work = jobOf();
    } catch (reason) {
      worker.terminate();
      throw reason;
    }
    const {job, moved} = work;
    try {
      return await run(worker, job, moved, signal, heard);
    } catch (reason) {
      if (!reason?.unstarted) throw reason;
      reasons.push(reason.message);
    }
  }
  throw new MorulaError(`no worker can be started here (${reasons.join('; ')}): build() builds on this thread`, 'no_worker');
}

/** Makes buildAsync() of a module. starts: functions that start a worker, the preferred one first. */
export function buildAsyncOf(module, starts, {requireBuilder, Tree}) {
  return async function buildAsync(mesh, {progress = null, signal = null, ...options} = {}) {
    requireGoing(signal);
    requireBuilder(mesh);
    const jobOf = () => {
      const positions = mesh.positions.slice();
      const facets = mesh.facets.slice();
      return {
        job: {module, positions, facets, options, hasProgress: progress !== null},
        moved: [positions.buffer, facets.buffer],
      };
    };
    const last = await runInAny(starts, jobOf, signal, (message) => {
      if (message.isReady) return false;
      if ('share' in message && progress(message.share) === false)
        throw new MorulaError('build: stopped on request', 'stopped');
      return !('share' in message);
    });
    if (last.error) throw new MorulaError(last.error.message, last.error.code);
    return Tree.fromBytes(last.bytes, mesh);
  };
}
