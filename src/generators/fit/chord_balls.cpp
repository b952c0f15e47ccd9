// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/chord_balls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/sampling.hpp>

namespace morula::detail {
namespace {

// Middle, and half the length as the radius, of every part of every stride-th line inside the object; mesh units.
std::vector<Sphere> chords_of(const ObjectLines& lines, int stride) {
  std::vector<Sphere> chords;
  for (int axis = 0; axis < 3; ++axis) {
    const int nu = lines.count()[static_cast<std::size_t>((axis + 1) % 3)],
              nv = lines.count()[static_cast<std::size_t>((axis + 2) % 3)];
    for (int v = stride / 2; v < nv; v += stride)
      for (int u = stride / 2; u < nu; u += stride) {
        const auto crossings = lines.line(axis, u, v);
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
          const double enter = crossings[i].at, leave = crossings[i + 1].at;
          Vec3 middle;
          middle[axis] = (enter + leave) / 2, middle[(axis + 1) % 3] = u + 0.5, middle[(axis + 2) % 3] = v + 0.5;
          chords.push_back({lines.from_lattice(middle), (leave - enter) / 2 * lines.cell()});
        }
      }
  }
  return chords;
}

template <class T>
std::vector<T> some_of(const std::vector<T>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<T> some;
  for (std::size_t k = 0; k < most; ++k) some.push_back(all[k * all.size() / most]);
  return some;
}

}  // namespace

std::vector<Sphere> chord_balls(const MeshView& mesh, const ObjectLines& lines, std::size_t most, std::uint64_t seed) {
  // The widest spacing that gives enough chords.
  constexpr int widest = 16;
  std::vector<Sphere> chords;
  for (int stride = widest; stride >= 1 && chords.size() < 4 * most; stride /= 2) chords = chords_of(lines, stride);
  constexpr std::size_t samples = 1000;
  std::vector<Vec3> points;
  if (!chords.empty())
    for (const SurfacePoint& s : sample_surface(mesh, samples, seed)) points.push_back(s.point);
  std::vector<Sphere> balls;
  for (const Sphere& chord : some_of(chords, 4 * most)) {
    double squared = std::numeric_limits<double>::infinity();
    for (const Vec3& p : points) squared = std::min(squared, squared_distance(p, chord.center));
    const double radius = std::min(chord.radius, std::sqrt(squared));
    constexpr double along = 1.5;  // half a chord through a tube at 45° is 1.41 radii
    if (chord.radius <= along * radius) balls.push_back({chord.center, radius});
  }
  return some_of(balls, most);
}

}  // namespace morula::detail
