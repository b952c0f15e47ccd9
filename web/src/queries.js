// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The queries of one module. index.d.ts has their contracts; module.cpp checks the places of fields used here.
import {budgetOf, inSlices} from './budget.js';
import {Handle} from './handle.js';
import {signed} from './numbers.js';

const contactSize = 80;
const hitSize = 88;
const locationSize = 16;
const missing = 0xffffffff;

export function queriesOf(memory, Body, {requireKind, requireLength, requireMultiple, indicesFrom}) {
  const handlesOf = (a, b) => [requireKind(a, Body, 'a'), requireKind(b, Body, 'b')];
  const vector = (begin) => [0, 8, 16].map((offset) => memory.data.getFloat64(begin + offset, true));

  function overlap(a, b) {
    const bodies = handlesOf(a, b);
    return memory.withBlock(4, (result) => {
      memory.call('morula_overlap', ...bodies, result);
      return memory.data.getInt32(result, true) === 1;
    });
  }

  class ContactQuery extends Handle {
    constructor() {
      super(memory, 'morula_contacts_destroy', memory.make('morula_contacts_create'));
    }
    run(a, b, {margin = 0, level = -1, pairTests, budgetMs} = {}) {
      const bodies = handlesOf(a, b);
      memory.withBlock(40, (options) => {
        memory.get('morula_contact_options_defaults', options, 40);
        memory.data.setFloat64(options + 8, margin, true);
        memory.data.setInt32(options + 16, signed(level, 'level'), true);
        const [tests, nanoseconds] = budgetOf(pairTests, budgetMs);
        memory.data.setBigInt64(options + 24, tests, true);
        memory.data.setBigInt64(options + 32, nanoseconds, true);
        memory.call('morula_collide', ...bodies, options, this.handle);
      });
      return this.contacts();
    }
    resume({pairTests, budgetMs} = {}) {
      memory.call('morula_contacts_resume', this.handle, ...budgetOf(pairTests, budgetMs));
      return this.contacts();
    }
    get count() {
      return memory.get('morula_contacts_count', this.handle);
    }
    get finished() {
      return memory.get('morula_contacts_finished', this.handle) !== 0;
    }
    contacts() {
      const first = memory.get('morula_contacts_data', this.handle);
      return Array.from({length: this.count}, (_, i) => {
        const at = first + contactSize * i;
        return {
          nodeA: memory.data.getUint32(at, true),
          nodeB: memory.data.getUint32(at + 4, true),
          finished: memory.data.getInt32(at + 8, true) !== 0,
          point: vector(at + 16),
          normal: vector(at + 40),
          depth: memory.data.getFloat64(at + 64, true),
          errorBound: memory.data.getFloat64(at + 72, true),
        };
      });
    }
  }

  function crossings(a, b) {
    const bodies = handlesOf(a, b);
    return indicesFrom((list, capacity, count) =>
      memory.call('morula_crossings', ...bodies, list, capacity, count), 2);
  }

  function distance(a, b, {tolerance = 0, stopAbove = Infinity, stopBelow = 0, pairTests, budgetMs} = {}) {
    const bodies = handlesOf(a, b);
    return memory.withBlock(136, (at) => {
      // The result, 80 bytes; then the options, 48; then whether the result is complete.
      memory.get('morula_distance_options_defaults', at + 80, 48);
      [tolerance, stopAbove, stopBelow].forEach((number, i) => memory.data.setFloat64(at + 88 + 8 * i, number, true));
      budgetOf(pairTests, budgetMs).forEach((number, i) => memory.data.setBigInt64(at + 112 + 8 * i, number, true));
      memory.call('morula_distance_bounds', ...bodies, at + 80, at, at + 128);
      const data = memory.data;
      return {
        lower: data.getFloat64(at, true),
        upper: data.getFloat64(at + 8, true),
        pointA: vector(at + 16),
        pointB: vector(at + 40),
        facetA: data.getUint32(at + 64, true),
        facetB: data.getUint32(at + 68, true),
        crossing: data.getInt32(at + 72, true) === 1,
        certified: data.getInt32(at + 76, true) === 1,
        complete: data.getInt32(at + 128, true) === 1,
      };
    });
  }

  function hitAt(at) {
    const facet = memory.data.getUint32(at + 80, true);
    if (facet === missing) return null;
    return {
      t: memory.data.getFloat64(at, true),
      point: vector(at + 8),
      barycentric: vector(at + 32),
      normal: vector(at + 56),
      facet,
    };
  }

  function firstHits(body, rays, tEnd = Infinity, {budgetMs} = {}) {
    const of = requireKind(body, Body, 'body');
    const count = requireMultiple(rays, 6, 'rays');
    const numbers = new Float64Array(7 * count);
    for (let i = 0; i < count; ++i) {
      for (let k = 0; k < 6; ++k) numbers[7 * i + k] = rays[6 * i + k];
      numbers[7 * i + 6] = tEnd;
    }
    return memory.withNumbers(Float64Array, numbers, (begin) => memory.withBlock(hitSize * count, (hits) => {
      const done = inSlices(count, budgetMs, (first, some) =>
        memory.call('morula_first_hits', of, begin + 56 * first, some, hits + hitSize * first));
      return Array.from({length: done}, (_, i) => hitAt(hits + hitSize * i));
    }));
  }
  function firstHit(body, origin, direction, tEnd) {
    requireLength(origin, 3, 'origin');
    requireLength(direction, 3, 'direction');
    return firstHits(body, [origin, direction].flatMap((numbers) => Array.from(numbers)), tEnd)[0];
  }

  function locate(body, points, {budgetMs} = {}) {
    const of = requireKind(body, Body, 'body');
    const count = requireMultiple(points, 3, 'points');
    return memory.withNumbers(Float64Array, points, (begin) => memory.withBlock(locationSize * count, (places) => {
      const done = inSlices(count, budgetMs, (first, some) =>
        memory.call('morula_locate', of, begin + 24 * first, some, places + locationSize * first));
      return Array.from({length: done}, (_, i) => {
        const at = places + locationSize * i;
        return {
          inside: memory.data.getInt32(at, true) === 1,
          onSurface: memory.data.getInt32(at + 4, true) === 1,
          winding: memory.data.getInt32(at + 8, true),
        };
      });
    }));
  }

  return {overlap, ContactQuery, crossings, distance, firstHit, firstHits, locate};
}
