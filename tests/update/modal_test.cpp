// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `modal` against a plain twin of the paper's formula, the certificate, and what it promises to cost.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/body.hpp>
#include <stdexcept>
#include <support/numbers.hpp>

#include "bodies.hpp"
#include "update/rules/mode_rows.hpp"

namespace morula {
using namespace detail;
namespace {

using test::Specimen;
using test::specimens;
using test::spheres_of;
using Bound = RuleOptions::ModalBound;
using Coordinates = std::vector<double>;

using test::infinity;
using test::nan;

UpdateOptions modal_options(Modes modes, Bound bound = Bound::gradient, std::vector<Rule> rules = {Rule::modal}) {
  UpdateOptions options{.rules = std::move(rules), .modes = std::move(modes)};
  options.details.modal_bound = bound;
  return options;
}

struct NamedModes {
  std::string name;
  Modes modes;
};
std::vector<NamedModes> all_modes(const Mesh& mesh) {
  return {{"smooth", test::smooth_modes(mesh, 6)},
          {"rough", test::rough_modes(mesh, 3)},
          {"linear", test::linear_modes(mesh)}};
}

Coordinates random_coordinates(std::size_t count, double scale, std::uint64_t seed) {
  Random random(seed);
  Coordinates q(count);
  for (double& x : q) x = random.uniform(-scale, scale);
  return q;
}

std::vector<Vec3> moved(const Mesh& mesh, const Modes& modes, const Coordinates& q) {
  std::vector<Vec3> positions(mesh.vertex_count());
  move_by_modes(modes, mesh.positions, q, positions);
  return positions;
}

// Another caller, who adds up in another order.
std::vector<Vec3> moved_backwards(const Mesh& mesh, const Modes& modes, const Coordinates& q) {
  std::vector<Vec3> positions(mesh.vertex_count());
  for (std::size_t j = q.size(); j-- > 0;)
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += modes.mode(j)[i] * q[j];
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += mesh.positions[i];
  return positions;
}

// [james2004] over the corners that the node owns, as it is written.
Sphere reference(const Specimen& b, const Modes& modes, const Coordinates& q, std::uint32_t node) {
  Sphere s{b.model.tree.spheres[node].center, 0};
  const auto corners = b.model.cover.region_corners(node);
  for (const std::uint32_t c : corners)
    s.radius = std::max(s.radius, distance(s.center, corner_position(b.model.cover, c, b.mesh.positions)));
  for (std::size_t j = 0; j < q.size(); ++j) {
    std::vector<Vec3> rows;
    for (const std::uint32_t c : corners) rows.push_back(corner_position(b.model.cover, c, modes.mode(j)));
    const Vec3 shift = enclosing_sphere(rows).center;
    s.center += q[j] * shift;
    s.radius += std::abs(q[j]) * farthest_distance(shift, rows);
  }
  return s;
}

TEST(Modal, spheres_are_those_of_the_formula) {
  for (const Specimen& b : specimens())
    for (const NamedModes& m : all_modes(b.mesh)) {
      Body body(b.mesh, b.model, modal_options(m.modes, Bound::shift));
      for (const double scale : {0.0, 0.01, 1.0, 300.0}) {
        const Coordinates q = random_coordinates(m.modes.mode_count, scale, 3);
        ASSERT_TRUE(body.update_modal(q));
        for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node) {
          const Sphere expected = reference(b, m.modes, q, node), actual = body.sphere(node);
          const double tolerance = 1e-5 * (1 + expected.radius + 30 * scale);
          EXPECT_LE(distance(actual.center, expected.center), tolerance) << b.name << ' ' << m.name << ' ' << node;
          EXPECT_NEAR(actual.radius, expected.radius, tolerance) << b.name << ' ' << m.name << ' ' << node;
        }
      }
    }
}

TEST(Modal, every_level_covers_at_any_coordinates) {
  for (const Specimen& b : specimens())
    for (const NamedModes& m : all_modes(b.mesh))
      for (const Bound bound : {Bound::shift, Bound::gradient}) {
        Body body(b.mesh, b.model, modal_options(m.modes, bound));
        std::uint64_t seed = 1;
        for (const double scale : {0.0, 1e-9, 1e-3, 0.1, 1.0, 50.0, 1e6, 1e14})
          for (int k = 0; k < 4; ++k) {
            const Coordinates q = random_coordinates(m.modes.mode_count, scale, seed++);
            ASSERT_TRUE(body.update_modal(q));
            for (const auto& positions : {moved(b.mesh, m.modes, q), moved_backwards(b.mesh, m.modes, q)}) {
              const Certificate proof = certify(b.model.cover, positions, spheres_of(body));
              EXPECT_TRUE(proof.covered) << b.name << ' ' << m.name << " by " << scale << ": " << proof.worst_excess;
            }
          }
      }
}

TEST(Modal, bodies_far_from_the_origin_and_modes_of_any_size_are_covered) {
  const Specimen& b = specimens()[2];
  for (const double offset : {1e3, 1e9})
    for (const double unit : {1e-200, 1e-3, 1e4, 1e150}) {
      Mesh mesh = b.mesh;
      mesh.positions = test::translated(mesh.positions, {offset, -offset, 0.5 * offset});
      const CoveredTree model = test::hand_made_tree(mesh, {.depth = 3, .cut_facets = true});
      Modes modes = test::smooth_modes(b.mesh, 5);
      for (Vec3& u : modes.displacements) u *= unit;
      Body body(mesh, model, modal_options(modes));
      for (int k = 0; k < 5; ++k) {
        Coordinates q = random_coordinates(5, 0.5, 40 + static_cast<std::uint64_t>(k));
        for (double& x : q) x /= unit;
        ASSERT_TRUE(body.update_modal(q));
        const Certificate proof = certify(model.cover, moved(mesh, modes, q), spheres_of(body));
        EXPECT_TRUE(proof.covered) << offset << ' ' << unit << ": " << proof.worst_excess;
        // Nor is the size of the modes paid for in radii.
        EXPECT_LT(body.sphere(0).radius, 20);
      }
    }
}

TEST(Modal, gradients_are_never_looser_and_follow_turning) {
  for (const Specimen& b : specimens())
    for (const NamedModes& m : all_modes(b.mesh)) {
      Body shift(b.mesh, b.model, modal_options(m.modes, Bound::shift));
      Body gradient(b.mesh, b.model, modal_options(m.modes, Bound::gradient));
      for (int k = 0; k < 4; ++k) {
        const Coordinates q = random_coordinates(m.modes.mode_count, 0.7, 90 + static_cast<std::uint64_t>(k));
        ASSERT_TRUE(shift.update_modal(q));
        ASSERT_TRUE(gradient.update_modal(q));
        for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node)
          EXPECT_LE(gradient.sphere(node).radius, shift.sphere(node).radius * (1 + 1e-6) + 1e-9)
              << b.name << ' ' << node;
      }
    }
  const Specimen& ball = specimens()[0];
  Body body(ball.mesh, ball.model, modal_options(test::linear_modes(ball.mesh)));
  const std::vector<Sphere> rest = spheres_of(body);
  for (const double degrees : {1.0, 37.0, 90.0, 180.0}) {
    const std::vector<Vec3> axes = test::rotated({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1, 2, 3}, degrees);
    Coordinates q;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) q.push_back(axes[column][row] - (row == column ? 1 : 0));
    ASSERT_TRUE(body.update_modal(q));
    for (std::uint32_t node = 0; node < rest.size(); ++node)
      EXPECT_NEAR(body.sphere(node).radius, rest[node].radius, 1e-5) << "turned by " << degrees << ", node " << node;
  }
}

