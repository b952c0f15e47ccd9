// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The fit of a single link: its shapes and planes, what a number of spheres brings, and the spheres.
#pragma once

#include <morula/robot/fit.hpp>

#include "fit/budget.hpp"

namespace morula::robot {

/// Fits links one at a time; calls for different links may run on different threads. The robot and the options must
/// outlive it.
class LinkFitter {
 public:
  LinkFitter(const Robot& robot, const FitOptions& options) : robot_(robot), o_(options) {}

  const std::string& name_of(const LinkSpheres& link) const { return robot_.links[link.link].name; }
  const std::vector<Shape>& shapes_of(const LinkSpheres& link) const;
  const std::vector<ClipPlane>& planes_of(const LinkSpheres& link) const;

  /// Reads the surface of the link, without the parts that planes cut off. Throws FileError for files that cannot be
  /// read, and std::invalid_argument for a clip margin that is too small.
  void read_surface(LinkSpheres& link) const;
  /// The outside volume of the link with few and with many spheres.
  Demand demand(const LinkSpheres& link) const;
  /// Sets the spheres, the inner spheres and all that is known about them, except the mass. budget: number of spheres;
  /// 0: as many as the largest protrusion requires.
  void fit(LinkSpheres& link, std::size_t budget) const;

 private:
  Quality quality(Quality of_optimized) const;
  BuildOptions build_options(const LinkSpheres& link) const;
  CoveredTree build_link(const LinkSpheres& link, const BuildOptions& options) const;
  void fit_new(LinkSpheres& link, std::size_t budget) const;
  void fit_mesh(LinkSpheres& link, std::size_t budget) const;
  void enforce_max_radius(LinkSpheres& link, BuildOptions options, CoveredTree& model) const;
  void enforce_margin(LinkSpheres& link, CoveredTree& model) const;
  void fit_inner(LinkSpheres& link) const;

  const Robot& robot_;
  const FitOptions& o_;
};

}  // namespace morula::robot
