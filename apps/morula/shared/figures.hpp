// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Numbers for people, as the study writes them.
#pragma once

#include <morula/study/numbers.hpp>

namespace morula::cli {

using study::counted;
using study::exact_digits;
using study::figure;
using study::hash_text;
using study::percent;
using study::seconds;

}  // namespace morula::cli
