// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Numbers as they are written for people. Files and JSON get every digit instead.
#pragma once

#include <cstdint>
#include <string>

namespace morula::toolbox {

/// Three significant digits.
std::string figure(double value);
/// A share of 1 as a percentage; a share that is not zero is never written as 0%.
std::string percent(double share);
std::string seconds(double value);
/// "1 sphere", "2 spheres"; `many` when the plural is not the singular with an s.
std::string counted(std::size_t count, const std::string& one, const std::string& many = {});
/// The digits that reading back needs for the same bits.
std::string exact_digits(double value);

/// 64-bit hashes as JSON has them: "0x…", since numbers of JSON readers often have 53 bits.
std::string hash_text(std::uint64_t hash);

}  // namespace morula::toolbox
