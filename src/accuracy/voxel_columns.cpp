// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "accuracy/voxel_columns.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <morula/geometry/triangle.hpp>
#include <morula/query/triangle_bvh.hpp>
#include <numbers>

#include "geometry/triangles/scan_triangle.hpp"

namespace morula::detail {
namespace {

// Rows (lattice lines of equal y) that a sphere or facet meets: [begin, end), clamped to the lattice.
struct Rows {
  int begin, end;
};

// Whole numbers in [lower, upper], or in [lower, upper) if a caller passes ceilings, for array indices.
int clamped(double index, int count) {
  return static_cast<int>(std::clamp(index, 0.0, static_cast<double>(count)));
}

// Lists of the items that meet each strip, as offsets and items, ascending in each strip.
class StripLists {
 public:
  template <class RowsOf>
  StripLists(std::size_t count, int strip_count, int strip_height, const RowsOf& rows_of)
      : begin_(static_cast<std::size_t>(strip_count) + 1, 0) {
    const auto each = [&](const auto& visit) {
      for (std::size_t i = 0; i < count; ++i) {
        const Rows rows = rows_of(i);
        if (rows.begin >= rows.end) continue;
        for (int s = rows.begin / strip_height; s <= (rows.end - 1) / strip_height; ++s)
          visit(static_cast<std::size_t>(s), static_cast<std::uint32_t>(i));
      }
    };
    each([&](std::size_t s, std::uint32_t) { ++begin_[s + 1]; });
    for (std::size_t s = 1; s < begin_.size(); ++s) begin_[s] += begin_[s - 1];
    items_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    each([&](std::size_t s, std::uint32_t i) { items_[next[s]++] = i; });
  }
  std::span<const std::uint32_t> operator[](std::size_t strip) const {
    return std::span(items_).subspan(begin_[strip], begin_[strip + 1] - begin_[strip]);
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> items_;
};

// Sets bits [begin, end) of a column.
void set_bits(std::span<std::uint64_t> words, int begin, int end) {
  if (begin >= end) return;
  const auto first = static_cast<std::size_t>(begin) / 64, last = static_cast<std::size_t>(end - 1) / 64;
  const std::uint64_t from_first = ~std::uint64_t{0} << (begin % 64);
  const std::uint64_t to_last = ~std::uint64_t{0} >> (63 - (end - 1) % 64);
  if (first == last) {
    words[first] |= from_first & to_last;
    return;
  }
  words[first] |= from_first;
  for (std::size_t w = first + 1; w < last; ++w) words[w] = ~std::uint64_t{0};
  words[last] |= to_last;
}

std::size_t count_bits(std::span<const std::uint64_t> words, int begin, int end) {
  if (begin >= end) return 0;
  const auto first = static_cast<std::size_t>(begin) / 64, last = static_cast<std::size_t>(end - 1) / 64;
  const std::uint64_t from_first = ~std::uint64_t{0} << (begin % 64);
  const std::uint64_t to_last = ~std::uint64_t{0} >> (63 - (end - 1) % 64);
  const auto bits = [](std::uint64_t w) { return static_cast<std::size_t>(std::popcount(w)); };
  if (first == last) return bits(words[first] & from_first & to_last);
  std::size_t sum = bits(words[first] & from_first) + bits(words[last] & to_last);
  for (std::size_t w = first + 1; w < last; ++w) sum += bits(words[w]);
  return sum;
}

// A change of the winding number of a column at the surface: it applies to voxels z and above.
struct ColumnCrossing {
  std::uint32_t column;  // index in the strip
  std::int32_t z;
  std::int32_t change;
};

// The part of the lattice that spheres reach. Bits are kept for this part only: spheres that are small compared with
// the object make a fine lattice that is nearly empty.
struct Window {
  int x_begin, x_end, z_begin, z_end;

  std::size_t words_per_column() const { return (static_cast<std::size_t>(z_end - z_begin) + 63) / 64; }
  std::size_t words_per_row() const { return static_cast<std::size_t>(x_end - x_begin) * words_per_column(); }
};

Window window_of(std::span<const Sphere> balls, const VoxelLattice& lattice) {
  Box box;
  for (const Sphere& b : balls) {
    box.add(b.center - Vec3{b.radius, b.radius, b.radius});
    box.add(b.center + Vec3{b.radius, b.radius, b.radius});
  }
  const auto begin = [&](int axis) { return clamped(std::floor(box.lower[axis]), lattice.count[axis]); };
  const auto end = [&](int axis) { return clamped(std::ceil(box.upper[axis]) + 1, lattice.count[axis]); };
  return {begin(0), std::max(begin(0), end(0)), begin(2), std::max(begin(2), end(2))};
}

/// The caps of an open surface in lattice coordinates, and the part of the lattice that they affect.
class CapField {
 public:
  CapField(const MeshView& caps, double sign) : bvh_(caps), sign_(sign) {
    // A surface of area A at distance d has a solid angle of A / d² at most; below π, a quarter of a turn, it leaves a
    // whole number on its side of every threshold. The factor above 1 is for rounding.
    squared_reach_ = 1.01 * surface_area(caps) / std::numbers::pi;
  }

