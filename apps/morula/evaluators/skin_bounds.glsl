// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere and box of a cluster of a skinned mesh from the transforms of its bones, in GLSL from 3.00 ES (highp) or 3.30
// on. They contain the vertices of the cluster as morph targets and then linear blend skinning move them.
//
// The rest data: in the file, numbers in this order. Structures as in a std430 buffer.
struct SkinBoundsCluster {
  vec3 center;
  float radius;
  vec3 half_extent;
  float overhang, growth, rounding;
  uint first_row, row_count;
};
struct SkinBoundsRow {
  uint bone;
  float weight, weight_stray, moment_stray;
  vec3 center;
  float radius;
};
struct SkinBoundsTarget {
  vec3 shift;
  float radius;
  vec3 half_extent;
  uint target;
};
// Define these three: rest data by number, and the matrix of a bone relative to rest, which is the global matrix of the
// joint times its inverse bind matrix.
SkinBoundsCluster skin_bounds_cluster(uint cluster);
SkinBoundsRow skin_bounds_row(uint row);
mat4 skin_bounds_bone(uint bone);

struct SkinBounds {
  vec4 sphere;  // center and radius
  vec3 lower;   // box
  vec3 upper;
};

// A bound of the factor by which a matrix lengthens vectors.
float skin_bounds_stretch(mat4 m) {
  vec3 x = vec3(m[0]), y = vec3(m[1]), z = vec3(m[2]);
  float xy = abs(dot(x, y)), yz = abs(dot(y, z)), zx = abs(dot(z, x));
  return sqrt(max(dot(x, x) + xy + zx, max(dot(y, y) + xy + yz, dot(z, z) + yz + zx)));
}

// Sums of squares of the rows of its linear part.
vec3 skin_bounds_squares(mat4 m) {
  vec3 x = vec3(m[0]), y = vec3(m[1]), z = vec3(m[2]);
  return x * x + y * y + z * z;
}

// The image of a box around 0, by its half sides.
vec3 skin_bounds_boxed(mat4 m, vec3 h) {
  return abs(vec3(m[0])) * h.x + abs(vec3(m[1])) * h.y + abs(vec3(m[2])) * h.z;
}

float skin_bounds_largest(vec3 v) { return max(v.x, max(v.y, v.z)); }

// How morph targets move a cluster.
struct SkinBoundsMorph {
  vec3 shift;
  float spread;
  vec3 half_extent;
  float travel;
};
SkinBoundsMorph skin_bounds_no_morph() {
  SkinBoundsMorph none;
  none.shift = none.half_extent = vec3(0.0f);
  none.spread = none.travel = 0.0f;
  return none;
}
// Adds a target of the cluster. weight: that of the morph target t.target, less its weight in the mesh at rest.
SkinBoundsMorph skin_bounds_add_target(SkinBoundsMorph m, SkinBoundsTarget t, float weight) {
  m.shift += weight * t.shift;
  m.spread += abs(weight) * t.radius;
  m.half_extent += abs(weight) * t.half_extent;
  m.travel += abs(weight) * (skin_bounds_largest(abs(t.shift)) + t.radius);
  return m;
}

// reach: that of the rest data. morph: the sum of all targets of the cluster.
SkinBounds skin_bounds_morphed(uint cluster, float reach, SkinBoundsMorph morph) {
  SkinBoundsCluster c = skin_bounds_cluster(cluster);
  if (c.row_count == 0u) return SkinBounds(vec4(0.0f), vec3(0.0f), vec3(0.0f));
  mat4 main_bone = skin_bounds_bone(skin_bounds_row(c.first_row).bone), blend = main_bone;
  vec3 middle = c.center + morph.shift, half_extent = c.half_extent + morph.half_extent;
  vec3 base = vec3(main_bone * vec4(middle, 1.0f)), center = base, low = vec3(3e38f), high = vec3(-3e38f);
  vec4 stray = vec4(0.0f);
  float rest_radius = c.radius + morph.spread, hull = 0.0f, size = reach, row_sum = 1.0f;
  for (uint i = 0u; i < c.row_count; ++i) {
    SkinBoundsRow row = skin_bounds_row(c.first_row + i);
    mat4 bone = skin_bounds_bone(row.bone), apart = bone - main_bone;
    vec3 shift = vec3(bone * vec4(middle, 1.0f)) - base;
    float moment = row.moment_stray + row.weight_stray * morph.spread;
    center += row.weight * shift;
    blend += row.weight * apart;
    stray += row.weight_stray * vec4(abs(shift), length(shift)) +
             vec4(moment * sqrt(dot(skin_bounds_squares(apart), vec3(1.0f))));
  }
  for (uint i = 0u; i < c.row_count; ++i) {
    SkinBoundsRow row = skin_bounds_row(c.first_row + i);
    mat4 bone = skin_bounds_bone(row.bone);
    float radius = row.radius + morph.spread;
    vec3 at = vec3(bone * vec4(row.center + morph.shift, 1.0f)), side = sqrt(skin_bounds_squares(bone)) * radius;
    low = min(low, at - side);
    high = max(high, at + side);
    hull = max(hull, length(at - center) + skin_bounds_stretch(bone) * radius);
    float sum = skin_bounds_largest(skin_bounds_boxed(bone, vec3(1.0f)));
    size = max(size, reach * sum + skin_bounds_largest(abs(vec3(bone[3]))));
    row_sum = max(row_sum, sum);
  }
  float pad = c.rounding * (size + morph.travel * row_sum);
  float radius = min(skin_bounds_stretch(blend) * rest_radius + stray.w, (1.0f + 2.0f * c.overhang) * hull);
  vec3 half_size = min(sqrt(skin_bounds_squares(blend)) * rest_radius, skin_bounds_boxed(blend, half_extent));
  half_size = (half_size + vec3(stray)) * c.growth;
  vec3 over = c.overhang * (high - low);
  return SkinBounds(vec4(center, radius * c.growth + pad), max(center - half_size, low - over) - vec3(pad),
                    min(center + half_size, high + over) + vec3(pad));
}

// The same without morph targets, or with all of them at rest.
SkinBounds skin_bounds(uint cluster, float reach) {
  return skin_bounds_morphed(cluster, reach, skin_bounds_no_morph());
}
