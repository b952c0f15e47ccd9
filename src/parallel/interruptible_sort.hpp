// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// std::sort with checks for interruption: millions of values take seconds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "parallel/interruption.hpp"

namespace morula::detail {

template <class Value, class Less>
void sort_interruptibly(std::vector<Value>& values, const Less& less) {
  // mutant looks-sort: `16` -> `30`
  InterruptPoller poll_interrupt(1u << 16);
  std::sort(values.begin(), values.end(), [&](const Value& p, const Value& q) {
    poll_interrupt();
    return less(p, q);
  });
}

}  // namespace morula::detail
