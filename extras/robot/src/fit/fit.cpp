// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <morula/geometry/box.hpp>
#include <morula/parallel/threads.hpp>
#include <morula/robot/fit.hpp>
#include <mutex>
#include <numeric>
#include <utility>

#include "fit/budget.hpp"
#include "fit/fit_options.hpp"
#include "fit/link_fit.hpp"
#include "fit/uncovered.hpp"

namespace morula::robot {

namespace {

constexpr std::size_t mean_spheres_of_a_mesh = 16;

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
  detail::Mutex mutex_;
  std::size_t all_ = 0, done_ = 0;
};

class Fitter {
 public:
  Fitter(const Robot& robot, const FitOptions& options, Workers& workers)
      : robot_(robot), o_(options), workers_(workers), one_(robot, options), progress_(options) {}

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
  const std::string& name_of(const LinkSpheres& link) const { return one_.name_of(link); }
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
      LinkSpheres link;
      link.link = i;
      if (!one_.shapes_of(link).empty() && o_.skip.count(name_of(link)) == 0) result_.links.push_back(std::move(link));
    }
    workers_.run(result_.links.size(), [&](std::size_t i) { one_.read_surface(result_.links[i]); });
    for (LinkSpheres& link : result_.links) {
      for (const std::string& note : link.surface.notes) {
        result_.notes.push_back(fmt::format("link {}: {}", name_of(link), note));
      }
    }
    std::erase_if(result_.links, [&](const LinkSpheres& link) {
      if (!link.surface.empty()) return false;
      result_.notes.push_back(
          one_.planes_of(link).empty()
              ? fmt::format("link {} has shapes without a facet: it gets no spheres", name_of(link))
              : fmt::format("link {} lies beyond its clip planes: it gets no spheres", name_of(link)));
      return true;
    });
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
               (o_.inner == 0 || same_insides(one_.shapes_of(first), one_.shapes_of(link)));
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
      demands[i] = one_.demand(first_of(group));
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

  void fit(const Group& group) {
    LinkSpheres& link = result_.links[group.members[0]];
    one_.fit(link, group.budget);
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

  const Robot& robot_;
  const FitOptions& o_;
  Workers& workers_;
  LinkFitter one_;
  FitProgress progress_;
  std::vector<Group> groups_;
  RobotSpheres result_;
};

}  // namespace

RobotSpheres fit_spheres(const Robot& robot, const FitOptions& options, WorkersOrAll given) {
  Workers& workers = given;
  require_fit_options(robot, options);
  if (options.max_uncovered) return fit_uncovered(robot, options, workers);
  return Fitter(robot, options, workers).run();
}

}  // namespace morula::robot
