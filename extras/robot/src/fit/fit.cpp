// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <morula/accuracy/looseness.hpp>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/box.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/robot/fit.hpp>
#include <morula/tree/cover.hpp>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "fit/budget.hpp"
#include "fit/clip.hpp"
#include "fit/inner.hpp"
#include "fit/rounding.hpp"
#include "fit/uncovered.hpp"
#include "fit/within.hpp"

namespace morula::robot {

namespace {

constexpr std::size_t most_spheres_for_radius = 256, mean_spheres_of_a_mesh = 16;

void require_sense(const Robot& robot, const FitOptions& o) {
  const auto require_link = [&](const std::string& name, const char* what) {
    if (robot.find_link(name) == none)
      throw std::invalid_argument(fmt::format("{}: the robot has no link {}", what, name));
  };
  for (const std::string& name : o.skip) require_link(name, "skip");
  for (const auto& [name, count] : o.link_spheres) {
    require_link(name, "link_spheres");
    if (count == 0) throw std::invalid_argument(fmt::format("link_spheres: 0 of link {}; skip the link instead", name));
  }
  for (const auto& [name, spheres] : o.fixed_spheres) {
    require_link(name, "fixed_spheres");
    if (spheres.empty())
      throw std::invalid_argument(fmt::format("fixed_spheres: link {} has none; skip the link instead", name));
  }
  for (const auto& [name, planes] : o.clip) {
    require_link(name, "clip");
    for (const ClipPlane& plane : planes) {
      if (!(std::abs(length(plane.normal) - 1) < 1e-9) || !(std::abs(plane.offset) < 1e30)) {
        throw std::invalid_argument(fmt::format("clip: the normal of a plane of link {} is not of length 1", name));
      }
    }
  }
  const auto require_not_below_0 = [](const char* argument, double value) {
    if (!(value >= 0 && value < 1e30))
      throw std::invalid_argument(fmt::format("{}: {} is not a number from 0 on", argument, value));
  };
  const auto require_above_0 = [](const char* argument, const std::optional<double>& value) {
    if (value && !(*value > 0 && *value < 1e30))
      throw std::invalid_argument(fmt::format("{}: {} is not a number above 0", argument, *value));
  };
  require_not_below_0("tolerance", o.tolerance);
  if (o.tolerance > 0 && o.method != Method::optimized) {
    throw std::invalid_argument(fmt::format(
        "method {} does not fit for a tolerance; use optimized, or leave the tolerance out", name(o.method)));
  }
  require_not_below_0("padding", o.padding);
  require_not_below_0("min_radius", o.min_radius);
  require_above_0("max_radius", o.max_radius);
  require_above_0("max_protrusion", o.max_protrusion);
  require_above_0("max_protrusion_share", o.max_protrusion_share);
  require_above_0("clip_margin", o.clip_margin);
  require_above_0("density", o.density);
  if (o.max_total && *o.max_total == 0) throw std::invalid_argument("max_total: a robot has at least 1 sphere");
  if (o.max_radius && *o.max_radius < o.min_radius) {
    throw std::invalid_argument(fmt::format("max_radius: {} is below min_radius, {}", *o.max_radius, o.min_radius));
  }
  if (o.method != Method::optimized && o.quality && *o.quality != Quality::standard) {
    throw std::invalid_argument(
        fmt::format("quality {} is for method optimized; method {} has one way only: leave the quality out",
                    name(*o.quality), name(o.method)));
  }
  if (o.spheres && *o.spheres == 0 && !o.max_total && !o.max_protrusion && !o.max_protrusion_share) {
    throw std::invalid_argument("spheres: 0 requires max_protrusion or max_protrusion_share");
  }
}

/// Links whose shapes are the same.
struct Group {
  std::vector<std::size_t> members;  // of RobotSpheres::links
  std::size_t budget = 0;            // number of spheres for the mesh and other shapes; 0: as many as max_protrusion
                                     // needs
};

bool same_surface(const LinkSurface& a, const LinkSurface& b) {
  return a.mesh.positions == b.mesh.positions && a.mesh.facets == b.mesh.facets && a.spheres == b.spheres;
}

/// Whether shapes have the same inside if their surfaces together are the same. A mesh of two may leave out space that
/// two meshes enclose each by itself.
bool same_insides(const std::vector<Shape>& a, const std::vector<Shape>& b) {
  const auto meshes = std::count_if(a.begin(), a.end(), [](const Shape& s) { return s.kind == Shape::Kind::mesh; });
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const Shape& s, const Shape& t) {
    return s.kind == t.kind && (s.kind != Shape::Kind::mesh || meshes == 1 || s.file == t.file);
  });
}