  /// The part of a column in which caps may matter, [begin, end) within 0 … count.
  std::array<int, 2> near_part(int x, int y, int count) const {
    const Box& box = bvh_.bounding_box();
    const double dx = std::max({box.lower.x - x, x - box.upper.x, 0.0});
    const double dy = std::max({box.lower.y - y, y - box.upper.y, 0.0});
    const double left = squared_reach_ - dx * dx - dy * dy;
    if (!(left >= 0)) return {0, 0};
    const double reach = std::sqrt(left);
    const int begin = clamped(std::floor(box.lower.z - reach), count);
    return {begin, std::max(begin, clamped(std::ceil(box.upper.z + reach) + 1, count))};
  }
  /// Winding number of the open surface, from that of the closed one.
  double winding(std::int32_t closed, int x, int y, int z) const {
    constexpr double accuracy = 4;  // error below 0.005 of a turn
    const Vec3 center{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    return sign_ * (closed - bvh_.winding_number(center, accuracy));
  }
  bool is_inside_far_away(std::int32_t closed) const { return sign_ * closed > 0; }

 private:
  TriangleBvh bvh_;
  double sign_;
  double squared_reach_;
};

class StripCounter {
 public:
  StripCounter(const VoxelLattice& lattice, const Window& window, int row_begin, int row_end)
      : lattice_(lattice), window_(window), row_begin_(row_begin), row_end_(row_end) {}

  // center, radius: in lattice coordinates.
  void add_sphere(const Vec3& center, double radius) {
    if (bits_.empty()) bits_.resize(static_cast<std::size_t>(row_end_ - row_begin_) * window_.words_per_row());
    const int begin = std::max(row_begin_, clamped(std::ceil(center.y - radius), lattice_.count[1]));
    const int end = std::min(row_end_, clamped(std::floor(center.y + radius) + 1, lattice_.count[1]));
    for (int y = begin; y < end; ++y) {
      const double in_row = radius * radius - (y - center.y) * (y - center.y);
      if (in_row < 0) continue;
      const double half_width = std::sqrt(in_row);
      const int x_begin = clamped(std::ceil(center.x - half_width), lattice_.count[0]);
      const int x_end = clamped(std::floor(center.x + half_width) + 1, lattice_.count[0]);
      for (int x = x_begin; x < x_end; ++x) {
        const double in_column = in_row - (x - center.x) * (x - center.x);
        if (in_column < 0) continue;
        const double half_chord = std::sqrt(in_column);
        set_bits(column(x, y), clamped(std::ceil(center.z - half_chord), lattice_.count[2]) - window_.z_begin,
                 clamped(std::floor(center.z + half_chord) + 1, lattice_.count[2]) - window_.z_begin);
      }
    }
  }

  // Corners in lattice coordinates.
  void add_facet(const Triangle& corners) {
    const LineLattice columns{0, 1, 2, 0.0, lattice_.count[0], row_begin_, row_end_};
    scan_triangle(corners, columns, [&](int x, int y, double z, bool leaves) {
      crossings_.push_back(
          {static_cast<std::uint32_t>(column_index(x, y)), clamped(std::ceil(z), lattice_.count[2]), leaves ? -1 : 1});
    });
  }

  VoxelCounts count(Inside inside) {
    VoxelCounts counts;
    for (const std::uint64_t w : bits_) counts.in_union += static_cast<std::size_t>(std::popcount(w));
    if (inside == Inside::unknown) return counts;
    sort_crossings();
    for (std::size_t i = 0; i < crossings_.size();) {
      const std::uint32_t at = crossings_[i].column;
      const int x = static_cast<int>(at % static_cast<std::uint32_t>(lattice_.count[0]));
      const int y = row_begin_ + static_cast<int>(at / static_cast<std::uint32_t>(lattice_.count[0]));
      std::int32_t winding = 0;
      int entered = 0;
      for (; i < crossings_.size() && crossings_[i].column == at; ++i) {
        const bool was_inside = is_inside(winding, inside);
        winding += crossings_[i].change;
        if (was_inside == is_inside(winding, inside)) continue;
        if (!was_inside) {
          entered = crossings_[i].z;
        } else {
          counts.inside += static_cast<std::size_t>(crossings_[i].z - entered);
          counts.in_both += count_union(x, y, entered, crossings_[i].z);
        }
      }
    }
    return counts;
  }

