// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features of one module. index.d.ts has the contracts; module.cpp checks the places of fields used here.
import {budgetOf} from './budget.js';
import {Handle} from './handle.js';
import {signed} from './numbers.js';

const pairSize = 144;
const missing = 0xffffffff;
const kinds = ['vertex-facet', 'facet-vertex', 'edge-edge', 'facet-facet'];

export function pairsOf(memory, Body, requireKind) {
  const numbers = (at, count) => Array.from({length: count}, (_, i) => memory.data.getFloat64(at + 8 * i, true));
  const vertices = (at) =>
    [0, 4, 8].map((offset) => memory.data.getUint32(at + offset, true)).filter((vertex) => vertex !== missing);

  function pairAt(at) {
    const data = memory.data;
    const pair = {
      kind: kinds[data.getInt32(at, true)],
      a: data.getUint32(at + 4, true),
      b: data.getUint32(at + 8, true),
      verticesA: vertices(at + 12),
      verticesB: vertices(at + 24),
    };
    if (pair.kind === 'facet-facet') return pair;
    return {
      ...pair,
      distance: data.getFloat64(at + 40, true),
      weightsA: numbers(at + 48, pair.verticesA.length),
      weightsB: numbers(at + 72, pair.verticesB.length),
      pointA: numbers(at + 96, 3),
      pointB: numbers(at + 120, 3),
    };
  }

  class PairQuery extends Handle {
    // Of a search that its budget ended: it reads their positions, which go with them.
    #bodies = [];

    constructor() {
      super(memory, 'morula_pairs_destroy', memory.make('morula_pairs_create'));
    }
    near(a, b, options) {
      return this.#search('morula_pairs_near', a, b, options);
    }
    crossing(a, b, options) {
      return this.#search('morula_pairs_crossing', a, b, options);
    }
    resume({boxTests, budgetMs} = {}) {
      for (const body of this.#bodies) requireKind(body, Body, 'body');
      memory.call('morula_pairs_resume', this.handle, ...budgetOf(boxTests, budgetMs));
      if (this.finished) this.#bodies = [];
      return this.pairs();
    }
    get count() {
      return memory.get('morula_pairs_count', this.handle);
    }
    get finished() {
      return memory.get('morula_pairs_finished', this.handle) !== 0;
    }
    pairs() {
      const first = memory.get('morula_pairs_data', this.handle);
      return Array.from({length: this.count}, (_, i) => pairAt(first + pairSize * i));
    }
    #search(name, a, b, options = {}) {
      const first = requireKind(a, Body, 'a');
      const second = b === null ? 0 : requireKind(b, Body, 'b');
      memory.withBlock(56, (place) => {
        memory.get('morula_pair_options_defaults', place, 56);
        const data = memory.data;
        data.setFloat64(place + 8, options.distance ?? 0, true);
        data.setInt32(place + 16, options.nearestFeaturesOnce ? 1 : 0, true);
        data.setInt32(place + 20, signed(options.rings ?? 0, 'rings'), true);
        data.setFloat64(place + 24, options.restDistance ?? 0, true);
        data.setInt32(place + 32, options.sameComponent ? 1 : 0, true);
        const [tests, nanoseconds] = budgetOf(options.boxTests, options.budgetMs);
        data.setBigInt64(place + 40, tests, true);
        data.setBigInt64(place + 48, nanoseconds, true);
        memory.call(name, first, second, place, this.handle);
      });
      this.#bodies = this.finished ? [] : [a, b ?? a];
      return this.pairs();
    }
  }

  /** With a query that is freed at once. */
  function proximity(a, b, options) {
    const query = new PairQuery();
    try {
      return query.near(a, b, options);
    } finally {
      query.free();
    }
  }

  return {PairQuery, proximity};
}
