// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/io/mesh_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/whole_output.hpp>
#include <stdexcept>
#include <string>

#include "io/byte_reader.hpp"
#include "io/mesh/formats.hpp"
#include "io/mesh/ply_header.hpp"
#include "io/number_text.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;

void write_balls(const std::filesystem::path& path, std::span<const Sphere> balls) {
  if (lower_extension(path) != ".ply") throw FileError(platform::text_of(path) + ": balls are written as .ply");
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(balls.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nproperty double radius\nend_header\n";
  bytes.reserve(bytes.size() + balls.size() * sizeof(Sphere));
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    poll_interrupt();
    const auto& [center, radius] = balls[i];
    if (!is_finite(center) || !std::isfinite(radius))
      throw std::invalid_argument("ball " + std::to_string(i) + " has a number that is not finite");
    for (int axis = 0; axis < 3; ++axis) store(bytes, center[axis]);
    store(bytes, radius);
  }
  write_whole(path, bytes);
}

std::vector<Sphere> read_balls(const std::filesystem::path& path) {
  const StandardFloats standard;
  if (lower_extension(path) != ".ply") throw FileError(platform::text_of(path) + ": balls are read from .ply");
  return read_ply_balls(path, read_whole(path));
}

bool is_ball_file(const std::filesystem::path& path) {
  if (lower_extension(path) != ".ply") return false;
  // No header of this library or of any known program is longer.
  constexpr std::uintmax_t longest_header = std::uintmax_t{1} << 18;
  try {
    const std::string start = read_part(path, 0, std::min(size_of_file(path), longest_header));
    TextScanner in = ply_scanner(path, start);
    return holds_balls(read_ply_header(in));
  } catch (const FileError&) {
    return false;
  }
}

void write_sofa_spheres(const std::filesystem::path& path, std::span<const Sphere> spheres) {
  // The loader skips any first line, and ignores the index.
  std::string text = "sph 1.0\nnums ";
  detail::append_number(text, spheres.size());
  detail::InterruptPoller poll_interrupt(4096);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    poll_interrupt();
    const Sphere& s = spheres[i];
    if (!is_finite(s.center) || !std::isfinite(s.radius))
      throw std::invalid_argument("sphere " + std::to_string(i) + " has a number that is not finite");
    text += "\nsphe ";
    detail::append_number(text, i);
    for (const double value : {s.center.x, s.center.y, s.center.z, s.radius}) {
      text += ' ';
      detail::append_number(text, value);
    }
  }
  write_whole(path, text + '\n');
}

}  // namespace morula
