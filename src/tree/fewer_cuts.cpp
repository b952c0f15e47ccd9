// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Proof that no guarantee changes. Let reach(n) be the largest squared distance, as computed in double, from the center
// of node n to a corner that n owned in the given cover. A leaf takes over patches of a facet only if every corner
// that it takes has a computed squared distance of at most reach(n) for n = the leaf and all nodes above it. So
//   reaches     after any number of such moves the largest squared distance of every node is at most reach(n): the
//               compared distances are those that certify() computes, by the same expression, so certified spheres stay
//               certified; and a rule that measures owned corners finds no larger radius about the same center at rest.
//               Nodes whose squares vanish or overflow, for which certify() has another test, take nothing.
//   tiling      patches keep their polygons and change their owner, or all patches of a facet, which tile it, become
//               one: the facet itself. Or patches of one facet and one owner become their convex hull, if it has no
//               more area than they have (joined_patches.hpp): its corners are some of theirs, so the first line holds
//               for these too.
//   regions     are made again, leaves depth first, so those of inner nodes are the unions of their children's; no leaf
//               gives its last patch away.
#include <algorithm>
#include <limits>
#include <morula/tree/cover.hpp>
#include <numeric>
#include <utility>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "tree/joined_patches.hpp"
#include "tree/region.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::uint32_t none = 0xffffffffu;
// Marks an owner: the patch has become a part of another patch of its owner.
constexpr std::uint32_t part_of_another = none - 1;
// The limit of certify(): squares above it have lost no digit.
constexpr double smallest_safe_square = 0x1p-900;

// Patches of one facet and one owner, and their future.
struct Share {
  std::uint32_t leaf;
  double area = 0;
  std::vector<std::uint32_t> patches{};
};

class Sharing {
 public:
  Sharing(const MeshView& mesh, const CoveredTree& model, Workers& workers);
  Cover with_fewer_cuts() &&;

 private:
  void look_at(std::uint32_t facet, std::span<const std::uint32_t> patches);
  bool takes_whole(std::uint32_t facet);
  void join_shares();
  void join_patches(std::uint32_t facet, Share& share);
  std::span<const std::uint32_t> corners_of(std::uint32_t patch) const;
  template <class Corners>
  bool contains(std::uint32_t leaf, const Corners& corners) const;
  double area_of(std::uint32_t patch) const;
  std::vector<std::vector<std::uint32_t>> patches_of_leaves() const;
  Cover assembled() const;

  MeshView mesh_;
  const SphereTree& tree_;
  const Cover& cover_;
  std::vector<Vec3> places_;  // positions of all corners
  std::vector<double> reach_;
  std::vector<std::uint32_t> owner_;         // leaf of each patch; none: it has become part of a whole facet
  std::vector<std::uint32_t> whole_owner_;   // leaf of each facet that is whole; none: it is unchanged
  std::vector<std::uint32_t> patch_counts_;  // number of patches of each leaf
  std::vector<Share> shares_;                // shares of one facet, the largest first
  // Corners [begin, end) of patches that other patches have become part of.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joined_;  // range of each patch; empty: it is unchanged
  std::vector<std::uint32_t> joined_corners_;
  PatchJoiner joiner_;
  std::vector<Barycentric> polygon_;
  std::vector<std::uint32_t> corners_;
};

Sharing::Sharing(const MeshView& mesh, const CoveredTree& model, Workers& workers)
    : mesh_(mesh), tree_(model.tree), cover_(model.cover) {
  places_.resize(cover_.vertex_count + cover_.cut_points.size());
  for (std::uint32_t i = 0; i < places_.size(); ++i) places_[i] = corner_position(cover_, i, mesh.positions);
  reach_.resize(tree_.node_count());
  parallel_for(workers, tree_.node_count(), 1, [&](std::size_t node, std::size_t) {
    double farthest = 0;
    for (const std::uint32_t c : cover_.region_corners(static_cast<std::uint32_t>(node)))
      farthest = std::max(farthest, squared_distance(tree_.spheres[node].center, places_[c]));
    // mutant fewer-cuts-vanished-squares: `> smallest_safe_square && farthest <` -> `<`
    const bool safe = farthest > smallest_safe_square && farthest < std::numeric_limits<double>::infinity();
    reach_[node] = safe ? farthest : -1;
  });
  owner_.resize(cover_.patch_count());
  joined_.resize(cover_.patch_count());
  whole_owner_.assign(mesh.facet_count(), none);
  patch_counts_.resize(tree_.node_count());
  for (std::uint32_t node = 0; node < tree_.node_count(); ++node) {
    if (!tree_.is_leaf(node)) continue;
    patch_counts_[node] = cover_.region_end[node] - cover_.region_begin[node];
    for (std::uint32_t p = cover_.region_begin[node]; p < cover_.region_end[node]; ++p) owner_[p] = node;
  }
}

