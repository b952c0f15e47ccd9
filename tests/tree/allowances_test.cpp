// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Every check of validate and certify at its limit: the smallest fault that it has to name. scripts/mutants takes the
// checks away, one after the other.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/tree/cover.hpp>
#include <support/meshes.hpp>

namespace morula {
namespace {

// Facet 0 is cut at its first edge into the patches of two leaves, facet 1 is a segment and whole, facet 2 is whole.
struct Cut {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {3, 3, 0}, {0, 1, 3}}};
  CoveredTree model;

  Cut() {
    const Sphere ball{{0, 0, 0}, 2};
    model.tree.branching = 2;
    model.tree.append_level({}, std::vector<Sphere>{ball});
    model.tree.append_level(std::vector<std::uint32_t>{2}, std::vector<Sphere>{ball, ball});
    Cover& c = model.cover;
    c.vertex_count = 4;
    c.facet_count = 3;
    c.cut_points = {{{0, 1, 1}, {0.7, 0.3, 0}}};
    c.patch_facet = {0, 1, 0, 2};
    c.corner_begin = {0, 3, 6, 9, 12};
    c.corners = {0, 4, 2, 3, 3, 0, 4, 1, 2, 0, 1, 3};
    c.region_begin = {0, 0, 2};
    c.region_end = {4, 2, 4};
  }
  std::string faults() const {
    std::string all;
    for (const std::string& f : validate(mesh, model)) all += f + "\n";
    return all;
  }
};

template <class Spoil>
std::string faults_after(const Spoil& spoil) {
  Cut cut;
  spoil(cut.model.cover);
  return cut.faults();
}
bool mentions(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

TEST(Validate, finds_no_fault_in_the_cut_that_the_others_spoil) {
  EXPECT_EQ(Cut().faults(), "");
}

TEST(Validate, names_a_gap_and_an_overlap_of_a_ten_thousand_millionth_of_a_facet) {
  for (const double off : {1e-10, -1e-10, 1e-6, -1e-6})
    EXPECT_TRUE(mentions(faults_after([&](Cover& c) {
                           c.cut_points.push_back({{0, 1, 1}, {0.7 - off, 0.3 + off, 0}});
                           c.corners[6] = 5;
                         }),
                         "instead of the whole"))
        << off;
}

// A dent in one patch that another one fills: areas add up, but a patch that is not convex is not the hull of its
// corners.
TEST(Validate, names_a_dent_that_is_filled) {
  for (const double deep : {1e-10, 1e-6, 0.1})
    EXPECT_TRUE(mentions(faults_after([&](Cover& c) {
                           c.cut_points = {{{0, 1, 2}, {0.7 - deep, 0.3, deep}}};
                           c.patch_facet = {0, 1, 0, 2};
                           c.corner_begin = {0, 4, 7, 10, 13};
                           c.corners = {0, 4, 1, 2, 3, 3, 0, 0, 1, 4, 0, 1, 3};
                         }),
                         "not convex"))
        << deep;
}

TEST(Validate, names_a_patch_that_runs_backwards_over_another) {
  // Whole, whole again and once backwards: areas add up.
  EXPECT_TRUE(mentions(faults_after([](Cover& c) {
                         c.patch_facet = {0, 1, 0, 0, 2};
                         c.corner_begin = {0, 3, 6, 9, 12, 15};
                         c.corners = {0, 1, 2, 3, 3, 0, 0, 1, 2, 0, 2, 1, 0, 1, 3};
                         c.region_begin = {0, 0, 2};
                         c.region_end = {5, 2, 5};
                       }),
                       "not convex"));
}

TEST(Validate, names_every_broken_size_and_index) {
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.vertex_count = 5; }), "another number of vertices"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.facet_count = 4; }), "another number of facets"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.corner_begin.push_back(12); }), "does not span"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.corner_begin.front() = 1; }), "does not span"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.corners.push_back(0); }), "does not span"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.region_begin.push_back(0); }), "another number of nodes"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.region_end.push_back(4); }), "another number of nodes"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.corner_begin[1] = 4; }), "patch 1 has fewer than 3 corners"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.corner_begin[1] = 2; }), "patch 0 has fewer than 3 corners"));
  // 0xffffffff + 3 is 2 in 32 bits.
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.corner_begin[1] = ~0u; }), "patch 1 has fewer than 3 corners"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.patch_facet[3] = 3; }), "patch 3 lies on facet 3 of 3"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.corners[1] = 5; }), "neither a vertex nor a cut point"));
}

