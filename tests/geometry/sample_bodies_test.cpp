// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/triangle.hpp>
#include <numbers>
#include <stdexcept>
#include <string>

namespace morula {
namespace {

std::vector<std::string> names() {
  return {sample_body_names().begin(), sample_body_names().end()};
}

// Longest side over shortest altitude: 1.15 when equilateral.
double worst_aspect(const Mesh& mesh) {
  double worst = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const Triangle t = mesh.corners(f);
    const double squared =
        std::max({squared_distance(t[0], t[1]), squared_distance(t[1], t[2]), squared_distance(t[2], t[0])});
    worst = std::max(worst, squared / length(area_vector(t)));
  }
  return worst;
}

// Clearly: facets in one plane, as along a tube, do not count.
bool segment_crosses(const Vec3& p, const Vec3& q, const Triangle& t) {
  const auto side = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const double six_volumes = dot(a - d, cross(b - d, c - d));
    return six_volumes > 1e-12 ? 1 : six_volumes < -1e-12 ? -1 : 0;
  };
  if (side(t[0], t[1], t[2], p) * side(t[0], t[1], t[2], q) != -1) return false;
  const int s = side(p, q, t[0], t[1]);
  return s != 0 && s == side(p, q, t[1], t[2]) && s == side(p, q, t[2], t[0]);
}

std::size_t crossing_facets(const Mesh& mesh) {
  std::size_t count = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    for (std::size_t g = 0; g < mesh.facet_count(); ++g) {
      bool share = false;
      for (const std::uint32_t v : mesh.facets[f])
        for (const std::uint32_t w : mesh.facets[g]) share = share || v == w;
      if (share) continue;
      const Triangle a = mesh.corners(f), b = mesh.corners(g);
      for (int side = 0; side < 3; ++side) count += segment_crosses(a[side], a[(side + 1) % 3], b);
    }
  return count;
}

TEST(SampleBodies, are_closed_oriented_manifold_and_clean) {
  for (const std::string& name : names())
    for (const int resolution : {3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 16, 17, 23, 31, 48, 60}) {
      SCOPED_TRACE(name + " " + std::to_string(resolution));
      const Mesh mesh = sample_body(name, resolution);
      EXPECT_NO_THROW(require_usable(mesh));
      const MeshReport report = inspect(mesh);
      EXPECT_TRUE(report.closed && report.oriented && report.manifold);
      EXPECT_GT(report.volume, 0);
      EXPECT_EQ(report.component_count, name == "two" ? 2u : 1u);
      EXPECT_EQ(report.degenerate_facets + report.duplicate_facets, 0u);
      EXPECT_EQ(report.duplicate_vertices + report.unused_vertices, 0u);
      // Euler: V − E + F is 2 for each ball and 0 for each ring.
      const std::size_t edges = report.facet_count * 3 / 2;
      EXPECT_EQ(report.vertex_count + report.facet_count - edges, name == "torus" || name == "two" ? 0u : 2u);
    }
}

TEST(SampleBodies, have_well_shaped_facets) {
  for (const std::string& name : names())
    for (const int resolution : {24, 48, 96})
      EXPECT_LT(worst_aspect(sample_body(name, resolution)), 3.5) << name << " " << resolution;
  // The coarsest are no needles either.
  for (const std::string& name : names()) EXPECT_LT(worst_aspect(sample_body(name, 3)), 14) << name;
}

TEST(SampleBodies, do_not_run_into_themselves) {
  for (const std::string& name : names())
    for (const int resolution : {3, 4, 5, 8, 12, 20}) {
      const Mesh mesh = sample_body(name, resolution);
      EXPECT_EQ(crossing_facets(mesh), 0u) << name << " " << resolution;
    }
}

TEST(SampleBodies, are_about_the_documented_size) {
  for (const std::string& name : names()) {
    const std::size_t facets = sample_body(name).facet_count();
    EXPECT_GE(facets, 2600u) << name;
    EXPECT_LE(facets, 5800u) << name;
    const double growth = static_cast<double>(sample_body(name, 192).facet_count()) / static_cast<double>(facets);
    EXPECT_NEAR(growth, 16, 1.5) << name;
    const Vec3 size = bounding_box(sample_body(name)).extent();
    EXPECT_GE(size.x, std::max(size.y, size.z) * 0.9) << name;
    EXPECT_LT(max_norm(bounding_box(sample_body(name)).center()), 0.55) << name;
  }
}

TEST(SampleBodies, have_the_volumes_of_their_shapes) {
  constexpr double pi = std::numbers::pi;
  EXPECT_NEAR(signed_volume(sample_body("bar")), 4, 1e-12);
  EXPECT_NEAR(surface_area(sample_body("bar")), 18, 1e-11);
  EXPECT_NEAR(signed_volume(sample_body("plate")), 0.8, 1e-12);
  const double capsule = pi * 0.25 * 2 + 4.0 / 3 * pi * 0.125, ring = 2 * pi * pi * 0.35 * 0.35;
  EXPECT_NEAR(signed_volume(sample_body("capsule", 192)) / capsule, 1, 1e-3);
  EXPECT_NEAR(signed_volume(sample_body("torus", 192)) / ring, 1, 2e-3);
  EXPECT_NEAR(signed_volume(sample_body("two", 192)) / (2 * 2 * pi * pi * 0.09), 1, 3e-3);
}

TEST(SampleBodies, capsule_vertices_lie_on_the_capsule) {
  for (const Vec3& p : sample_body("capsule", 21).positions) {
    const Vec3 on_axis{std::clamp(p.x, -1.0, 1.0), 0, 0};
    EXPECT_NEAR(distance(p, on_axis), 0.5, 1e-15);
  }
}

// The promise "deterministic to the bit", between machines and over time.
TEST(SampleBodies, bits_are_the_golden_ones) {
  const std::map<std::string, std::uint64_t> golden{{"bar", 0x17dbc82799c83c48u},  {"capsule", 0xf9adc8d57cdb909au},
                                                    {"limb", 0xe4f524468d78185au}, {"torus", 0x1cc34d60897bf463u},
                                                    {"blob", 0xa5e53133e8ab0596u}, {"plate", 0x8b86e553baecf799u},
                                                    {"two", 0xc028c6565dfd6459u},  {"tool", 0xb24e9f641b4da6cdu},
                                                    {"hand", 0x91905c247af6fe8du}, {"vessel", 0x6bc76b441db4c6f4u}};
  for (const std::string& name : names()) EXPECT_EQ(mesh_hash(sample_body(name)), golden.at(name)) << name;
}

TEST(SampleBodies, refuse_unknown_names_and_resolutions) {
  const auto message = [](const char* name, int resolution) -> std::string {
    try {
      sample_body(name, resolution);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "nothing thrown";
  };
  EXPECT_EQ(
      message("cow", 48),
      "no sample body is called 'cow'; known are bar, capsule, limb, torus, blob, plate, two, tool, hand, vessel");
  EXPECT_EQ(message("bar", 2), "resolution 2 is not in 3…4096");
  EXPECT_EQ(message("bar", 4097), "resolution 4097 is not in 3…4096");
  EXPECT_EQ(message("bar", -1), "resolution -1 is not in 3…4096");
}

}  // namespace
}  // namespace morula