/// The progress of all work of a fit, which is counted before it begins.
class FitProgress {
 public:
  explicit FitProgress(const FitOptions& options) : report_(options.progress) {}
  void expect(std::size_t work) { all_ += work; }
  /// Called on any thread.
  void complete(std::size_t work, const std::string& link) {
    if (!report_) return;
    const std::lock_guard lock(mutex_);
    done_ += work;
    report_(static_cast<double>(done_) / static_cast<double>(all_), link);
  }

 private:
  const std::function<void(double, const std::string&)>& report_;
  std::mutex mutex_;
  std::size_t all_ = 0, done_ = 0;
};

class Fitter {
 public:
  Fitter(const Robot& robot, const FitOptions& options, Workers& workers)
      : robot_(robot), o_(options), workers_(workers), progress_(options) {}

  RobotSpheres run() {
    read_surfaces();
    find_alike();
    std::vector<std::size_t> all(groups_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const std::vector<std::size_t> sharing = groups_that_share();
    for (const std::vector<std::size_t>* stage : {&sharing, &std::as_const(all)})
      for (const std::size_t group : *stage) progress_.expect(work_of(group));
    set_budgets(sharing);
    for_each_group(all, [&](std::size_t, std::size_t group) { fit(groups_[group]); });
    note_total();
    for (LinkSpheres& link : result_.links) {
      const std::optional<Inertial>& own = robot_.links[link.link].inertial;
      link.figures.mass = own && own->mass > 0 ? own->mass : o_.density * link.figures.solid.volume;
    }
    return std::move(result_);
  }

 private:
  const std::string& name_of(const LinkSpheres& link) const { return robot_.links[link.link].name; }
  const LinkSpheres& first_of(std::size_t group) const { return result_.links[groups_[group].members[0]]; }
  std::size_t facets_of(std::size_t group) const { return first_of(group).surface.mesh.facet_count(); }
  std::size_t work_of(std::size_t group) const { return 50 + facets_of(group); }

  /// Calls f(i, groups[i]) for all i on the workers, the costliest first, and reports progress.
  template <class F>
  void for_each_group(const std::vector<std::size_t>& groups, const F& f) {
    std::vector<std::size_t> order(groups.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return facets_of(groups[a]) > facets_of(groups[b]); });
    workers_.run(groups.size(), [&](std::size_t k) {
      const std::size_t group = groups[order[k]];
      f(order[k], group);
      progress_.complete(work_of(group), name_of(first_of(group)));
    });
  }

