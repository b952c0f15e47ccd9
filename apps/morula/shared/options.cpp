// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "platform/decimal.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"

namespace morula::cli {
namespace {

/// Least number of insertions, deletions and replacements of a character.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = text.find(separator); end != std::string::npos; end = text.find(separator, begin)) {
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  return parts;
}

template <class Number>
std::optional<Number> parse_number(const std::string& text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto result = platform::read_number(text.data(), end, value);
  if (result.ec != std::errc{} || result.ptr != end) return std::nullopt;
  return value;
}

std::string without_plus(const std::string& text) {
  return text.size() > 1 && text.front() == '+' && text[1] != '-' ? text.substr(1) : text;
}

template <class Items>
std::vector<std::string> names_of(const Items& items) {
  std::vector<std::string> names;
  for (const auto item : items) names.emplace_back(name(item));
  return names;
}

Rule parse_rule(const std::string& text) {
  check_name("rule", text, rule_names());
  return *rule_from_name(text);
}

}  // namespace

void add_threads(CLI::App& command, unsigned& threads) {
  add_option(command, "--threads", threads, "Threads to use; default: one per processor. Results do not depend on it")
      ->type_name("N")
      ->transform(whole_number(1, 1024));
}

void add_weld(CLI::App& command, bool& weld, std::string_view of) {
  add_flag(
      command, "--weld", weld,
      fmt::format("Merge vertices of {} that are equal and stay so, such as the corners of a glTF with hard edges; "
                  "files of positions and weights have the vertices of the file",
                  of));
}

Workers make_workers(unsigned threads) {
  Workers workers(threads);
  if (workers.thread_count() < threads) {
    note("--threads {}: only {} to be had, here or in this build; the result is the same", threads,
         workers.thread_count());
  }
  return workers;
}

CLI::Validator real_number(double least, double most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        const std::optional<double> value = parse_number<double>(without_plus(text));
        if (!value || !std::isfinite(*value)) return fmt::format("'{}' is not a number", text);
        if (*value >= least && *value <= most) return std::string();
        if (most == std::numeric_limits<double>::max()) return fmt::format("{} is below {}", text, least);
        return fmt::format("{} is not in {} to {}", text, least, most);
      },
      "");
}

CLI::Validator number_above_zero() {
  return CLI::Validator(
      [](std::string& text) {
        const std::optional<double> value = parse_number<double>(without_plus(text));
        if (value && std::isfinite(*value) && *value > 0) return std::string();
        return fmt::format("'{}' is not a number above 0", text);
      },
      "");
}

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        const std::optional<std::uint64_t> value = parse_number<std::uint64_t>(without_plus(text));
        if (!value || *value < least || *value > most) {
          const bool open = most == std::numeric_limits<std::uint64_t>::max();
          return open ? fmt::format("'{}' is not a whole number of {} or more", text, least)
                      : fmt::format("'{}' is not a whole number from {} to {}", text, least, most);
        }
        text = std::to_string(*value);
        return std::string();
      },
      "");
}

void add_json(CLI::App& command, bool& json) {
  add_flag(command, "--json", json, "Print the result as JSON; notes and errors go to stderr, one line of JSON each");
}

void add_sph_origin(CLI::App& command, std::string& origin) {
  add_option(command, "--sph-origin", origin,
             "Origin of the centers of a .sph: none, bbox-center (files of the published toolkit) or x,y,z")
      ->type_name("ORIGIN")
      ->capture_default_str();
}

void add_rule_details(CLI::App& command, RuleDetailNames& names) {
  add_option(command, "--approach1-weights", names.approach1_weights,
             "Weights of linked vertices in a leaf's center: uniform, inverse-distance or area")
      ->type_name("NAME")
      ->capture_default_str();
  add_option(command, "--approach1-inner-center", names.approach1_inner_center,
             "Inner centers follow: children or linked-vertices")
      ->type_name("NAME")
      ->capture_default_str();
  add_option(command, "--approach2-inner-boxes", names.approach2_inner_boxes,
             "Inner boxes hold: child-spheres or child-centers")
      ->type_name("NAME")
      ->capture_default_str();
  add_option(command, "--wrapped-center", names.wrapped_center,
             "Center for wrapped: children (moved by their average) or smallest (least radius)")
      ->type_name("NAME")
      ->capture_default_str();
  add_option(command, "--distance-floor", names.distance_floor,
             "Share of the radius to which shorter distances are raised in ratios; 0 is the paper")
      ->type_name("SHARE")
      ->transform(real_number(0.0, 1.0))
      ->capture_default_str();
  add_option(command, "--modal-bound", names.modal_bound,
             "Bound of modal: gradient (follows strain and rotation) or shift (as in the paper)")
      ->type_name("NAME")
      ->capture_default_str();
}

std::string nearest_name(std::string_view given, const std::vector<std::string>& known) {
  // A name that was cut short is nearer than any typing mistake.
  for (const std::string& name : known) {
    if (given.size() >= 3 && name.starts_with(given)) return name;
  }
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, given.size() / 3) + 1;
  for (const std::string& name : known) {
    const std::size_t distance = edit_distance(given, name);
    if (distance < least) {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

void check_name(std::string_view kind, const std::string& given, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), given) != known.end()) return;
  const std::string near = nearest_name(given, known);
  throw UsageError(fmt::format("unknown {} '{}'; known: {}{}", kind, given, fmt::join(known, ", "),
                               near.empty() ? "" : fmt::format("; did you mean {}?", near)));
}

std::vector<std::string> method_names() {
  return names_of(all_methods());
}

std::vector<std::string> rule_names() {
  return names_of(all_rules());
}

