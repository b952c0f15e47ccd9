// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Numbers for people, as all programs here write them.
#pragma once

#include <toolbox/numbers.hpp>
#include <toolbox/stopwatch.hpp>

namespace morula::cli {

using toolbox::counted;
using toolbox::exact_digits;
using toolbox::figure;
using toolbox::hash_text;
using toolbox::median;
using toolbox::percent;
using toolbox::seconds;

}  // namespace morula::cli
