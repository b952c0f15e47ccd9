// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Claims of equal bits: hashes of everything that the core computes, by name.
#pragma once

#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <string>
#include <vector>

namespace morula::bits {

struct Claim {
  std::string name;
  std::uint64_t hash;
  bool operator==(const Claim&) const = default;
};
using Claims = std::vector<Claim>;

/// What the kernels have no part in: bodies by formula, trees and covers by every method, balls and distances, figures.
Claims shapes(Workers& workers);
/// What they have: bodies that follow every rule through motions, and queries about pairs of them.
Claims motions(Workers& workers);

}  // namespace morula::bits
