// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The queue that refines a front: what ContactQuery and collide() with a budget run.
#pragma once

#include <morula/collide/contacts.hpp>
#include <morula/collide/front.hpp>
#include <morula/parallel/workers.hpp>
#include <vector>

#include "collide/facets/contact_extras.hpp"
#include "collide/pairs/meter.hpp"
#include "collide/pairs/tree_pair.hpp"

namespace morula::detail {

class FrontWalk {
 public:
  std::vector<ColliderPair> pairs;
  Front front;
  ContactExtras extras;

  /// Arguments have been checked. keeps: the front is to be carried into the next frame, which costs a little.
  void start(const CollideOptions& options, bool accepts, Workers& workers, Contacts& result);
  void resume(const CollideOptions& options, Workers& workers, Contacts& result);
  void carry(const CollideOptions& options, Workers& workers, Contacts& result);
  /// A front from outside. Before anything else is done with it, it has to be of these pairs, and well formed: with no
  /// index out of range.
  void adopt(Front other);
  bool is_well_formed() const;
  /// Only what is finished in the front, which is of the present frame.
  void list_finished(const CollideOptions& options, Contacts& result);
  void cut(std::vector<FrontPair>& list);
  /// No front, and none of what an exception may have left in any state.
  void forget() noexcept;

 private:
  // An opened pair on its way: tested by any thread, then taken in, in order.
  struct Slot {
    Front::Waiting pair;
    NodeRange below_a, below_b;
    bool knows_verdicts;  // from the previous frame
    double clearance;
    std::size_t first_mask = 0;  // in round_masks_
    std::uint32_t tests() const { return knows_verdicts ? 0 : below_a.count * below_b.count; }
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
  void refine(const CollideOptions& options, Workers& workers, Contacts& result);
  void finish(const CollideOptions& options, Meter& meter, Contacts& result);
  bool reachable(const CollideOptions& options, const Front::Waiting& pair) const;
  bool still_holds(const CollideOptions& options, const Front::Waiting& pair) const;
  /// How far both nodes have come since a pair was opened in an earlier frame.
  double traveled_since(const Front::Opened& before) const;
  void test_roots(Run& run);
  void fill_round(Run& run);
  void test(const CollideOptions& options, Slot& slot, NodeRange below_b, std::uint64_t* masks) const;
  void test_round(Run& run);
  bool test_in_time(Run& run);  // false: not all
  void take_in(const Slot& slot, const std::uint64_t* masks, Run& run);
  void admit(const Front::Waiting& found, Run& run);
  void report(const Front::Waiting& pair, bool finished, Contacts& result) const;

  bool keeps_ = false;
  std::vector<TreePair> trees_;
  // The previous frame's, while its verdicts may serve.
  std::vector<Front::Opened> opened_before_;
  std::vector<std::uint64_t> masks_before_;
  std::vector<std::uint32_t> roots_before_;
  std::vector<Slot> round_;
  std::vector<std::uint64_t> round_masks_;
  std::vector<Front::Waiting> aside_;
  std::vector<std::uint32_t> before_of_child_;  // a table by place in a block; all none between uses
  std::vector<double> ways_;
};

}  // namespace morula::detail
