// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies are square grids rolled up, without poles, so that facets are well shaped at every resolution. Only + − × ÷ √
// and the library's own sine and cosine are used: the bits are the same everywhere.
#include <algorithm>
#include <array>
#include <map>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::array<std::string_view, 10> body_names{"bar",   "capsule", "limb", "torus", "blob",
                                                      "plate", "two",     "tool", "hand",  "vessel"};

// Two facets for the square a b c d, cut along the shorter diagonal. Equal diagonals are cut a–c, for any rounding.
void add_square(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  const std::vector<Vec3>& p = mesh.positions;
  if (squared_distance(p[b], p[d]) < squared_distance(p[a], p[c]) * (1 - 1e-9))
    mesh.facets.insert(mesh.facets.end(), {Facet{a, b, d}, Facet{b, c, d}});
  else
    mesh.facets.insert(mesh.facets.end(), {Facet{a, b, c}, Facet{a, c, d}});
}

// The surface of a box of nx × ny × nz cells; point(i, j, k) places the corners. Outward if point keeps orientation.
//
// Vertices in order: the bottom k = 0 row by row, the rings 0 < k < nz, the top k = nz row by row.
template <class Point>
Mesh box_surface(int nx, int ny, int nz, Point&& point) {
  const int full = (nx + 1) * (ny + 1), ring = 2 * (nx + ny);
  const auto index = [=](int i, int j, int k) {
    if (k == 0) return static_cast<std::uint32_t>(j * (nx + 1) + i);
    const int first = full + (k - 1) * ring;
    if (k == nz) return static_cast<std::uint32_t>(first + j * (nx + 1) + i);
    const int around = j == 0 ? i : i == nx ? nx + j : j == ny ? nx + ny + (nx - i) : ring - j;
    return static_cast<std::uint32_t>(first + around);
  };
  Mesh mesh;
  mesh.positions.resize(static_cast<std::size_t>(2 * full + (nz - 1) * ring));
  mesh.facets.reserve(static_cast<std::size_t>(4 * (nx * ny + nz * (nx + ny))));
  InterruptPoller poll_interrupt(4096);
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) {
        poll_interrupt();
        if (k == 0 || k == nz || j == 0 || j == ny || i == 0 || i == nx)
          mesh.positions[index(i, j, k)] = point(i, j, k);
        else
          i = nx - 1;  // the inside is skipped
      }
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      poll_interrupt();
      add_square(mesh, index(i, j, 0), index(i, j + 1, 0), index(i + 1, j + 1, 0), index(i + 1, j, 0));
      add_square(mesh, index(i, j, nz), index(i + 1, j, nz), index(i + 1, j + 1, nz), index(i, j + 1, nz));
    }
  for (int k = 0; k < nz; ++k) {
    for (int i = 0; i < nx; ++i) {
      poll_interrupt();
      add_square(mesh, index(i, 0, k), index(i + 1, 0, k), index(i + 1, 0, k + 1), index(i, 0, k + 1));
      add_square(mesh, index(i + 1, ny, k), index(i, ny, k), index(i, ny, k + 1), index(i + 1, ny, k + 1));
    }
    for (int j = 0; j < ny; ++j) {
      poll_interrupt();
      add_square(mesh, index(0, j + 1, k), index(0, j, k), index(0, j, k + 1), index(0, j + 1, k + 1));
      add_square(mesh, index(nx, j, k), index(nx, j + 1, k), index(nx, j + 1, k + 1), index(nx, j, k + 1));
    }
  }
  return mesh;
}

Mesh box(const std::array<int, 3>& cells, const Vec3& size) {
  const auto place = [](int i, int n, double length) { return length * (static_cast<double>(i) / n - 0.5); };
  return box_surface(cells[0], cells[1], cells[2], [&](int i, int j, int k) {
    return Vec3{place(i, cells[0], size.x), place(j, cells[1], size.y), place(k, cells[2], size.z)};
  });
}

// −1 … 1 as i runs from 0 to n, spaced so that on the sphere around a cube all steps turn by the same angle.
double equal_angles(int i, int n) {
  const auto [s, c] = sin_cos(pi / 4 * (2 * static_cast<double>(i) / n - 1));
  // The ends are exact: the sides of the cube must be symmetric to the bit.
  return i == 0 ? -1.0 : i == n ? 1.0 : s / c;
}

