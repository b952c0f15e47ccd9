// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <morula/study/amounts.hpp>
#include <morula/update/body.hpp>
#include <stdexcept>
#include <toolbox/numbers.hpp>

#include "words.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

constexpr int bisections = 8;

/// One tree by one rule in one motion: values by the share of the full amount, each measured once.
class AmountCurve {
 public:
  AmountCurve(const Plan& plan, const NamedMesh& body, const CoveredTree& model, Rule rule, const Deformations& motion,
              std::string name)
      : plan_(plan),
        mesh_(body.mesh),
        motion_(motion),
        meter_(body.mesh),
        body_(body.mesh, model, {.rules = {rule}}),
        name_(std::move(name)) {
    const Vec3 extent = bounding_box(mesh_).extent();
    longest_ = std::max({extent.x, extent.y, extent.z});
    box_volume_ = extent.x * extent.y * extent.z;
  }
  const std::string& name() const { return name_; }

  /// level: a place in Plan::levels().
  const UnitValues& at(double share, std::size_t level) {
    const auto known = values_.find(share);
    if (known != values_.end()) return known->second[level];
    const std::vector<Vec3> positions = deform(mesh_, motion_, share);
    if (!body_.update(positions)) throw std::logic_error("the study's own motion was rejected by update");
    const SphereTree tree = body_.current_tree();
    const double area = surface_area({positions, mesh_.facets});
    std::vector<UnitValues> levels;
    for (const std::size_t l : plan_.levels()) {
      const Looseness loose = meter_.measure(positions, level_set_spheres(tree, std::min(l, tree.level_count() - 1)),
                                             {.kind = VoxelGrid::Kind::level, .resolution = plan_.resolution});
      levels.push_back(unit_values(loose, area, longest_, box_volume_));
    }
    return values_.emplace(share, std::move(levels)).first->second[level];
  }

 private:
  const Plan& plan_;
  const Mesh& mesh_;
  const Deformations& motion_;
  LoosenessMeter meter_;
  Body body_;
  std::string name_;
  double longest_ = 0, box_volume_ = 0;
  std::map<double, std::vector<UnitValues>> values_;
};

constexpr std::array parts{FigurePart::a, FigurePart::b, FigurePart::c, FigurePart::d};

bool is_of_rules(FigurePart part) {
  return part == FigurePart::a || part == FigurePart::b;
}
std::size_t level_of(const Plan& plan, FigurePart part) {
  return part == FigurePart::a || part == FigurePart::c ? 0 : plan.levels().size() - 1;
}
char letter(FigurePart part) {
  return static_cast<char>('a' + static_cast<int>(part));
}

/// The curves of Fig. 2 for one body and motion.
struct Curves {
  std::vector<AmountCurve> rules, generators;

  double largest(FigurePart part, std::size_t level, AmountUnit unit, double share) {
    double most = 0;
    for (AmountCurve& curve : is_of_rules(part) ? rules : generators)
      most = std::max(most, curve.at(share, level)[static_cast<std::size_t>(unit)]);
    return most;
  }
};

Curves curves_of(const Plan& plan, const Result& trees, std::size_t body, std::size_t motion) {
  Curves curves;
  for (std::size_t s = 0; s < plan.sources.size(); ++s) {
    if (plan.sources[s].body != body) continue;
    const auto add = [&](std::vector<AmountCurve>& list, Rule rule, std::string name) {
      list.emplace_back(plan, plan.bodies[body], trees.model[s], rule, plan.motions[motion], std::move(name));
    };
    if (plan.sources[s].named() == Method::medial) {
      add(curves.rules, Rule::approach1, title(Rule::approach1));
      add(curves.rules, Rule::approach2, title(Rule::approach2));
    }
    add(curves.generators, Rule::approach2, plan.sources[s].method);
  }
  return curves;
}

