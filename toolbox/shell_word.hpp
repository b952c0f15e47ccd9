// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Words of command lines that a user copies.
#pragma once

#include <string>

namespace morula::toolbox {

/// A word as a shell reads it back: in quotes if it has more than letters, digits and harmless signs. Windows: as
/// PowerShell reads it, and cmd as well unless the word has signs that one of them replaces even in quotes.
std::string shell_word(const std::string& word);

}  // namespace morula::toolbox
