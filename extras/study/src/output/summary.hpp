// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Words that a reader needs next to a claim.
#pragma once

#include <string>
#include <string_view>

namespace morula::study {

/// The criterion of a claim and its reason, in at most two sentences without figures; empty for an unknown claim.
std::string why_of(std::string_view claim_id);

}  // namespace morula::study
