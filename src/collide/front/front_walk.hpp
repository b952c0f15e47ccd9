// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The queue that refines a front; ContactQuery and collide() with a budget run it.
#pragma once

#include <memory>
#include <morula/collide/contacts.hpp>
#include <morula/collide/front.hpp>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <vector>

#include "collide/facets/contact_surface.hpp"
#include "collide/pairs/meter.hpp"
#include "collide/pairs/placed_pair.hpp"
#include "collide/pairs/tree_pair.hpp"

namespace morula::detail {

struct ColliderPair {
  std::shared_ptr<const Collider> a, b;
  double weight;
};

/// Extras of contacts, added on request, and their memory: surfaces, facet pairs, containment. Inside queries are made
/// on first use, and kept for the same pairs.
class ContactExtras {
 public:
  /// Discards the memory, before other colliders or after an exception.
  void forget() noexcept {
    inside_.clear();
    surfaces_.clear();
    nodes_.clear();
  }
  /// Fills the extras that the options request, and clears the others. The pairs must have current positions. An
  /// incomplete extra leaves the result unfinished. Surfaces that are present belong to the first contacts: the search
  /// continues after them. meter: ends surfaces when its time is over; null: no budget.
  void add(std::span<const ColliderPair> pairs, const CollideOptions& options, Meter* meter, Contacts& result);
  /// The surface of one contact, finished or not.
  ContactSurface surface_of(std::span<const ColliderPair> pairs, const Contact& contact);

 private:
  struct Inside {
    std::optional<InsideQuery> a, b;  // none for an open surface
    std::vector<std::uint32_t> components_a, components_b;
  };
  void add_surfaces(std::span<const ColliderPair> pairs, const CollideOptions& options, Meter* meter, Contacts& result);
  void add_crossings(std::span<const ColliderPair> pairs, Contacts& result);
  void add_containment(std::span<const ColliderPair> pairs, Contacts& result);

  std::vector<SurfaceScratch> surfaces_;  // one per pair
  std::vector<NodePair> nodes_;
  CrossingQuery crossings_;
  std::vector<Inside> inside_;
};

/// Stores the stamps of the present frame; with_spheres: also the spheres with which follow_travel() compares the next
/// frame.
void begin_travel(Front::Pair& bodies, const Collider& a, const Collider& b, const PlacedPair& placed,
                  bool with_spheres);

/// Adds to `path_length` the relative motion of the bodies since then, and stores the present frame. Nodes that kept
/// every bit, in a frame that did, have a path of 0. The path is measured in a's coordinates without its transform, so
/// bodies that are transformed together have not moved. Cost: linear in nodes.
void follow_travel(Front::Pair& bodies, const Collider& a, const Collider& b, const PlacedPair& placed,
                   std::vector<double>& scratch);

class FrontWalk {
 public:
  std::vector<ColliderPair> pairs;
  Front front;
  ContactExtras extras;

  /// Starts a front. The caller has checked the arguments. accepts: the front will be carried into the next frame,
  /// which costs a little.
  void start(const CollideOptions& options, bool accepts, Workers& workers, Contacts& result);
  void resume(const CollideOptions& options, Workers& workers, Contacts& result);
  void carry(const CollideOptions& options, Workers& workers, Contacts& result);
  /// Takes a front from outside. Before any other use, the caller has to check that it belongs to these pairs and is
  /// well formed: no index is out of range.
  void adopt(Front other);
  bool is_well_formed() const;
  /// Lists only the finished contacts of the front, which belongs to the present frame.
  void list_finished(const CollideOptions& options, Contacts& result);
  /// Lists the cut of the front, which belongs to these pairs; nothing without a front.
  void cut(std::vector<FrontPair>& list);
  /// Discards the front; keeps its memory.
  void end_front() noexcept;
  /// Discards the front, and all memory that an exception may have left in any state.
  void forget() noexcept;

 private:
  // An opened pair in progress: any thread tests it, then it is merged in order.
  struct Slot {
    Front::Waiting pair;
    NodeRange below_a, below_b;
    bool has_verdicts;  // whether there are verdicts of the previous frame
    double clearance;
    std::size_t first_mask = 0;  // begin of the masks in round_masks_
    std::uint32_t tests() const { return has_verdicts ? 0 : below_a.count * below_b.count; }
  };
  struct Run {
    const CollideOptions& options;
    Workers& workers;
    Contacts& result;
    Meter meter;
  };

  template <class F>
  void each_verdict(const F& f) const;
  void place(const CollideOptions& options);
  void refine(Run& run);
  void finish(const CollideOptions& options, Meter& meter, Contacts& result);
  bool reachable(const CollideOptions& options, const Front::Waiting& pair) const;
  bool still_holds(const CollideOptions& options, const Front::Waiting& pair) const;
  /// The path length of both nodes since a pair was opened in an earlier frame.
  double traveled_since(const Front::Opened& before) const;
  void test_roots(Run& run);
  void fill_round(Run& run);
  void test(const CollideOptions& options, Slot& slot, NodeRange below_b, std::uint64_t* masks) const;
  void test_round(Run& run);
  bool test_in_time(Run& run);  // false: the time ended before all tests were done
  void take_in(const Slot& slot, const std::uint64_t* masks, Run& run);
  void admit(const Front::Waiting& found, Run& run);
  void report(const Front::Waiting& pair, bool finished, Contacts& result) const;

  bool records_paths_ = false;
  std::vector<TreePair> trees_;
  // The opened pairs of the previous frame, while its verdicts may serve.
  std::vector<Front::Opened> opened_before_;
  std::vector<std::uint64_t> masks_before_;
  std::vector<std::uint32_t> roots_before_;
  std::vector<Slot> round_;
  std::vector<std::uint64_t> round_masks_;
  std::vector<Front::Waiting> aside_;
  std::vector<std::uint32_t> before_of_child_;  // by place in a block; all entries are none between uses
  std::vector<double> ways_;
};

}  // namespace morula::detail