  void read_surfaces() {
    result_.visual = o_.visual;
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      const Link& link = robot_.links[i];
      if (shapes_of(link).empty() || o_.skip.count(link.name) != 0) continue;
      LinkSpheres spheres;
      spheres.link = i;
      result_.links.push_back(std::move(spheres));
    }
    workers_.run(result_.links.size(), [&](std::size_t i) {
      const Link& link = robot_.links[result_.links[i].link];
      LinkSurface& surface = result_.links[i].surface;
      surface = surface_of(robot_.file, shapes_of(link));
      if (const std::vector<ClipPlane>& planes = planes_of(result_.links[i]); !planes.empty()) {
        std::vector<std::string> notes = std::move(surface.notes);
        surface = clipped(surface, planes, o_.clip_margin.value_or(0));
        surface.notes = std::move(notes);
        if (o_.clip_margin && o_.fixed_spheres.count(link.name) == 0) require_margin(link, surface.mesh, planes);
      }
    });
    for (LinkSpheres& link : result_.links) {
      for (const std::string& note : link.surface.notes) {
        result_.notes.push_back(fmt::format("link {}: {}", name_of(link), note));
      }
    }
    std::erase_if(result_.links, [&](const LinkSpheres& link) {
      if (!link.surface.empty()) return false;
      result_.notes.push_back(
          planes_of(link).empty()
              ? fmt::format("link {} has shapes without a facet: it gets no spheres", name_of(link))
              : fmt::format("link {} lies beyond its clip planes: it gets no spheres", name_of(link)));
      return true;
    });
  }

  const std::vector<Shape>& shapes_of(const Link& link) const { return o_.visual ? link.visual : link.collision; }
  const std::vector<ClipPlane>& planes_of(const LinkSpheres& link) const {
    static const std::vector<ClipPlane> none_of_them;
    const auto found = o_.clip.find(name_of(link));
    return found == o_.clip.end() ? none_of_them : found->second;
  }

  bool stands_alone(const LinkSpheres& link) const {
    const std::string& name = name_of(link);
    return o_.fixed_spheres.count(name) != 0 || o_.link_spheres.count(name) != 0 || o_.clip.count(name) != 0;
  }

  void find_alike() {
    for (std::size_t i = 0; i < result_.links.size(); ++i) {
      LinkSpheres& link = result_.links[i];
      const auto same = [&](const Group& group) {
        const LinkSpheres& first = result_.links[group.members[0]];
        return !stands_alone(link) && !stands_alone(first) && same_surface(first.surface, link.surface) &&
               (o_.inner == 0 || same_insides(shapes_of(robot_.links[first.link]), shapes_of(robot_.links[link.link])));
      };
      const auto found = std::find_if(groups_.begin(), groups_.end(), same);
      if (found == groups_.end()) {
        groups_.push_back({{i}, 0});
      } else {
        link.same_shape_as = result_.links[found->members[0]].link;
        found->members.push_back(i);
      }
    }
  }

  /// The number that the options give for the first link of a group, in place of a common number; no value if they do
  /// not.
  std::optional<std::size_t> own_number(std::size_t group) const {
    const std::string& name = name_of(first_of(group));
    if (const auto kept = o_.fixed_spheres.find(name); kept != o_.fixed_spheres.end()) return kept->second.size();
    if (const auto own = o_.link_spheres.find(name); own != o_.link_spheres.end()) return own->second;
    return std::nullopt;
  }

  /// The groups that share the total, if there is one.
  std::vector<std::size_t> groups_that_share() const {
    std::vector<std::size_t> sharing;
    for (std::size_t i = 0; o_.max_total && i < groups_.size(); ++i)
      if (!own_number(i)) sharing.push_back(i);
    return sharing;
  }

  void set_budgets(const std::vector<std::size_t>& sharing) {
    for (std::size_t i = 0; i < groups_.size(); ++i) groups_[i].budget = own_number(i).value_or(o_.spheres.value_or(0));
    if (o_.max_total) {
      share_total(sharing);
    } else if (!o_.spheres && !o_.max_protrusion && !o_.max_protrusion_share) {
      share_among_sizes();
    }
  }

  /// On average the same number for each mesh without a number of its own.
  void share_among_sizes() {
    std::vector<std::size_t> sharing;
    std::vector<MeshSize> sizes;
    std::size_t meshes = 0;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const Mesh& mesh = first_of(i).surface.mesh;
      if (own_number(i) || mesh.facets.empty()) continue;
      Box box;
      for (const Vec3& p : mesh.positions) box.add(p);
      const Vec3 e = box.upper - box.lower;
      sharing.push_back(i);
      sizes.push_back({2 * (e.x * e.y + e.y * e.z + e.z * e.x), groups_[i].members.size()});
      meshes += groups_[i].members.size();
    }
    const std::vector<std::size_t> counts = share_by_size(sizes, mean_spheres_of_a_mesh * meshes);
    for (std::size_t k = 0; k < sharing.size(); ++k)
      groups_[sharing[k]].budget = first_of(sharing[k]).surface.spheres.size() + counts[k];
  }

  /// Divides the part of the total that single links leave.
  void share_total(const std::vector<std::size_t>& sharing) {
    std::size_t left = *o_.max_total;
    for (std::size_t i = 0; i < groups_.size(); ++i) left -= std::min(left, own_number(i).value_or(0));
    std::vector<Demand> demands(sharing.size());
    for_each_group(sharing, [&](std::size_t i, std::size_t group) {
      demands[i] = demand(first_of(group));
      demands[i].links = groups_[group].members.size();
    });
    const std::vector<std::size_t> counts = share_spheres(demands, left);
    for (std::size_t i = 0; i < sharing.size(); ++i) groups_[sharing[i]].budget = counts[i];
  }

  void note_total() {
    if (!o_.max_total || result_.sphere_count() <= *o_.max_total) return;
    result_.notes.push_back(fmt::format(
        "the robot has {} spheres, and the largest total is {}: numbers and spheres given for single links, "
        "spheres among the shapes, one sphere for every other link, clip planes and the largest radius come "
        "first; allow more, or skip links",
        result_.sphere_count(), *o_.max_total));
  }

  Demand demand(const LinkSpheres& link) const {
    Demand demand;
    demand.fixed = link.surface.spheres.size();
    demand.has_mesh = !link.surface.mesh.facets.empty();
    if (!demand.has_mesh) return demand;
    BuildOptions build_options{
        .method = o_.method, .seed = o_.seed, .quality = quality(Quality::draft), .stop = o_.stop};
    std::array<double, 4> volumes{};
    for (std::size_t k = 0; k < volumes.size(); ++k) {
      if (Demand::counts[k] == 1) {
        volumes[k] = volume(enclosing_sphere(link.surface.mesh.positions));
        continue;
      }
      build_options.spheres = Demand::counts[k];
      const CoveredTree model = build_link(link, build_options);
      volumes[k] = union_mass(leaves(model), 64).volume;
    }
    // A surface that is open has no volume of its own: the rest of many spheres replaces it.
    const MeshReport report = inspect(link.surface.mesh);
    const double object = report.has_volume() ? std::abs(report.volume) : 0;
    const double inside = object > 0 && object < volumes.back() ? object : 0.8 * volumes.back();
    for (std::size_t k = 0; k < volumes.size(); ++k) demand.outside[k] = std::max(0.0, volumes[k] - inside);
    return demand;
  }

  static std::vector<Sphere> leaves(const CoveredTree& model) {
    return level_set_spheres(model.tree, model.tree.level_count() - 1);
  }

  /// The quality for a build; the methods other than optimized have only one.
  Quality quality(Quality of_optimized) const {
    return o_.method == Method::optimized ? of_optimized : Quality::standard;
  }

  CoveredTree build_link(const LinkSpheres& link, const BuildOptions& options) const {
    // The mesh is the file's fault; other arguments are the caller's.
    try {
      require_usable(link.surface.mesh);
      require_usable_scale(link.surface.mesh);
    } catch (const std::invalid_argument& error) {
      throw FileError(fmt::format("{}:{}: link {}: {}", robot_.file.string(), robot_.links[link.link].line,
                                  name_of(link), error.what()));
    }
    return build(link.surface.mesh, options, serial_workers());
  }

  void fit(const Group& group) {
    LinkSpheres& link = result_.links[group.members[0]];
    if (const auto kept = o_.fixed_spheres.find(name_of(link)); kept != o_.fixed_spheres.end()) {
      link.spheres = kept->second;
    } else {
      fit_new(link, group.budget);
    }
    measure(link);
    if (o_.inner > 0) {
      link.inner =
          inner_spheres(robot_.file, shapes_of(robot_.links[link.link]), planes_of(link), o_.inner, o_.seed, o_.stop);
      if (o_.stop.stop_requested()) throw BuildStopped();
      link.inner_volume = union_mass(link.inner).volume;
      if (link.inner.empty()) {
        link.notes.push_back(fmt::format("link {} has no inner spheres: no surface of it is closed", name_of(link)));
      }
    }
    for (std::size_t k = 1; k < group.members.size(); ++k) {
      LinkSpheres& other = result_.links[group.members[k]];
      other.spheres = link.spheres;
      other.tree = link.tree;
      other.figures = link.figures;
      other.inner = link.inner;
      other.inner_volume = link.inner_volume;
      other.notes = link.notes;
    }
  }

  void fit_new(LinkSpheres& link, std::size_t budget) const {
    link.spheres = link.surface.spheres;
    if (!link.surface.mesh.facets.empty()) {
      BuildOptions options{.method = o_.method,
                           .seed = o_.seed,
                           .quality = quality(o_.quality.value_or(Quality::fast)),
                           .stop = o_.stop};
      options.tolerance = o_.tolerance;
      options.max_protrusion = o_.max_protrusion;
      if (o_.max_protrusion_share) {
        Box box;
        for (const Vec3& p : link.surface.mesh.positions) box.add(p);
        const double own = *o_.max_protrusion_share * box.diagonal();
        options.max_protrusion = std::min(options.max_protrusion.value_or(own), own);
      }
      const std::size_t beside = link.surface.spheres.size();
      if (budget != 0) options.spheres = budget > beside ? budget - beside : 1;
      if (budget != 0 && budget <= beside) {
        link.notes.push_back(
            fmt::format("link {} has {} spheres of its own and gets one more for the rest", name_of(link), beside));
      }
      auto model = std::make_shared<CoveredTree>(build_link(link, options));
      enforce_max_radius(link, options, *model);
      if (o_.clip_margin && !planes_of(link).empty()) keep_from_planes(link, *model);
      if (!model->report.complete) {
        link.notes.push_back(
            fmt::format("link {}: the spheres exceed the largest protrusion; allow more of them", name_of(link)));
      }
      for (const Sphere& leaf : leaves(*model)) link.spheres.push_back(reduced(leaf, o_.tolerance));
      link.tree = std::move(model);
    }
    if (o_.tolerance > 0 && planes_of(link).empty())
      grow_inside(link.surface.mesh, link.spheres, o_.max_radius ? *o_.max_radius - o_.padding : 1e30);
    for (Sphere& s : link.spheres) s.radius = padded_radius(s.radius);
    round_outward(link.spheres);
    remove_repeated(link.spheres);
  }

  /// Removes spheres that are equal to an earlier one.
  static void remove_repeated(std::vector<Sphere>& spheres) {
    std::vector<Sphere> kept;
    for (const Sphere& s : spheres)
      if (std::find(kept.begin(), kept.end(), s) == kept.end()) kept.push_back(s);
    spheres = std::move(kept);
  }

  double padded_radius(double radius) const { return std::max(radius + o_.padding, o_.min_radius); }
  /// The radius that the sphere of a leaf of a fitted tree gets in files.
  double final_radius(const Sphere& leaf) const { return padded_radius(reduced(leaf, o_.tolerance).radius); }

  /// The least distance of a sphere from planes: rounding to decimals moves less than 1e-6 of the size, and rounding to
  /// float even less.
  static double clip_allowance(const Mesh& mesh) {
    double extent = 0;
    for (const Vec3& p : mesh.positions) extent = std::max(extent, max_norm(p));
    return 2e-6 * extent;
  }

  /// A sphere around a point that near to a plane reaches beyond it, however small it is.
  void require_margin(const Link& link, const Mesh& mesh, std::span<const ClipPlane> planes) const {
    const double least = o_.padding + clip_allowance(mesh);
    if (least_height(mesh, planes) >= least) return;
    throw std::invalid_argument(
        fmt::format("clip margin {} is too small for link {}: padding and rounding take {:.6g}, so every cover reaches "
                    "beyond its clip planes; give more than that, and the more, the fewer spheres it takes",
                    *o_.clip_margin, link.name, least));
  }

  void keep_from_planes(LinkSpheres& link, CoveredTree& model) const {
    const std::vector<ClipPlane>& planes = planes_of(link);
    const double allowance = clip_allowance(link.surface.mesh);
    const auto stays = [&](const Sphere& s) {
      const Sphere last{s.center, final_radius(s)};
      return !(reach_beyond(std::span(&last, 1), planes, allowance) > 0);
    };
    // The center of a sphere around the lowest point is no higher above that than its radius.
    const auto may_stay = [&](const Sphere& s, const Mesh& part) {
      return least_height(part, planes) >= allowance + std::max(o_.padding, o_.min_radius - s.radius);
    };
    const std::size_t before = model.tree.leaf_count();
    divide_until(stays, may_stay, link.surface.mesh, model,
                 {.seed = o_.seed, .quality = Quality::draft, .stop = o_.stop});
    const std::vector<Sphere> divided = leaves(model);
    if (divided.size() == before || !std::all_of(divided.begin(), divided.end(), stays)) return;
    link.notes.push_back(
        fmt::format("link {} has {} spheres instead of {}, so that none reaches beyond its clip planes", name_of(link),
                    divided.size(), before));
  }

  void enforce_max_radius(LinkSpheres& link, BuildOptions options, CoveredTree& model) const {
    if (!o_.max_radius) return;
    const auto largest = [](const CoveredTree& tree) {
      double radius = 0;
      for (const Sphere& s : leaves(tree)) radius = std::max(radius, s.radius);
      return radius;
    };
    const auto fits = [&](const CoveredTree& tree) {
      return largest(tree) - o_.tolerance + o_.padding <= *o_.max_radius;
    };
    std::size_t spheres = options.spheres.value_or(model.tree.leaf_count());
    while (!fits(model) && spheres < most_spheres_for_radius) {
      options.spheres = spheres *= 2;
      model = build_link(link, options);
    }
    // A thick link is covered best by spheres that fill it, for any number of them. The spheres of an octree are as
    // small as its cells.
    for (int depth = 1; !fits(model) && depth <= max_depth; ++depth) {
      model = build_link(link, {.method = Method::octree, .depth = depth, .seed = o_.seed, .stop = o_.stop});
    }
    if (!fits(model)) {
      link.notes.push_back(fmt::format("link {}: spheres exceed the largest radius; allow larger ones", name_of(link)));
    }
  }

  /// A distance from the spheres within which every point of the mesh is proven to lie. A bound that exceeds the
  /// tolerance by less than it is loose by gives way to the proof of larger spheres.
  double proven_distance(const Mesh& mesh, std::vector<Sphere> spheres, const Coverage& cover) const {
    if (cover.covered) return 0;
    const double bound = cover.uncovered_distance_upper + cover.tolerance;
    if (bound <= o_.tolerance || !(o_.tolerance > 0)) return bound;
    // mutant robot-tolerance-not-certified: `s.radius += o_.tolerance` -> `s.radius += 2 * o_.tolerance`
    for (Sphere& s : spheres) s.radius += o_.tolerance;
    return coverage(mesh, spheres, serial_workers()).covered ? o_.tolerance : bound;
  }

  void measure(LinkSpheres& link) const {
    LinkFigures& figures = link.figures;
    const LinkSurface& surface = link.surface;
    figures.facets = surface.mesh.facet_count();
    figures.covered = true;
    // Kept spheres may come from any source. The radius of fitted ones includes more than the rounding to float.
    std::vector<Sphere> certified = link.spheres;
    const double allowance = float_allowance(extent_of(link.spheres));
    // mutant robot-kept-as-floats: `allowance` -> `0 * allowance`
    for (Sphere& s : certified) s.radius = std::max(0.0, s.radius - allowance);
    // A sphere among the shapes is covered if one sphere contains it; otherwise no point of it is farther from the
    // spheres than it reaches out of any of them.
    for (const Sphere& own : surface.spheres) {
      double least = std::numeric_limits<double>::infinity();
      for (const Sphere& s : certified) least = std::min(least, distance(s.center, own.center) + own.radius - s.radius);
      if (!(least > 0)) continue;
      figures.covered = false;
      figures.within = std::max(figures.within, least);
      figures.uncovered_distance = std::max(figures.uncovered_distance, least);
    }
    figures.solid = union_mass(link.spheres);
    if (const std::vector<ClipPlane>& planes = planes_of(link); !planes.empty()) {
      figures.beyond_clip = reach_beyond(link.spheres, planes);
      if (o_.clip_margin && *figures.beyond_clip > 0) {
        link.notes.push_back(fmt::format(
            "link {}: spheres reach beyond its clip planes; give a larger margin, or less padding or smaller radii",
            name_of(link)));
      }
    }
    std::vector<double> protrusions;
    const auto beyond_own = [&](const Sphere& s) {
      double least = std::numeric_limits<double>::infinity();
      for (const Sphere& own : surface.spheres)
        least = std::min(least, s.radius + distance(s.center, own.center) - own.radius);
      return least;
    };
    if (surface.mesh.facets.empty()) {
      for (const Sphere& s : link.spheres) protrusions.push_back(std::max(0.0, beyond_own(s)));
      figures.object_volume = union_mass(surface.spheres).volume;
      figures.outside_volume = std::max(0.0, figures.solid.volume - *figures.object_volume);
    } else {
      const Coverage cover = coverage(surface.mesh, certified, serial_workers());
      figures.covered = figures.covered && cover.covered;
      figures.uncovered_distance = std::max(figures.uncovered_distance, cover.uncovered_distance);
      figures.uncovered_share = cover.uncovered_area;
      figures.within = std::max(figures.within, proven_distance(surface.mesh, certified, cover));
      const SignedDistance object(surface.mesh);
      for (const Sphere& s : link.spheres) {
        protrusions.push_back(std::max(0.0, std::min(object.protrusion_bound(s), beyond_own(s))));
      }
      if (surface.spheres.empty()) {
        const Looseness loose = looseness(surface.mesh, link.spheres, {.resolution = 128}, serial_workers());
        if (loose.looseness) {
          figures.object_volume = loose.object_volume;
          figures.outside_volume = loose.outside_volume;
        }
      }
    }
    std::sort(protrusions.begin(), protrusions.end());
    if (protrusions.empty()) return;
    const auto count = static_cast<double>(protrusions.size());
    figures.protrusion_mean = std::accumulate(protrusions.begin(), protrusions.end(), 0.0) / count;
    figures.protrusion_p95 = protrusions[static_cast<std::size_t>(std::ceil(0.95 * count)) - 1];
    figures.protrusion_max = protrusions.back();
  }

  const Robot& robot_;
  const FitOptions& o_;
  Workers& workers_;
  FitProgress progress_;
  std::vector<Group> groups_;
  RobotSpheres result_;
};

}  // namespace