  OpenVoxelCounts count_open(const CapField& caps) {
    OpenVoxelCounts counts;
    for (const std::uint64_t w : bits_) counts.in_union += static_cast<std::size_t>(std::popcount(w));
    sort_crossings();
    std::size_t next = 0;
    for (int y = row_begin_; y < row_end_; ++y)
      for (int x = 0; x < lattice_.count[0]; ++x) {
        const std::size_t at = column_index(x, y);
        const auto [near_begin, near_end] = caps.near_part(x, y, lattice_.count[2]);
        std::int32_t winding = 0;
        int z = 0;
        // The closed surface's winding number is constant from one crossing to the next.
        while (true) {
          const bool crosses = next < crossings_.size() && crossings_[next].column == at;
          const int end = crosses ? crossings_[next].z : lattice_.count[2];
          add_far(counts, caps, winding, x, y, z, std::min(end, near_begin));
          add_near(counts, caps, winding, x, y, std::max(z, near_begin), std::min(end, near_end));
          add_far(counts, caps, winding, x, y, std::max(z, near_end), end);
          counts.closed_turns += static_cast<std::int64_t>(winding) * std::max(0, end - z);
          z = std::max(z, end);
          if (!crosses) break;
          winding += crossings_[next++].change;
        }
      }
    return counts;
  }

 private:
  void add_far(OpenVoxelCounts& counts, const CapField& caps, std::int32_t winding, int x, int y, int begin, int end) {
    if (begin >= end || !caps.is_inside_far_away(winding)) return;
    const std::size_t both = count_union(x, y, begin, end);
    for (std::size_t t = 0; t < counts.inside.size(); ++t) {
      counts.inside[t] += static_cast<std::size_t>(end - begin);
      counts.in_both[t] += both;
    }
  }
  void add_near(OpenVoxelCounts& counts, const CapField& caps, std::int32_t winding, int x, int y, int begin, int end) {
    for (int z = begin; z < end; ++z) {
      const double turns = caps.winding(winding, x, y, z);
      if (turns <= inside_thresholds.front()) continue;
      const std::size_t both = count_union(x, y, z, z + 1);
      for (std::size_t t = 0; t < counts.inside.size(); ++t) {
        if (turns <= inside_thresholds[t]) break;
        ++counts.inside[t];
        counts.in_both[t] += both;
      }
    }
  }
  static bool is_inside(std::int32_t winding, Inside inside) {
    return inside == Inside::nonzero_winding ? winding != 0 : winding % 2 != 0;
  }
  std::size_t column_count() const {
    return static_cast<std::size_t>(row_end_ - row_begin_) * static_cast<std::size_t>(lattice_.count[0]);
  }
  std::size_t column_index(int x, int y) const {
    return static_cast<std::size_t>(y - row_begin_) * static_cast<std::size_t>(lattice_.count[0]) +
           static_cast<std::size_t>(x);
  }
  // x: in the window.
  std::span<std::uint64_t> column(int x, int y) {
    return std::span(bits_).subspan(static_cast<std::size_t>(y - row_begin_) * window_.words_per_row() +
                                        static_cast<std::size_t>(x - window_.x_begin) * window_.words_per_column(),
                                    window_.words_per_column());
  }
  std::size_t count_union(int x, int y, int z_begin, int z_end) {
    if (bits_.empty() || x < window_.x_begin || x >= window_.x_end) return 0;
    return count_bits(column(x, y), std::max(z_begin, window_.z_begin) - window_.z_begin,
                      std::min(z_end, window_.z_end) - window_.z_begin);
  }

  // Sorts by column, then by z. Crossings are first assigned to the columns, because nearly all columns hold two or
  // four.
  void sort_crossings() {
    std::vector<std::uint32_t> next(column_count() + 1, 0);
    for (const ColumnCrossing& c : crossings_) ++next[c.column + 1];
    for (std::size_t k = 1; k < next.size(); ++k) next[k] += next[k - 1];
    std::vector<ColumnCrossing> sorted(crossings_.size());
    for (const ColumnCrossing& c : crossings_) sorted[next[c.column]++] = c;
    crossings_.swap(sorted);
    for (std::size_t begin = 0; begin < crossings_.size();) {
      std::size_t end = begin + 1;
      while (end < crossings_.size() && crossings_[end].column == crossings_[begin].column) ++end;
      std::sort(crossings_.begin() + static_cast<std::ptrdiff_t>(begin),
                crossings_.begin() + static_cast<std::ptrdiff_t>(end),
                [](const ColumnCrossing& a, const ColumnCrossing& b) { return a.z < b.z; });
      begin = end;
    }
  }

