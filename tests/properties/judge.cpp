// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "judge.hpp"

namespace oracle {
namespace {

struct Bounds {
  Point lower, upper;
};

Bounds bounds_of(const Triangle& t) {
  const auto least = [](Real a, Real b, Real c) { return std::min({a, b, c}); };
  const auto most = [](Real a, Real b, Real c) { return std::max({a, b, c}); };
  return {{least(t[0].x, t[1].x, t[2].x), least(t[0].y, t[1].y, t[2].y), least(t[0].z, t[1].z, t[2].z)},
          {most(t[0].x, t[1].x, t[2].x), most(t[0].y, t[1].y, t[2].y), most(t[0].z, t[1].z, t[2].z)}};
}

Real squared_distance(const Bounds& b, const Point& p) {
  const auto beyond = [](Real low, Real high, Real x) { return std::max({low - x, x - high, Real(0)}); };
  const Point d{beyond(b.lower.x, b.upper.x, p.x), beyond(b.lower.y, b.upper.y, p.y),
                beyond(b.lower.z, b.upper.z, p.z)};
  return dot(d, d);
}

// Which of a facet's candidates hold a point: one bit each.
using Word = std::uint64_t;
constexpr std::size_t word_bits = 64;

class FacetSearch {
 public:
  FacetSearch(std::span<const Ball> balls, Dice& dice, CoverTally& tally, const Effort& effort, Real largest)
      : dice_(dice), tally_(tally), effort_(effort) {
    for (const Ball& ball : balls) {
      const Real reach = ball.radius + allowance(largest, ball.radius);
      const Real squared = ball.radius >= 0 ? reach * reach : -1;
      all_.push_back({ball.center, ball.radius, squared, rough(ball.center),
                      static_cast<double>(squared * (1 - 0x1p-46L) - 0x1p-46L * largest * largest - 1e-300L),
                      static_cast<double>(squared * (1 + 0x1p-46L) + 0x1p-46L * largest * largest + 1e-300L)});
    }
  }

  void look(std::size_t number, const Triangle& facet, std::span<const Hint> hints,
            std::optional<UncoveredPoint>& worst) {
    ++tally_.facets;
    number_ = number;
    worst_ = &worst;
    choose(facet);
    nodes_.clear();
    masks_.clear();
    const std::array<std::size_t, 3> corners{add(facet[0]), add(facet[1]), add(facet[2])};
    const bool proved = cut(corners);
    if (proved) ++tally_.proved;
    for (const Hint& hint : hints) add(at(facet, hint.v, hint.w));
    // Proved facets are sampled now and then, so that the proof itself is watched.
    if (!proved || dice_.chance(0.05)) scatter(facet);
  }

 private:
  // A squared distance of doubles is off by less than 50 · 2^-53 of the square of the largest coordinate, which exceeds
  // a quarter of any difference: below `surely_in` or above `surely_out`, which allow for 128 of them, it decides.
  struct Rough {
    double x, y, z;
  };
  static Rough rough(const Point& p) {
    return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  }
  struct Reach {
    Point center;
    Real radius, squared;
    Rough about;
    double surely_in, surely_out;
  };
  static bool holds(const Reach& ball, const Point& p, const Rough& about) {
    const double x = about.x - ball.about.x, y = about.y - ball.about.y, z = about.z - ball.about.z;
    const double roughly = x * x + y * y + z * z;
    if (roughly < ball.surely_in) return true;
    if (roughly > ball.surely_out) return false;
    const Point d = p - ball.center;
    return dot(d, d) <= ball.squared;
  }

  void choose(const Triangle& facet) {
    const Bounds box = bounds_of(facet);
    near_.clear();
    for (const Reach& ball : all_)
      // Twice: candidates may be too many, never too few.
      if (ball.squared >= 0 && squared_distance(box, ball.center) <= 2 * ball.squared) near_.push_back(ball);
    words_ = (near_.size() + word_bits - 1) / word_bits;
  }

  // The number of a point, whose mask is known from now on.
  std::size_t add(const Point& p) {
    ++tally_.samples;
    nodes_.push_back(p);
    const std::size_t first = masks_.size();
    masks_.resize(first + words_);
    bool held = false;
    const Rough about = rough(p);
    for (std::size_t i = 0; i < near_.size(); ++i) {
      if (holds(near_[i], p, about)) {
        masks_[first + i / word_bits] |= Word(1) << (i % word_bits);
        held = true;
      }
    }
    if (!held) note(p);
    return nodes_.size() - 1;
  }

