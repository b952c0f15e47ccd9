// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "output/styles.hpp"

#include <algorithm>

namespace morula::study {

using namespace toolbox;

namespace {

struct Look {
  std::string_view name;
  int color;
  Marker marker;
  std::vector<double> dash;  // rules only
  bool strong;
};

/// Solid belongs to `exact` alone; new trees are points.
const std::vector<Look>& rule_looks() {
  static const std::vector<Look> looks{{"approach1", 1, Marker::triangle, {8, 3, 2, 3}, true},
                                       {"approach2", 0, Marker::diamond, {9, 4}, true},
                                       {"exact", 2, Marker::circle, {}, true},
                                       {"rebuilt", 4, Marker::square, {14, 3}, true},
                                       {"traditional", 3, Marker::down, {2, 3}, false},
                                       {"weighted", 5, Marker::cross, {5, 3}, false},
                                       {"wrapped", 6, Marker::plus, {12, 3, 2, 3, 2, 3}, false},
                                       {"fresh", 7, Marker::pentagon, {}, true}};
  return looks;
}

const std::vector<Look>& method_looks() {
  static const std::vector<Look> looks{
      {"medial", 0, Marker::diamond, {}, true},   {"grid", 1, Marker::square, {}, true},
      {"hubbard", 2, Marker::triangle, {}, true}, {"spawn", 3, Marker::down, {}, true},
      {"optimized", 5, Marker::circle, {}, true}, {"octree", 6, Marker::pentagon, {}, true},
      {"combined", 4, Marker::plus, {}, true}};
  return looks;
}

Look look_of(const std::vector<Look>& looks, std::string_view name) {
  const auto found = std::find_if(looks.begin(), looks.end(), [&](const Look& look) { return look.name == name; });
  if (found != looks.end()) return *found;
  std::size_t sum = 0;
  for (const char letter : name) sum = 31 * sum + static_cast<unsigned char>(letter);
  const auto step = static_cast<double>(1 + sum / 64 % 5);
  return {name,
          static_cast<int>(sum % palette.size()),
          static_cast<Marker>(sum / 8 % marker_count),
          {4 + step, 2, 1, 2, 1, 2},
          false};
}

}  // namespace

PlotLine style_of(const Series& series) {
  const Look rule = look_of(rule_looks(), series.rule);
  PlotLine line{.name = series.name, .color = rule.color, .strong = rule.strong, .marker = rule.marker};
  if (!series.rule.empty()) line.dash = rule.dash;
  if (!series.method.empty()) {
    const Look method = look_of(method_looks(), series.method);
    line.color = method.color;
    line.marker = method.marker;
    line.strong = method.strong;
  }
  line.dots = series.rule == name(RuleKey(fresh));
  line.hollow = series.faint || line.dots;
  if (series.faint) line.strong = false;
  return line;
}

}  // namespace morula::study
