// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/mjcf/copies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace morula::robot {

using tinyxml2::XMLElement;

namespace {

/// Copies, elements in them, and pairs of them that are referred to, all together.
constexpr std::size_t most_copies = 10'000, most_comparisons = 10'000'000;

/// Whether two elements in copies of one <replicate> are in the same copy.
bool stand_together(const MjcfName& a, const MjcfName& b) {
  const auto depth = static_cast<std::ptrdiff_t>(std::min(a.copies.size(), b.copies.size()));
  return std::equal(a.copies.begin(), a.copies.begin() + depth, b.copies.begin(),
                    [](const MjcfCopy& x, const MjcfCopy& y) { return x.of != y.of || x.number == y.number; });
}

}  // namespace

bool MjcfNames::add(const std::string& written, const MjcfName& name) {
  if (!all_.insert(name.text).second) return false;
  if (!name.copies.empty()) copies_[written].push_back(name);
  return true;
}

std::vector<MjcfName> MjcfNames::of(const std::string& written) const {
  const auto found = copies_.find(written);
  if (found == copies_.end() || all_.count(written) != 0) return {{written}};
  return found->second;
}

MjcfCopies::Series::Series(const MjcfFiles& files, const MjcfValues& values, const XMLElement& at) {
  const MjcfElement e{at};
  const double given = values.numbers(e, "count", 1)[0];
  if (!(given >= 0 && given <= static_cast<double>(most_copies) && given == std::floor(given))) {
    files.fail(at, fmt::format("count=\"{}\" of <replicate> is not a number of copies from 0 to {}", e.find("count"),
                               most_copies));
  }
  count = static_cast<int>(given);
  offset = values.vector(e, "offset", {});
  angles = values.vector(e, "euler", {});
  if (const char* text = e.find("sep")) separator = text;
}

std::string MjcfCopies::Series::suffix(int number) const {
  return fmt::format("{}{:0{}}", separator, number, std::to_string(count).size());
}

std::string MjcfCopies::name_of(const XMLElement& at) const {
  const char* own = at.Attribute("name");
  return own == nullptr || *own == '\0' ? "" : own + suffix_;
}

void MjcfCopies::count(const XMLElement& at) {
  if (!copies_.empty() && ++counted_ > most_copies) {
    files_.fail(at, fmt::format("<replicate> makes more than {} elements", most_copies));
  }
}

std::vector<std::pair<std::string, std::string>> MjcfCopies::pairs(const XMLElement& at,
                                                                   const std::vector<MjcfName>& some,
                                                                   const std::vector<MjcfName>& others) {
  std::vector<std::pair<std::string, std::string>> found;
  compared_ += some.size() * others.size();
  for (const MjcfName& a : some) {
    for (const MjcfName& b : others) {
      if (counted_ > most_copies || compared_ > most_comparisons)
        files_.fail(at, "this refers to too many pairs of copies of <replicate>");
      if (!stand_together(a, b)) continue;
      found.emplace_back(a.text, b.text);
      if (!a.copies.empty() || !b.copies.empty()) ++counted_;
    }
  }
  return found;
}

}  // namespace morula::robot
