// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Surface trees with the objects that they borrow, and lists of pairs of features as columns.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/surface_tree.hpp>
#include <optional>
#include <shared_mutex>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "holders.hpp"
#include "records.hpp"

namespace morula::python {

/// A surface tree, the positions that it borrows, and the body that it follows.
struct HeldSurface : Exchanging {
  SurfaceTree tree;
  std::vector<Positions> positions;
  std::shared_ptr<Side> followed;  // or none
  mutable std::shared_mutex mutex;
  mutable std::atomic<bool> has_warned = false;  // warn_of_duplicates() has warned

  explicit HeldSurface(SurfaceTree&& made) : tree(std::move(made)) {}
  void visit(References& references) const { references(followed); }
};

/// Locks one or two surfaces, or none, that a query reads, then the bodies that they follow. To be made without the
/// GIL. Throws RuntimeError when such a body has changed its tree.
class SurfaceReading {
 public:
  explicit SurfaceReading(const HeldSurface* a, const HeldSurface* b = nullptr) {
    // One order for everybody, and each surface once.
    std::vector<const Side*> sides;
    for (const HeldSurface* surface : {std::min(a, b), std::max(a, b)}) {
      if (!surface || (!locks_.empty() && locks_.back().mutex() == &surface->mutex)) continue;
      locks_.emplace_back(surface->mutex);
      if (surface->followed) sides.push_back(surface->followed.get());
    }
    bodies_.emplace(sides);
    for (const Side* side : sides) side->current();
  }

 private:
  std::vector<std::shared_lock<std::shared_mutex>> locks_;
  std::optional<Reading> bodies_;
};

struct FeaturePairs {
  std::vector<FeaturePair> pairs;
};

template <class Holder, class Member>
auto pair_column(Member FeaturePair::*member) {
  return [member](nb::handle self) {
    const auto& pairs = nb::cast<const Holder&>(self).pairs;
    using Row = std::remove_cvref_t<decltype(pairs[0])>;
    using Scalar = std::conditional_t<std::is_enum_v<Member>, std::uint8_t, Member>;
    return column<Row>(std::span<const Row>(pairs),
                       pairs.empty() ? nullptr : reinterpret_cast<const Scalar*>(&(pairs[0].*member)), self);
  };
}

inline constexpr const char* kind_text = "(n,) uint8: morula.PairKind of each pair.";
inline constexpr const char* index_text = "(n,) uint32: a vertex, a facet, or an edge of SurfaceTree.edges.";

template <class Holder>
Record<Holder>& pair_columns(Record<Holder>& record) {
  record.property("kind", pair_column<Holder>(&FeaturePair::kind), kind_text)
      .property("a", pair_column<Holder>(&FeaturePair::a), index_text)
      .property("b", pair_column<Holder>(&FeaturePair::b), index_text)
      .table([](const Holder& self) { return self.pairs.size(); });
  return record;
}

}  // namespace morula::python