std::size_t RobotSpheres::sphere_count() const {
  std::size_t count = 0;
  for (const LinkSpheres& link : links) count += link.spheres.size();
  return count;
}

bool RobotSpheres::covered() const {
  return std::all_of(links.begin(), links.end(), [](const LinkSpheres& link) { return link.figures.covered; });
}

double RobotSpheres::within() const {
  double largest = 0;
  for (const LinkSpheres& link : links) largest = std::max(largest, link.figures.within);
  return largest;
}

double RobotSpheres::uncovered_share() const {
  double uncovered = 0, all = 0;
  for (const LinkSpheres& link : links) {
    const double area = inspect(link.surface.mesh).area;
    uncovered += area * link.figures.uncovered_share;
    all += area;
  }
  return all > 0 ? uncovered / all : 0;
}

std::size_t RobotSpheres::inner_count() const {
  std::size_t count = 0;
  for (const LinkSpheres& link : links) count += link.inner.size();
  return count;
}

RobotSpheres RobotSpheres::with_inner_spheres() const {
  RobotSpheres result;
  result.notes = notes;
  result.visual = visual;
  for (const LinkSpheres& link : links) {
    if (link.inner.empty()) {
      result.notes.insert(result.notes.end(), link.notes.begin(), link.notes.end());
      continue;
    }
    result.links.push_back(link);
    result.links.back().spheres = link.inner;
  }
  return result;
}

const LinkSpheres* RobotSpheres::of(std::size_t link) const {
  for (const LinkSpheres& spheres : links) {
    if (spheres.link == link) return &spheres;
  }
  return nullptr;
}

RobotSpheres fit_spheres(const Robot& robot, const FitOptions& options, WorkersOrAll given) {
  Workers& workers = given;
  require_sense(robot, options);
  if (options.max_uncovered) return fit_uncovered(robot, options, workers);
  return Fitter(robot, options, workers).run();
}

}  // namespace morula::robot
