// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Costs as JSON, for the cache and for study.json.
#pragma once

#include <morula/study/cost.hpp>

#include "json.hpp"

namespace morula::study {

/// "rules", "boxes", "mixes".
Json costs_json(const Cost& cost);

}  // namespace morula::study