  void note(const Point& p) {
    Real gap = std::numeric_limits<Real>::infinity();
    for (const Reach& ball : all_)
      if (ball.squared >= 0) gap = std::min(gap, distance(p, ball.center) - ball.radius);
    if (!*worst_ || gap > (*worst_)->gap) *worst_ = UncoveredPoint{number_, p, gap};
  }

  bool in_one_ball(const std::array<std::size_t, 3>& t) const {
    for (std::size_t w = 0; w < words_; ++w)
      if (masks_[t[0] * words_ + w] & masks_[t[1] * words_ + w] & masks_[t[2] * words_ + w]) return true;
    return false;
  }

  bool cut(const std::array<std::size_t, 3>& whole) {
    pieces_.assign(1, whole);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const std::array<std::size_t, 3> piece = pieces_[i];
      if (in_one_ball(piece)) continue;
      if (i >= effort_.cuts * (4 + near_.size()) / 4) return false;
      std::size_t side = 0;
      Real longest = -1;
      for (std::size_t k = 0; k < 3; ++k) {
        const Point d = nodes_[piece[k]] - nodes_[piece[(k + 1) % 3]];
        if (dot(d, d) > longest) longest = dot(d, d), side = k;
      }
      if (longest == 0) continue;  // a point, which was looked at
      const std::size_t from = piece[side], to = piece[(side + 1) % 3], apex = piece[(side + 2) % 3];
      const std::size_t middle = add(Real(0.5) * (nodes_[from] + nodes_[to]));
      pieces_.push_back({from, middle, apex});
      pieces_.push_back({middle, to, apex});
    }
    return true;
  }

  static Point at(const Triangle& t, Real v, Real w) { return (1 - v - w) * t[0] + v * t[1] + w * t[2]; }

  void scatter(const Triangle& t) {
    for (std::size_t n = 0; n < effort_.scattered; ++n) {
      // Multiples of 2^-40: sums and differences of them are exact.
      constexpr std::uint64_t one = std::uint64_t(1) << 40;
      std::uint64_t v = dice_.next() % (one + 1), w = dice_.next() % (one + 1);
      switch (n % 3) {
        case 0:
          if (v + w > one) v = one - v, w = one - w;
          break;
        case 1:
          w = dice_.chance(0.5) ? 0 : one - v;
          break;
        default:
          v >>= dice_.below(40), w = 0;
      }
      const Real scale = 0x1p-40L;
      const Real x = static_cast<Real>(v) * scale, y = static_cast<Real>(w) * scale;
      const std::size_t turn = dice_.below(3);
      const std::array<Real, 3> weights{1 - x - y, x, y};
      add(at(t, weights[(1 + turn) % 3], weights[(2 + turn) % 3]));
    }
  }

  Dice& dice_;
  CoverTally& tally_;
  const Effort& effort_;
  std::vector<Reach> all_, near_;
  std::size_t words_ = 0, number_ = 0;
  std::optional<UncoveredPoint>* worst_ = nullptr;
  std::vector<Point> nodes_;
  std::vector<Word> masks_;
  std::vector<std::array<std::size_t, 3>> pieces_;
};

}  // namespace

std::optional<UncoveredPoint> find_uncovered(std::span<const Triangle> facets, std::span<const Ball> balls, Dice& dice,
                                             CoverTally& tally, const Effort& effort, std::span<const Hint> hints) {
  Real largest = 0;
  for (const Triangle& t : facets)
    for (const Point& p : t) largest = std::max(largest, largest_coordinate(p));
  for (const Ball& ball : balls) largest = std::max(largest, largest_coordinate(ball.center));
  FacetSearch search(balls, dice, tally, effort, largest);
  std::optional<UncoveredPoint> worst;
  for (std::size_t f = 0, h = 0; f < facets.size(); ++f) {
    const std::size_t first = h;
    while (h < hints.size() && hints[h].facet == f) ++h;
    search.look(f, facets[f], hints.subspan(first, h - first), worst);
  }
  return worst;
}

Real gap_of(const Point& point, std::span<const Ball> balls) {
  Real gap = std::numeric_limits<Real>::infinity();
  for (const Ball& ball : balls) gap = std::min(gap, distance(point, ball.center) - ball.radius);
  return gap;
}

}  // namespace oracle
