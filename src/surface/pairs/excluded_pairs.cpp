// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/excluded_pairs.hpp"

#include <algorithm>

namespace morula::detail {
namespace {

/// The value that a surface keeps, or a new one. The lock is not held while it is made, because workers may do other
/// work for this surface in between. Two threads may make the same value.
template <class Value, class Make>
std::shared_ptr<const Value> kept(Mutex& mutex, std::shared_ptr<const Value>& value, const Make& make) {
  {
    const std::lock_guard lock(mutex);
    if (value) return value;
  }
  std::shared_ptr<const Value> made = make();
  const std::lock_guard lock(mutex);
  if (!value) value = std::move(made);
  return value;
}

}  // namespace

ExcludedPairs::ExcludedPairs(const SurfaceTreeState& s, const ExclusionRule& rule, Workers& workers) : rule_(rule) {
  if (rule.rings > 0)
    rings_ = std::make_unique<RingTable>(s, rule.rings, rule.features, most_bytes_per_facet * s.blocks.order.size());
  if (!(rule.rest_distance > 0)) return;
  ExclusionTables& tables = *s.exclusions;
  boxes_ = kept(tables.mutex, tables.rest_boxes, [&] { return std::make_shared<const RestBoxes>(s); });
  near_ = NearAtRest(kept(tables.mutex, tables.rest_shapes[rule.features == Features::all ? 1 : 0],
                          [&] { return std::make_shared<const RestShapes>(s, rule.features, workers); }),
                     rule.rest_distance, ExclusionTest(s, rule).rounding());
}

// A box holds all vertices of the facets below its node, and so every point of the features of its blocks. Where
// are_surely_near() is true of two boxes, are_near_at_rest() is true of all pairs of features in them.
bool ExcludedPairs::are_all(const SurfaceTreeState& s, const BoxNode& a, const BoxNode& b, bool by_table) const {
  // If a table is too large, the threads' order decides which rows it has.
  if (by_table && rings_ && rings_->fits() &&
      (a.is_block() ? rings_->has_row(a.number) && rings_->of(a.number, b.number) == RingTable::all()
                    : rings_->hold(a.height, a.number, b.number)))
    return true;
  return boxes_ && ExclusionTest(s, rule_).are_surely_near(boxes_->of(a), boxes_->of(b));
}

namespace {

std::shared_ptr<const ExcludedPairs> find_table(ExclusionTables& tables, const ExclusionRule& rule) {
  const std::lock_guard lock(tables.mutex);
  const auto at = std::find_if(tables.latest_first.begin(), tables.latest_first.end(),
                               // mutant exclusion-rule: `() == rule` -> `().features == rule.features`
                               [&](const auto& table) { return table->rule() == rule; });
  if (at == tables.latest_first.end()) return nullptr;
  std::rotate(tables.latest_first.begin(), at, at + 1);
  return tables.latest_first.front();
}

}  // namespace

std::shared_ptr<const ExcludedPairs> excluded_pairs(const SurfaceTreeState& surface, const ExclusionRule& rule,
                                                    Workers& workers) {
  constexpr std::size_t most_tables = 4;
  ExclusionTables& tables = *surface.exclusions;
  if (auto found = find_table(tables, rule)) return found;
  auto made = std::make_shared<const ExcludedPairs>(surface, rule, workers);
  if (auto found = find_table(tables, rule)) return found;
  const std::lock_guard lock(tables.mutex);
  tables.latest_first.insert(tables.latest_first.begin(), made);
  if (tables.latest_first.size() > most_tables) tables.latest_first.pop_back();
  return made;
}

}  // namespace morula::detail
