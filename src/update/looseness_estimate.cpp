// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/geometry/scale.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <numbers>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "simd/float4.hpp"
#include "update/points/surface_samples.hpp"

namespace morula {
using namespace detail;
namespace {

// One float per sample of a block.
using Lanes = std::array<Float4, block_size / 4>;

Float4 lanes_of(const SampleBlock::Lanes& values, std::size_t quad) {
  return Float4::load(values.data() + 4 * quad);
}

// 1 where value > 0, else 0; in between for values below 1e-30.
Float4 is_positive(const Float4& value) {
  return min(max(value * Float4(1e30f), Float4(0.0f)), Float4(1.0f));
}

// Where rays from the block's samples leave the ball, for those inside it; heights grow to that. side: 1 outward, −1.
void raise_to(const Spheref& ball, const SampleBlock& block, float side, Lanes& height) noexcept {
  const Float4 cx(ball.center.x), cy(ball.center.y), cz(ball.center.z), squared_radius(ball.radius * ball.radius);
  for (std::size_t q = 0; q < height.size(); ++q) {
    const Float4 x = lanes_of(block.x, q) - cx, y = lanes_of(block.y, q) - cy, z = lanes_of(block.z, q) - cz;
    const Float4 along =
        Float4(side) * (x * lanes_of(block.dx, q) + y * lanes_of(block.dy, q) + z * lanes_of(block.dz, q));
    const Float4 depth = max(squared_radius - (x * x + y * y + z * z), Float4(0.0f));
    height[q] = max(height[q], (sqrt(along * along + depth) - along) * is_positive(depth));
  }
}

bool touch(const Spheref& a, const Spheref& b) {
  const float reach = a.radius + b.radius;
  return squared_distance(a.center, b.center) <= reach * reach;
}

// Between directions: below 60 degrees, rays keep apart as curvature has it.
constexpr float facing_cosine = 0.5f, facing_sine = 0.5f * std::numbers::sqrt3_v<float>;

// One over the distance along a ray at which y becomes as near as its start x is 2 (y − x)·d / |y − x|². The largest
// over samples y whose directions face the ray's, lane by lane.
void find_facing(const Vec3f& from, const Vec3f& direction, float side, const SampleBlock& block,
                 Lanes& nearness) noexcept {
  const Float4 px(from.x), py(from.y), pz(from.z), dx(direction.x), dy(direction.y), dz(direction.z);
  const Float4 least_facing(facing_cosine), twice(2 * side), tiny(1e-30f);
  for (std::size_t q = 0; q < nearness.size(); ++q) {
    const Float4 x = lanes_of(block.x, q) - px, y = lanes_of(block.y, q) - py, z = lanes_of(block.z, q) - pz;
    const Float4 along = x * dx + y * dy + z * dz;
    const Float4 cosine = lanes_of(block.dx, q) * dx + lanes_of(block.dy, q) * dy + lanes_of(block.dz, q) * dz;
    const Float4 value = twice * along / (x * x + y * y + z * z + tiny);
    nearness[q] = max(nearness[q], value * is_positive(least_facing - cosine));
  }
}

// May a direction of one cone face one of the other?
bool may_face(const BlockBound& a, const BlockBound& b) {
  // Both half angles together, 0…2π; then what they leave of 60 degrees. No arccosine: it differs between libraries.
  const float cosine = a.cosine * b.cosine - a.sine * b.sine, sine = a.sine * b.cosine + a.cosine * b.sine;
  if (cosine <= facing_cosine || sine < 0) return true;
  return dot(a.axis, b.axis) <= facing_cosine * cosine + facing_sine * sine;
}

// Smallest positive root of 1 + a t + b t²: where neighbouring rays meet.
float focal_distance(float a, float b) {
  const float discriminant = a * a - 4 * b;
  const float divisor = discriminant >= 0 ? std::sqrt(discriminant) - a : 0.0f;
  return divisor > 0 ? 2 / divisor : std::numeric_limits<float>::infinity();
}

}  // namespace

// What is known about a ray at this pose: how near it comes to facing surface within `length`.
struct Outlook {
  float length = 0;
  float nearness = 0;
};

struct LoosenessEstimator::State {
  explicit State(const Mesh& rest, std::size_t count)
      : samples(rest, count), height(samples.blocks().size()), candidates(height.size()) {
    for (auto& side : outlook) side.resize(samples.count());
  }

  SurfaceSamples samples;
  std::vector<Lanes> height;                    // per block
  std::array<std::vector<Outlook>, 2> outlook;  // outward and inward, per sample
  std::vector<std::uint32_t> candidates;        // blocks that may face the present one; the first few are set