// A tube of 4 × quarter edges around with a half sphere on each end, `along` edges between them.
//
// point(direction, a): direction on the unit sphere, its z along the tube; a runs from 0 to 1 between the two half
// spheres, where direction.z is 0, and is exactly 0 and 1 on them.
template <class Point>
Mesh rounded_tube(int quarter, int along, Point&& point) {
  const int band = (quarter + 1) / 2;  // rows of a half sphere below its cap
  const int rows = 2 * band + along;
  return box_surface(quarter, quarter, rows, [&](int i, int j, int k) {
    const double z = k < band ? equal_angles(k, 2 * band) : k > rows - band ? equal_angles(k - along, 2 * band) : 0.0;
    const double a = static_cast<double>(std::clamp(k - band, 0, along)) / along;
    return point(normalized(Vec3{equal_angles(i, quarter), equal_angles(j, quarter), z}), a);
  });
}

// From 0 to 1 with level ends.
double smooth_step(double a) {
  return a * a * (3 - 2 * a);
}

// 1 at the middle, falling smoothly to 0 at `reach` from it.
double bump(double a, double middle, double reach) {
  const double q = (a - middle) / reach, rest = std::max(0.0, 1 - q * q);
  return rest * rest * rest;
}

Mesh capsule(int resolution) {
  const int quarter = std::max(1, (resolution + 2) / 4), along = std::max(1, resolution * 5 / 8);
  constexpr double straight = 2.0, radius = 0.5;
  return rounded_tube(quarter, along, [](const Vec3& d, double a) {
    return Vec3{straight * (a - 0.5) + radius * d.z, radius * d.x, radius * d.y};
  });
}

// A rough arm: bent at the elbow, thinner and flatter towards the hand, with muscles on the inside of the bend.
Mesh limb(int resolution) {
  const int quarter = std::max(1, (resolution + 2) / 4), along = std::max(1, resolution * 7 / 8);
  return rounded_tube(quarter, along, [](const Vec3& d, double even) {
    // Rows lie closer where the arm is thinner.
    const double a = even + 0.25 * even * (1 - even);
    // The center line: a hyperbola with a slight sideways sweep. It turns with a radius of 1 at the elbow, wider than
    // the arm is there, so that the surface cannot run into itself.
    const double u = 2 * a - 1, root = std::sqrt(u * u + 0.16);
    const Vec3 center{2 * u, 1.6 * root - 1.2, 0.15 * u * u * u};
    const Vec3 tangent = normalized(Vec3{2, 1.6 * u / root, 0.45 * u * u});
    const Vec3 side = normalized(Vec3{0, 0, 1} - tangent * tangent.z);
    const Vec3 up = cross(side, tangent);
    // All values that change with a have level ends: the half spheres join without a crease.
    const double window = 16 * a * a * (1 - a) * (1 - a);
    const double biceps = bump(a, 0.28, 0.28), forearm = bump(a, 0.66, 0.3);
    const auto [ripple, other_ripple] = sin_cos(11 * a);
    const double radius = 0.54 - 0.2 * smooth_step(a) + 0.08 * biceps + 0.07 * forearm;
    const double swelling = 1 + 0.2 * biceps * d.x - 0.1 * forearm * d.x +
                            window * (0.06 * ripple * d.y + 0.05 * other_ripple * (d.x * d.x - d.y * d.y));
    const double flattening = 1 - 0.2 * smooth_step(a);
    return center + (up * (d.x * flattening) + side * d.y + tangent * d.z) * (radius * swelling);
  });
}

Mesh torus(int around, double tube_radius) {
  const int across = std::max(3, static_cast<int>(tube_radius * around + 0.5));
  Mesh mesh;
  for (int i = 0; i < around; ++i) {
    check_interrupt();
    const auto [si, ci] = sin_cos(2 * pi * i / around);
    for (int j = 0; j < across; ++j) {
      const auto [sj, cj] = sin_cos(2 * pi * j / across);
      const double reach = 1 + tube_radius * cj;
      mesh.positions.push_back({reach * ci, reach * si, tube_radius * sj});
    }
  }
  const auto index = [=](int i, int j) { return static_cast<std::uint32_t>(i % around * across + j % across); };
  for (int i = 0; i < around; ++i) {
    check_interrupt();
    for (int j = 0; j < across; ++j)
      add_square(mesh, index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1));
  }
  return mesh;
}

