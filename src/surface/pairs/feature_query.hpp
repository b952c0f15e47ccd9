// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The common parts of queries of surface trees: search, filter, and results gathered chunk by chunk.
#pragma once

#include <algorithm>
#include <cmath>
#include <morula/surface/feature_pairs.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/object_call.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruptible_sort.hpp"
#include "parallel/interruption.hpp"
#include "surface/pairs/feature_filter.hpp"
#include "surface/pairs/pair_search.hpp"

namespace morula::detail {

inline void require_length(double length, const char* name) {
  if (!(length >= 0) || !std::isfinite(length))
    throw std::invalid_argument(std::string(name) + ' ' + std::to_string(length) + " is not a length of 0 or more");
}

inline void require_budget(const Budget& budget) {
  if ((budget.is_tests() && budget.tests() < 0) || (budget.is_time() && budget.time().count() < 0))
    throw std::invalid_argument("a budget of " +
                                std::to_string(budget.is_tests() ? budget.tests() : budget.time().count()) +
                                (budget.is_tests() ? " tests" : " ns") + " is negative");
}

/// Points of a feature in the present pose of a surface.
class FeaturePoints {
 public:
  FeaturePoints(const SurfaceTreeState& s, Feature feature, std::uint32_t number, bool at_end = false) {
    const FeatureVertices vertices(s, feature, number);
    size_ = vertices.size();
    for (std::size_t i = 0; i < size_; ++i) point_[i] = at_end ? s.to_of(vertices[i]) : s.from_of(vertices[i]);
  }
  operator std::span<const Vec3>() const { return {point_.data(), size_}; }

 private:
  std::array<Vec3, 3> point_;
  std::size_t size_;
};

/// For FeatureQuery: look(a, b, pair) returns the result for one pair, if there is one.
template <class Look>
auto one_by_one(const Look& visit) {
  return
      [visit](const SurfaceTreeState& a, const SurfaceTreeState& b, std::span<const FeaturePair> pairs, auto& found) {
        InterruptPoller poll_interrupt(128);
        for (const FeaturePair& pair : pairs) {
          poll_interrupt();
          if (const auto one = visit(a, b, pair)) found.push_back(*one);
        }
      };
}

/// Runs a query whose state is `state`, unless it is rejected: call() begins it or continues it.
template <class State, class Call>
SurfaceQueryStatus call_of(State& state, CallKind kind, const Call& call) {
  ObjectCall own(state, kind);
  if (!own.status()) return {own.status()};
  const SurfaceQueryStatus status = call();
  own.finish(status);
  return status;
}

template <class Found>
class FeatureQuery {
 public:
  struct Request {
    double reach = 0;  ///< largest distance of boxes that count as near
    Features features = Features::all;
    bool sorted = true;
    bool by_spheres = true;  ///< whether pairs whose features are farther apart than the reach may be left out
  };

  /// Starts a query; of one surface with itself if b is a. narrow(a, b, pairs, found): adds the results for pairs of
  /// features whose boxes are near; workers call it.
  template <class Options, class Narrow>
  SurfaceQueryStatus run(const SurfaceTreeState& a, const SurfaceTreeState& b, const Request& request,
                         const Options& options, Workers& workers, const Narrow& narrow) {
    const StandardFloats standard;
    SurfaceQueryStatus status;
    static_cast<Status&>(status) = a.askable(0);
    if (status && &a != &b) static_cast<Status&>(status) = b.askable(1);
    if (status) static_cast<Status&>(status) = start_filter(a, b, request.features, options, workers);
    if (!status) return status;
    search_.start(a, b, request.reach, request.features, request.by_spheres, workers);
    request_ = request;
    const auto coordinate = [](const SurfaceTreeState& s, const SurfaceBoxes& boxes) {
      return max_norm(s.origin) + boxes.extent;
    };
    largest_coordinate_ = std::max(coordinate(a, search_.boxes().a()), coordinate(b, search_.boxes().b()));
    found_.clear();
    candidates_ = 0;
    return go_on(options, workers, narrow);
  }
  /// Continues a query. reach: the value at the start. The filter is read again: options may have been set since.
  template <class Options, class Narrow>
  SurfaceQueryStatus resume(double reach, const Options& options, Workers& workers, const Narrow& narrow) {
    const StandardFloats standard;
    if (!search_.is_started()) return {{.code = Status::Code::no_front}};
    if (!search_.is_current()) return {{.code = Status::Code::other_frame}};
    // Pairs that were farther apart were not kept.
    // mutant resume-other-distance: `reach != request_.reach` -> `false`
    if (reach != request_.reach) return {{.code = Status::Code::other_options}};
    SurfaceQueryStatus status;
    static_cast<Status&>(status) = start_filter(search_.a(), search_.b(), request_.features, options, workers);
    if (!status) return status;
    return go_on(options, workers, narrow);
  }