TEST(Validate, names_every_bad_cut_point) {
  EXPECT_TRUE(
      mentions(faults_after([](Cover& c) { c.cut_points[0].vertex[2] = 4; }), "cut point 0 refers to vertex 4 of 4"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.cut_points[0].weight = {1.5, -0.5, 0}; }), "not in 0"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.cut_points[0].weight = {0.6, 0.6, -0.2}; }), "not in 0"));
  for (const double off : {2e-12, -2e-12, 1e-9, -1e-9})
    EXPECT_TRUE(mentions(faults_after([&](Cover& c) { c.cut_points[0].weight[1] += off; }), "do not add up to 1"))
        << off;
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.cut_points[0].vertex = {0, 3, 3}; }), "off its facet 0"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.corners[1] = 3; }), "off its facet 0"));
}

TEST(Validate, names_a_facet_without_area_that_is_not_one_whole_patch) {
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.corners[5] = 3; }), "facet 1 add up"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.patch_facet[1] = 2, c.corners[4] = 1; }), "facet 1 add up"));
}

TEST(Validate, names_every_region_that_is_not_its_childrens) {
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.region_begin[2] = 1; }), "do not follow one another"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.region_end[1] = 1; }), "do not follow one another"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.region_end[2] = 3; }), "not the union"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.region_end[0] = 3, c.region_end[2] = 3; }), "whole surface"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.region_begin[1] = c.region_begin[0] = 1; }), "whole surface"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.region_end[2] = 5; }), "beyond the last patch"));
  EXPECT_TRUE(mentions(faults_after([](Cover& c) { c.region_end[1] = c.region_begin[2] = 0; }), "owns no patches"));
}

// The farthest corner is exactly 5 from the center.
TEST(Certify, tells_a_sphere_that_just_contains_from_one_that_just_does_not) {
  Mesh mesh{{{3, 4, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  Cover c;
  c.vertex_count = 3;
  c.facet_count = 1;
  c.patch_facet = {0};
  c.corner_begin = {0, 3};
  c.corners = {1, 0, 2};
  c.region_begin = {0};
  c.region_end = {1};
  const auto covered = [&](double radius) {
    return certify(c, mesh.positions, std::vector<Sphere>{{{0, 0, 0}, radius}}).covered;
  };
  EXPECT_TRUE(covered(5));
  EXPECT_FALSE(covered(std::nextafter(5.0, 0.0)));
  EXPECT_FALSE(covered(std::numeric_limits<double>::quiet_NaN()));
  for (Vec3& p : mesh.positions) {
    const double kept = p.y;
    p.y = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(covered(1e9));
    p.y = kept;
  }
  EXPECT_TRUE(covered(5));
}

// A sphere that has to grow contains its corners in real numbers, not only as doubles measure them.
TEST(Cover, pays_for_distances_taken_in_double) {
  using Wide = Vector3<long double>;
  Random random(1);
  const auto any = [&](double most) { return random.uniform(-most, most); };
  for (int round = 0; round < 5000; ++round) {
    Mesh mesh;
    for (int i = 0; i < 3; ++i) mesh.positions.push_back({any(1), any(1), any(1)});
    mesh.facets = {{0, 1, 2}};
    SphereTree tree;
    tree.append_level({}, std::vector<Sphere>{{{any(2), any(2), any(2)}, 0.01}});
    const CoveredTree model = cover(mesh, tree);
    const Sphere& s = model.tree.spheres[0];
    for (const Vec3& p : mesh.positions)
      ASSERT_LE(length(Wide(p) - Wide(s.center)), static_cast<long double>(s.radius)) << round;
  }
}

}  // namespace
}  // namespace morula
