// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Notices of other authors' code that is compiled in.
#pragma once

#include <string>

namespace morula::cli {

/// Morula's own license in a line, then the notices of all libraries that this program was built with, one after the
/// other: what --licenses prints.
std::string license_texts();

}  // namespace morula::cli
