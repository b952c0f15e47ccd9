// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Record of a run: what was judged, and what was found wrong.
#pragma once

#include <cstdint>
#include <filesystem>
#include <judge.hpp>
#include <map>
#include <morula/geometry/mesh.hpp>
#include <string>
#include <vector>

namespace morula::properties {

struct Counts {
  std::size_t cases = 0, refused_builds = 0;
  std::size_t frames = 0, levels = 0;
  oracle::CoverTally cover;
  std::size_t corners = 0;   ///< of regions, held against their node's sphere
  std::size_t enlarged = 0;  ///< far builds with spheres that had to grow for rounding
  std::size_t modal_frames = 0, skinned_frames = 0, swaps = 0, round_trips = 0;
  std::size_t poses_of_pairs = 0;
  std::size_t crossings = 0;       ///< pairs of facets that brute force found to meet
  std::size_t exact_poses = 0;     ///< with all pairs known exactly
  std::size_t followed_pairs = 0;  ///< poses in which surfaces that follow the bodies were asked
  std::size_t near_pairs = 0;      ///< pairs of points nearer than a margin
  std::size_t interruptions = 0;   ///< ends of a query's work, the last one included, at which it was complete
};

/// The case that is running: its name goes to whoever has to repeat it.
struct Place {
  std::uint64_t seed = 0, number = 0;
  std::string description;  ///< mesh, tree, rules; grows
  Mesh mesh;                ///< the first body's, for --keep
  std::string frame;        ///< what the body does at the moment
  std::vector<Vec3> pose;
  Mesh second;  ///< the other body's, placed, where there is one
};

class Record {
 public:
  /// keep: a folder for what is needed to look into failures; empty: none. loud: failures are printed.
  explicit Record(std::filesystem::path keep, bool loud = true) : keep_(std::move(keep)), loud_(loud) {}

  Counts counts;
  Place place;
  std::string command = "scripts/properties";  ///< what repeats a case, but for its seed and number

  void begin(std::uint64_t seed, std::uint64_t number);
  /// One line, the first time in this case that something of this kind is wrong.
  void fail(const std::string& kind, const std::string& what);
  /// The same unless it holds.
  void expect(bool holds, const std::string& kind, const std::string& otherwise) {
    if (!holds) fail(kind, otherwise);
  }

  std::size_t failed_cases() const { return failed_cases_; }
  const std::map<std::string, std::size_t>& failures() const { return failures_; }  ///< cases, by kind
  std::string summary(double seconds) const;

 private:
  void keep(const std::string& kind, const std::string& what) const;

  std::filesystem::path keep_;
  bool loud_;
  std::map<std::string, std::size_t> failures_;
  std::vector<std::string> seen_;  // kinds, in this case
  std::size_t failed_cases_ = 0;
};

}  // namespace morula::properties