TEST(Modal, at_rest_the_spheres_are_those_of_rest_bit_for_bit) {
  for (const Specimen& b : specimens()) {
    const Modes modes = test::smooth_modes(b.mesh, 3);
    for (const std::vector<Rule>& rules :
         {std::vector{Rule::modal}, std::vector{Rule::exact, Rule::modal}, std::vector{Rule::modal, Rule::approach1}}) {
      Body body(b.mesh, b.model, modal_options(modes, Bound::gradient, rules));
      const std::uint64_t rest = body.hash();
      ASSERT_TRUE(body.update_modal(Coordinates{1.5, -20, 3e3}));
      EXPECT_NE(body.hash(), rest);
      ASSERT_TRUE(body.update_modal(Coordinates{0, 0, 0}));
      EXPECT_EQ(body.hash(), rest) << b.name;
      ASSERT_TRUE(body.update_modal(Coordinates{-0.0, 0, -0.0}));
      EXPECT_EQ(body.hash(), rest) << b.name;
      EXPECT_EQ(body.rest_tree().spheres[0].center.x, b.model.tree.spheres[0].center.x);
    }
    Body modal(b.mesh, b.model, modal_options(modes));
    for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node) {
      EXPECT_LE(distance(modal.sphere(node).center, b.model.tree.spheres[node].center), 1e-6);
      EXPECT_LE(modal.sphere(node).radius, b.model.tree.spheres[node].radius * (1 + 1e-5) + 1e-5);
    }
  }
}

