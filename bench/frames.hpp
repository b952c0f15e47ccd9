// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Frames of a motion, and the times that they take.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <vector>

#include "scenario.hpp"

namespace morula::bench {

/// As a host has them: float.
using Frame = std::vector<Vec3f>;

/// A bend by 90 degrees and back in 25 frames; the first and the last are rest.
std::vector<Frame> bend_and_back(const Mesh& mesh);

/// frame_time(f): the seconds that frame f took.
template <class FrameTime>
std::vector<double> timed_frames(const Settings& settings, std::size_t frame_count, const FrameTime& frame_time) {
  std::vector<double> seconds;
  timed(settings, [&] {
    for (std::size_t f = 0; f < frame_count; ++f) seconds.push_back(frame_time(f));
  });
  return seconds;
}

/// Of the median frame.
double nanoseconds_per_vertex(const std::vector<double>& seconds, const Mesh& mesh);

}  // namespace morula::bench
