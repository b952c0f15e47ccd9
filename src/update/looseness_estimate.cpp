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
#include "update/points/ray_kernels.hpp"
#include "update/points/surface_samples.hpp"

namespace morula {
using namespace detail;
namespace {

bool touch(const Spheref& a, const Spheref& b) {
  const float reach = a.radius + b.radius;
  return squared_distance(a.center, b.center) <= reach * reach;
}

// Sine of the angle of facing_cosine.
constexpr float facing_sine = 0.5f * std::numbers::sqrt3_v<float>;

// Whether a direction of one cone may face one of the other.
bool may_face(const BlockBound& a, const BlockBound& b) {
  // Cosine and sine of both half angles together, 0…2π; then of the rest up to 60 degrees. No arccosine: it differs
  // between libraries.
  const float cosine = a.cosine * b.cosine - a.sine * b.sine, sine = a.sine * b.cosine + a.cosine * b.sine;
  if (cosine <= facing_cosine || sine < 0) return true;
  return dot(a.axis, b.axis) <= facing_cosine * cosine + facing_sine * sine;
}

// Smallest positive root of 1 + a t + b t²: where neighboring rays meet.
float focal_distance(float a, float b) {
  const float discriminant = a * a - 4 * b;
  const float divisor = discriminant >= 0 ? std::sqrt(discriminant) - a : 0.0f;
  return divisor > 0 ? 2 / divisor : std::numeric_limits<float>::infinity();
}

// Most spheres that rays are raised over at a time.
constexpr std::size_t most_spheres = 512;

constexpr std::size_t most_levels = max_depth + 1;

// Approximate nanoseconds per item of an estimate's tasks: only their ratios matter, because steps share the tasks by
// them.
constexpr double facet_cost = 3, sphere_cost = 1.7, facing_cost = 2.5, block_cost = 80;
// Cost of a sample, in each step that moves it.
constexpr std::array<double, SurfaceSamples::move_steps / 2> move_cost{8, 8, 8, 4, 4, 21, 21, 4};

}  // namespace

// The reciprocal distance at which a ray comes nearest to facing surface within `length`, at this pose.
struct Outlook {
  float length = 0;
  float nearness = 0;
};

// A body's spheres at the moment of an estimate.
struct Subject {
  const SphereTree* tree = nullptr;
  std::span<const Spheref> spheres{};
  Vec3 origin{};
};

Subject subject_of(const Body& body) noexcept {
  return {&body.rest_tree(), body.spheres(), body.origin()};
}

// Blocks whose rays one task searches.
constexpr std::size_t blocks_per_look = 2;
// Tasks of a group at one level and to one side: rays are raised over the spheres, then the rays of its blocks are
// searched.
constexpr std::size_t tasks_per_side = 1 + group_size / blocks_per_look;

// An estimate in steps: its tasks come in a fixed order, and each step gets as many as make up its share of the cost.
// The cost of a task was counted in the last estimate: a body moves little from one to the next.
struct Course {
  std::vector<Vec3> positions;
  std::vector<Spheref> spheres;
  Subject subject;
  std::size_t step = 0, steps = 0;  // equal: no estimate is in progress
  std::size_t task = 0;
  double cost = 0, whole_cost = 0;  // expected cost of the finished tasks, and of all
  std::vector<double> expected;     // expected cost of each task
};

struct LoosenessEstimator::State {
  State(const MeshView& rest, std::size_t count)
      : samples(rest, count), height(samples.blocks().size()), facing(height.size()) {
    facing_places.reserve(height.size());
    spheres.reserve(most_spheres);
    for (auto& side : outlook) side.resize(samples.count());
    course.positions.resize(rest.vertex_count());
    course.expected.resize(SurfaceSamples::move_steps +
                           samples.group_bounds().size() * (most_levels - 1) * per_level());
    for (std::size_t task = 0; task < course.expected.size(); ++task) course.expected[task] = first_guess(task);
  }

