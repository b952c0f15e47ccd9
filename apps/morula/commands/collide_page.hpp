// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of `morula collide`: both bodies as one, their spheres below one root, and a mark at each contact.
#pragma once

#include <morula/page/page.hpp>

#include "commands/collide_bodies.hpp"
#include "commands/collide_report.hpp"

namespace morula::cli {

class CollidePage {
 public:
  /// The bodies at rest, where they are placed.
  CollidePage(const Side& a, const Side& b, const std::string& rule);
  /// The bodies and what was found of them, after each other, from the first frame.
  void add(const Side& a, const Side& b, const CollidedFrame& found);
  /// After the last frame.
  std::string text() const;

 private:
  std::vector<Sphere> spheres(const Side& a, const Side& b) const;

  PageContent content_;
};

}  // namespace morula::cli