  /// Resets the query to a new one: no results, nothing started, and no memory, which an exception may have left in any
  /// state.
  void forget() noexcept { *this = FeatureQuery(); }

  const std::vector<Found>& found() const { return found_; }
  const std::vector<OpenFacets>& open() const { return open_; }
  const PairSearch& search() const { return search_; }
  bool is_finished() const { return is_finished_; }
  /// The reach of the results, also when surfaces have moved since.
  double reach() const { return request_.reach; }
  double largest_coordinate() const { return largest_coordinate_; }

 private:
  /// If a budget bounds the work, the search makes the rows of tables that it needs.
  template <class Options>
  Status start_filter(const SurfaceTreeState& a, const SurfaceTreeState& b, Features features, const Options& options,
                      Workers& workers) {
    return filter_.start(options.filter, a, b, features, options.budget.is_unlimited(), workers);
  }
  /// Returns changed_during_call if a callback has moved a surface; the caller then discards the results.
  template <class Options, class Narrow>
  SurfaceQueryStatus go_on(const Options& options, Workers& workers, const Narrow& narrow) {
    const SurfaceTreeState &a = search_.a(), &b = search_.b();
    search_.exclude(filter_.excluded());
    SurfaceMeter meter(options.budget, options.clock);
    std::size_t count = 0;
    is_finished_ = search_.run(
        meter, workers,
        [&](std::size_t chunks) {
          count = chunks;
          if (chunks_.size() < chunks) chunks_.resize(chunks);
          for (std::size_t i = 0; i < chunks; ++i) chunks_[i].found.clear(), chunks_[i].candidates = 0;
        },
        [&](std::size_t chunk, const FeaturePair& pair, bool are_neighbors_known) {
          if (filter_.accepts(pair, are_neighbors_known)) chunks_[chunk].pairs.push_back(pair);
        },
        [&](std::size_t chunk) {
          Chunk& c = chunks_[chunk];
          c.candidates += c.pairs.size();
          narrow(a, b, c.pairs, c.found);
          c.pairs.clear();
        });
    const std::size_t known = found_.size();
    for (std::size_t i = 0; i < count; ++i) {
      check_interrupt();
      found_.insert(found_.end(), chunks_[i].found.begin(), chunks_[i].found.end());
      candidates_ += chunks_[i].candidates;
    }
    if (request_.sorted && found_.size() > known)
      sort_interruptibly(found_, [](const FeaturePair& p, const FeaturePair& q) { return p < q; });
    search_.open(open_);
    SurfaceQueryStatus status;
    // mutant surface-moved-in-call: `static_cast ... (status) = search_.moved(Status::Code::changed_during_call)` -> ``
    static_cast<Status&>(status) = search_.moved(Status::Code::changed_during_call);
    if (!status) return status;
    status.finished = is_finished_;
    status.box_tests = 64 * meter.groups_tested;
    status.candidates = candidates_;
    return status;
  }

  struct alignas(64) Chunk {
    std::vector<FeaturePair> pairs;  // pairs to be examined
    std::vector<Found> found;
    std::size_t candidates = 0;
  };
  PairSearch search_;
  FeatureFilter filter_;
  Request request_{};
  double largest_coordinate_ = 0;
  std::vector<Chunk> chunks_;
  std::vector<Found> found_;
  std::size_t candidates_ = 0;
  std::vector<OpenFacets> open_;
  bool is_finished_ = false;
};

}  // namespace morula::detail
