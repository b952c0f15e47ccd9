// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sampling.hpp>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>
#include <tuple>

namespace morula::detail {
namespace {

using std::numbers::pi;

// Halves parts along the longest side until they are blocks, so that every block is compact.
void sort_compactly(std::span<std::uint32_t> order, std::span<const Vec3f> points) {
  if (order.size() <= block_size) return;
  Box box;
  for (const std::uint32_t i : order) box.add(Vec3(points[i]));
  const int axis = box.longest_axis();
  const std::size_t blocks = (order.size() + block_size - 1) / block_size;
  const std::size_t half = blocks / 2 * block_size;
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return points[a][axis] != points[b][axis] ? points[a][axis] < points[b][axis] : a < b;
                   });
  sort_compactly(order.first(half), points);
  sort_compactly(order.subspan(half), points);
}

// A view with its scalar type decided once, not per vertex.
template <class Scalar>
struct ReaderOf {
  const PositionView& view;
  Vec3 operator[](std::size_t vertex) const {
    Scalar s[3];
    std::memcpy(s, view.address(vertex), sizeof s);
    return {static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])};
  }
};

// The first vertex at the place of each vertex: components that share a seam without sharing vertices are one.
std::vector<std::uint32_t> first_at_place(const PositionView& positions) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t v) { return std::tuple(positions[v].x, positions[v].y, positions[v].z, v); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    // mutant sample-seams-apart: `first[order[i - 1]]` -> `order[i]`
    first[order[i]] = i > 0 && positions[order[i]] == positions[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

}  // namespace

// Connected components of the surface: the component that each sample lies on.
struct SurfaceSamples::ComponentIndex {
  std::vector<std::uint32_t> of_sample{};  // empty if there is only one component
  std::vector<std::size_t> sample_count{};

  // Samples of a component with too few samples for a ring have neighbors anywhere, as loose facets do.
  bool may_be_neighbors(std::uint32_t a, std::uint32_t b) const {
    // mutant sample-components-mixed: `of_sample.empty` -> `true || of_sample.empty`
    return of_sample.empty() || of_sample[a] == of_sample[b] || sample_count[of_sample[a]] <= ring_size;
  }
};

SurfaceSamples::ComponentIndex SurfaceSamples::index_components(const MeshView& rest) const {
  const std::vector<std::uint32_t> first = first_at_place(rest.positions);
  std::vector<Facet> facets(rest.facets.begin(), rest.facets.end());
  for (Facet& f : facets)
    for (std::uint32_t& v : f) v = first[v];
  const Components components = components_by_vertices(MeshView{rest.positions, facets});
  std::vector<std::uint32_t> of_vertex(rest.vertex_count());
  for (std::size_t f = 0; f < facets.size(); ++f)
    for (const std::uint32_t v : rest.facets[f]) of_vertex[v] = components.of_facet[f];
  ComponentIndex index;
  index.sample_count.resize(components.count);
  for (const Site& site : sites_) {
    index.of_sample.push_back(of_vertex[site.facet[0]]);
    ++index.sample_count[index.of_sample.back()];
  }
  return index;
}

SurfaceSamples::SurfaceSamples(const MeshView& rest, std::size_t count)
    : facets_(rest.facets.begin(), rest.facets.end()) {
  const MeshReport report = inspect(rest);
  if (!(report.area > 0)) throw std::invalid_argument("looseness estimate: the mesh has no area to sample");
  has_volume_ = report.has_volume() && report.volume != 0;
  inside_out_ = report.volume < 0;
  const double size = max_norm(report.box.extent());
  constexpr int ordinary = 20;  // sizes from 2^-20 to 2^20 keep cubes of a millionth of them within float
  if (std::abs(std::ilogb(size)) > ordinary) per_mesh_unit_ = std::ldexp(1.0, -std::ilogb(size));
  count = (count + block_size - 1) / block_size * block_size;
  const double each = report.area / static_cast<double>(count);
  std::vector<Vec3f> points;
  for (const SurfacePoint& s : sample_surface(rest, count)) {
    const auto [a, b, c] = rest.corners(s.facet);
    sites_.push_back({rest.facets[s.facet], s.barycentric, 2 * each / length(cross(b - a, c - a))});
    points.emplace_back((s.point - report.box.center()) * per_mesh_unit_);
  }
  sort_into_blocks(std::move(points));
  place(rest.positions, 0, sites_.size());
  bound_blocks();
  choose_rings(std::sqrt(each) * per_mesh_unit_,
               report.component_count > 1 ? index_components(rest) : ComponentIndex{});
  move(rest.positions);
}

void SurfaceSamples::sort_into_blocks(std::vector<Vec3f> points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  sort_compactly(order, points);
  std::vector<Site> sorted;
  for (const std::uint32_t i : order) sorted.push_back(sites_[i]);
  sites_ = std::move(sorted);
  blocks_.resize(sites_.size() / block_size);
  bounds_.resize(blocks_.size());
  group_bounds_.resize((blocks_.size() + group_size - 1) / group_size);
  for (std::vector<Vec3f>* v : {&point_, &normal_, &direction_}) v->resize(sites_.size());
  area_.resize(sites_.size());
}

void SurfaceSamples::choose_rings(double spacing, const ComponentIndex& index) {
  for (std::uint32_t i = 0; i < sites_.size(); ++i) sites_[i].ring = ring_of(i, spacing, index);
}

// One neighbor in each of six sectors about the normal: the nearest that is not so near that rounding and facets decide
// about the curvature, or the nearest of all. The other side of a thin wall is no neighbor, nor is a component that
// crosses this one, or leaves it when the body moves.
std::array<std::uint32_t, SurfaceSamples::ring_size> SurfaceSamples::ring_of(std::uint32_t sample, double spacing,
                                                                             const ComponentIndex& index) const {
  constexpr double near = 1.5, far = 4.0;  // spacings
  constexpr float other_side = -0.2f;      // cosine between normals
  const Vec3f normal = normal_[sample];
  const Vec3f u = normalized(cross(normal, std::abs(normal.x) < 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0}));
  const Vec3f v = cross(normal, u);
  constexpr std::uint32_t none = 0xffffffffu;
  std::array<std::uint32_t, ring_size> ring;
  std::array<double, ring_size> best;
  ring.fill(none);
  best.fill(std::numeric_limits<double>::infinity());
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (distance(bounds_[b].places.center, point_[sample]) >
        static_cast<double>(bounds_[b].places.radius) + far * spacing)
      continue;
    for (auto other = static_cast<std::uint32_t>(b * block_size); other < (b + 1) * block_size; ++other) {
      const Vec3f offset = point_[other] - point_[sample];
      const double gap = length(offset);
      if (other == sample || gap > far * spacing || dot(normal, normal_[other]) < other_side) continue;
      if (!index.may_be_neighbors(sample, other)) continue;
      const double turn = angle_of(static_cast<double>(dot(offset, v)), static_cast<double>(dot(offset, u)));
      const auto sector =
          std::min<std::size_t>(ring_size - 1, static_cast<std::size_t>((turn / pi + 1) * ring_size / 2));
      // Too near is worse than far away, and the nearer the worse.
      const double rank = gap >= near * spacing ? gap : (far + near) * spacing - gap;
      if (rank < best[sector]) best[sector] = rank, ring[sector] = other;
    }
  }
  std::uint32_t last = sample;
  for (const std::uint32_t other : ring) last = other != none ? other : last;
  for (std::uint32_t& other : ring) other = last = other != none ? other : last;
  return ring;
}