  const VoxelLattice& lattice_;
  const Window& window_;
  int row_begin_, row_end_;
  std::vector<std::uint64_t>
      bits_;  // bits of the union in the window, 64 voxels of a column to a word; or nothing at all
  std::vector<ColumnCrossing> crossings_;
};

// Number of rows of a strip: enough columns to be worth a chunk, no more than 4 MiB of bits whatever the resolution (a
// single row of the longest lattice takes 8 MiB).
int strip_height(const Window& window) {
  constexpr std::size_t most_words = std::size_t{1} << 19;
  constexpr std::size_t tallest = 8;
  return static_cast<int>(
      std::clamp<std::size_t>(most_words / std::max<std::size_t>(1, window.words_per_row()), 1, tallest));
}

/// Counts all strips of a lattice. facets: facets of the surface that columns cross.
template <class Counts, class Count>
std::vector<Counts> count_strips(const VoxelLattice& lattice, const MeshView& mesh, bool with_facets,
                                 std::span<const Sphere> spheres, Workers& workers, const Count& count) {
  std::vector<Sphere> balls;
  balls.reserve(spheres.size());
  for (const Sphere& s : spheres) balls.push_back({lattice.to_lattice(s.center), s.radius / lattice.edge});
  const Window window = window_of(balls, lattice);
  const int height = strip_height(window);
  const int strip_count = (lattice.count[1] + height - 1) / height;
  const StripLists balls_of(balls.size(), strip_count, height, [&](std::size_t i) {
    return Rows{clamped(std::ceil(balls[i].center.y - balls[i].radius), lattice.count[1]),
                clamped(std::floor(balls[i].center.y + balls[i].radius) + 1, lattice.count[1])};
  });

  std::vector<Vec3> vertices(with_facets ? mesh.vertex_count() : 0);
  for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v] = lattice.to_lattice(mesh.positions[v]);
  const StripLists facets_of(with_facets ? mesh.facet_count() : 0, strip_count, height, [&](std::size_t f) {
    const double a = vertices[mesh.facets[f][0]].y, b = vertices[mesh.facets[f][1]].y,
                 c = vertices[mesh.facets[f][2]].y;
    return Rows{clamped(std::ceil(std::min({a, b, c})), lattice.count[1]),
                clamped(std::ceil(std::max({a, b, c})), lattice.count[1])};
  });

  std::vector<Counts> partial(static_cast<std::size_t>(strip_count));
  workers.run(partial.size(), [&](std::size_t strip) {
    const int row_begin = static_cast<int>(strip) * height;
    StripCounter counter(lattice, window, row_begin, std::min(row_begin + height, lattice.count[1]));
    for (const std::uint32_t i : balls_of[strip]) counter.add_sphere(balls[i].center, balls[i].radius);
    for (const std::uint32_t f : facets_of[strip])
      counter.add_facet({vertices[mesh.facets[f][0]], vertices[mesh.facets[f][1]], vertices[mesh.facets[f][2]]});
    partial[strip] = count(counter);
  });
  return partial;
}

}  // namespace

VoxelCounts count_voxels(const VoxelLattice& lattice, const MeshView& mesh, Inside inside,
                         std::span<const Sphere> spheres, Workers& workers) {
  VoxelCounts counts;
  for (const VoxelCounts& p : count_strips<VoxelCounts>(lattice, mesh, inside != Inside::unknown, spheres, workers,
                                                        [&](StripCounter& counter) { return counter.count(inside); })) {
    counts.in_union += p.in_union;
    counts.inside += p.inside;
    counts.in_both += p.in_both;
  }
  return counts;
}

OpenVoxelCounts count_open_voxels(const VoxelLattice& lattice, const MeshView& closed, std::size_t first_cap,
                                  double sign, std::span<const Sphere> spheres, Workers& workers) {
  std::vector<Vec3> vertices(closed.vertex_count());
  for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v] = lattice.to_lattice(closed.positions[v]);
  const CapField caps(MeshView(vertices, closed.facets.subspan(first_cap)), sign);
  OpenVoxelCounts counts;
  for (const OpenVoxelCounts& p : count_strips<OpenVoxelCounts>(
           lattice, closed, true, spheres, workers, [&](StripCounter& counter) { return counter.count_open(caps); })) {
    counts.in_union += p.in_union;
    counts.closed_turns += p.closed_turns;
    for (std::size_t t = 0; t < counts.inside.size(); ++t) {
      counts.inside[t] += p.inside[t];
      counts.in_both[t] += p.in_both[t];
    }
  }
  return counts;
}

}  // namespace morula::detail
