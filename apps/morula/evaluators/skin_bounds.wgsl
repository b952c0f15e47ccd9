// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere and box of a cluster of a skinned mesh from the transforms of its bones, in WGSL. They contain the vertices of
// the cluster as morph targets and then linear blend skinning move them.
//
// The rest data: in the file, numbers in this order.
struct SkinBoundsCluster {
  center: vec3f,
  radius: f32,
  half_extent: vec3f,
  overhang: f32,
  growth: f32,
  rounding: f32,
  first_row: u32,
  row_count: u32,
}
struct SkinBoundsRow {
  bone: u32,
  weight: f32,
  weight_stray: f32,
  moment_stray: f32,
  center: vec3f,
  radius: f32,
}
struct SkinBoundsTarget {
  shift: vec3f,
  radius: f32,
  half_extent: vec3f,
  target_number: u32,
}
// Declare the rest data, and the matrices relative to rest: the global matrix of each joint times its inverse bind
// matrix. For example:
//   @group(0) @binding(0) var<storage, read> skin_bounds_clusters: array<SkinBoundsCluster>;
//   @group(0) @binding(1) var<storage, read> skin_bounds_rows: array<SkinBoundsRow>;
//   @group(0) @binding(2) var<storage, read> skin_bounds_bones: array<mat4x4f>;

struct SkinBounds {
  sphere: vec4f,  // center and radius
  lower: vec3f,  // box
  upper: vec3f,
}

// A bound of the factor by which a matrix lengthens vectors.
fn skin_bounds_stretch(m: mat4x4f) -> f32 {
  let x = m[0].xyz;
  let y = m[1].xyz;
  let z = m[2].xyz;
  let xy = abs(dot(x, y));
  let yz = abs(dot(y, z));
  let zx = abs(dot(z, x));
  return sqrt(max(dot(x, x) + xy + zx, max(dot(y, y) + xy + yz, dot(z, z) + yz + zx)));
}

// Sums of squares of the rows of its linear part.
fn skin_bounds_squares(m: mat4x4f) -> vec3f {
  return m[0].xyz * m[0].xyz + m[1].xyz * m[1].xyz + m[2].xyz * m[2].xyz;
}

// The image of a box around 0, by its half sides.
fn skin_bounds_boxed(m: mat4x4f, h: vec3f) -> vec3f {
  return abs(m[0].xyz) * h.x + abs(m[1].xyz) * h.y + abs(m[2].xyz) * h.z;
}

fn skin_bounds_largest(v: vec3f) -> f32 {
  return max(v.x, max(v.y, v.z));
}

// How morph targets move a cluster: SkinBoundsMorph() for none.
struct SkinBoundsMorph {
  shift: vec3f,
  spread: f32,
  half_extent: vec3f,
  travel: f32,
}
// Adds a target of the cluster. weight: that of the morph target t.target_number, less its weight in the mesh at rest.
fn skin_bounds_add_target(morph: SkinBoundsMorph, t: SkinBoundsTarget, weight: f32) -> SkinBoundsMorph {
  var m = morph;
  m.shift += weight * t.shift;
  m.spread += abs(weight) * t.radius;
  m.half_extent += abs(weight) * t.half_extent;
  m.travel += abs(weight) * (skin_bounds_largest(abs(t.shift)) + t.radius);
  return m;
}

// reach: that of the rest data. morph: the sum of all targets of the cluster.
fn skin_bounds_morphed(cluster: u32, reach: f32, morph: SkinBoundsMorph) -> SkinBounds {
  let c = skin_bounds_clusters[cluster];
  if (c.row_count == 0u) {
    return SkinBounds(vec4f(0.0f), vec3f(0.0f), vec3f(0.0f));
  }
  let main_bone = skin_bounds_bones[skin_bounds_rows[c.first_row].bone];
  let middle = c.center + morph.shift;
  let half_extent = c.half_extent + morph.half_extent;
  let rest_radius = c.radius + morph.spread;
  let base = (main_bone * vec4f(middle, 1.0f)).xyz;
  var center = base;
  var blend = main_bone;
  var stray = vec4f(0.0f);
  for (var i = 0u; i < c.row_count; i += 1u) {
    let row = skin_bounds_rows[c.first_row + i];
    let bone = skin_bounds_bones[row.bone];
    let apart = bone - main_bone;
    let shift = (bone * vec4f(middle, 1.0f)).xyz - base;
    let moment = row.moment_stray + row.weight_stray * morph.spread;
    center += row.weight * shift;
    blend += row.weight * apart;
    stray += row.weight_stray * vec4f(abs(shift), length(shift));
    stray += vec4f(moment * sqrt(dot(skin_bounds_squares(apart), vec3f(1.0f))));
  }
  var low = vec3f(3e38f);
  var high = vec3f(-3e38f);
  var hull = 0.0f;
  var size = reach;
  var row_sum = 1.0f;
  for (var i = 0u; i < c.row_count; i += 1u) {
    let row = skin_bounds_rows[c.first_row + i];
    let bone = skin_bounds_bones[row.bone];
    let radius = row.radius + morph.spread;
    let at = (bone * vec4f(row.center + morph.shift, 1.0f)).xyz;
    let side = sqrt(skin_bounds_squares(bone)) * radius;
    low = min(low, at - side);
    high = max(high, at + side);
    hull = max(hull, length(at - center) + skin_bounds_stretch(bone) * radius);
    let sum = skin_bounds_largest(skin_bounds_boxed(bone, vec3f(1.0f)));
    size = max(size, reach * sum + skin_bounds_largest(abs(bone[3].xyz)));
    row_sum = max(row_sum, sum);
  }
  let pad = c.rounding * (size + morph.travel * row_sum);
  let radius = min(skin_bounds_stretch(blend) * rest_radius + stray.w, (1.0f + 2.0f * c.overhang) * hull);
  let inner = min(sqrt(skin_bounds_squares(blend)) * rest_radius, skin_bounds_boxed(blend, half_extent));
  let half_size = (inner + stray.xyz) * c.growth;
  let over = c.overhang * (high - low);
  return SkinBounds(vec4f(center, radius * c.growth + pad), max(center - half_size, low - over) - vec3f(pad),
                    min(center + half_size, high + over) + vec3f(pad));
}

// The same without morph targets, or with all of them at rest.
fn skin_bounds(cluster: u32, reach: f32) -> SkinBounds {
  return skin_bounds_morphed(cluster, reach, SkinBoundsMorph());
}
