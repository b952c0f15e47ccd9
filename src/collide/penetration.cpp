// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/collide/penetration.hpp>
#include <morula/geometry/box.hpp>
#include <numbers>

#include "collide/body_identity.hpp"
#include "collide/pairs/meter.hpp"
#include "collide/require.hpp"
#include "geometry/object_call.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

/// The number of first cells along the longest side of the box that holds both bodies.
constexpr double first_cells = 4;
/// The most halvings of the first cells: then cells are 10^-6 of the box, the finest that the coordinates of bodies far
/// from the origin resolve.
constexpr std::uint32_t most_levels = 18;

struct Cell {
  Vec3 center;
  std::uint32_t level;
  /// Whether the cell is known to be inside a, inside b; then so are all its parts.
  bool in_a, in_b;
};

/// The parts of a cell's volume, as shares: proven to be inside, proven to be outside, and estimated to be inside.
struct Share {
  double inside = 0, outside = 0, guess = 0.5;
};

/// The cells of which all others are parts; start() fills it, and the query does not change it.
struct FirstCells {
  Vec3 half;          // half sides of a first cell
  double pad = 0;     // upper bound of the error of a distance
  double volume = 0;  // volume of one first cell
  double all = 0;     // volume of all first cells

  double volume_of(std::uint32_t level) const { return std::ldexp(volume, -3 * static_cast<int>(level)); }
};

/// Undecided cells of one level, each with its share: start() fills in the first, divide_next() their parts.
struct OpenCells {
  std::vector<Cell> cells;
  std::vector<Share> shares;

  std::size_t size() const { return cells.size(); }
  void clear() noexcept { cells.clear(), shares.clear(); }
  void add(const Cell& cell, const Share& share) {
    cells.push_back(cell);
    shares.push_back(share);
  }
  void swap(OpenCells& other) noexcept { cells.swap(other.cells), shares.swap(other.shares); }
};

/// Sums over cells: a cell is added when it is proven to be inside or left open, and an open cell is subtracted when it
/// is divided.
struct CellSums {
  double sure = 0;                       // volume of cells inside both
  Vec3 sure_moment;                      // the same volumes times their centers
  double open_inside = 0, open_all = 0;  // volume in undivided cells: proven to be inside, and possibly inside

  void add_inside(const Cell& cell, double volume) { sure += volume, sure_moment += cell.center * volume; }
  void add_open(const Share& share, double volume) {
    open_inside += share.inside;
    open_all += volume - share.outside;
  }
  void remove_open(const Share& share, double volume) {
    open_inside -= share.inside;
    open_all -= volume - share.outside;
  }
};

/// Bounds of the volume, the best so far: balls of a cell may prove more than the balls of its parts.
struct VolumeBounds {
  double lower = 0, upper = 0;

  void narrow(const CellSums& sums) {
    lower = std::max(lower, sums.sure + sums.open_inside);
    upper = std::min(upper, sums.sure + sums.open_all);
  }
};

/// The estimated share of a cell that is inside, if the nearer surface is a plane.
double share_inside(double distance, double half_side) {
  return std::clamp(0.5 - 0.5 * distance / half_side, 0.0, 1.0);
}

/// A lower bound of the volume that a ball about the center of a cube, of half side 1, has inside the cube: the ball
/// less the caps beyond the six sides, which do not overlap as long as the ball reaches no farther than the middles of
/// the edges. A larger ball counts as one that reaches so far.
double ball_in_cube(double radius) {
  constexpr double pi = std::numbers::pi;
  const double r = std::clamp(radius, 0.0, std::numbers::sqrt2), h = std::max(0.0, r - 1);
  return 4.0 / 3.0 * pi * r * r * r - 6 * (pi * h * h * (3 * r - h) / 3);
}

