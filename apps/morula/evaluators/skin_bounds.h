// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere and box of a cluster of a skinned mesh from the transforms of its bones, in C99 or C++. They contain the
// vertices of the cluster as morph targets and then linear blend skinning move them.
#ifndef MORULA_SKIN_BOUNDS_H
#define MORULA_SKIN_BOUNDS_H
#include <math.h>
#include <stdint.h>

// The rest data: in the file, numbers in this order.
typedef struct {
  float center[3], radius, half_extent[3], overhang, growth, rounding;
  uint32_t first_row, row_count;
} skin_bounds_cluster;
typedef struct {
  uint32_t bone;
  float weight, weight_stray, moment_stray, center[3], radius;
} skin_bounds_row;

typedef struct {
  float shift[3], radius, half_extent[3];
  uint32_t target;
} skin_bounds_target;

typedef struct {
  float center[3], radius;   // sphere
  float lower[3], upper[3];  // box
} skin_bounds;

static inline float skin_bounds_length(const float* v) {
  return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}
static inline float skin_bounds_image(const float* row, const float* p) {
  return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
}
// A bound of the factor by which a matrix lengthens vectors.
static inline float skin_bounds_stretch(const float* m) {
  float xx = m[0] * m[0] + m[4] * m[4] + m[8] * m[8], xy = fabsf(m[0] * m[1] + m[4] * m[5] + m[8] * m[9]);
  float yy = m[1] * m[1] + m[5] * m[5] + m[9] * m[9], yz = fabsf(m[1] * m[2] + m[5] * m[6] + m[9] * m[10]);
  float zz = m[2] * m[2] + m[6] * m[6] + m[10] * m[10], zx = fabsf(m[2] * m[0] + m[6] * m[4] + m[10] * m[8]);
  return sqrtf(fmaxf(xx + xy + zx, fmaxf(yy + xy + yz, zz + yz + zx)));
}

// How morph targets move a cluster: 0 for none.
typedef struct {
  float shift[3], spread, half_extent[3], travel;
} skin_bounds_morph;

// Adds a target of the cluster. weight: that of the morph target t->target, less its weight in the mesh at rest.
static inline void skin_bounds_add_target(skin_bounds_morph* m, const skin_bounds_target* t, float weight) {
  float size = fabsf(weight), farthest = 0;
  for (int k = 0; k < 3; ++k) {
    m->shift[k] += weight * t->shift[k];
    m->half_extent[k] += size * t->half_extent[k];
    farthest = fmaxf(farthest, fabsf(t->shift[k]));
  }
  m->spread += size * t->radius;
  m->travel += size * (farthest + t->radius);
}

// rows: all rows of the rest data. reach: that of the rest data. bones: 12 floats for each bone, the rows of its 3 x 4
// matrix relative to rest: the global matrix of the joint times its inverse bind matrix. morph: the sum of all targets
// of the cluster.
static inline skin_bounds skin_bounds_morphed(const skin_bounds_cluster* c, const skin_bounds_row* rows, float reach,
                                              const float* bones, const skin_bounds_morph* morph) {
  skin_bounds out = {{0}, 0, {0}, {0}};
  if (c->row_count == 0) return out;
  const float* main_bone = bones + 12 * rows[c->first_row].bone;
  float blend[12], middle[3], base[3], stray[4] = {0}, hull = 0, size = reach, row_sum = 1, low[3], high[3];
  float rest_radius = c->radius + morph->spread;
  for (int k = 0; k < 12; ++k) blend[k] = main_bone[k];
  for (int k = 0; k < 3; ++k) middle[k] = c->center[k] + morph->shift[k];
  for (int k = 0; k < 3; ++k) out.center[k] = base[k] = skin_bounds_image(main_bone + 4 * k, middle);
  for (uint32_t i = 0; i < c->row_count; ++i) {
    const skin_bounds_row* row = rows + c->first_row + i;
    const float* bone = bones + 12 * row->bone;
    float shift[3], squares = 0, moment;
    for (int k = 0; k < 12; ++k) {
      float apart = bone[k] - main_bone[k];
      blend[k] += row->weight * apart;
      squares += k % 4 == 3 ? 0 : apart * apart;
    }
    moment = (row->moment_stray + row->weight_stray * morph->spread) * sqrtf(squares);
    for (int k = 0; k < 3; ++k) {
      shift[k] = skin_bounds_image(bone + 4 * k, middle) - base[k];
      out.center[k] += row->weight * shift[k];
      stray[k] += row->weight_stray * fabsf(shift[k]) + moment;
    }
    stray[3] += row->weight_stray * skin_bounds_length(shift) + moment;
  }
  for (uint32_t i = 0; i < c->row_count; ++i) {
    const skin_bounds_row* row = rows + c->first_row + i;
    const float* bone = bones + 12 * row->bone;
    float place[3], apart[3], sum = 0, moved = 0, radius = row->radius + morph->spread;
    for (int k = 0; k < 3; ++k) place[k] = row->center[k] + morph->shift[k];
    for (int k = 0; k < 3; ++k) {
      const float* m = bone + 4 * k;
      float at = skin_bounds_image(m, place), side = skin_bounds_length(m) * radius;
      low[k] = i == 0 ? at - side : fminf(low[k], at - side);
      high[k] = i == 0 ? at + side : fmaxf(high[k], at + side);
      apart[k] = at - out.center[k];
      sum = fmaxf(sum, fabsf(m[0]) + fabsf(m[1]) + fabsf(m[2]));
      moved = fmaxf(moved, fabsf(m[3]));
    }
    size = fmaxf(size, reach * sum + moved);
    row_sum = fmaxf(row_sum, sum);
    hull = fmaxf(hull, skin_bounds_length(apart) + skin_bounds_stretch(bone) * radius);
  }
  float pad = c->rounding * (size + morph->travel * row_sum), h[3];
  out.radius =
      fminf(skin_bounds_stretch(blend) * rest_radius + stray[3], (1 + 2 * c->overhang) * hull) * c->growth + pad;
  for (int k = 0; k < 3; ++k) h[k] = c->half_extent[k] + morph->half_extent[k];
  for (int k = 0; k < 3; ++k) {
    const float* m = blend + 4 * k;
    float boxed = fabsf(m[0]) * h[0] + fabsf(m[1]) * h[1] + fabsf(m[2]) * h[2];
    float half = (fminf(skin_bounds_length(m) * rest_radius, boxed) + stray[k]) * c->growth;
    float over = c->overhang * (high[k] - low[k]);
    out.lower[k] = fmaxf(out.center[k] - half, low[k] - over) - pad;
    out.upper[k] = fminf(out.center[k] + half, high[k] + over) + pad;
  }
  return out;
}

// The same without morph targets, or with all of them at rest.
static inline skin_bounds skin_bounds_of(const skin_bounds_cluster* c, const skin_bounds_row* rows, float reach,
                                         const float* bones) {
  skin_bounds_morph none = {{0}, 0, {0}, 0};
  return skin_bounds_morphed(c, rows, reach, bones, &none);
}
#endif