void SurfaceSamples::move(const PositionView& positions) noexcept {
  for (std::size_t step = 0; step < move_steps; ++step) {
    if (positions.is_double())
      move_step(ReaderOf<double>{positions}, step);
    else
      move_step(ReaderOf<float>{positions}, step);
  }
}

void SurfaceSamples::move(std::span<const Vec3> positions, std::size_t begin, std::size_t end) noexcept {
  for (std::size_t step = begin; step < end; ++step) move_step(positions.data(), step);
}

// Samples' places in three steps, directions in two, curvature in two, bounds; then the volume.
template <class Reader>
void SurfaceSamples::move_step(const Reader& positions, std::size_t step) noexcept {
  static_assert(move_steps == 16);
  const auto from = [this](std::size_t part, std::size_t parts) { return sites_.size() * part / parts; };
  if (step < 3) return place(positions, from(step, 3), from(step + 1, 3));
  if (step < 5) return average_directions(from(step - 3, 2), from(step - 2, 2));
  if (step < 7) return measure_curvature(from(step - 5, 2), from(step - 4, 2));
  if (step > 7) return measure_volume(positions, step - 8, move_steps - 8);
  bound_blocks();
  bound_groups();
}

template <class Reader>
void SurfaceSamples::place(const Reader& positions, std::size_t begin, std::size_t end) noexcept {
  if (begin == 0) origin_ = positions[facets_[0][0]];
  for (std::size_t i = begin; i < end; ++i) {
    const Site& s = sites_[i];
    const Vec3 a = (positions[s.facet[0]] - origin_) * per_mesh_unit_,
               b = (positions[s.facet[1]] - origin_) * per_mesh_unit_,
               c = (positions[s.facet[2]] - origin_) * per_mesh_unit_;
    const Vec3 twice_area = cross(b - a, c - a);
    const double size = length(twice_area);
    point_[i] = Vec3f(a * s.barycentric[0] + b * s.barycentric[1] + c * s.barycentric[2]);
    normal_[i] = size > 0 ? Vec3f(twice_area / (inside_out_ ? -size : size)) : Vec3f{};
    area_[i] = static_cast<float>(0.5 * size * s.share);
  }
}

