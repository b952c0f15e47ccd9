// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A node of one body and a node of another.
#pragma once

#include <cstdint>

namespace morula {

struct NodePair {
  std::uint32_t a, b;
  constexpr bool operator==(const NodePair&) const = default;
};

}  // namespace morula
