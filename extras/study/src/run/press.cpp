// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/press.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <morula/collide/collider.hpp>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <numbers>
#include <stdexcept>
#include <toolbox/numbers.hpp>
#include <toolbox/stopwatch.hpp>

namespace morula::study {

using namespace toolbox;

namespace {

double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

double squared_distance_to(const Segment& s, const Vec3& p) {
  const Vec3 along = s.to - s.from;
  const double squared = squared_length(along);
  const double t = squared > 0 ? std::clamp(dot(p - s.from, along) / squared, 0.0, 1.0) : 0;
  return squared_distance(p, s.from + t * along);
}

/// The crossings in the region of a node: the crossings of those of its body's facets of which it owns a part.
class CrossingsOfNodes {
 public:
  CrossingsOfNodes(const Collider& body, std::vector<std::uint32_t> facets)
      : body_(body), facets_(std::move(facets)), known_(body.tree().node_count()), lists_(known_.size()) {}
  /// Ascending.
  const std::vector<std::uint32_t>& of(std::uint32_t node) {
    if (!known_[node]) {
      std::vector<std::uint32_t> owned(body_.facets(node).begin(), body_.facets(node).end());
      std::sort(owned.begin(), owned.end());
      for (std::uint32_t i = 0; i < facets_.size(); ++i)
        if (std::binary_search(owned.begin(), owned.end(), facets_[i])) lists_[node].push_back(i);
      known_[node] = true;
    }
    return lists_[node];
  }

 private:
  const Collider& body_;
  std::vector<std::uint32_t> facets_;  // one per crossing
  std::vector<bool> known_;
  std::vector<std::vector<std::uint32_t>> lists_;
};

/// The crossings of one pose, with which contacts are compared.
class Judge {
 public:
  Judge(const Collider& a, const Collider& b, const PressTruth& truth)
      : truth_(truth), of_a_(a, facets_of(truth, true)), of_b_(b, facets_of(truth, false)) {
    for (const Crossing& c : truth.crossings) {
      const Triangle ta = a.triangle(c.facet_a);
      const Triangle tb = b.triangle(c.facet_b);
      normals_.push_back(facet_normal(tb) - facet_normal(ta));
      weights_.push_back(distance(c.segment.from, c.segment.to));
    }
  }
  /// The crossings in the regions of both nodes.
  const std::vector<std::uint32_t>& crossings_of(const Contact& contact) {
    const std::vector<std::uint32_t>& a = of_a_.of(contact.node_a);
    const std::vector<std::uint32_t>& b = of_b_.of(contact.node_b);
    common_.clear();
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common_));
    return common_;
  }
  /// The normal between the two surfaces at their crossing, from b to a: the mean over the contact's own crossings by
  /// length; if it has none, that of the nearest one.
  Vec3 normal_near(const Contact& contact, const std::vector<std::uint32_t>& own) const {
    Vec3 sum{};
    for (const std::uint32_t i : own) sum += weights_[i] * normals_[i];
    if (squared_length(sum) > 0) return normalized(sum);
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < truth_.crossings.size(); ++i) {
      const double d = squared_distance_to(truth_.crossings[i].segment, contact.point);
      if (d < least) least = d, nearest = i;
    }
    return normalized(normals_[nearest], truth_.normal);
  }

 private:
  static std::vector<std::uint32_t> facets_of(const PressTruth& truth, bool of_a) {
    std::vector<std::uint32_t> list;
    for (const Crossing& c : truth.crossings) list.push_back(of_a ? c.facet_a : c.facet_b);
    return list;
  }
  static Vec3 facet_normal(const Triangle& t) { return normalized(cross(t[1] - t[0], t[2] - t[0]), {0, 0, 0}); }

  const PressTruth& truth_;
  CrossingsOfNodes of_a_, of_b_;
  std::vector<Vec3> normals_;
  std::vector<double> weights_;
  std::vector<std::uint32_t> common_;
};

/// The least value that nine tenths of the values do not exceed.
double ninth_tenth(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[(9 * values.size() + 9) / 10 - 1];
}

PressFigures judge(Judge& judge, const PressTruth& truth, const Contacts& found, double diagonal) {
  PressFigures f;
  f.true_depth = truth.depth / diagonal;
  f.pair_tests = found.pair_tests;
  f.contacts = found.contacts.size();
  f.finished = found.finished_count;
  f.crossings = truth.crossings.size();
  std::vector<bool> held(f.crossings, false);
  std::vector<double> of_spheres, of_surfaces;
  Vec3 sum_spheres{};
  Vec3 sum_surfaces{};
  for (std::size_t i = 0; i < found.contacts.size(); ++i) {
    const Contact& contact = found.contacts[i];
    const ContactSurface& surface = found.surfaces[i];
    const std::vector<std::uint32_t>& own = judge.crossings_of(contact);
    for (const std::uint32_t crossing : own) held[crossing] = true;
    const Vec3 normal = judge.normal_near(contact, own);
    of_spheres.push_back(degrees_between(contact.normal, normal));
    sum_spheres += contact.depth * contact.normal;
    f.depth_spheres = std::max(f.depth_spheres, contact.depth / truth.depth);
    f.error_bound += contact.error_bound / diagonal;
    if (surface.depth <= 0) continue;
    of_surfaces.push_back(degrees_between(surface.normal, normal));
    sum_surfaces += surface.depth * surface.normal;
    f.depth_surfaces = std::max(f.depth_surfaces, surface.depth / truth.depth);
  }
  f.kept = of_surfaces.size();
  f.lost = static_cast<std::size_t>(std::count(held.begin(), held.end(), false));
  if (!of_spheres.empty()) {
    f.error_bound /= static_cast<double>(of_spheres.size());
    f.normal_spheres = median(of_spheres);
    f.normal_spheres_90 = ninth_tenth(of_spheres);
    f.net_spheres = degrees_between(sum_spheres, truth.normal);
  }
  if (!of_surfaces.empty()) {
    f.normal_surfaces = median(of_surfaces);
    f.normal_surfaces_90 = ninth_tenth(of_surfaces);
    f.net_surfaces = degrees_between(sum_surfaces, truth.normal);
  }
  return f;
}

