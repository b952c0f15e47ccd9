// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The demo's experiment: bodies × methods × motions × rules, measured at a few frames of each motion.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <morula/accuracy/coverage.hpp>
#include <morula/accuracy/looseness.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/update/body.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shared/experiment.hpp"

namespace morula::cli {

struct FrameFigures {
  std::size_t frame = 0;
  double parameter = 0;  // 0 at rest, 1 at the full amount
  Looseness looseness;
  Coverage coverage;
};

/// The rules that are compared. On leaves, which the figures are of, `wrapped` would be `exact` once more.
inline constexpr std::array demo_rules{Rule::traditional, Rule::weighted, Rule::approach1, Rule::approach2,
                                       Rule::exact};

/// One rule following one motion with one tree; figures are of the leaves (the last level set).
struct DemoCell {
  std::string body;
  Method method{};
  std::string motion;  // as describe() says it; it is also the option of morula deform
  Rule rule{};
  std::vector<FrameFigures> frames;
  double microseconds = 0;  // per frame, median over all frames and repeats, one thread
  double nanoseconds_per_vertex = 0;
  bool returns_to_rest = false;  // the last frame has the bits of the first
  // Of the rule exact: every frame, every level.
  bool certified = false;
  double worst_excess = 0;

  double worst_looseness() const;
  double worst_bare_area() const;
  double worst_gap() const;
  double rest_looseness() const { return frames.front().looseness.looseness.value_or(0); }
};

/// A body, its tree, and how every rule fares.
struct DemoTree {
  std::string body;
  Method method{};
  std::size_t vertices = 0;
  std::size_t facets = 0;
  std::size_t spheres = 0;
  std::size_t leaves = 0;
  double build_seconds = 0;
  double voxel_edge = 0;
  std::vector<std::string> skipped;  // motions this body cannot make, and why
  std::vector<DemoCell> cells;
  Built built;  // for more experiments on the same tree
};

struct DemoPlan {
  std::vector<NamedMesh> bodies;
  std::vector<Deformations> motions;
  std::size_t frame_count = 25;
  int repeats = 5;  // of every update, for the times
  int resolution = 192;
};

/// Frames that are measured: rest, half way, the full amount, back at rest.
std::vector<std::size_t> measured_frames(std::size_t frame_count);

/// Writes meshes, trees and the spheres at the full amount into `folder`. Progress goes to `progress`: share done, and
/// what is being done.
std::vector<DemoTree> run_demo(const DemoPlan& plan, const std::filesystem::path& folder, Workers& workers,
                               const std::function<void(double, std::string)>& progress);

}  // namespace morula::cli
