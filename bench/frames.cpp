// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "frames.hpp"

#include <morula/deform/deformation.hpp>

namespace morula::bench {

std::vector<Frame> bend_and_back(const Mesh& mesh) {
  std::vector<Frame> frames;
  for (const double t : frame_parameters(25)) {
    Frame frame;
    for (const Vec3& p : deform(mesh, {Bend{90}}, t)) frame.emplace_back(p);
    frames.push_back(std::move(frame));
  }
  return frames;
}

double nanoseconds_per_vertex(const std::vector<double>& seconds, const Mesh& mesh) {
  return 1e9 * median(seconds) / static_cast<double>(mesh.vertex_count());
}

}  // namespace morula::bench