struct Frame {
  std::uint64_t frame = 0;
  RigidTransform transform{};
  BodyIdentity body{};
};
Frame frame_of(const Collider& collider) {
  return {collider.sphere_state().frame, collider.transform(), BodyIdentity(collider)};
}
/// ok, or the difference.
Status::Code compared(const Frame& then, const Frame& now) {
  // mutant penetration-of-assigned: `!(then.body == now.body)` -> `false`
  if (!(then.body == now.body)) return Status::Code::other_bodies;
  if (then.frame != now.frame) return Status::Code::other_frame;
  return then.transform == now.transform ? Status::Code::ok : Status::Code::other_transform;
}

Box box_of(const Collider& body) {
  Box box;
  for (const Facet& f : body.mesh_facets())
    for (const std::uint32_t v : f) box.add(body.vertex(v));
  return box;
}

}  // namespace

struct PenetrationQuery::State {
  State(const Collider& a, const Collider& b) : body{hold(a), hold(b)}, queries{InsideQuery(a), InsideQuery(b)} {}

  CallState call;
  std::array<std::shared_ptr<const Collider>, 2> body;
  std::array<InsideQuery, 2> queries;
  std::array<Frame, 2> frames{};
  PairAsRead read{};  // the pair as the present call reads it
  bool is_started = false;

  FirstCells first{};
  OpenCells open, parts;  // undecided cells of this level and of the next
  std::size_t next = 0;   // place in `open`: all cells ahead of it are divided already
  CellSums sums{};
  VolumeBounds best{};

  Status usable(const PenetrationOptions& options) const {
    if (!(options.tolerance >= 0) || !std::isfinite(options.tolerance) || !(options.volume_tolerance >= 0) ||
        !std::isfinite(options.volume_tolerance) || (options.budget.is_tests() && options.budget.tests() < 0) ||
        (options.budget.is_time() && options.budget.time().count() < 0))
      return {.code = Status::Code::bad_option};
    for (std::uint8_t i = 0; i < 2; ++i)
      if (const Status status = askable(*body[i], i); !status) return status;
    return {};
  }

  void begin_reading() { read = PairAsRead(*body[0], *body[1]); }
  Penetration done(ObjectCall<State>& own, const Penetration& result) {
    const Status status = read.status();
    own.finish(status ? result.status : status);
    return status ? result : Penetration{.status = status};
  }

  void forget() noexcept {
    is_started = false;
    open.clear(), parts.clear();
  }
  void start() {
    is_started = true;
    open.clear(), parts.clear();
    first = {}, sums = {}, best = {}, next = 0;
    for (std::size_t i = 0; i < 2; ++i) frames[i] = frame_of(*body[i]);
    const Box a = box_of(*body[0]), b = box_of(*body[1]);
    Box both{max(a.lower, b.lower), min(a.upper, b.upper)};
    if (both.is_empty()) return;
    // The box is enlarged, so that surface that touches its border is within it.
    const double largest = std::max(max_norm(both.lower), max_norm(both.upper));
    const double room = 0x1p-40 * largest;
    both.lower -= Vec3{room, room, room}, both.upper += Vec3{room, room, room};
    // Centers of cells, distances to facets and corners are off by less than 2^-46 of the coordinates.
    first.pad = 0x1p-44 * largest;
    const Vec3 extent = both.extent();
    const double side = std::max({extent.x, extent.y, extent.z}) / first_cells;
    if (!(side > 0)) return;
    std::array<int, 3> count{};
    for (int k = 0; k < 3; ++k) {
      count[static_cast<std::size_t>(k)] = std::max(1, static_cast<int>(std::ceil(extent[k] / side * (1 - 0x1p-40))));
      first.half[k] = 0.5 * extent[k] / count[static_cast<std::size_t>(k)];
    }
    const Vec3& half = first.half;
    first.volume = 8 * half.x * half.y * half.z;
    for (int x = 0; x < count[0]; ++x)
      for (int y = 0; y < count[1]; ++y)
        for (int z = 0; z < count[2]; ++z) {
          open.add(
              {both.lower + Vec3{(2 * x + 1) * half.x, (2 * y + 1) * half.y, (2 * z + 1) * half.z}, 0, false, false},
              {});
          sums.add_open({}, first.volume);
        }
    best.upper = first.all = sums.open_all;
  }