Method parse_method(const std::string& text) {
  check_name("method", text, method_names());
  return *method_from_name(text);
}

std::vector<std::string> reduction_names() {
  return names_of(all_reductions());
}

std::vector<std::string> optimizer_names() {
  return names_of(all_optimizers());
}

std::vector<Reduction> parse_reducers(const std::string& text) {
  std::vector<Reduction> reducers;
  if (text.empty()) return reducers;
  for (const std::string& item : split(text, ',')) {
    check_name("reducer", item, reduction_names());
    reducers.push_back(*reduction_from_name(item));
  }
  return reducers;
}

Optimizer parse_optimizer(const std::string& text) {
  check_name("optimizer", text, optimizer_names());
  return *optimizer_from_name(text);
}

std::vector<std::string> quality_names() {
  return names_of(all_qualities());
}

Quality parse_quality(const std::string& text) {
  check_name("quality", text, quality_names());
  return *quality_from_name(text);
}

Axis parse_axis(const std::string& text) {
  check_name("axis", text, {"x", "y", "z", "auto"});
  return text == "x" ? Axis::x : text == "y" ? Axis::y : text == "z" ? Axis::z : Axis::automatic;
}

std::vector<Rule> parse_rules(const std::string& text) {
  if (text.find_first_of(":,") == std::string::npos) return {parse_rule(text)};
  std::vector<Rule> rules;
  for (const std::string& item : split(text, ',')) {
    const std::size_t colon = item.find(':');
    const std::optional<unsigned> level =
        colon == std::string::npos ? std::nullopt : parse_number<unsigned>(item.substr(0, colon));
    if (!level || *level > static_cast<unsigned>(max_depth)) {
      throw UsageError(fmt::format(
          "'{}' in --rule is not LEVEL:RULE with a level 0 to {}; an example: 0:exact,2:approach2", item, max_depth));
    }
    if (rules.empty() ? *level != 0 : *level < rules.size()) {
      throw UsageError(
          fmt::format("--rule {}: levels must start at 0 and ascend; an example: 0:exact,2:approach2", text));
    }
    const Rule rule = parse_rule(item.substr(colon + 1));
    if (!rules.empty()) rules.resize(*level, rules.back());
    rules.push_back(rule);
  }
  return rules;
}

void require_position_rules(const std::vector<Rule>& rules) {
  for (const Rule rule : rules) {
    if (traits(rule).follows == RuleTraits::Follows::positions) continue;
    throw UsageError(fmt::format("--rule {} needs {}: not offered here", name(rule),
                                 traits(rule).follows == RuleTraits::Follows::modes
                                     ? "the coordinates of a modal model"
                                     : "a skin and the transforms of its bones"));
  }
}

RuleOptions parse_rule_details(const RuleDetailNames& names) {
  RuleOptions details;
  check_name("--approach1-weights", names.approach1_weights, {"uniform", "inverse-distance", "area"});
  check_name("--approach1-inner-center", names.approach1_inner_center, {"children", "linked-vertices"});
  check_name("--approach2-inner-boxes", names.approach2_inner_boxes, {"child-spheres", "child-centers"});
  details.approach1_weights = names.approach1_weights == "uniform" ? RuleOptions::Weights::uniform
                              : names.approach1_weights == "area"  ? RuleOptions::Weights::area
                                                                   : RuleOptions::Weights::inverse_distance;
  details.approach1_inner_center = names.approach1_inner_center == "children"
                                       ? RuleOptions::InnerCenter::children
                                       : RuleOptions::InnerCenter::linked_vertices;
  details.approach2_inner_boxes = names.approach2_inner_boxes == "child-spheres"
                                      ? RuleOptions::InnerBoxes::child_spheres
                                      : RuleOptions::InnerBoxes::child_centers;
  check_name("--wrapped-center", names.wrapped_center, {"children", "smallest"});
  details.wrapped_center =
      names.wrapped_center == "children" ? RuleOptions::WrappedCenter::children : RuleOptions::WrappedCenter::smallest;
  details.distance_floor = names.distance_floor;
  check_name("--modal-bound", names.modal_bound, {"gradient", "shift"});
  details.modal_bound =
      names.modal_bound == "shift" ? RuleOptions::ModalBound::shift : RuleOptions::ModalBound::gradient;
  return details;
}

Vec3 parse_vector(std::string_view option, const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  Vec3 v;
  for (int axis = 0; axis < 3; ++axis) {
    const auto part = static_cast<std::size_t>(axis);
    const std::optional<double> value = part < parts.size() ? parse_number<double>(parts[part]) : std::nullopt;
    if (!value || !std::isfinite(*value) || parts.size() != 3) {
      throw UsageError(fmt::format("{} '{}' is not three numbers such as 0.5,0,-1", option, text));
    }
    v[axis] = *value;
  }
  return v;
}

SphOrigin parse_sph_origin(const std::string& text) {
  using Kind = SphOrigin::Kind;
  if (text == "none") return {};
  if (text == "bbox-center") return {Kind::box_center, {}};
  if (text.find(',') == std::string::npos) {
    throw UsageError(fmt::format("--sph-origin '{}' is none of: none, bbox-center, x,y,z", text));
  }
  return {Kind::point, parse_vector("--sph-origin", text)};
}

ReadTreeOptions parse_sph_origin(const std::string& text, const Mesh* mesh) {
  const SphOrigin origin = parse_sph_origin(text);
  if (origin.kind != SphOrigin::Kind::box_center) return {.sph_origin = origin.point};
  if (mesh == nullptr) throw UsageError("--sph-origin bbox-center needs the mesh: add --mesh MESH");
  return {.sph_origin = bounding_box(*mesh).center()};
}

}  // namespace morula::cli
