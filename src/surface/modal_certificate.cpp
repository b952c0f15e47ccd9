// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/surface/modal_certificate.hpp>
#include <stdexcept>
#include <string>

#include "geometry/nearest_pair.hpp"
#include "geometry/triangles/triangles_meet.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruptible_sort.hpp"
#include "parallel/interruption.hpp"
#include "surface/pairs/feature_filter.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::uint32_t facets_of_a_leaf = 4;

/// Facets [begin, end) in sorted order; the children are the halves.
struct Node {
  std::uint32_t begin, end;
  std::uint32_t left = 0, right = 0;  // 0: a leaf
  Box box{};
  double spread = 0;  // largest distance of a vertex's displacements from the mean, all modes together
};

bool share_a_vertex(const Facet& f, const Facet& g) {
  return std::find_first_of(f.begin(), f.end(), g.begin(), g.end()) != f.end();
}

}  // namespace

struct ModalCertificate::State {
  std::size_t vertex_count = 0, mode_count = 0;
  std::vector<Facet> facets;
  std::vector<double> scales;
  double largest_norm = 1;

  struct Open {
    double norm;  // norm up to which the pair is proven apart
    std::uint32_t a, b;
    auto operator<=>(const Open&) const = default;
  };
  std::vector<double> norms;       // norms in ascending order
  std::vector<FeaturePair> pairs;  // the pair of each norm
  double free = 0;
  std::size_t facet_pairs = 0, node_pairs = 0;

  std::size_t open_at(double norm) const {
    return static_cast<std::size_t>(std::lower_bound(norms.begin(), norms.end(), norm) - norms.begin());
  }
};

namespace {

/// Examines pairs from the root down.
class ModalCertifier {
 public:
  ModalCertifier(const MeshView& mesh, const Modes& modes, const ModalCertificateOptions& options,
                 std::span<const double> scales)
      : tree_(make_surface_tree(mesh)),
        modes_(modes.mode_count),
        largest_norm_(options.largest_norm),
        rest_distance_(options.rest_distance) {
    // Displacements for modal coordinates of norm 1, vertex by vertex.
    moves_.resize(tree_.mesh.rest.size() * modes_);
    double farthest = 0, coordinate = 0;
    for (std::size_t v = 0; v < tree_.mesh.rest.size(); ++v) {
      double square = 0;
      for (std::size_t j = 0; j < modes_; ++j) {
        moves_[v * modes_ + j] = modes.mode(j)[v] * scales[j];
        square += squared_length(moves_[v * modes_ + j]);
      }
      if (tree_.blocks.slot_of_vertex[v] == SurfaceTreeState::no_slot) continue;
      farthest = std::max(farthest, std::sqrt(square));
      coordinate = std::max(coordinate, max_norm(tree_.mesh.rest[v]));
    }
    // Positions of vertices: sums of as many terms as there are modes, each off by 2^-52 of itself. Gaps and lengths
    // here are off by about 2^-48 of coordinates and displacements. The sum of all errors is below 2^-44 of the largest
    // coordinate that a vertex may reach, for less than 2^6 modes, and grows in proportion beyond.
    const double terms = std::max(1.0, static_cast<double>(modes_) / 64);
    pad_ = options.margin * (1 + 0x1p-40) +
           0x1p-44 * terms * (coordinate + farthest * largest_norm_ * std::sqrt(static_cast<double>(modes_ + 1)));
    make_node(0, static_cast<std::uint32_t>(tree_.blocks.order.size()));
  }

