// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere and box of a cluster of a skinned mesh from the transforms of its bones, in C99 or C++. They contain the
// vertices of the cluster as linear blend skinning moves them.
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

// rows: all rows of the rest data. reach: that of the rest data. bones: 12 floats for each bone, the rows of its 3 x 4
// matrix relative to rest: the global matrix of the joint times its inverse bind matrix.
static inline skin_bounds skin_bounds_of(const skin_bounds_cluster* c, const skin_bounds_row* rows, float reach,
                                         const float* bones) {
  skin_bounds out = {{0}, 0, {0}, {0}};
  if (c->row_count == 0) return out;
  const float* main_bone = bones + 12 * rows[c->first_row].bone;
  float blend[12], base[3], stray[4] = {0}, hull = 0, size = reach, low[3], high[3];
  for (int k = 0; k < 12; ++k) blend[k] = main_bone[k];
  for (int k = 0; k < 3; ++k) out.center[k] = base[k] = skin_bounds_image(main_bone + 4 * k, c->center);
  for (uint32_t i = 0; i < c->row_count; ++i) {
    const skin_bounds_row* row = rows + c->first_row + i;
    const float* bone = bones + 12 * row->bone;
    float shift[3], squares = 0;
    for (int k = 0; k < 12; ++k) {
      float apart = bone[k] - main_bone[k];
      blend[k] += row->weight * apart;
      squares += k % 4 == 3 ? 0 : apart * apart;
    }
    for (int k = 0; k < 3; ++k) {
      shift[k] = skin_bounds_image(bone + 4 * k, c->center) - base[k];
      out.center[k] += row->weight * shift[k];
      stray[k] += row->weight_stray * fabsf(shift[k]) + row->moment_stray * sqrtf(squares);
    }
    stray[3] += row->weight_stray * skin_bounds_length(shift) + row->moment_stray * sqrtf(squares);
  }
  for (uint32_t i = 0; i < c->row_count; ++i) {
    const skin_bounds_row* row = rows + c->first_row + i;
    const float* bone = bones + 12 * row->bone;
    float apart[3], turned = 0, moved = 0;
    for (int k = 0; k < 3; ++k) {
      const float* m = bone + 4 * k;
      float at = skin_bounds_image(m, row->center), side = skin_bounds_length(m) * row->radius;
      low[k] = i == 0 ? at - side : fminf(low[k], at - side);
      high[k] = i == 0 ? at + side : fmaxf(high[k], at + side);
      apart[k] = at - out.center[k];
      turned = fmaxf(turned, fabsf(m[0]) + fabsf(m[1]) + fabsf(m[2]));
      moved = fmaxf(moved, fabsf(m[3]));
    }
    size = fmaxf(size, reach * turned + moved);
    hull = fmaxf(hull, skin_bounds_length(apart) + skin_bounds_stretch(bone) * row->radius);
  }
  float pad = c->rounding * size;
  out.radius = fminf(skin_bounds_stretch(blend) * c->radius + stray[3], (1 + 2 * c->overhang) * hull) * c->growth + pad;
  for (int k = 0; k < 3; ++k) {
    const float *m = blend + 4 * k, *h = c->half_extent;
    float boxed = fabsf(m[0]) * h[0] + fabsf(m[1]) * h[1] + fabsf(m[2]) * h[2];
    float half = (fminf(skin_bounds_length(m) * c->radius, boxed) + stray[k]) * c->growth;
    float over = c->overhang * (high[k] - low[k]);
    out.lower[k] = fmaxf(out.center[k] - half, low[k] - over) - pad;
    out.upper[k] = fminf(out.center[k] + half, high[k] + over) + pad;
  }
  return out;
}
#endif
