// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Options that several commands share, and the words they are given in.
#pragma once

#include <cstdint>
#include <limits>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/update/rules.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/command.hpp"

namespace morula::cli {

void add_threads(CLI::App& command, unsigned& threads);
/// The requested number of workers or, with a note, the available number.
Workers make_workers(unsigned threads);

/// For options that take a number, which CLI11 would read more generously: not "nan", "inf", "-1" as 2^64 - 1, "0x10",
/// or "010" as 8. Applied before the number is read, together with the range.
CLI::Validator real_number(double least = std::numeric_limits<double>::lowest(),
                           double most = std::numeric_limits<double>::max());
CLI::Validator number_above_zero();
CLI::Validator whole_number(std::uint64_t least = 0, std::uint64_t most = std::numeric_limits<std::uint64_t>::max());
/// --weld; of: the meshes that it welds, such as "MESH".
void add_weld(CLI::App& command, bool& weld, std::string_view of);
void add_json(CLI::App& command, bool& json);
void add_sph_origin(CLI::App& command, std::string& origin);
/// The `details` of rules: --approach1-weights and the rest.
struct RuleDetailNames {
  std::string approach1_weights = "uniform";
  std::string approach1_inner_center = "children";
  std::string approach2_inner_boxes = "child-spheres";
  std::string wrapped_center = "children";
  double distance_floor = 0.0;
  std::string modal_bound = "gradient";
};
void add_rule_details(CLI::App& command, RuleDetailNames& names);

/// The known name nearest to `given`; empty when none is near enough to be meant.
std::string nearest_name(std::string_view given, const std::vector<std::string>& known);
/// Throws UsageError, listing the known names and the nearest one, unless `given` is known.
void check_name(std::string_view kind, const std::string& given, const std::vector<std::string>& known);

/// The names of all methods, and of all rules, for help texts.
std::vector<std::string> method_names();
std::vector<std::string> rule_names();
Method parse_method(const std::string& name);
std::vector<std::string> reduction_names();
std::vector<std::string> optimizer_names();
/// "merge,expand"; nothing for "".
std::vector<Reduction> parse_reducers(const std::string& text);
Optimizer parse_optimizer(const std::string& name);
std::vector<std::string> quality_names();
Quality parse_quality(const std::string& name);
Axis parse_axis(const std::string& name);
/// "exact", or a list such as "0:exact,2:approach2": from the given level on, until the next one given.
std::vector<Rule> parse_rules(const std::string& text);
/// Throws UsageError for a rule that follows anything but positions: the command has nothing else.
void require_position_rules(const std::vector<Rule>& rules);
RuleOptions parse_rule_details(const RuleDetailNames& names);
/// "x,y,z".
Vec3 parse_vector(std::string_view option, const std::string& text);
/// The origin of a .sph file, to which its coordinates are relative.
struct SphOrigin {
  enum class Kind { none, box_center, point };
  Kind kind = Kind::none;
  Vec3 point{0, 0, 0};  ///< coordinates for Kind `point`
};
/// "none", "bbox-center" or "x,y,z".
SphOrigin parse_sph_origin(const std::string& text);
/// none, bbox-center (of `mesh`; rejected without a mesh) or "x,y,z".
ReadTreeOptions parse_sph_origin(const std::string& text, const Mesh* mesh);

}  // namespace morula::cli