TEST(Modal, same_bits_for_any_number_of_workers) {
  for (const Specimen& b : specimens()) {
    const Modes modes = test::smooth_modes(b.mesh, 5);
    const Coordinates q{0.3, -0.2, 0.7, 0.05, -1};
    for (const std::vector<Rule>& rules :
         {std::vector{Rule::modal}, std::vector{Rule::approach2, Rule::modal, Rule::exact}}) {
      Body one(b.mesh, b.model, modal_options(modes, Bound::gradient, rules));
      ASSERT_TRUE(one.update_modal(q));
      for (const unsigned count : {2u, 3u, 8u}) {
        Workers workers(count);
        Body other(b.mesh, b.model, modal_options(modes, Bound::gradient, rules), workers);
        ASSERT_TRUE(other.update_modal(q, workers));
        EXPECT_EQ(other.hash(), one.hash()) << b.name << ", " << count;
      }
    }
  }
}

TEST(Modal, no_vertex_is_read_when_all_levels_are_modal) {
  const Specimen& b = specimens()[2];
  const Modes modes = test::smooth_modes(b.mesh, 3);
  Body modal(b.mesh, b.model, modal_options(modes));
  const UpdateStatus status = modal.update_modal(Coordinates{1, 2, 3});
  EXPECT_TRUE(status);
  EXPECT_EQ(status.nodes_updated, b.model.tree.node_count());
  EXPECT_EQ(status.vertices_read + status.cut_points_moved + status.points_tested, 0u);
  Body mixed(b.mesh, b.model, modal_options(modes, Bound::gradient, {Rule::modal, Rule::exact}));
  EXPECT_EQ(mixed.update_modal(Coordinates{1, 2, 3}).vertices_read, b.mesh.vertex_count());
}

TEST(Modal, levels_mix_and_each_does_what_it_does_alone) {
  for (const Specimen& b : specimens()) {
    const Modes modes = test::smooth_modes(b.mesh, 4);
    const Coordinates q{0.4, -0.3, 0.2, 0.9};
    Body modal(b.mesh, b.model, modal_options(modes));
    Body exact(b.mesh, b.model, {.rules = {Rule::exact}});
    Body exact_of_modes(b.mesh, b.model, modal_options(modes, Bound::gradient, {Rule::exact}));
    Body mixed(b.mesh, b.model, modal_options(modes, Bound::gradient, {Rule::exact, Rule::modal}));
    const std::vector<Vec3> positions = moved(b.mesh, modes, q);
    ASSERT_TRUE(modal.update_modal(q) && mixed.update_modal(q) && exact_of_modes.update_modal(q));
    ASSERT_TRUE(exact.update(positions));
    EXPECT_EQ(exact_of_modes.hash(), exact.hash()) << b.name;
    EXPECT_EQ(mixed.origin(), modal.origin()) << b.name;
    EXPECT_EQ(mixed.spheres()[0], exact.spheres()[0]) << b.name;
    for (std::uint32_t node = 1; node < b.model.tree.node_count(); ++node)
      EXPECT_EQ(mixed.spheres()[node], modal.spheres()[node]) << b.name << ' ' << node;
    EXPECT_TRUE(certify(b.model.cover, positions, spheres_of(mixed)).covered) << b.name;
    ASSERT_TRUE(exact_of_modes.update(b.mesh.positions)) << "positions are as good, without modal levels";
  }
}

TEST(Modal, one_sphere_can_be_asked_for_alone) {
  const Specimen& b = specimens()[2];
  Body body(b.mesh, b.model, modal_options(test::smooth_modes(b.mesh, 4)));
  const std::uint64_t rest = body.hash();
  const Coordinates q{0.4, -0.3, 0, 0.9};
  std::vector<Sphere> lazy;
  for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node) lazy.push_back(body.modal_sphere(node, q));
  EXPECT_EQ(body.hash(), rest);
  ASSERT_TRUE(body.update_modal(q));
  EXPECT_EQ(spheres_of(body), lazy);
  for (const Coordinates& bad : {Coordinates{1, 2, 3}, Coordinates{1, 2, 3, nan}, Coordinates{1, 2, 3, 1e30}})
    EXPECT_EQ(body.modal_sphere(3, bad).radius, infinity);
  EXPECT_EQ(Body(b.mesh, b.model).modal_sphere(3, q).radius, infinity);
}