  void pose(const PositionView& positions) noexcept;
  double level(const Body& body, std::size_t level) noexcept;
  double outside_volume(const Body& body, std::size_t level, float side) noexcept;
  void raise_over_level(const Body& body, std::size_t level, float side) noexcept;
  void raise_over(const Spheref& ball, float side) noexcept;
  std::span<const std::uint32_t> blocks_facing(std::size_t block, float longest) noexcept;
  SampleBlock::Lanes ray_lengths(std::size_t block, float side) const noexcept;
  void look_out(std::size_t block, float side, const SampleBlock::Lanes& lengths) noexcept;
  double volume_over(std::size_t block, float side, const SampleBlock::Lanes& lengths) const noexcept;
  Outlook& outlook_of(std::size_t sample, float side) noexcept { return outlook[side < 0][sample]; }
};

void LoosenessEstimator::State::pose(const PositionView& positions) noexcept {
  samples.move(positions);
  for (auto& side : outlook) std::fill(side.begin(), side.end(), Outlook{});
}

void LoosenessEstimator::State::raise_over(const Spheref& ball, float side) noexcept {
  const std::vector<BlockBound>& bounds = samples.bounds();
  for (std::size_t g = 0; g < samples.group_bounds().size(); ++g) {
    if (!touch(ball, samples.group_bounds()[g])) continue;
    const std::size_t end = std::min(bounds.size(), (g + 1) * group_size);
    for (std::size_t b = g * group_size; b < end; ++b)
      if (touch(ball, bounds[b].places)) raise_to(ball, samples.blocks()[b], side, height[b]);
  }
}

// The spheres of level set j: those of level j and the leaves above it.
void LoosenessEstimator::State::raise_over_level(const Body& body, std::size_t level, float side) noexcept {
  for (Lanes& lanes : height) lanes.fill(Float4(0.0f));
  const SphereTree& tree = body.rest_tree();
  const double scale = samples.per_mesh_unit();
  const auto narrow_scale = static_cast<float>(scale);
  const Vec3f shift((body.origin() - samples.origin()) * scale);
  for (std::uint32_t node = 0; node < tree.level_begin[level + 1]; ++node) {
    if (node < tree.level_begin[level] && !tree.is_leaf(node)) continue;
    const Spheref& s = body.spheres()[node];
    raise_over({s.center * narrow_scale + shift, s.radius * narrow_scale}, side);
  }
}

// Rays end at focal points: neighbouring ones meet there, and beyond each would count what is the other's.
SampleBlock::Lanes LoosenessEstimator::State::ray_lengths(std::size_t b, float side) const noexcept {
  const SampleBlock& block = samples.blocks()[b];
  SampleBlock::Lanes lengths;
  for (std::size_t i = 0; i < block_size; ++i)
    lengths[i] = std::min(height[b][i / 4].lanes()[i % 4], focal_distance(side * block.growth1[i], block.growth2[i]));
  return lengths;
}

// Whatever is nearer to a point of a ray than its start lies within twice the ray's length of the start.
std::span<const std::uint32_t> LoosenessEstimator::State::blocks_facing(std::size_t block, float longest) noexcept {
  const std::vector<BlockBound>& bounds = samples.bounds();
  const Spheref reached{bounds[block].places.center, bounds[block].places.radius + 2 * longest};
  std::size_t count = 0;
  for (std::size_t g = 0; g < samples.group_bounds().size(); ++g) {
    if (!touch(reached, samples.group_bounds()[g])) continue;
    const std::size_t end = std::min(bounds.size(), (g + 1) * group_size);
    for (std::size_t b = g * group_size; b < end; ++b)
      if (touch(reached, bounds[b].places) && may_face(bounds[block], bounds[b]))
        candidates[count++] = static_cast<std::uint32_t>(b);
  }
  return std::span(candidates).first(count);
}

// Brings the outlook of the block's rays up to their heights. Levels are done from the coarse to the fine ones, whose
// rays are mostly shorter: they find everything known.
void LoosenessEstimator::State::look_out(std::size_t b, float side, const SampleBlock::Lanes& lengths) noexcept {
  float longest = 0;
  for (std::size_t i = 0; i < block_size; ++i)
    if (lengths[i] > outlook_of(b * block_size + i, side).length) longest = std::max(longest, lengths[i]);
  if (!(longest > 0)) return;
  const std::span<const std::uint32_t> facing = blocks_facing(b, longest);
  const SampleBlock& block = samples.blocks()[b];
  for (std::size_t i = 0; i < block_size; ++i) {
    const float length = lengths[i];
    Outlook& known = outlook_of(b * block_size + i, side);
    if (!(length > known.length)) continue;
    const Vec3f from{block.x[i], block.y[i], block.z[i]}, direction{block.dx[i], block.dy[i], block.dz[i]};
    const Spheref nearer{from + direction * (side * length), length};
    Lanes nearness;
    nearness.fill(Float4(0.0f));
    for (const std::uint32_t other : facing)
      if (touch(nearer, samples.bounds()[other].places))
        find_facing(from, direction, side, samples.blocks()[other], nearness);
    known = {length, largest_lane(max(max(nearness[0], nearness[1]), max(nearness[2], nearness[3])))};
  }
}

double LoosenessEstimator::State::volume_over(std::size_t b, float side,
                                              const SampleBlock::Lanes& lengths) const noexcept {
  const SampleBlock& block = samples.blocks()[b];
  double volume = 0;
  for (std::size_t i = 0; i < block_size; ++i) {
    const float nearness = outlook[side < 0][b * block_size + i].nearness;
    const float h = nearness * lengths[i] > 1.0f ? 1.0f / nearness : lengths[i];
    volume +=
        static_cast<double>(block.flux[i] * h * (1 + h * (side * block.growth1[i] / 2 + h * block.growth2[i] / 3)));
  }
  return volume;
}

double LoosenessEstimator::State::outside_volume(const Body& body, std::size_t level, float side) noexcept {
  raise_over_level(body, level, side);
  double volume = 0;
  for (std::size_t b = 0; b < height.size(); ++b) {
    const SampleBlock::Lanes lengths = ray_lengths(b, side);
    look_out(b, side, lengths);
    volume += volume_over(b, side, lengths);
  }
  return volume;
}

double LoosenessEstimator::State::level(const Body& body, std::size_t level) noexcept {
  const double volume = samples.volume();
  if (!(volume > 0)) return 0;
  if (level == 0) {
    const auto radius = static_cast<double>(body.spheres()[0].radius);
    const double ball = 4 * std::numbers::pi / 3 * radius * radius * radius;
    return std::max(0.0, ball / volume - (samples.has_volume() ? 1.0 : 0.0));
  }
  const double unit = 1 / samples.per_mesh_unit(), of_one = volume / (unit * unit * unit);
  const double outside = outside_volume(body, level, 1.0f);
  return (samples.has_volume() ? outside : outside + outside_volume(body, level, -1.0f)) / of_one;
}

LoosenessEstimator::LoosenessEstimator(const Mesh& rest, std::size_t sample_count) {
  const StandardFloats standard;
  require_usable(rest);
  require_usable_scale(rest);
  if (sample_count < 64 || sample_count > (std::size_t{1} << 20))
    throw std::invalid_argument("looseness estimate: " + std::to_string(sample_count) + " samples; 64…2^20 can be had");
  state_ = std::make_unique<State>(rest, sample_count);
}

LoosenessEstimator::~LoosenessEstimator() = default;
LoosenessEstimator::LoosenessEstimator(LoosenessEstimator&&) noexcept = default;
LoosenessEstimator& LoosenessEstimator::operator=(LoosenessEstimator&&) noexcept = default;

void LoosenessEstimator::pose(const PositionView& positions) noexcept {
  const StandardFloats standard;
  state_->pose(positions);
}

void LoosenessEstimator::estimate(const Body& body, std::span<double> looseness) noexcept {
  const StandardFloats standard;
  const std::size_t levels = body.rest_tree().level_count();
  for (std::size_t level = 0; level < looseness.size(); ++level)
    looseness[level] = level < levels ? state_->level(body, level) : looseness[levels - 1];
}

std::size_t LoosenessEstimator::sample_count() const {
  return state_->samples.count();
}

double LoosenessEstimator::volume() const {
  return state_->samples.volume();
}

std::vector<double> estimate_looseness(const Mesh& rest, const Body& body, const PositionView& positions) {
  const StandardFloats standard;
  if (positions.size() != rest.vertex_count() || positions.size() != body.vertex_count())
    throw std::invalid_argument("looseness estimate: " + std::to_string(positions.size()) +
                                " positions for a mesh of " + std::to_string(rest.vertex_count()) +
                                " vertices and a body of " + std::to_string(body.vertex_count()));
  LoosenessEstimator estimator(rest);
  estimator.pose(positions);
  std::vector<double> looseness(body.rest_tree().level_count());
  estimator.estimate(body, looseness);
  return looseness;
}

}  // namespace morula