void SurfaceSamples::bound_blocks() noexcept {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const std::span points(point_.data() + b * block_size, block_size);
    const std::span directions(direction_.data() + b * block_size, block_size);
    Vec3f lower = points[0], upper = points[0], sum;
    for (const Vec3f& p : points) lower = min(lower, p), upper = max(upper, p);
    for (const Vec3f& d : directions) sum += d;
    BlockBound& bound = bounds_[b];
    bound.places.center = (lower + upper) * 0.5f;
    bound.axis = normalized(sum);
    float squared = 0, cosine = 1;
    for (const Vec3f& p : points) squared = std::max(squared, squared_distance(p, bound.places.center));
    for (const Vec3f& d : directions) cosine = std::min(cosine, dot(d, bound.axis));
    bound.places.radius = std::sqrt(squared);
    bound.cosine = std::max(-1.0f, cosine);
    bound.sine = std::sqrt(1 - bound.cosine * bound.cosine);
  }
}

void SurfaceSamples::bound_groups() noexcept {
  for (std::size_t g = 0; g < group_bounds_.size(); ++g) {
    const std::size_t begin = g * group_size, end = std::min(bounds_.size(), begin + group_size);
    Vec3f lower = bounds_[begin].places.center, upper = lower;
    for (std::size_t b = begin; b < end; ++b)
      lower = min(lower, bounds_[b].places.center), upper = max(upper, bounds_[b].places.center);
    const Vec3f center = (lower + upper) * 0.5f;
    float radius = 0;
    for (std::size_t b = begin; b < end; ++b)
      radius = std::max(radius, distance(center, bounds_[b].places.center) + bounds_[b].places.radius);
    group_bounds_[g] = {center, radius};
  }
}

// Along the facets' own normals, rays would leave gaps outside sharp edges and cross in a rough surface.
void SurfaceSamples::average_directions(std::size_t begin, std::size_t end) noexcept {
  for (std::size_t i = begin; i < end; ++i) {
    Vec3f sum = normal_[i];
    for (const std::uint32_t neighbor : sites_[i].ring) sum += normal_[neighbor];
    direction_[i] = normalized(sum, normal_[i]);
    SampleBlock& block = blocks_[i / block_size];
    const std::size_t lane = i % block_size;
    block.x[lane] = point_[i].x, block.y[lane] = point_[i].y, block.z[lane] = point_[i].z;
    block.dx[lane] = direction_[i].x, block.dy[lane] = direction_[i].y, block.dz[lane] = direction_[i].z;
    block.flux[lane] = area_[i] * std::max(0.0f, dot(direction_[i], normal_[i]));
  }
}

// The ring moved out along the directions, p + t d, encloses the area a0 + a1 t + a2 t².
void SurfaceSamples::measure_curvature(std::size_t begin, std::size_t end) noexcept {
  constexpr float flat = 0.02f;  // share of the squared distances: rings of less area have no usable curvature
  for (std::size_t i = begin; i < end; ++i) {
    const auto& ring = sites_[i].ring;
    Vec3f a0, a1, a2;
    float squared_distances = 0;
    Vec3f p = point_[ring.back()] - point_[i], d = direction_[ring.back()] - direction_[i];
    for (const std::uint32_t neighbor : ring) {
      const Vec3f q = point_[neighbor] - point_[i], e = direction_[neighbor] - direction_[i];
      a0 += cross(p, q);
      a1 += cross(p, e) + cross(d, q);
      a2 += cross(d, e);
      squared_distances += squared_length(q);
      p = q, d = e;
    }
    const float area = dot(direction_[i], a0);
    const bool usable = area > flat * squared_distances;
    SampleBlock& block = blocks_[i / block_size];
    block.growth1[i % block_size] = usable ? dot(direction_[i], a1) / area : 0.0f;
    block.growth2[i % block_size] = usable ? dot(direction_[i], a2) / area : 0.0f;
  }
}

template <class Reader>
void SurfaceSamples::measure_volume(const Reader& positions, std::size_t part, std::size_t parts) noexcept {
  if (!has_volume_) {
    if (part > 0) return;
    const double area = std::accumulate(area_.begin(), area_.end(), 0.0) / (per_mesh_unit_ * per_mesh_unit_);
    volume_ = area * std::sqrt(area / pi) / 6;
    return;
  }
  // Six times the volume between a facet and the origin's height: over a closed surface that adds up to the volume
  // inside. There are two sums, so that one need not wait for the other.
  const auto six_volumes = [&](const Facet& f) {
    const Vec3 a = positions[f[0]], b = positions[f[1]], c = positions[f[2]];
    const double height = (a.z - origin_.z) + (b.z - origin_.z) + (c.z - origin_.z);
    return height * ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
  };
  const std::size_t begin = facets_.size() * part / parts, end = facets_.size() * (part + 1) / parts;
  double even = 0, odd = 0;
  std::size_t i = begin;
  for (; i + 1 < end; i += 2) even += six_volumes(facets_[i]), odd += six_volumes(facets_[i + 1]);
  // mutant estimate-volume-odd-facet: `i < end` -> `end < i`
  if (i < end) even += six_volumes(facets_[i]);
  six_volumes_ = (part == 0 ? 0 : six_volumes_) + even + odd;
  if (part + 1 == parts) volume_ = std::abs(six_volumes_) / 6;
}

}  // namespace morula::detail