  /// Calls open(norm, facet, facet) for each pair that is not proven apart up to the largest norm.
  template <class Found>
  void search(const Found& open) {
    std::vector<std::array<std::uint32_t, 2>> stack{{0, 0}};
    while (!stack.empty()) {
      const auto [a, b] = stack.back();
      stack.pop_back();
      poll_interrupt_();
      const Node &p = nodes_[a], &q = nodes_[b];
      if (a != b) {
        ++node_pairs;
        if (norm_of_nodes(a, b) >= largest_norm_) continue;
      }
      if (p.left == 0 && q.left == 0) {
        look_at_facets(p, q, open);
      } else if (a == b) {
        stack.push_back({p.left, p.left}), stack.push_back({p.right, p.right}), stack.push_back({p.left, p.right});
      } else if (q.left == 0 || (p.left != 0 && p.end - p.begin >= q.end - q.begin)) {
        stack.push_back({p.left, b}), stack.push_back({p.right, b});
      } else {
        stack.push_back({a, q.left}), stack.push_back({a, q.right});
      }
    }
  }

  std::size_t facet_pairs = 0, node_pairs = 0;

 private:
  std::span<const Vec3> moves(std::uint32_t vertex) const { return std::span(moves_).subspan(vertex * modes_, modes_); }
  std::span<const Vec3> mean(std::uint32_t node) const { return std::span(means_).subspan(node * modes_, modes_); }

  std::uint32_t make_node(std::uint32_t begin, std::uint32_t end) {
    poll_interrupt_();
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    Node node{begin, end};
    means_.resize(means_.size() + modes_);
    Vec3* const mean = &means_[number * modes_];
    for (std::uint32_t i = begin; i < end; ++i)
      for (const std::uint32_t v : tree_.blocks.facets_in_order[i]) {
        node.box.add(tree_.mesh.rest[v]);
        for (std::size_t j = 0; j < modes_; ++j) mean[j] += moves(v)[j] * (1.0 / (3 * (end - begin)));
      }
    for (std::uint32_t i = begin; i < end; ++i)
      for (const std::uint32_t v : tree_.blocks.facets_in_order[i]) {
        double square = 0;
        for (std::size_t j = 0; j < modes_; ++j) square += squared_length(moves(v)[j] - mean[j]);
        node.spread = std::max(node.spread, std::sqrt(square));
      }
    nodes_.push_back(node);
    if (end - begin > facets_of_a_leaf) {
      const std::uint32_t middle = begin + (end - begin) / 2;
      const std::uint32_t left = make_node(begin, middle), right = make_node(middle, end);
      nodes_[number].left = left, nodes_[number].right = right;
    }
    return number;
  }

  /// (gap − allowance) / length, rounded down.
  double ratio(double gap, double length) const {
    const double room = gap - pad_;
    if (!(room > 0)) return 0;
    return length > 0 ? room / (length * (1 + 0x1p-40)) * (1 - 0x1p-50) : std::numeric_limits<double>::infinity();
  }

  /// The norm up to which all of one node is proven apart from all of the other. The direction is that of the line
  /// through the nearest points of their boxes; along it the boxes are as far apart as these points.
  double norm_of_nodes(std::uint32_t a, std::uint32_t b) const {
    const Box &p = nodes_[a].box, &q = nodes_[b].box;
    const Vec3 gap = max(q.lower - p.upper, Vec3{}) - max(p.lower - q.upper, Vec3{});
    const double apart = length(gap);
    if (!(apart > pad_)) return 0;
    const Vec3 n = gap / apart;
    double square = 0;
    for (std::size_t j = 0; j < modes_; ++j) {
      const double along = dot(n, mean(b)[j] - mean(a)[j]);
      square += along * along;
    }
    // mutant modal-spread: `(square) + nodes_[a].spread + nodes_[b].spread` -> `(square)`
    return ratio(apart, std::sqrt(square) + nodes_[a].spread + nodes_[b].spread);
  }

