// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page without data, made from viewer/ when the library was built; or the reason why there is none.
#pragma once

#include <string>

namespace morula::page {

/// The whole HTML file, with the line `page_data_mark` in the place of the data. Empty when the page was not built.
std::string page_template();
/// The reason why it was not built, as the end of a sentence; empty when it was.
std::string why_no_template();

inline constexpr const char* page_data_mark = "<!-- MORULA DATA -->";

}  // namespace morula::page