Mesh blob(int resolution) {
  // Unit directions of the lobes (to about 1e-2; normalized below) and the height of each.
  constexpr std::array<Vec3, 6> lobes{Vec3{0.9, 0.3, 0.3},    Vec3{-0.4, 0.9, 0.2},  Vec3{-0.8, -0.5, 0.3},
                                      Vec3{0.3, -0.9, -0.35}, Vec3{0.1, 0.25, 0.96}, Vec3{-0.1, 0.3, -0.95}};
  constexpr std::array<double, 6> heights{0.75, 0.55, 0.65, 0.5, 0.6, 0.4};
  const int n = std::max(1, (3 * resolution + 4) / 8);
  return box_surface(n, n, n, [&](int i, int j, int k) {
    const Vec3 d = normalized(Vec3{equal_angles(i, n), equal_angles(j, n), equal_angles(k, n)});
    double radius = 0.6;
    for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
      const double facing = 0.5 + 0.5 * dot(d, normalized(lobes[lobe]));
      const double squared = facing * facing, fourth = squared * squared, eighth = fourth * fourth;
      radius += heights[lobe] * eighth * fourth;
    }
    return d * radius;
  });
}

// A probe: its handle at negative x, its tip at positive x. Radii change with level ends, so that there are no creases.
Mesh tool(int resolution) {
  const int quarter = std::max(1, (resolution + 4) / 8), along = std::max(1, 2 * resolution);
  constexpr double straight = 2.8, handle = 0.14, shaft = 0.1, tip = 0.05;
  return rounded_tube(quarter, along, [](const Vec3& d, double a) {
    const auto step = [&](double from, double to) {
      return smooth_step(std::clamp((a - from) / (to - from), 0.0, 1.0));
    };
    const double radius = handle - (handle - shaft) * step(0.3, 0.4) - (shaft - tip) * step(0.7, 0.95);
    return Vec3{straight * (a - 0.5) + radius * d.z, radius * d.x, radius * d.y};
  });
}

// A blood vessel: slender, in an S, with a bulge behind its middle.
Mesh vessel(int resolution) {
  const int quarter = std::max(1, (resolution + 4) / 8), along = std::max(1, 2 * resolution);
  return rounded_tube(quarter, along, [](const Vec3& d, double even) {
    const double a = even - 0.06 * bump(even, 0.9, 0.5) * even * (1 - even), u = 2 * a - 1;
    // The center line is a cubic: it turns with a radius of more than 0.9, wider than the bulge.
    const Vec3 center{2 * u, 0.9 * u * (u * u - 1), 0.3 * u * u};
    const Vec3 tangent = normalized(Vec3{2, 0.9 * (3 * u * u - 1), 0.6 * u});
    const Vec3 side = normalized(Vec3{0, 0, 1} - tangent * tangent.z);
    const Vec3 up = cross(side, tangent);
    const double radius = 0.2 - 0.06 * smooth_step(a) + 0.1 * bump(a, 0.6, 0.25);
    return center + (up * d.x + side * d.y + tangent * d.z) * radius;
  });
}

// The unit cells of a hand: a palm, four fingers of different length and a thumb.
std::vector<std::array<int, 3>> hand_cells() {
  std::vector<std::array<int, 3>> cells;
  const auto add = [&](int x0, int x1, int y0, int y1) {
    for (int x = x0; x < x1; ++x)
      for (int y = y0; y < y1; ++y) cells.push_back({x, y, 0});
  };
  add(0, 5, 0, 7);
  constexpr std::array<int, 4> lengths{3, 5, 5, 4};
  for (int finger = 0; finger < 4; ++finger)
    add(5, 5 + lengths[static_cast<std::size_t>(finger)], 2 * finger, 2 * finger + 1);
  add(1, 2, 7, 9);
  return cells;
}

