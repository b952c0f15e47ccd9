// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/collide/collider.hpp>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/study/touch.hpp>
#include <morula/update/body.hpp>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <toolbox/numbers.hpp>
#include <toolbox/stopwatch.hpp>

namespace morula::study {

using namespace toolbox;

namespace {

/// One copy in its present pose and place.
class TouchingBody {
 public:
  TouchingBody(const Mesh& mesh, const CoveredTree& model, const TouchSide& side)
      : mesh_(mesh), body_(mesh, model), collider_(mesh, body_), motion_(side.motion) {
    collider_.set_transform(side.transform);
  }
  TouchingBody(const TouchingBody&) = delete;
  TouchingBody& operator=(const TouchingBody&) = delete;

  void move_to(double parameter) {
    positions_ = deform(mesh_, motion_, parameter);
    if (!body_.update(positions_)) throw std::logic_error("the study's own motion was rejected by update");
    collider_.set_positions(positions_);
  }
  const Collider& collider() const { return collider_; }
  std::vector<Vec3> in_world() const {
    std::vector<Vec3> positions(mesh_.vertex_count());
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v) positions[v] = collider_.vertex(v);
    return positions;
  }

 private:
  const Mesh& mesh_;
  std::vector<Vec3> positions_;
  Body body_;
  Collider collider_;
  Deformations motion_;
};

/// Whether the point is in a contact: within its error bound, with both facets among its nodes'.
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

}  // namespace

TouchPlan TouchPlan::crossed_arms(const Mesh& mesh) {
  const double diagonal = bounding_box(mesh).diagonal();
  TouchPlan plan;
  plan.a = {{Bend{40}}, {}};
  plan.b = {{Bend{-40}, Twist{60}},
            RigidTransform::from_axis({0, 0, 1}, std::numbers::pi / 2, {0, 0, 0.17 * diagonal})};
  return plan;
}

std::size_t Touch::crossing_count() const {
  return std::accumulate(crossings.begin(), crossings.end(), std::size_t{0});
}

Touch run_touch(const TouchPlan& plan, const Mesh& mesh, const CoveredTree& model) {
  const double diagonal = bounding_box(mesh).diagonal();
  const auto frames = static_cast<double>(plan.frames);
  TouchingBody a(mesh, model, plan.a);
  TouchingBody b(mesh, model, plan.b);
  Touch touch;
  for (const std::optional<std::size_t>& budget : plan.budgets) touch.rows.push_back({.budget = budget});

  std::vector<std::vector<double>> times(touch.rows.size());
  std::vector<std::size_t> contacts(touch.rows.size()), finished(touch.rows.size());
  ContactQuery query;
  query.add(a.collider(), b.collider());
  for (std::size_t frame = 0; frame < plan.frames; ++frame) {
    const double parameter = static_cast<double>(frame) / (frames - 1);
    a.move_to(parameter);
    b.move_to(parameter);
    const std::vector<Crossing> crossings = brute_force::crossings(a.collider(), b.collider());
    touch.crossings.push_back(crossings.size());
    for (std::size_t i = 0; i < touch.rows.size(); ++i) {
      TouchRow& row = touch.rows[i];
      CollideOptions options;
      if (row.budget) options.budget = Budget(*row.budget);
      query.set_options(options);
      for (int repeat = 0; repeat < plan.timed_queries; ++repeat) {
        Stopwatch watch;
        const ContactStatus status = query.run();
        times[i].push_back(watch.lap());
        if (!status) throw std::invalid_argument(message(status));
      }
      const Contacts& found = query.contacts();
      contacts[i] += found.contacts.size();
      finished[i] += found.finished_count;
      row.missed += count_missed(crossings, a.collider(), b.collider(), found.contacts);
      row.pair_tests += static_cast<double>(found.pair_tests) / frames;
      for (const Contact& c : found.contacts) row.mean_error_bound += c.error_bound / diagonal;
    }
    if (frame == plan.frames / 2) {
      touch.middle_a = a.in_world();
      touch.middle_b = b.in_world();
    }
  }
  for (std::size_t i = 0; i < touch.rows.size(); ++i) {
    TouchRow& row = touch.rows[i];
    const double count = static_cast<double>(std::max<std::size_t>(contacts[i], 1));
    row.contacts = static_cast<double>(contacts[i]) / frames;
    row.finished_share = static_cast<double>(finished[i]) / count;
    row.mean_error_bound /= count;
    row.seconds = median(times[i]);
  }
  return touch;
}

}  // namespace morula::study
