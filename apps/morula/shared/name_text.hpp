// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Names of files as text: they are bytes, and need not be UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace morula::cli {

/// A name as UTF-8 text. Text that is UTF-8 and holds no "\x" stays as it is. In all other names each byte that is not
/// part of UTF-8 becomes \xHH, with two upper-case digits, and a backslash becomes two. Different names give different
/// texts.
std::string text_of_name(std::string_view name);
/// The name that text_of_name() wrote.
std::string name_of_text(std::string_view text);

}  // namespace morula::cli
