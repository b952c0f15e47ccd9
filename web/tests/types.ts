// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Compiled, not run: the types as a page uses them.
import {load, MorulaError, type Body, type Morula, type Tree} from 'morula';
import {load as loadInline} from 'morula/inline';

export async function page(positions: Float32Array, facets: Uint32Array): Promise<number> {
  const morula: Morula = await load({variant: 'runtime', simd: false});
  await loadInline();
  using mesh = new morula.Mesh(positions, facets);
  const tree = morula.build(mesh, {quality: 'fast', progress: (share) => share < 1});
  const body: Body = new morula.Body(mesh, tree, {rules: ['exact', 'wrapped'], precision: 'double'});
  body.positions[0] = 1;
  body.update();
  body.update([0, 0, 0]);
  const hit = morula.firstHit(body, [0, 0, 1], [0, 0, -1]);
  // @ts-expect-error a miss is null
  hit.facet;
  // @ts-expect-error no such method of generators
  morula.build(mesh, {method: 'magic'});
  // @ts-expect-error trees are built or read
  new morula.Tree();
  const later: Promise<Tree> = morula.buildAsync(mesh, {progress: null, signal: new AbortController().signal});
  (await later).free();
  for (const pair of morula.proximity(body, null, {distance: 0.1, budgetMs: 2})) if (pair.kind === 'edge-edge') pair.weightsA[1];
  // @ts-expect-error a distance is required
  new morula.PairQuery().near(body, body, {});
  const query = new morula.ContactQuery();
  try {
    for (const contact of query.run(body, body, {budgetMs: 1})) if (contact.finished) return contact.point[2];
  } catch (error) {
    if (error instanceof MorulaError && error.code === 'rejected') return 0;
  }
  return hit?.t ?? body.spheres().length;
}
