// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/ring_table.hpp"

#include <algorithm>
#include <utility>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

constexpr std::uint64_t all_bits = ~std::uint64_t{0};

}  // namespace

const std::uint64_t RingTable::none_[most_masks] = {};
const std::uint64_t RingTable::all_[most_masks] = {all_bits, all_bits, all_bits, all_bits, all_bits,
                                                   all_bits, all_bits, all_bits, all_bits, all_bits,
                                                   all_bits, all_bits, all_bits, all_bits, all_bits};

RingTable::RingTable(const SurfaceTreeState& surface, std::uint32_t rings, Features features, std::size_t most_bytes)
    : surface_(surface),
      rings_(rings),
      features_(features),
      most_bytes_(most_bytes),
      blocks_of_vertices_(surface),
      rows_(surface.block_count()) {}

RingTable::~RingTable() {
  for (const auto& row : rows_) delete row.load(std::memory_order_relaxed);
}

void RingTable::make_all(Workers& workers) {
  if (has_nodes_.load(std::memory_order_acquire)) return;
  parallel_for(workers, rows_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end && fits(); ++block) {
      check_interrupt();
      row(static_cast<std::uint32_t>(block));
    }
  });
  if (row_count_.load() == rows_.size()) make_nodes();
}

std::unique_ptr<RingRowMaker> RingTable::take_maker() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<RingRowMaker> maker = std::move(idle_.back());
      idle_.pop_back();
      return maker;
    }
  }
  return std::make_unique<RingRowMaker>(surface_, rings_, features_, blocks_of_vertices_);
}

// Two threads may make the same row; the first one's stays.
const RingRow* RingTable::row(std::uint32_t block) {
  if (const RingRow* const made = rows_[block].load(std::memory_order_acquire)) return made;
  if (!fits()) return nullptr;
  std::unique_ptr<RingRowMaker> maker = take_maker();
  std::optional<RingRow> made = maker->make(block);
  {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(maker));
  }
  if (!made) {
    is_too_large_.store(true);
    return nullptr;
  }
  auto row = std::make_unique<const RingRow>(std::move(*made));
  const RingRow* present = nullptr;
  if (!rows_[block].compare_exchange_strong(present, row.get(), std::memory_order_acq_rel)) return present;
  ++row_count_;
  // mutant exclusion-memory: `most_bytes_` -> `100 * most_bytes_`
  if (row_bytes_ += row->bytes(); row_bytes_ > most_bytes_) is_too_large_.store(true);
  return row.release();
}

const std::uint64_t* RingTable::of(std::uint32_t a, std::uint32_t b) {
  const RingRow* const made = row(a);
  if (made == nullptr) return nullptr;
  const auto end = made->entries.end();
  const auto at = std::lower_bound(made->entries.begin(), end, b,
                                   [](const RingRow::Entry& entry, std::uint32_t block) { return entry.last < block; });
  // mutant exclusion-run: `end || b < at->first` -> `end`
  if (at == end || b < at->first) return none_;
  return at->masks == RingRow::no_masks ? all_ : &made->masks[at->masks];
}

void RingTable::make_nodes() {
  const std::lock_guard lock(mutex_);
  if (has_nodes_.load(std::memory_order_relaxed)) return;
  idle_.clear();
  std::vector<std::uint32_t> begin{0};
  std::vector<ExcludedNodes::Run> runs;
  for (const auto& of_block : rows_) {
    for (const RingRow::Entry& entry : of_block.load(std::memory_order_acquire)->entries)
      if (entry.masks == RingRow::no_masks) runs.push_back({entry.first, entry.last});
    begin.push_back(static_cast<std::uint32_t>(runs.size()));
  }
  const std::size_t used = row_bytes_.load();
  nodes_ = ExcludedNodes(std::move(begin), std::move(runs), most_bytes_ > used ? most_bytes_ - used : 0);
  has_nodes_.store(true, std::memory_order_release);
}

std::size_t RingTable::bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t idle = 0;
  for (const auto& maker : idle_) idle += maker->bytes();
  return row_bytes_.load() + rows_.size() * sizeof(rows_[0]) + blocks_of_vertices_.bytes() + nodes_.bytes() + idle;
}

}  // namespace morula::detail