  /// The same norm for two facets, along a direction of any length except 0.
  double norm_along(const Facet& f, const Facet& g, const Vec3& direction) const {
    const double size = length(direction);
    if (!(size > 0x1p-400) || !std::isfinite(size)) return 0;
    const Vec3 n = direction / size;
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t v : f)
      for (const std::uint32_t w : g) {
        const double gap = dot(n, tree_.mesh.rest[w] - tree_.mesh.rest[v]);
        if (!(gap > pad_)) return 0;
        double square = 0;
        for (std::size_t j = 0; j < modes_; ++j) {
          const double along = dot(n, moves(w)[j] - moves(v)[j]);
          square += along * along;
        }
        least = std::min(least, ratio(gap, std::sqrt(square)));
      }
    return least;
  }

  /// The best of several directions. Every direction gives a valid norm.
  double norm_of_facets(const Facet& f, const Facet& g) const {
    const Triangle s{tree_.mesh.rest[f[0]], tree_.mesh.rest[f[1]], tree_.mesh.rest[f[2]]};
    const Triangle t{tree_.mesh.rest[g[0]], tree_.mesh.rest[g[1]], tree_.mesh.rest[g[2]]};
    const NearestPair nearest = nearest_pair(s, t);
    if (nearest.crossing) return 0;
    double best = norm_along(f, g, nearest.point_b - nearest.point_a);
    if (best >= largest_norm_) return best;
    const Vec3 middles = (t[0] + t[1] + t[2]) - (s[0] + s[1] + s[2]);
    for (const Vec3& direction : {middles, area_vector(s), -area_vector(s), area_vector(t), -area_vector(t)})
      best = std::max(best, norm_along(f, g, direction));
    return best;
  }

  template <class Found>
  void look_at_facets(const Node& p, const Node& q, const Found& open) {
    const bool is_one = p.begin == q.begin;
    for (std::uint32_t i = p.begin; i < p.end; ++i)
      for (std::uint32_t k = is_one ? i + 1 : q.begin; k < q.end; ++k) {
        const Facet &f = tree_.blocks.facets_in_order[i], &g = tree_.blocks.facets_in_order[k];
        if (share_a_vertex(f, g)) continue;
        ++facet_pairs;
        const double norm = norm_of_facets(f, g);
        if (norm < largest_norm_ && !is_near_at_rest(tree_.blocks.order[i], tree_.blocks.order[k]))
          open(norm, tree_.blocks.order[i], tree_.blocks.order[k]);
      }
  }

  bool is_near_at_rest(std::uint32_t f, std::uint32_t g) const {
    return rest_distance_ > 0 &&
           are_within_at_rest(tree_, {PairKind::facet_facet, std::min(f, g), std::max(f, g)}, rest_distance_);
  }

  SurfaceTreeState tree_;
  std::size_t modes_;
  double largest_norm_, rest_distance_, pad_ = 0;
  std::vector<Vec3> moves_, means_;
  std::vector<Node> nodes_;
  InterruptPoller poll_interrupt_{64};
};

}  // namespace

