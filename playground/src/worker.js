// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The worker: unpacks and compiles the module, reads or makes a mesh, builds its tree. The page stays free.
import { load } from 'morula';
import { clustersOf } from './clusters.js';
import { checkMeshBytes, checkFacetCount, mostSoftVertices } from './limits.js';

let morula = null;

async function unpack(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const bytes = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
  return WebAssembly.compile(bytes);
}

/** A sample with about so many facets: their number grows with the square of the resolution. */
function sample(name, facets) {
  const trial = morula.Mesh.sample(name, 24);
  const resolution = Math.max(3, Math.round(24 * Math.sqrt(facets / trial.facetCount)));
  trial.free();
  return morula.Mesh.sample(name, resolution);
}

async function meshOf({ shape, detail, file, mesh }) {
  if (mesh) return new morula.Mesh(mesh.positions, mesh.facets);
  if (!file) return sample(shape, detail);
  const bytes = new Uint8Array(await file.blob.arrayBuffer());
  checkMeshBytes(file.name, bytes);
  return morula.Mesh.fromBytes(file.name, bytes);
}

async function run({ id, source, options }) {
  const mesh = await meshOf(source);
  try {
    checkFacetCount(mesh.facetCount);
    const positions = mesh.positions.slice();
    const facets = mesh.facets.slice();
    const progress = (share) => postMessage({ id, share });
    const begin = performance.now();
    const tree = morula.build(mesh, { ...options, progress });
    const seconds = (performance.now() - begin) / 1000;
    const bytes = tree.toBytes();
    tree.free();
    const clusters = positions.length / 3 <= mostSoftVertices ? clustersOf(positions, facets, 48) : null;
    postMessage({ id, made: { positions, facets, tree: bytes, seconds, clusters } }, [positions.buffer, facets.buffer, bytes.buffer]);
  } finally {
    mesh.free();
  }
}

async function take(data) {
  try {
    if (data.module) {
      const module = typeof data.module === 'string' ? await unpack(data.module) : data.module;
      morula = await load({ source: module });
      if (typeof data.module === 'string') postMessage({ module });
    } else {
      await run(data);
    }
  } catch (error) {
    postMessage({ id: data.id ?? 0, error: error.message, code: error.code ?? error.name });
  }
}

// In order: a job may come before the module is ready.
let last = Promise.resolve();
addEventListener('message', ({ data }) => {
  last = last.then(() => take(data));
});