  struct Verdict {
    Status status;
    enum { undecided, inside, outside } what = undecided;
    Share share{};
    std::size_t probes = 0;
  };
  /// Queries the bodies that are not known to contain the whole cell.
  Verdict visit(Cell& cell) {
    Verdict verdict;
    const Vec3& half = first.half;
    const double scale = std::ldexp(1.0, -static_cast<int>(cell.level));
    // mutant penetration-cell-by-its-middle: `length` -> `0 * length`
    const double reach = length(half) * scale * (1 + 0x1p-40) + first.pad;
    const double half_side = std::cbrt(first.volume_of(cell.level)) * 0.5;
    verdict.share.guess = 1;
    double radius_inside = std::numeric_limits<double>::infinity(), radius_outside = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      bool& in = i == 0 ? cell.in_a : cell.in_b;
      if (in) continue;
      const Probe probe = queries[i].probe({cell.center, 0});
      ++verdict.probes;
      if (!probe.status) {
        verdict.status = probe.status;
        verdict.status.body = static_cast<std::uint8_t>(i);
        return verdict;
      }
      if (probe.distance > reach) {
        verdict.what = Verdict::outside;
        return verdict;
      }
      in = probe.distance < -reach;
      verdict.share.guess = std::min(verdict.share.guess, share_inside(probe.distance, half_side));
      radius_inside = std::min(radius_inside, -probe.distance - first.pad);
      radius_outside = std::max(radius_outside, probe.distance - first.pad);
    }
    // The ball in the largest cube about the center that is in the cell.
    const double least_half = std::min({half.x, half.y, half.z}) * scale, cube = least_half * least_half * least_half;
    verdict.share.inside = ball_in_cube(radius_inside / least_half) * cube * (1 - 0x1p-40);
    verdict.share.outside = ball_in_cube(radius_outside / least_half) * cube * (1 - 0x1p-40);
    if (cell.in_a && cell.in_b) verdict.what = Verdict::inside;
    return verdict;
  }

  /// Replaces the next cell by its undecided parts.
  Status divide_next(std::size_t& probes) {
    const Cell cell = open.cells[next];
    const std::uint32_t level = cell.level + 1;
    const Vec3 quarter = first.half * std::ldexp(1.0, -static_cast<int>(level));
    const double part_volume = first.volume_of(level);
    std::array<Cell, 8> below;
    std::array<Verdict, 8> verdicts;
    for (std::size_t k = 0; k < 8; ++k) {
      below[k] = {cell.center + Vec3{k & 1 ? quarter.x : -quarter.x, k & 2 ? quarter.y : -quarter.y,
                                     k & 4 ? quarter.z : -quarter.z},
                  level, cell.in_a, cell.in_b};
      verdicts[k] = visit(below[k]);
      probes += verdicts[k].probes;
      if (!verdicts[k].status) return verdicts[k].status;
    }
    sums.remove_open(open.shares[next], first.volume_of(cell.level));
    ++next;
    for (std::size_t k = 0; k < 8; ++k) {
      if (verdicts[k].what == Verdict::inside) sums.add_inside(below[k], part_volume);
      if (verdicts[k].what != Verdict::undecided) continue;
      parts.add(below[k], verdicts[k].share);
      sums.add_open(verdicts[k].share, part_volume);
    }
    return {};
  }

  /// Computes bounds and center from the present sums.
  void sum_up(Penetration& result) const {
    double guess = sums.sure;
    Vec3 moment = sums.sure_moment;
    const auto add = [&](const Cell& cell, const Share& share) {
      const double part = first.volume_of(cell.level);
      guess += part * share.guess;
      moment += cell.center * (part * share.guess);
    };
    for (std::size_t i = next; i < open.size(); ++i) add(open.cells[i], open.shares[i]);
    for (std::size_t i = 0; i < parts.size(); ++i) add(parts.cells[i], parts.shares[i]);
    if (guess > 0) result.center = moment / guess;
    // Sums and differences of a million volumes are off by 2^-30 of the largest, and each volume by 2^-1074: volumes of
    // bodies below 10^-107 underflow.
    const double rounding = 0x1p-30 * first.all + 0x1p-1050;
    const bool is_empty = open.size() == next && parts.size() == 0 && sums.sure == 0;
    result.lower = std::max(0.0, best.lower - rounding);
    result.upper = is_empty ? 0.0 : best.upper + rounding;
    result.estimate = std::clamp(guess, result.lower, result.upper);
    result.certified = body[0]->sphere_state().covers && body[1]->sphere_state().covers;
  }

  /// divides_one: divide at least one cell, unless the budget is zero, so that repeated resume() calls always finish.
  Penetration go_on(const PenetrationOptions& options, bool divides_one) {
    Penetration result;
    result.status = usable(options);
    if (!result.status) return result;
    const Budget& budget = options.budget;
    const bool is_zero = (budget.is_tests() && budget.tests() == 0) || (budget.is_time() && budget.time().count() == 0);
    const std::chrono::nanoseconds begin = options.budget.is_time() ? now(options.clock) : std::chrono::nanoseconds{};
    const auto is_spent = [&] {
      // mutant penetration-stands-still: `result.probes == 0` -> `false`
      if (divides_one && !is_zero && result.probes == 0) return false;
      if (options.budget.is_tests())  // each of a cell's eight parts takes at most two
        return static_cast<std::int64_t>(result.probes) + 16 > options.budget.tests();
      return options.budget.is_time() && now(options.clock) - begin >= options.budget.time();
    };
    const auto is_narrow = [&] {
      best.narrow(sums);
      return best.upper - best.lower <= std::max(options.tolerance * best.upper, options.volume_tolerance);
    };
    while (!(result.finished = is_narrow()) && !is_spent()) {
      if (next == open.size()) {
        if (parts.size() == 0 || parts.cells.front().level >= most_levels) break;
        open.swap(parts);
        parts.clear();
        next = 0;
        continue;
      }
      check_interrupt();
      if (result.status = divide_next(result.probes); !result.status) return result;
    }
    sum_up(result);
    return result;
  }
};