  SurfaceSamples samples;
  std::vector<SampleBlock::Lanes> height;       // per block
  std::array<std::vector<Outlook>, 2> outlook;  // outward and inward, per sample
  std::vector<std::uint32_t> facing;            // blocks that may face the present one
  RaySphereList facing_places;                  // places of these blocks
  RaySphereList spheres;                        // spheres that rays are being raised over
  Course course{};
  double work = 0;                                           // work of the current task
  std::array<std::array<double, most_levels>, 2> outside{};  // volume per level, outward and inward: of a course

  struct Blocks {
    std::size_t begin, end;
  };
  Blocks all_blocks() const noexcept { return {0, height.size()}; }
  Blocks some_blocks(std::size_t begin, std::size_t count) const noexcept {
    return {std::min(begin, height.size()), std::min(begin + count, height.size())};
  }
  // Number of levels below the root of the present course.
  std::size_t level_count() const noexcept { return std::min(most_levels, course.subject.tree->level_count()) - 1; }
  std::size_t per_level() const noexcept { return (samples.has_volume() ? 1 : 2) * tasks_per_side; }
  std::size_t task_count() const noexcept {
    return SurfaceSamples::move_steps + samples.group_bounds().size() * level_count() * per_level();
  }
  double first_guess(std::size_t task) const noexcept;
  void run(std::size_t task) noexcept;

