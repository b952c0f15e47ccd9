// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features of surfaces, and which of them a query keeps.
#pragma once

#include <cstdint>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/swept.hpp>
#include <vector>

#include "surfaces.hpp"

namespace morula::python {

struct ProximityPairs {
  std::vector<ProximityPair> pairs;
};

struct SweptPairs {
  std::vector<SweptPair> pairs;
};

/// keeps: None or a function of Python's, which the caller holds.
PairFilter filter_of(std::uint32_t rings, double rest_distance, bool same_component, nb::handle keeps);

}  // namespace morula::python