bool can_move(const Plan& plan, std::size_t body, std::size_t motion) {
  try {
    deform(plan.bodies[body].mesh, plan.motions[motion], 1.0);
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

std::vector<FoundAmount> search(const Plan& plan, std::size_t body, std::size_t motion, Curves& curves) {
  std::vector<FoundAmount> list;
  for (const FigurePart part : parts) {
    if ((is_of_rules(part) ? curves.rules : curves.generators).empty()) continue;
    const std::size_t level = level_of(plan, part);
    for (const AmountUnit unit : amount_units) {
      const auto largest = [&](double share) { return curves.largest(part, level, unit, share); };
      FoundAmount found{body, motion, part, unit, share_reaching(paper_axis_end, largest)};
      found.at_rest = largest(0);
      found.at_full = largest(1);
      list.push_back(found);
    }
  }
  return list;
}

/// "stretch 1.05" for a share of "stretch 2".
std::string amount_of(const Plan& plan, std::size_t motion, double share) {
  Deformations scaled = plan.motions[motion];
  for (Deformation& d : scaled) {
    if (auto* stretch = std::get_if<Stretch>(&d)) stretch->factor = 1 + share * (stretch->factor - 1);
    if (auto* twist = std::get_if<Twist>(&d)) twist->degrees *= share;
    if (auto* bend = std::get_if<Bend>(&d)) bend->degrees *= share;
    if (auto* rotate = std::get_if<Rotate>(&d)) rotate->degrees *= share;
  }
  return describe_all(scaled);
}

/// A panel of Fig. 2: up to the full amount, or up to the found one on the paper's axes.
Figure panel(const Plan& plan, Curves& curves, const FoundAmount& found, bool full) {
  const double share = full ? 1.0 : found.share.value();
  const std::string amount = amount_of(plan, found.motion, share);
  const std::string kind = first_word(describe_all(plan.motions[found.motion]));
  Figure figure;
  figure.group = fmt::format("paper-axes-{}", letter(found.part));
  figure.id = figure.group + (full ? "-full" : fmt::format("-{}", name(found.unit)));
  figure.title = fmt::format("Fig. 2 {}, level {}: up to {}", letter(found.part),
                             plan.levels()[level_of(plan, found.part)], amount);
  figure.motion = kind;
  figure.body = found.body;
  figure.y_label = amount;
  figure.y_unit = text(found.unit);
  if (!full) figure.y_end = paper_axis_end;
  for (AmountCurve& curve : is_of_rules(found.part) ? curves.rules : curves.generators) {
    Series series{curve.name(), SeriesRole::method, {}, {}};
    for (std::size_t i = 0; i < plan.samples; ++i) {
      const double t = share * static_cast<double>(i) / static_cast<double>(plan.samples - 1);
      series.x.push_back(static_cast<double>(i));
      series.y.emplace_back(curve.at(t, level_of(plan, found.part))[static_cast<std::size_t>(found.unit)]);
    }
    figure.series.push_back(std::move(series));
  }
  return figure;
}

std::string amount_text(const Plan& plan, const FoundAmount& found) {
  if (!found.share) return found.at_rest >= paper_axis_end ? "beyond at rest" : "not reached";
  const std::string words = amount_of(plan, found.motion, std::round(*found.share * 256) / 256);
  const std::size_t space = words.find(' ');
  return figure(std::stod(words.substr(space + 1)));
}

std::vector<Figure> figures_of(const Plan& plan, const std::vector<FoundAmount>& found, Curves& curves) {
  std::vector<Figure> figures;
  for (const FoundAmount& f : found) {
    if (f.unit == AmountUnit::object) figures.push_back(panel(plan, curves, f, true));
    if (f.share) figures.push_back(panel(plan, curves, f, false));
  }
  return figures;
}

/// The trees of the paper's generators alone, one of each for a body.
Plan plan_of_trees(const Plan& plan) {
  Plan trees = plan;
  trees.sources.clear();
  for (std::size_t body = 0; body < plan.bodies.size(); ++body)
    for (const Method method : paper_methods())
      if (const auto source = plan.find_source(body, method)) trees.sources.push_back(plan.sources[*source]);
  trees.rules.clear();
  trees.mixes.clear();
  trees.press_rules.clear();
  trees.press_sources.clear();
  trees.needle_sides = 0;
  trees.keep_trees = true;
  return trees;
}

/// Trees are built without motions.
Result run_trees(Plan trees, Workers& workers, const RunOptions& options) {
  trees.motions.clear();
  trees.measures.protrusion = false;
  return run(trees, workers, options);
}

}  // namespace

std::string_view name(AmountUnit unit) {
  constexpr std::array<std::string_view, amount_units.size()> names{"object", "box", "grid", "thickness", "edge"};
  return names[static_cast<std::size_t>(unit)];
}

std::string_view text(AmountUnit unit) {
  constexpr std::array<std::string_view, amount_units.size()> texts{
      "object volumes", "boxes of the object at rest", "share of the voxel grid", "mean thickness over the length",
      "edge of a cube over the length"};
  return texts[static_cast<std::size_t>(unit)];
}

UnitValues unit_values(const Looseness& grid, double area, double longest_side, double box_volume) {
  const double outside = grid.outside_volume;
  const double voxel = grid.voxel_edge * grid.voxel_edge * grid.voxel_edge;
  return {outside / grid.object_volume, outside / box_volume, outside / (static_cast<double>(grid.voxels) * voxel),
          outside / (area * longest_side), std::cbrt(outside) / longest_side};
}

std::optional<double> share_reaching(double end, const std::function<double(double)>& value) {
  double low = 0, high = 1;
  if (value(low) >= end || value(high) < end) return std::nullopt;
  for (int i = 0; i < bisections; ++i) {
    const double middle = (low + high) / 2;
    (value(middle) >= end ? high : low) = middle;
  }
  return high;
}

PaperAmounts find_paper_amounts(const Plan& plan, Workers& workers, const RunOptions& options) {
  const Plan trees = plan_of_trees(plan);
  PaperAmounts amounts;
  if (trees.sources.empty() || trees.sources.front().body != 0) return amounts;
  const Result result = run_trees(trees, workers, options);
  const std::size_t motions = trees.motions.size();
  std::vector<std::vector<FoundAmount>> found(trees.bodies.size() * motions);
  workers.run(found.size(), [&](std::size_t i) {
    const std::size_t body = i / motions, motion = i % motions;
    if (!can_move(trees, body, motion)) return;
    if (options.stop.stop_requested()) throw Stopped();
    Curves curves = curves_of(trees, result, body, motion);
    found[i] = search(trees, body, motion, curves);
    if (i == 0) amounts.figures = figures_of(trees, found[i], curves);
  });
  for (const std::vector<FoundAmount>& some : found)
    amounts.found.insert(amounts.found.end(), some.begin(), some.end());
  return amounts;
}

Table amounts_table(const Plan& plan, const PaperAmounts& amounts) {
  Table table{"paper-amounts",
              "Amounts at which the largest curve ends at 0.14, the end of the paper's axes",
              "Fig. 2 a and b: Approach 1 and 2 on the medial tree; c and d: the paper's generators with Approach 2. "
              "Stretch as a factor, twist and bend in degrees.",
              false,
              {"body", "motion", "unit", "Fig. 2 a", "Fig. 2 b", "Fig. 2 c", "Fig. 2 d"},
              {}};
  for (const FoundAmount& first : amounts.found) {
    const auto is_row_of = [&](const FoundAmount& f) {
      return f.body == first.body && f.motion == first.motion && f.unit == first.unit;
    };
    if (&*std::find_if(amounts.found.begin(), amounts.found.end(), is_row_of) != &first) continue;
    std::vector<TableValue> row{plan.bodies[first.body].name, first_word(describe_all(plan.motions[first.motion])),
                                std::string(text(first.unit))};
    for (const FigurePart part : parts) {
      const auto at = std::find_if(amounts.found.begin(), amounts.found.end(),
                                   [&](const FoundAmount& f) { return is_row_of(f) && f.part == part; });
      row.push_back(at == amounts.found.end() ? TableValue() : TableValue(amount_text(plan, *at)));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace morula::study
