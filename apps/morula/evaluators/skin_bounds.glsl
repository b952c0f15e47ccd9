// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere and box of a cluster of a skinned mesh from the transforms of its bones, in GLSL from 3.00 ES (highp) or 3.30
// on. They contain the vertices of the cluster as linear blend skinning moves them.
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

// reach: that of the rest data.
SkinBounds skin_bounds(uint cluster, float reach) {
  SkinBoundsCluster c = skin_bounds_cluster(cluster);
  if (c.row_count == 0u) return SkinBounds(vec4(0.0f), vec3(0.0f), vec3(0.0f));
  mat4 main_bone = skin_bounds_bone(skin_bounds_row(c.first_row).bone), blend = main_bone;
  vec3 base = vec3(main_bone * vec4(c.center, 1.0f)), center = base, low = vec3(3e38f), high = vec3(-3e38f);
  vec4 stray = vec4(0.0f);
  float hull = 0.0f, size = reach;
  for (uint i = 0u; i < c.row_count; ++i) {
    SkinBoundsRow row = skin_bounds_row(c.first_row + i);
    mat4 bone = skin_bounds_bone(row.bone), apart = bone - main_bone;
    vec3 shift = vec3(bone * vec4(c.center, 1.0f)) - base;
    center += row.weight * shift;
    blend += row.weight * apart;
    stray += row.weight_stray * vec4(abs(shift), length(shift)) +
             vec4(row.moment_stray * sqrt(dot(skin_bounds_squares(apart), vec3(1.0f))));
  }
  for (uint i = 0u; i < c.row_count; ++i) {
    SkinBoundsRow row = skin_bounds_row(c.first_row + i);
    mat4 bone = skin_bounds_bone(row.bone);
    vec3 at = vec3(bone * vec4(row.center, 1.0f)), side = sqrt(skin_bounds_squares(bone)) * row.radius;
    low = min(low, at - side);
    high = max(high, at + side);
    hull = max(hull, length(at - center) + skin_bounds_stretch(bone) * row.radius);
    float turned = skin_bounds_largest(skin_bounds_boxed(bone, vec3(reach)));
    size = max(size, turned + skin_bounds_largest(abs(vec3(bone[3]))));
  }
  float pad = c.rounding * size;
  float radius = min(skin_bounds_stretch(blend) * c.radius + stray.w, (1.0f + 2.0f * c.overhang) * hull);
  vec3 half_size = min(sqrt(skin_bounds_squares(blend)) * c.radius, skin_bounds_boxed(blend, c.half_extent));
  half_size = (half_size + vec3(stray)) * c.growth;
  vec3 over = c.overhang * (high - low);
  return SkinBounds(vec4(center, radius * c.growth + pad), max(center - half_size, low - over) - vec3(pad),
                    min(center + half_size, high + over) + vec3(pad));
}