  void forget_outlook() noexcept;
  void pose(const PositionView& positions) noexcept;
  double looseness_at(const Subject& subject, std::size_t level, double outward, double inward) const noexcept;
  double level(const Subject& subject, std::size_t level) noexcept;
  double outside_volume(const Subject& subject, std::size_t level, float side) noexcept;
  double look_out_from(Blocks blocks, float side, double volume) noexcept;
  void raise_over_level(const Subject& subject, std::size_t level, float side, Blocks blocks) noexcept;
  void raise_over_spheres(float side, Blocks blocks) noexcept;
  FacingBlocks blocks_facing(std::size_t block, float longest) noexcept;
  SampleBlock::Lanes ray_lengths(std::size_t block, float side) const noexcept;
  void look_out(std::size_t block, float side, const SampleBlock::Lanes& lengths) noexcept;
  double volume_over(std::size_t block, float side, const SampleBlock::Lanes& lengths) const noexcept;
  Outlook& outlook_of(std::size_t sample, float side) noexcept { return outlook[side < 0][sample]; }
};

void LoosenessEstimator::State::forget_outlook() noexcept {
  for (auto& side : outlook) std::fill(side.begin(), side.end(), Outlook{});
}

void LoosenessEstimator::State::pose(const PositionView& positions) noexcept {
  course.step = course.steps;
  samples.move(positions);
  forget_outlook();
}

void LoosenessEstimator::State::raise_over_spheres(float side, Blocks blocks) noexcept {
  const RaySpheres columns = spheres.columns();
  for (std::size_t b = blocks.begin; b < blocks.end; ++b)
    ray_kernels().raise(samples.blocks()[b], samples.bounds()[b].places, columns, side, height[b].data());
  work += sphere_cost * static_cast<double>(spheres.count() * (blocks.end - blocks.begin));
  spheres.clear();
}

// Raises rays over the spheres of level set j: the spheres of level j and of the leaves above it.
void LoosenessEstimator::State::raise_over_level(const Subject& subject, std::size_t level, float side,
                                                 Blocks blocks) noexcept {
  for (std::size_t b = blocks.begin; b < blocks.end; ++b) height[b].fill(0);
  const SphereTree& tree = *subject.tree;
  const double scale = samples.per_mesh_unit();
  const auto narrow_scale = static_cast<float>(scale);
  const Vec3f shift((subject.origin - samples.origin()) * scale);
  for (std::uint32_t node = 0; node < tree.level_begin[level + 1]; ++node) {
    if (node < tree.level_begin[level] && !tree.is_leaf(node)) continue;
    const Spheref& s = subject.spheres[node];
    spheres.add({s.center * narrow_scale + shift, s.radius * narrow_scale});
    // mutant rays-spheres-of-full-lists-lost: `raise_over_spheres(side, blocks)` -> `spheres.clear()`
    if (spheres.count() == most_spheres) raise_over_spheres(side, blocks);
  }
  raise_over_spheres(side, blocks);
}

// Rays end at focal points: neighboring ones meet there, and beyond it each would count the other's volume.
SampleBlock::Lanes LoosenessEstimator::State::ray_lengths(std::size_t b, float side) const noexcept {
  const SampleBlock& block = samples.blocks()[b];
  SampleBlock::Lanes lengths;
  for (std::size_t i = 0; i < block_size; ++i)
    lengths[i] = std::min(height[b][i], focal_distance(side * block.growth1[i], block.growth2[i]));
  return lengths;
}

// Points that are nearer to a point of a ray than its start lie within twice the ray's length of the start.
FacingBlocks LoosenessEstimator::State::blocks_facing(std::size_t block, float longest) noexcept {
  const std::vector<BlockBound>& bounds = samples.bounds();
  const Spheref reached{bounds[block].places.center, bounds[block].places.radius + 2 * longest};
  facing_places.clear();
  for (std::size_t g = 0; g < samples.group_bounds().size(); ++g) {
    if (!touch(reached, samples.group_bounds()[g])) continue;
    const std::size_t end = std::min(bounds.size(), (g + 1) * group_size);
    for (std::size_t b = g * group_size; b < end; ++b)
      if (touch(reached, bounds[b].places) && may_face(bounds[block], bounds[b]))
        facing[facing_places.count()] = static_cast<std::uint32_t>(b), facing_places.add(bounds[b].places);
  }
  return {samples.blocks().data(), facing.data(), facing_places.columns()};
}

// Extends the outlook of the block's rays to their heights. Levels are processed from the coarse to the fine ones,
// whose rays are mostly shorter: their outlook is mostly computed already.
void LoosenessEstimator::State::look_out(std::size_t b, float side, const SampleBlock::Lanes& lengths) noexcept {
  float longest = 0;
  for (std::size_t i = 0; i < block_size; ++i)
    if (lengths[i] > outlook_of(b * block_size + i, side).length) longest = std::max(longest, lengths[i]);
  if (!(longest > 0)) return;
  const FacingBlocks may_be_faced = blocks_facing(b, longest);
  work += facing_cost * static_cast<double>(samples.bounds().size() + block_size * facing_places.count());
  const SampleBlock& block = samples.blocks()[b];
  for (std::size_t i = 0; i < block_size; ++i) {
    const float length = lengths[i];
    Outlook& known = outlook_of(b * block_size + i, side);
    if (!(length > known.length)) continue;
    const Vec3f from{block.x[i], block.y[i], block.z[i]}, direction{block.dx[i], block.dy[i], block.dz[i]};
    known = {length, ray_kernels().nearness({from, direction, side, length}, may_be_faced)};
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

// Volume of the rays as they have been raised. Adds to `volume`, block after block: the same sum whether all come at
// once or a few at a time.
double LoosenessEstimator::State::look_out_from(Blocks blocks, float side, double volume) noexcept {
  for (std::size_t b = blocks.begin; b < blocks.end; ++b) {
    const SampleBlock::Lanes lengths = ray_lengths(b, side);
    look_out(b, side, lengths);
    volume += volume_over(b, side, lengths);
    work += block_cost;
  }
  return volume;
}

double LoosenessEstimator::State::outside_volume(const Subject& subject, std::size_t level, float side) noexcept {
  raise_over_level(subject, level, side, all_blocks());
  return look_out_from(all_blocks(), side, 0);
}

double LoosenessEstimator::State::looseness_at(const Subject& subject, std::size_t level, double outward,
                                               double inward) const noexcept {
  const double volume = samples.volume();
  if (!(volume > 0)) return 0;
  if (level == 0) {
    const auto radius = static_cast<double>(subject.spheres[0].radius);
    const double ball = 4 * std::numbers::pi / 3 * radius * radius * radius;
    return std::max(0.0, ball / volume - (samples.has_volume() ? 1.0 : 0.0));
  }
  const double unit = 1 / samples.per_mesh_unit(), of_one = volume / (unit * unit * unit);
  return (samples.has_volume() ? outward : outward + inward) / of_one;
}

double LoosenessEstimator::State::level(const Subject& subject, std::size_t level) noexcept {
  double outward = 0, inward = 0;
  if (level > 0 && samples.volume() > 0) {
    outward = outside_volume(subject, level, 1.0f);
    if (!samples.has_volume()) inward = outside_volume(subject, level, -1.0f);
  }
  return looseness_at(subject, level, outward, inward);
}

// Estimated cost of a task that has not run yet.
double LoosenessEstimator::State::first_guess(std::size_t task) const noexcept {
  if (task < move_cost.size()) return move_cost[task] * static_cast<double>(samples.count());
  if (task < SurfaceSamples::move_steps)
    return facet_cost * static_cast<double>(samples.facet_count()) / static_cast<double>(move_cost.size());
  return 20 * block_cost;
}

// First the samples are moved, step by step. Then the rays of each group's blocks are searched, at every level and to
// both sides where these count.
void LoosenessEstimator::State::run(std::size_t task) noexcept {
  if (task < SurfaceSamples::move_steps) return samples.move(course.positions, task, task + 1);
  std::size_t k = task - SurfaceSamples::move_steps;
  if (k == 0) {
    forget_outlook();
    for (auto& side : outside) side.fill(0);
  }
  const std::size_t part = k % tasks_per_side, inward = k % per_level() / tasks_per_side;
  k /= per_level();
  const std::size_t level = 1 + k % level_count(), first = k / level_count() * group_size;
  const float side = inward == 0 ? 1.0f : -1.0f;
  work = 0;
  if (part == 0) {
    raise_over_level(course.subject, level, side, some_blocks(first, group_size));
  } else {
    double& volume = outside[inward][level];
    volume = look_out_from(some_blocks(first + (part - 1) * blocks_per_look, blocks_per_look), side, volume);
  }
  course.expected[task] = work;
}

LoosenessEstimator::LoosenessEstimator(const MeshView& rest, std::size_t sample_count) {
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
    looseness[level] = level < levels ? state_->level(subject_of(body), level) : looseness[levels - 1];
}

void LoosenessEstimator::reserve(std::size_t nodes) {
  state_->course.spheres.reserve(nodes);
}

void LoosenessEstimator::give_up() noexcept {
  state_->course.step = state_->course.steps;
}

void LoosenessEstimator::begin(const PositionView& positions, const Body& body, std::size_t steps) noexcept {
  const StandardFloats standard;
  State& s = *state_;
  for (std::size_t v = 0; v < s.course.positions.size(); ++v) s.course.positions[v] = positions[v];
  s.course.spheres.assign(body.spheres().begin(), body.spheres().end());
  s.course.subject = {&body.rest_tree(), s.course.spheres, body.origin()};
  s.course.step = s.course.task = 0;
  s.course.steps = std::max<std::size_t>(1, steps);
  s.course.cost = s.course.whole_cost = 0;
  for (std::size_t task = 0; task < s.task_count(); ++task) s.course.whole_cost += s.course.expected[task];
}

bool LoosenessEstimator::step(std::span<double> looseness) noexcept {
  const StandardFloats standard;
  State& s = *state_;
  Course& c = s.course;
  if (c.step == c.steps) return false;
  const bool last = ++c.step == c.steps;
  const double until = c.whole_cost * static_cast<double>(c.step) / static_cast<double>(c.steps);
  // A task that is due by a half is run.
  for (; c.task < s.task_count() && (last || c.cost + c.expected[c.task] / 2 < until); ++c.task) {
    c.cost += c.expected[c.task];
    s.run(c.task);
  }
  if (!last) return false;
  const std::size_t levels = c.subject.tree->level_count();
  for (std::size_t level = 0; level < looseness.size(); ++level)
    looseness[level] = level < levels ? s.looseness_at(c.subject, level, s.outside[0][level], s.outside[1][level])
                                      : looseness[levels - 1];
  return true;
}

std::size_t LoosenessEstimator::sample_count() const {
  return state_->samples.count();
}

bool LoosenessEstimator::has_volume() const {
  return state_->samples.has_volume();
}

double LoosenessEstimator::volume() const {
  return state_->samples.volume();
}

std::vector<double> estimate_looseness(const MeshView& rest, const Body& body, const PositionView& positions) {
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
