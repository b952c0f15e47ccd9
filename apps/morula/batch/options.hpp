// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Options of a batch, for programs that spread one over many machines.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace morula::cli {

/// The options among those of `morula batch` that results depend on, in one spelling: the words of keys and tasks. All
/// are checked as the command checks them, with a small build by a worker. Throws UsageError.
std::vector<std::string> checked_build_words(const std::vector<std::string>& options);
/// The note that so many kept results were of no use.
std::string remade_text(std::size_t count);

}  // namespace morula::cli