PenetrationQuery::PenetrationQuery(const Collider& a, const Collider& b) {
  const StandardFloats standard;
  state_ = std::make_unique<State>(a, b);
}
PenetrationQuery::~PenetrationQuery() = default;
PenetrationQuery::PenetrationQuery(PenetrationQuery&&) noexcept = default;
PenetrationQuery& PenetrationQuery::operator=(PenetrationQuery&&) noexcept = default;

Penetration PenetrationQuery::run(const PenetrationOptions& options) {
  const StandardFloats standard;
  ObjectCall own(*state_, CallKind::begins);
  if (!own.status()) return {.status = own.status()};
  if (Status status = state_->usable(options); !status) return {.status = status};
  state_->begin_reading();
  state_->start();
  return state_->done(own, state_->go_on(options, false));
}

Penetration PenetrationQuery::resume(const PenetrationOptions& options) {
  const StandardFloats standard;
  State& s = *state_;
  ObjectCall own(s, CallKind::goes_on);
  if (!own.status()) return {.status = own.status()};
  if (!s.is_started) return {.status = {.code = Status::Code::no_front}};
  for (std::uint8_t i = 0; i < 2; ++i)
    if (const Status::Code code = compared(s.frames[i], frame_of(*s.body[i])); code != Status::Code::ok)
      return {.status = {.code = code, .body = i}};
  s.begin_reading();
  return s.done(own, s.go_on(options, true));
}

}  // namespace morula