Axis axis_from(const std::string& text) {
  return text == "x" ? Axis::x : text == "y" ? Axis::y : Axis::z;
}

}  // namespace

std::string_view name(Axis axis) {
  switch (axis) {
    case Axis::x:
      return "x";
    case Axis::y:
      return "y";
    case Axis::z:
      return "z";
    case Axis::automatic:
      break;
  }
  return "auto";
}

std::string PressQuery::name() const {
  return budget ? fmt::format("{} tests", *budget) : leaves ? "leaves" : fmt::format("level {}", level);
}

std::vector<PressQuery> press_queries(const Plan& plan) {
  std::vector<PressQuery> queries;
  const auto last = static_cast<std::size_t>(plan.depth);
  for (std::size_t level = 1; level < last; ++level) queries.push_back({level, false, std::nullopt});
  for (const std::size_t budget : plan.press_budgets) queries.push_back({last, true, budget});
  queries.push_back({last, true, std::nullopt});
  return queries;
}

PressCell run_press(const Plan& plan, std::size_t source, std::size_t rule, const CoveredTree& model,
                    const PressScene& scene, const StopToken& stop) {
  PressCell cell{source, rule, {}};
  const Mesh& mesh = plan.bodies[scene.body].mesh;
  Body moving(mesh, model, plan.press_rules[rule].options);  // one for both sides: they are in the same pose
  if (!moving.update(scene.positions)) throw std::logic_error("the study's own motion was rejected by update");
  Collider a(mesh, moving);
  Collider b(mesh, moving);
  a.set_positions(scene.positions);
  b.set_positions(scene.positions);
  const std::vector<PressQuery> queries = press_queries(plan);
  Contacts found;
  for (const PressTruth& truth : scene.truths) {
    b.set_transform(truth.transform);
    Judge truth_of(a, b, truth);
    for (std::size_t q = 0; q < queries.size(); ++q) {
      if (stop.stop_requested()) throw BuildStopped();
      CollideOptions options;
      options.surfaces = true;
      const std::size_t last = model.tree.level_count() - 1;  // of a tree from a file: perhaps less than planned
      if (!queries[q].leaves) options.level = static_cast<std::uint32_t>(std::min(queries[q].level, last));
      if (queries[q].budget) options.budget = *queries[q].budget;
      ContactQuery query(options);
      query.add(a, b);
      if (const ContactStatus status = query.run(); !status) throw std::invalid_argument(message(status));
      found = query.contacts();
      for (std::size_t i = found.surfaces.size(); i < found.contacts.size(); ++i)
        found.surfaces.push_back(query.surface(i));
      cell.figures.push_back(judge(truth_of, truth, found, scene.diagonal));
      cell.figures.back().axis = truth.axis;
      cell.figures.back().amount = static_cast<std::size_t>(
          std::find(plan.press_amounts.begin(), plan.press_amounts.end(), truth.amount) - plan.press_amounts.begin());
      cell.figures.back().query = q;
    }
  }
  return cell;
}

Json figures_json(const PressCell& cell) {
  Json figures = Json::array();
  for (const PressFigures& f : cell.figures) {
    figures.push_back({{"axis", name(f.axis)},
                       {"amount", f.amount},
                       {"query", f.query},
                       {"true_depth", f.true_depth},
                       {"pair_tests", f.pair_tests},
                       {"contacts", f.contacts},
                       {"finished", f.finished},
                       {"kept", f.kept},
                       {"depth_spheres", f.depth_spheres},
                       {"depth_surfaces", f.depth_surfaces},
                       {"normal_spheres", json_of(f.normal_spheres)},
                       {"normal_spheres_90", json_of(f.normal_spheres_90)},
                       {"normal_surfaces", json_of(f.normal_surfaces)},
                       {"normal_surfaces_90", json_of(f.normal_surfaces_90)},
                       {"net_spheres", json_of(f.net_spheres)},
                       {"net_surfaces", json_of(f.net_surfaces)},
                       {"crossings", f.crossings},
                       {"lost", f.lost},
                       {"error_bound", f.error_bound}});
  }
  return figures;
}

std::vector<PressFigures> figures_from_json(const Json& json) {
  std::vector<PressFigures> figures;
  for (const Json& f : json) {
    figures.push_back({axis_from(f.at("axis")), f.at("amount"), f.at("query"), f.at("true_depth"), f.at("pair_tests"),
                       f.at("contacts"), f.at("finished"), f.at("kept"), f.at("depth_spheres"), f.at("depth_surfaces"),
                       value_from(f.at("normal_spheres")), value_from(f.at("normal_spheres_90")),
                       value_from(f.at("normal_surfaces")), value_from(f.at("normal_surfaces_90")),
                       value_from(f.at("net_spheres")), value_from(f.at("net_surfaces")), f.at("crossings"),
                       f.at("lost"), f.at("error_bound")});
  }
  return figures;
}

}  // namespace morula::study