ModalCertificate::ModalCertificate(const MeshView& rest, const Modes& modes, const ModalCertificateOptions& options)
    : state_(std::make_unique<State>()) {
  const StandardFloats standard;
  State& s = *state_;
  if (!(options.largest_norm > 0) || !std::isfinite(options.largest_norm))
    throw std::invalid_argument("ModalCertificateOptions::largest_norm " + std::to_string(options.largest_norm) +
                                " is not positive");
  if (!(options.margin >= 0) || !std::isfinite(options.margin))
    throw std::invalid_argument("ModalCertificateOptions::margin " + std::to_string(options.margin) +
                                " is not a length of 0 or more");
  if (!(options.rest_distance >= 0) || !std::isfinite(options.rest_distance))
    throw std::invalid_argument("ModalCertificateOptions::rest_distance " + std::to_string(options.rest_distance) +
                                " is not a length of 0 or more");
  if (modes.vertex_count != rest.vertex_count() || modes.displacements.size() != modes.mode_count * modes.vertex_count)
    throw std::invalid_argument("modes of " + std::to_string(modes.vertex_count) + " vertices for a mesh of " +
                                std::to_string(rest.vertex_count()));
  for (const Vec3& u : modes.displacements)
    if (!is_finite(u) || !(max_norm(u) < 0x1p100))
      throw std::invalid_argument("a displacement is not finite, or 2^100 or more");
  s.scales = options.scales.empty() ? std::vector<double>(modes.mode_count, 1.0) : options.scales;
  if (s.scales.size() != modes.mode_count)
    throw std::invalid_argument(std::to_string(s.scales.size()) + " scales for " + std::to_string(modes.mode_count) +
                                " modes");
  for (const double scale : s.scales)
    if (!(scale > 0x1p-100 && scale < 0x1p100))
      throw std::invalid_argument("scale " + std::to_string(scale) + " of a mode is not positive, or out of range");
  ModalCertifier certifier(rest, modes, options, s.scales);
  std::vector<State::Open> open;
  certifier.search([&](double norm, std::uint32_t a, std::uint32_t b) {
    open.push_back({norm, std::min(a, b), std::max(a, b)});
  });
  sort_interruptibly(open, std::less<>());
  s.vertex_count = rest.vertex_count();
  s.mode_count = modes.mode_count;
  s.facets.assign(rest.facets.begin(), rest.facets.end());
  s.largest_norm = options.largest_norm;
  for (const State::Open& pair : open) {
    s.norms.push_back(pair.norm);
    s.pairs.push_back({PairKind::facet_facet, pair.a, pair.b});
  }
  s.free = open.empty() ? s.largest_norm : open.front().norm;
  s.facet_pairs = certifier.facet_pairs;
  s.node_pairs = certifier.node_pairs;
}
ModalCertificate::~ModalCertificate() = default;
ModalCertificate::ModalCertificate(ModalCertificate&&) noexcept = default;
ModalCertificate& ModalCertificate::operator=(ModalCertificate&&) noexcept = default;

double ModalCertificate::norm(std::span<const double> coordinates) const {
  const StandardFloats standard;
  if (coordinates.size() != state_->mode_count) return std::numeric_limits<double>::infinity();
  double square = 0;
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    const double y = coordinates[j] / state_->scales[j];
    square += y * y;
  }
  // Squares that underflow to 0 belong to numbers below 2^-500. A sum of n of them is off by n 2^-53 of itself.
  const double rounding = 0x1p-44 + 0x1p-53 * static_cast<double>(coordinates.size());
  const double norm = (std::sqrt(square) + 0x1p-500) * (1 + rounding);
  return std::isnan(norm) ? std::numeric_limits<double>::infinity() : norm;
}

double ModalCertificate::free_norm() const {
  return state_->free;
}
bool ModalCertificate::is_known(std::span<const double> coordinates) const {
  return norm(coordinates) <= state_->largest_norm;
}

std::span<const FeaturePair> ModalCertificate::open(std::span<const double> coordinates) const {
  return std::span(state_->pairs).first(state_->open_at(norm(coordinates)));
}

bool ModalCertificate::crossings(std::span<const double> coordinates, const PositionView& positions,
                                 std::vector<FeaturePair>& pairs) const {
  const StandardFloats standard;
  const State& s = *state_;
  if (!is_known(coordinates) || positions.size() != s.vertex_count) return false;
  const std::size_t before = pairs.size();
  const auto corners = [&](std::uint32_t facet) -> Triangle {
    const Facet& f = s.facets[facet];
    return {positions[f[0]], positions[f[1]], positions[f[2]]};
  };
  try {
    for (const FeaturePair& pair : open(coordinates))
      if (triangles_meet(corners(pair.a), corners(pair.b))) pairs.push_back(pair);
  } catch (...) {
    pairs.resize(before);
    throw;
  }
  std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(before), pairs.end());
  return true;
}

std::size_t ModalCertificate::tested_facet_pairs() const {
  return state_->facet_pairs;
}
std::size_t ModalCertificate::tested_node_pairs() const {
  return state_->node_pairs;
}

}  // namespace morula