TEST(Modal, bad_coordinates_are_reported_and_change_nothing) {
  const Specimen& b = specimens()[2];
  const Modes modes = test::smooth_modes(b.mesh, 3);
  for (const std::vector<Rule>& rules : {std::vector{Rule::modal}, std::vector{Rule::exact, Rule::modal}}) {
    Body body(b.mesh, b.model, modal_options(modes, Bound::gradient, rules));
    ASSERT_TRUE(body.update_modal(Coordinates{1, 2, 3}));
    const std::uint64_t last_good = body.hash();
    const auto refuse = [&](const Coordinates& q, UpdateStatus::Code code, std::size_t first) {
      const UpdateStatus status = body.update_modal(q);
      EXPECT_EQ(status.code, code);
      EXPECT_EQ(status.index, first);
      EXPECT_EQ(status.nodes_updated, 0u);
      EXPECT_EQ(body.hash(), last_good);
    };
    using Code = UpdateStatus::Code;
    refuse({}, Code::wrong_coordinate_count, 0);
    refuse({1, 2}, Code::wrong_coordinate_count, 0);
    refuse({1, 2, 3, 4}, Code::wrong_coordinate_count, 0);
    refuse({1, nan, infinity}, Code::bad_coordinate, 1);
    refuse({1, 1e30, -infinity}, Code::bad_coordinate, 2);
    refuse({1e20, -1e30, 3}, Code::bad_coordinate, 1);
    refuse({1e308, 1e300, 1e300}, Code::bad_coordinate, 0);
    EXPECT_EQ(body.update(b.mesh.positions).code, Code::needs_coordinates);
    EXPECT_EQ(body.hash(), last_good);
    ASSERT_TRUE(body.update_modal(Coordinates{1, 2, 3}));
    EXPECT_EQ(body.hash(), last_good);
  }
  Body without(b.mesh, b.model);
  EXPECT_EQ(without.update_modal(Coordinates{1, 2, 3}).code, UpdateStatus::Code::no_modes);
}

TEST(Modal, modes_that_do_not_fit_are_refused_by_name) {
  const Specimen& b = specimens()[0];
  const auto refuse = [&](const auto& spoil, const std::string& fragment) {
    UpdateOptions options = modal_options(test::smooth_modes(b.mesh, 3));
    spoil(options);
    try {
      Body(b.mesh, b.model, options);
      ADD_FAILURE() << fragment;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(fragment), std::string::npos) << error.what();
    }
  };
  refuse([](UpdateOptions& o) { o.modes = {}; }, "the rule modal needs the modes");
  refuse([](UpdateOptions& o) { --o.modes.vertex_count; }, "the modes are for 641 vertices, but the mesh has 642");
  refuse([](UpdateOptions& o) { ++o.modes.mode_count; }, "4 modes of 642 vertices need a displacement each");
  refuse([](UpdateOptions& o) { o.modes.displacements.pop_back(); }, "there are 1925");
  refuse([](UpdateOptions& o) { o.modes.displacements[642 + 7].z = nan; }, "mode 1: the displacement of vertex 7");
}

TEST(ModeRows, the_stretch_of_a_matrix_is_bounded_and_nearly_reached) {
  Random random(5);
  const auto entry = [&] { return random.uniform(-2, 2); };
  for (int k = 0; k < 300; ++k) {
    std::array<Vec3, 3> columns;
    for (Vec3& c : columns) c = {entry(), entry(), entry()};
    if (k % 3 == 0) columns[2] = columns[0] * 0.5;
    if (k % 5 == 0) columns = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1 - 0.02 * k / 5}};
    Vec3 v = normalized(Vec3{entry(), entry(), entry()});
    for (int step = 0; step < 500; ++step) {
      const Vec3 image = times(columns, v);
      v = normalized(Vec3{dot(columns[0], image), dot(columns[1], image), dot(columns[2], image)}, v);
    }
    const double reached = length(times(columns, v));
    EXPECT_GE(largest_stretch(columns), reached);
    EXPECT_LE(largest_stretch(columns), 1.03 * reached);
  }
  EXPECT_NEAR(largest_stretch({Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}}), 1.0, 1e-11);
  EXPECT_EQ(largest_stretch({}), 0.0);
}

// A matrix of any size: its cubes of squares leave the range of double from about 1e51 on, and below about 1e-54.
TEST(ModeRows, the_stretch_of_very_large_and_very_small_matrices_is_bounded) {
  Random random(6);
  for (int k = 0; k < 20000; ++k) {
    const double size = std::ldexp(1, k % 2 == 0 ? 160 + k % 20 : -1000 + k % 1990);
    std::array<Vec3, 3> unit, columns;
    for (std::size_t i = 0; i < 3; ++i) {
      unit[i] = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      columns[i] = unit[i] * size;
    }
    Vec3 v{0.6, 0, 0.8};
    for (int step = 0; step < 40; ++step) {
      const Vec3 image = times(unit, v);
      v = normalized(Vec3{dot(unit[0], image), dot(unit[1], image), dot(unit[2], image)}, v);
    }
    EXPECT_GE(largest_stretch(columns) / size, length(times(unit, v)) * (1 - 1e-15)) << k;
    EXPECT_LE(largest_stretch(columns) / size, 1.03 * largest_stretch(unit)) << k;
  }
  constexpr double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(largest_stretch({Vec3{infinite, 0, 0}, Vec3{}, Vec3{}}), infinite);
  EXPECT_EQ(largest_stretch({Vec3{}, Vec3{0, std::nan(""), 0}, Vec3{}}), infinite);
}

}  // namespace
}  // namespace morula
