// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Starts the workers of Morula.buildAsync(), in pages, in node and in hosts like them.
import {MorulaError} from './errors.js';

const isNode = () => typeof Worker === 'undefined' && globalThis.process?.versions?.node !== undefined;
const threads = () => import(/* webpackIgnore: true */ /* @vite-ignore */ 'node:worker_threads');

/** A worker of node with the interface of one of a page, as far as run() uses it. */
function asOfPage(worker) {
  const own = {
    onmessage() {},
    onmessageerror() {},
    onerror() {},
    postMessage: (message, moved) => worker.postMessage(message, moved),
    terminate: () => void worker.terminate(),
  };
  worker.on('message', (data) => own.onmessage({data}));
  worker.on('messageerror', () => own.onmessageerror());
  worker.on('error', (error) => own.onerror(error));
  worker.on('exit', (code) => own.onerror(new Error(`the worker ended with exit code ${code}`)));
  return own;
}

/** A worker whose code is a module of its own. address: of the module. ofPage: a function that starts it in a page. */
export async function workerAt(address, ofPage) {
  if (!isNode()) return ofPage();
  const {Worker: Thread} = await threads();
  return asOfPage(new Thread(address));
}

/** A worker whose code is a text, for pages whose workers cannot be fetched. */
export async function workerOf(text) {
  if (isNode()) {
    const {Worker: Thread} = await threads();
    return asOfPage(new Thread(text, {eval: true}));
  }
  const address = URL.createObjectURL(new Blob([text], {type: 'text/javascript'}));
  let worker = null;
  try {
    worker = new Worker(address);
  } catch {
    // Hosts such as deno have workers of modules alone.
    worker = new Worker(address, {type: 'module'});
  }
  // The worker fetches its code before this.
  setTimeout(() => URL.revokeObjectURL(address), 60000);
  return worker;
}

/** The reason of an aborted signal; the first browsers with exceptions of WebAssembly have none. */
export const reasonOf = (signal) => signal.reason ?? new DOMException('the build was aborted', 'AbortError');

/** Runs a job in a worker. Resolves to its last message, or rejects with `unstarted` if the worker never answered. signal:
 * ends the worker, and rejects with its reason. heard: called with each message, and may throw to end the worker. */
export function run(worker, job, moved, signal, heard) {
  let hasAnswered = false;
  return new Promise((resolve, reject) => {
    const end = (settle, value) => {
      signal?.removeEventListener('abort', abort);
      worker.onmessage = worker.onmessageerror = worker.onerror = () => {};
      worker.terminate();
      settle(value);
    };
    const abort = () => end(reject, reasonOf(signal));
    worker.onmessage = ({data}) => {
      hasAnswered = true;
      try {
        if (heard(data)) end(resolve, data);
      } catch (reason) {
        end(reject, reason);
      }
    };
    worker.onerror = (event) => {
      event.preventDefault?.();
      const text = event.message || 'the worker failed';
      end(reject, Object.assign(new MorulaError(text, 'internal'), {unstarted: !hasAnswered}));
    };
    // Without this a build whose result is too large to be copied would never end.
    worker.onmessageerror = () => end(reject, new MorulaError('a message of the worker cannot be read', 'internal'));
    signal?.addEventListener('abort', abort);
    try {
      worker.postMessage(job, moved);
    } catch (reason) {
      end(reject, reason);
    }
  });
}