// Facets are processed in order: the result cannot depend on chunks.
Cover Sharing::with_fewer_cuts() && {
  std::vector<std::uint32_t> begin(mesh_.facet_count() + 1), patches(cover_.patch_count());
  for (const std::uint32_t f : cover_.patch_facet) ++begin[f + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t p = 0; p < patches.size(); ++p) patches[next[cover_.patch_facet[p]]++] = p;
  // mutant looks-fewer-cuts: `14` -> `30`
  InterruptPoller poll_interrupt(1u << 14);
  for (std::uint32_t f = 0; f < mesh_.facet_count(); ++f) {
    poll_interrupt();
    look_at(f, std::span(patches).subspan(begin[f], begin[f + 1] - begin[f]));
  }
  return assembled();
}

void Sharing::look_at(std::uint32_t facet, std::span<const std::uint32_t> patches) {
  if (patches.size() < 2) return;
  shares_.clear();
  for (const std::uint32_t p : patches) {
    const auto owns = [&](const Share& share) { return share.leaf == owner_[p]; };
    auto share = std::find_if(shares_.begin(), shares_.end(), owns);
    if (share == shares_.end()) share = shares_.insert(shares_.end(), {.leaf = owner_[p]});
    share->area += area_of(p);
    share->patches.push_back(p);
  }
  for (Share& share : shares_) join_patches(facet, share);
  std::stable_sort(shares_.begin(), shares_.end(), [](const Share& a, const Share& b) { return a.area > b.area; });
  if (takes_whole(facet)) return;
  join_shares();
  for (Share& share : shares_) join_patches(facet, share);
}

bool Sharing::takes_whole(std::uint32_t facet) {
  for (const Share& taker : shares_) {
    const auto can_give = [&](const Share& share) {
      // mutant fewer-cuts-last-patch-whole: `share.patches.size()` -> `0`
      return share.leaf == taker.leaf || patch_counts_[share.leaf] > share.patches.size();
    };
    if (!std::all_of(shares_.begin(), shares_.end(), can_give) || !contains(taker.leaf, mesh_.facets[facet])) continue;
    for (const Share& share : shares_) {
      patch_counts_[share.leaf] -= static_cast<std::uint32_t>(share.patches.size());
      for (const std::uint32_t p : share.patches) owner_[p] = none;
    }
    ++patch_counts_[taker.leaf];
    whole_owner_[facet] = taker.leaf;
    return true;
  }
  return false;
}

// The smallest share is the first to go, to the largest that contains it.
void Sharing::join_shares() {
  for (std::size_t k = shares_.size(); k-- > 1;) {
    Share& giver = shares_[k];
    const auto count = static_cast<std::uint32_t>(giver.patches.size());
    // mutant fewer-cuts-last-patch: `if (patch_counts_[giver.leaf] <= count) continue` -> ``
    if (patch_counts_[giver.leaf] <= count) continue;
    const auto contains_giver = [&](const Share& taker) {
      return &taker != &giver && std::all_of(giver.patches.begin(), giver.patches.end(),
                                             [&](std::uint32_t p) { return contains(taker.leaf, corners_of(p)); });
    };
    const auto taker = std::find_if(shares_.begin(), shares_.end(), contains_giver);
    if (taker == shares_.end()) continue;
    patch_counts_[giver.leaf] -= count;
    patch_counts_[taker->leaf] += count;
    for (const std::uint32_t p : giver.patches) owner_[p] = taker->leaf;
    taker->patches.insert(taker->patches.end(), giver.patches.begin(), giver.patches.end());
    shares_.erase(shares_.begin() + static_cast<std::ptrdiff_t>(k));
  }
}

// Joins patches of one facet and one leaf if their union is convex.
void Sharing::join_patches(std::uint32_t facet, Share& share) {
  if (share.patches.size() < 2) return;
  joiner_.clear();
  corners_.clear();
  for (const std::uint32_t p : share.patches) {
    const auto corners = corners_of(p);
    polygon_.clear();
    for (const std::uint32_t c : corners)
      if (const auto b = barycentric_on(cover_, mesh_.facets[facet], c)) polygon_.push_back(*b);
    if (polygon_.size() != corners.size()) return;  // patches off their facet, which validate() reports
    joiner_.add(polygon_);
    corners_.insert(corners_.end(), corners.begin(), corners.end());
  }
  const auto polygons = joiner_.join();
  if (polygons.size() == share.patches.size()) return;
  // mutant fewer-cuts-joined-counted: `patch_counts_ ... <std::uint32_t>(share.patches.size() - polygons.size())` -> ``
  patch_counts_[share.leaf] -= static_cast<std::uint32_t>(share.patches.size() - polygons.size());
  for (std::size_t k = 0; k < share.patches.size(); ++k) {
    const std::uint32_t p = share.patches[k];
    if (k >= polygons.size()) {
      owner_[p] = part_of_another;
      continue;
    }
    const auto begin = static_cast<std::uint32_t>(joined_corners_.size());
    for (const std::uint32_t corner : polygons[k].corners) joined_corners_.push_back(corners_[corner]);
    joined_[p] = {begin, static_cast<std::uint32_t>(joined_corners_.size())};
  }
  share.patches.resize(polygons.size());
}

