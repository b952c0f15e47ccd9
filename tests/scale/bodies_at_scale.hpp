// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies of every size that double has, and a judge that squares without loss: in long double, whose exponents reach
// 16 times as far.
#pragma once

#include <limits>
#include <morula/tree/cover.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula::test {

static_assert(std::numeric_limits<long double>::max_exponent > 4 * std::numeric_limits<double>::max_exponent,
              "the judge of these tests needs a long double whose range is wider than that of double");

struct BodyAtScale {
  std::string name;
  Mesh mesh;
};
/// Cube, octahedron, ball, plate and capsule, of a size of about 1.
const std::vector<BodyAtScale>& unit_bodies();

/// 1e-300 … 1e300.
std::span<const double> sizes();
/// Of the size, its distance from the origin in sizes.
std::span<const double> offsets();

/// x ↦ size · (x + (offset, −offset, offset / 2)), rounded once per operation.
Vec3 placed(const Vec3& x, double size, double offset);
Mesh placed(Mesh mesh, double size, double offset);
std::string told(const std::string& name, double size, double offset);

/// Largest |coordinate| of the vertices that facets use.
double reach_of(const Mesh& mesh);
/// Is it refused by what takes squares and cubes?
bool is_out_of_range(const Mesh& mesh);

/// |x − c| in long double.
long double exact_distance(const Vec3& c, const std::array<long double, 3>& x);
std::array<long double, 3> exact_corner(const Cover& cover, std::uint32_t corner, std::span<const Vec3> positions);

/// How far the farthest corner of a node's region is from a point.
long double reach_from(const Vec3& center, const Cover& cover, std::uint32_t node, std::span<const Vec3> positions);
/// Do all spheres contain their regions? Anything that is not finite does not.
bool covers(const Cover& cover, std::span<const Vec3> positions, std::span<const Sphere> spheres);

/// Whether the call throws std::invalid_argument with a message that says what to do.
template <class Call>
bool is_refused(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return std::string(error.what()).find("scale") != std::string::npos ||
           std::string(error.what()).find("1e30") != std::string::npos;
  }
  return false;
}

}  // namespace morula::test
