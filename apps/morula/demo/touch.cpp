// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "demo/touch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/update/body.hpp>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "shared/figures.hpp"
#include "shared/progress.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

constexpr std::array<std::optional<std::size_t>, 5> shown_budgets{100, 500, 2000, 10000, std::nullopt};
constexpr std::size_t touch_frames = 5;

/// One limb: where its motion and its place have taken it.
class TouchingLimb {
 public:
  TouchingLimb(const Mesh& mesh, const Built& built, Deformations motion, const RigidTransform& placement)
      : mesh_(mesh), body_(mesh, built), collider_(mesh, body_), motion_(std::move(motion)) {
    collider_.place(placement);
  }
  TouchingLimb(const TouchingLimb&) = delete;
  TouchingLimb& operator=(const TouchingLimb&) = delete;

  void move_to(double parameter) {
    positions_ = deform(mesh_, motion_, parameter);
    if (!body_.update(positions_)) throw std::logic_error("the demo's own motion was refused by update");
    collider_.set_positions(positions_);
  }
  const Collider& collider() const { return collider_; }
  Mesh in_world() const {
    Mesh mesh = mesh_;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) mesh.positions[v] = collider_.vertex(v);
    return mesh;
  }

 private:
  const Mesh& mesh_;
  std::vector<Vec3> positions_;
  Body body_;
  Collider collider_;
  Deformations motion_;
};

/// Is the point in a contact: within its error bound, both facets among its nodes'?
bool is_reported(const Vec3& point, const Crossing& crossing, const Collider& a, const Collider& b,
                 const std::vector<Contact>& contacts) {
  const auto has = [](std::span<const std::uint32_t> facets, std::uint32_t facet) {
    return std::find(facets.begin(), facets.end(), facet) != facets.end();
  };
  // The point itself is rounded: it is not exactly on both facets.
  const double rounding = 1e-14 * max_norm(point);
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& c) {
    return distance(point, c.point) <= c.error_bound * (1 + 1e-9) + rounding &&
           has(a.facets(c.node_a), crossing.facet_a) && has(b.facets(c.node_b), crossing.facet_b);
  });
}

std::size_t count_missed(const std::vector<Crossing>& crossings, const Collider& a, const Collider& b,
                         const std::vector<Contact>& contacts) {
  return static_cast<std::size_t>(std::count_if(crossings.begin(), crossings.end(), [&](const Crossing& crossing) {
    const auto& [p, q] = crossing.segment;
    return !is_reported(p, crossing, a, b, contacts) || !is_reported(q, crossing, a, b, contacts) ||
           !is_reported(0.5 * (p + q), crossing, a, b, contacts);
  }));
}

std::string budget_name(const TouchRow& row) {
  return row.budget ? std::to_string(*row.budget) : "unlimited";
}

}  // namespace

std::size_t DemoTouch::crossing_count() const {
  return std::accumulate(crossings.begin(), crossings.end(), std::size_t{0});
}