std::span<const std::uint32_t> Sharing::corners_of(std::uint32_t patch) const {
  const auto [begin, end] = joined_[patch];
  return begin == end ? cover_.patch(patch) : std::span(joined_corners_).subspan(begin, end - begin);
}

template <class Corners>
bool Sharing::contains(std::uint32_t leaf, const Corners& corners) const {
  // mutant fewer-cuts-leaf-alone: `tree_.parent[node]` -> `no_node`
  for (std::uint32_t node = leaf; node != no_node; node = tree_.parent[node])
    for (const std::uint32_t c : corners)
      // mutant fewer-cuts-beyond-reach: `reach_` -> `1.1 * reach_`
      if (!(squared_distance(tree_.spheres[node].center, places_[c]) <= reach_[node])) return false;
  return true;
}

double Sharing::area_of(std::uint32_t patch) const {
  const auto corners = cover_.patch(patch);
  Vec3 sum{};
  for (std::size_t k = 2; k < corners.size(); ++k)
    sum += cross(places_[corners[k - 1]] - places_[corners[0]], places_[corners[k]] - places_[corners[0]]);
  return length(sum);
}

// Patches in their former order, a whole facet in the place of its owner's first patch; patches from other leaves come
// last.
std::vector<std::vector<std::uint32_t>> Sharing::patches_of_leaves() const {
  std::vector<std::vector<std::uint32_t>> patches_of(tree_.node_count());
  std::vector<std::uint8_t> placed(mesh_.facet_count());
  const auto is_leafs_own = [&](std::uint32_t node, std::uint32_t p) {
    if (owner_[p] != none) return owner_[p] == node;
    const std::uint32_t f = cover_.patch_facet[p];
    // mutant fewer-cuts-counted-in-a-byte: `std::exchange(placed[f], std::uint8_t{1})` -> `placed[f]++`
    return whole_owner_[f] == node && std::exchange(placed[f], std::uint8_t{1}) == 0;
  };
  for (std::uint32_t node = 0; node < tree_.node_count(); ++node) {
    if (!tree_.is_leaf(node)) continue;
    for (std::uint32_t p = cover_.region_begin[node]; p < cover_.region_end[node]; ++p)
      if (is_leafs_own(node, p)) patches_of[node].push_back(p);
  }
  for (std::uint32_t node = 0; node < tree_.node_count(); ++node) {
    if (!tree_.is_leaf(node)) continue;
    for (std::uint32_t p = cover_.region_begin[node]; p < cover_.region_end[node]; ++p)
      if (owner_[p] < part_of_another && owner_[p] != node) patches_of[owner_[p]].push_back(p);
  }
  return patches_of;
}

Cover Sharing::assembled() const {
  const std::vector<std::vector<std::uint32_t>> patches_of = patches_of_leaves();
  Cover result;
  result.vertex_count = cover_.vertex_count;
  result.facet_count = cover_.facet_count;
  result.corner_begin.push_back(0);
  result.region_begin.resize(tree_.node_count());
  result.region_end.resize(tree_.node_count());
  std::vector<std::uint32_t> number(cover_.cut_points.size(), none);
  const auto add_corner = [&](std::uint32_t c) {
    if (c >= cover_.vertex_count) {
      std::uint32_t& cut = number[c - cover_.vertex_count];
      if (cut == none) {
        cut = static_cast<std::uint32_t>(cover_.vertex_count + result.cut_points.size());
        result.cut_points.push_back(cover_.cut_points[c - cover_.vertex_count]);
      }
      c = cut;
    }
    result.corners.push_back(c);
  };
  // mutant looks-fewer-cuts-patches: `16` -> `30`
  InterruptPoller poll_interrupt(1u << 16);
  const auto visit = [&](const auto& self, std::uint32_t node) -> void {
    result.region_begin[node] = static_cast<std::uint32_t>(result.patch_count());
    for (const std::uint32_t p : patches_of[node]) {
      poll_interrupt();
      const std::uint32_t f = cover_.patch_facet[p];
      result.patch_facet.push_back(f);
      if (owner_[p] == none)
        for (const std::uint32_t v : mesh_.facets[f]) add_corner(v);
      else
        for (const std::uint32_t c : corners_of(p)) add_corner(c);
      result.corner_begin.push_back(static_cast<std::uint32_t>(result.corners.size()));
    }
    for (std::uint32_t c = 0; c < tree_.child_count[node]; ++c) self(self, tree_.first_child[node] + c);
    result.region_end[node] = static_cast<std::uint32_t>(result.patch_count());
  };
  visit(visit, 0);
  // A tree is kept for long, so it keeps no spare memory.
  result.cut_points.shrink_to_fit();
  result.patch_facet.shrink_to_fit();
  result.corner_begin.shrink_to_fit();
  result.corners.shrink_to_fit();
  return result;
}

}  // namespace

Cover with_fewer_cuts(const MeshView& mesh, const CoveredTree& model, WorkersOrAll given) {
  Workers& workers = given;
  const StandardFloats standard;
  return Sharing(mesh, model, workers).with_fewer_cuts();
}

}  // namespace morula
