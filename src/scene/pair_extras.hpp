// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Memory to look at the facets of one pair at a time. It is shared by all pairs of a scene: a pair keeps what was
// found.
#pragma once

#include <memory>
#include <morula/collide/crossings.hpp>
#include <mutex>
#include <utility>
#include <vector>

#include "collide/facets/contact_surface.hpp"

namespace morula::detail {

struct PairExtras {
  SurfaceScratch surfaces;
  CrossingQuery crossings;
  std::vector<NodePair> nodes;
};

/// One for each thread that is at work.
class ExtrasPool {
 public:
  /// Taken out of the pool as long as it lives.
  class Loan {
   public:
    explicit Loan(ExtrasPool& pool) : pool_(pool), extras_(pool.take()) {}
    ~Loan() { pool_.give_back(std::move(extras_)); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    PairExtras& operator*() const { return *extras_; }

   private:
    ExtrasPool& pool_;
    std::unique_ptr<PairExtras> extras_;
  };

  /// None is on loan. What was interrupted may be half made.
  void forget() noexcept { free_.clear(); }

 private:
  std::unique_ptr<PairExtras> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) {
      ++count_;
      // So that giving back allocates nothing.
      free_.reserve(count_);
      return std::make_unique<PairExtras>();
    }
    std::unique_ptr<PairExtras> extras = std::move(free_.back());
    free_.pop_back();
    return extras;
  }
  void give_back(std::unique_ptr<PairExtras> extras) noexcept {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(extras));
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<PairExtras>> free_;
  std::size_t count_ = 0;
};

}  // namespace morula::detail