DemoTouch run_touch(const Mesh& limb, const Built& built, int repeats, const std::filesystem::path& folder) {
  const double diagonal = bounding_box(limb).diagonal();
  // Crossed like two arms, one on the other: the bend brings them into each other, the twist turns what touches.
  TouchingLimb a(limb, built, {Bend{40}}, {});
  TouchingLimb b(limb, built, {Bend{-40}, Twist{60}},
                 RigidTransform::from_axis({0, 0, 1}, std::numbers::pi / 2, {0, 0, 0.17 * diagonal}));
  DemoTouch touch;
  touch.frame_count = touch_frames;
  for (const std::optional<std::size_t>& budget : shown_budgets) {
    TouchRow row;
    row.budget = budget;
    touch.rows.push_back(row);
  }

  std::vector<std::vector<double>> times(touch.rows.size());
  std::vector<std::size_t> contacts(touch.rows.size()), finished(touch.rows.size());
  ContactQuery query;
  query.add(a.collider(), b.collider());
  for (std::size_t frame = 0; frame < touch_frames; ++frame) {
    const double parameter = static_cast<double>(frame) / (touch_frames - 1);
    a.move_to(parameter);
    b.move_to(parameter);
    const std::vector<Crossing> crossings = brute_force::crossings(a.collider(), b.collider());
    touch.crossings.push_back(crossings.size());
    for (std::size_t i = 0; i < touch.rows.size(); ++i) {
      TouchRow& row = touch.rows[i];
      CollideOptions options;
      if (row.budget) options.budget = Budget(*row.budget);
      query.set_options(options);
      for (int repeat = 0; repeat < repeats; ++repeat) {
        Stopwatch watch;
        query.run();
        times[i].push_back(1e6 * watch.lap());
      }
      const Contacts& found = query.contacts();
      contacts[i] += found.contacts.size();
      finished[i] += found.finished_count;
      row.missed += count_missed(crossings, a.collider(), b.collider(), found.contacts);
      row.pair_tests += static_cast<double>(found.pair_tests) / touch_frames;
      for (const Contact& c : found.contacts) row.mean_error_bound += c.error_bound / diagonal;
    }
    if (frame == touch_frames / 2) {
      write_mesh(folder / "limb-touching-a.obj", a.in_world());
      write_mesh(folder / "limb-touching-b.obj", b.in_world());
    }
  }
  for (std::size_t i = 0; i < touch.rows.size(); ++i) {
    TouchRow& row = touch.rows[i];
    const double count = static_cast<double>(std::max<std::size_t>(contacts[i], 1));
    row.contacts = static_cast<double>(contacts[i]) / touch_frames;
    row.finished_share = static_cast<double>(finished[i]) / count;
    row.mean_error_bound /= count;
    row.microseconds = median(times[i]);
  }
  return touch;
}

std::string touch_table(const DemoTouch& touch) {
  Table table({"budget", "contacts", "finished", "crossings missed", "error bound", "pair tests", "time"});
  for (const TouchRow& row : touch.rows) {
    table.add({budget_name(row), fmt::format("{:.0f}", row.contacts), percent(row.finished_share),
               fmt::format("{} of {}", row.missed, touch.crossing_count()), percent(row.mean_error_bound),
               fmt::format("{:.0f}", row.pair_tests), fmt::format("{} µs", figure(row.microseconds))});
  }
  return table.text();
}

std::string touch_finding(const DemoTouch& touch) {
  const std::vector<std::string> faults = touch_faults(touch);
  if (!faults.empty()) return faults.front() + ": that must not happen, please report it.";
  return fmt::format(
      "What a budget leaves undone stays in the answer as coarser contacts: less work makes contacts less exact, but "
      "none "
      "of the {} pairs of facets that cross is ever missed.",
      touch.crossing_count());
}

std::vector<std::string> touch_faults(const DemoTouch& touch) {
  std::vector<std::string> faults;
  for (const TouchRow& row : touch.rows) {
    if (row.missed == 0) continue;
    faults.push_back(fmt::format("contacts MISS {} (budget {})", counted(row.missed, "crossing"), budget_name(row)));
  }
  return faults;
}

std::string touch_csv(const DemoTouch& touch) {
  std::string text = "budget,contacts,finished_share,missed,crossings,mean_error_bound,pair_tests,microseconds\n";
  for (const TouchRow& row : touch.rows) {
    text +=
        fmt::format("{},{},{},{},{},{},{},{}\n", budget_name(row), exact_digits(row.contacts),
                    exact_digits(row.finished_share), row.missed, touch.crossing_count(),
                    exact_digits(row.mean_error_bound), exact_digits(row.pair_tests), exact_digits(row.microseconds));
  }
  return text;
}

Json touch_json(const DemoTouch& touch) {
  Json rows = Json::array();
  for (const TouchRow& row : touch.rows) {
    rows.push_back({{"budget", row.budget ? Json(*row.budget) : Json(nullptr)},
                    {"contacts", row.contacts},
                    {"finished_share", row.finished_share},
                    {"missed", row.missed},
                    {"mean_error_bound", row.mean_error_bound},
                    {"pair_tests", row.pair_tests},
                    {"microseconds", row.microseconds}});
  }
  return {{"frames", touch.frame_count},
          {"crossings", touch.crossings},
          {"finding", touch_finding(touch)},
          {"budgets", rows}};
}

}  // namespace morula::cli
