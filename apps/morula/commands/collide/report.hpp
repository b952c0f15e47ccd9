// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Collide report: a table, JSON, or a CSV file of everything that `morula collide` found.
#pragma once

#include <morula/collide/contacts.hpp>
#include <morula/collide/crossings.hpp>
#include <string>
#include <toolbox/svg_plot.hpp>
#include <vector>

#include "shared/report.hpp"

namespace morula::cli {

struct CollidedFrame {
  std::string name_a, name_b;
  std::vector<Contact> contacts{};
  std::vector<ContactSurface> surfaces{};  // one per contact
  std::vector<Crossing> crossings{};       // with --crossings
  bool finished = false;
  std::size_t pair_tests = 0;
  std::uint32_t achieved_level = 0;
  double microseconds = 0, crossings_microseconds = 0;

  /// The greatest depth of the surfaces; 0 without contacts.
  double deepest() const;
};

struct CollideRun {
  std::string mesh_a, mesh_b, rule, budget, output, page{};
  bool find_crossings = false;
  bool built_a = false, built_b = false;
  unsigned threads = 1;
};

Json vec3_json(const Vec3& v);
Json surface_point_json(const SurfacePoint& p);
std::string vec3_csv(const Vec3& v);  // three cells
/// A line about sides whose tree the command built; empty without any.
std::string built_tree_note(bool built_a, bool built_b);

std::string collide_text(const CollideRun& run, const std::vector<CollidedFrame>& frames);
/// Contacts, their greatest depth and pair tests over the frames; with --crossings, pairs of facets.
toolbox::Plot collide_plot(const CollideRun& run, const std::vector<CollidedFrame>& frames);
Json collide_json(const CollideRun& run, const std::vector<CollidedFrame>& frames);
std::string contacts_csv(const std::vector<CollidedFrame>& frames);
std::string crossings_csv(const std::vector<CollidedFrame>& frames);

}  // namespace morula::cli
