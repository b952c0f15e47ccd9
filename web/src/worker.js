// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The worker of Morula.buildAsync(): one build, whose progress and result it posts.
import {loadFrom} from './load.js';

/** Answers one job {module, positions, facets, options, hasProgress} by messages {isReady} before the build, {share}, and
 * then {bytes} or {error}. */
async function answer(job, post) {
  try {
    const {Mesh, build} = await loadFrom(job.module);
    post({isReady: true}, []);
    const progress = job.hasProgress ? (share) => post({share}, []) : null;
    const bytes = build(new Mesh(job.positions, job.facets), {...job.options, progress}).toBytes();
    post({bytes}, [bytes.buffer]);
  } catch (error) {
    post({error: {message: String(error?.message ?? error), code: error?.code ?? 'internal'}}, []);
  }
}

/** The page hears an error of a worker that has not answered, and tries another kind. */
function unreadable() {
  throw new Error('the job cannot be read in the worker');
}

if (typeof globalThis.postMessage === 'function') {
  globalThis.onmessageerror = unreadable;
  globalThis.onmessage = ({data}) => answer(data, (message, moved) => globalThis.postMessage(message, moved));
} else {
  // A worker of node.
  import(/* webpackIgnore: true */ /* @vite-ignore */ 'node:worker_threads').then(({parentPort}) => {
    parentPort.once('messageerror', unreadable);
    parentPort.once('message', (job) => answer(job, (message, moved) => parentPort.postMessage(message, moved)));
  });
}