// The surface of unit cells, n × n squares on each side of a cell. Cells must meet in sides, or not at all.
Mesh cell_surface(const std::vector<std::array<int, 3>>& cells, int n) {
  const std::set<std::array<int, 3>> filled(cells.begin(), cells.end());
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = known.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) mesh.positions.push_back(Vec3{double(at[0]), double(at[1]), double(at[2])} / static_cast<double>(n));
    return found->second;
  };
  for (const std::array<int, 3>& cell : cells) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        std::array<int, 3> next = cell;
        next[static_cast<std::size_t>(axis)] += 2 * side - 1;
        if (filled.count(next) > 0) continue;
        check_interrupt();
        // u, v and the axis are a right-handed frame; the other side is seen from behind.
        const auto u = static_cast<std::size_t>((axis + 1) % 3), v = static_cast<std::size_t>((axis + 2) % 3);
        for (int i = 0; i < n; ++i) {
          for (int j = 0; j < n; ++j) {
            const auto corner = [&](int along_u, int along_v) {
              std::array<int, 3> at{n * cell[0], n * cell[1], n * cell[2]};
              at[static_cast<std::size_t>(axis)] += n * side;
              at[u] += i + along_u;
              at[v] += j + along_v;
              return vertex(at);
            };
            const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
            if (side == 1)
              add_square(mesh, a, b, c, d);
            else
              add_square(mesh, a, d, c, b);
          }
        }
      }
    }
  }
  return mesh;
}

// Moves every vertex half way to the mean of its neighbors, again and again.
void smooth(Mesh& mesh, int rounds) {
  std::vector<Vec3> sums(mesh.vertex_count());
  for (int round = 0; round < rounds; ++round) {
    check_interrupt();
    std::vector<double> counts(mesh.vertex_count(), 0);
    std::fill(sums.begin(), sums.end(), Vec3{});
    for (const Facet& f : mesh.facets) {
      for (std::size_t k = 0; k < 3; ++k) {
        sums[f[k]] += mesh.positions[f[(k + 1) % 3]];
        counts[f[k]] += 1;
      }
    }
    for (std::size_t v = 0; v < sums.size(); ++v) mesh.positions[v] = (mesh.positions[v] + sums[v] / counts[v]) * 0.5;
  }
}

// A hand, the fingers along x. Rounds follow the number of vertices, so that its shape is nearly the same at every
// resolution up to 96; above, its edges are sharper.
Mesh hand(int resolution) {
  const int n = std::max(1, (resolution + 4) / 12);
  Mesh mesh = cell_surface(hand_cells(), n);
  smooth(mesh, std::min(n * n, 64));
  const Vec3 center = bounding_box(mesh).center();
  for (Vec3& p : mesh.positions) p = (p - center) * 0.4;
  return mesh;
}

// Two links of a chain: they hold each other but do not touch, 0.4 apart at the nearest.
Mesh two(int resolution) {
  Mesh mesh = torus(std::max(8, resolution), 0.3);  // with fewer edges, the links would intersect
  const std::size_t count = mesh.vertex_count(), facets = mesh.facet_count();
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3 p = mesh.positions[v];
    mesh.positions.push_back({p.x + 1, -p.z, p.y});
  }
  for (std::size_t f = 0; f < facets; ++f) {
    Facet shifted = mesh.facets[f];
    for (std::uint32_t& v : shifted) v += static_cast<std::uint32_t>(count);
    mesh.facets.push_back(shifted);
  }
  return mesh;
}

}  // namespace

std::span<const std::string_view> sample_body_names() {
  return body_names;
}

Mesh sample_body(std::string_view name, int resolution) {
  const StandardFloats standard;
  constexpr int coarsest = 3, finest = 4096;
  if (resolution < coarsest || resolution > finest)
    throw std::invalid_argument("resolution " + std::to_string(resolution) + " is not in " + std::to_string(coarsest) +
                                "…" + std::to_string(finest));
  const int quarter = std::max(1, (resolution + 2) / 4);
  if (name == "bar") return box({4 * quarter, quarter, quarter}, {4, 1, 1});
  if (name == "capsule") return capsule(resolution);
  if (name == "limb") return limb(resolution);
  if (name == "torus") return torus((3 * resolution + 1) / 2, 0.35);
  if (name == "blob") return blob(resolution);
  // Thin along y, so that a bend, which is in the x-y plane, rolls it up.
  if (name == "plate")
    return box({resolution, std::max(1, resolution / 40), std::max(1, (resolution + 1) / 2)}, {4, 0.1, 2});
  if (name == "two") return two(resolution);
  if (name == "tool") return tool(resolution);
  if (name == "hand") return hand(resolution);
  if (name == "vessel") return vessel(resolution);
  std::string known;
  for (const std::string_view body : body_names) known += (known.empty() ? "" : ", ") + std::string(body);
  throw std::invalid_argument("no sample body is called '" + std::string(name) + "'; known are " + known);
}

}  // namespace morula
