// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "actor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/update/skin_morphs.hpp>

#include "covering.hpp"
#include "skins.hpp"

namespace morula::properties {
namespace {

using oracle::Point;
using oracle::Real;

// Farther than this a body may refuse to go (2^57), so a refusal is no fault.
constexpr double far_enough_to_refuse = 0x1p52;

double reach_of(const Mesh& mesh, const std::vector<bool>& used, const auto& positions) {
  double reach = 0;
  const std::size_t first = mesh.facets[0][0];
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i])
      for (const auto d : {positions[i].x - positions[first].x, positions[i].y - positions[first].y,
                           positions[i].z - positions[first].z})
        reach = std::max(reach, static_cast<double>(std::abs(d)));
  return reach;
}

Modes random_modes(const Mesh& mesh, Dice& dice) {
  Modes modes{mesh.vertex_count(), static_cast<std::size_t>(dice.between(1, 5)), {}};
  const Box box = bounding_box(mesh);
  const double size = std::max(box.diagonal(), 1e-9);
  const auto any = [&] { return Vec3{dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(-1, 1)}; };
  const std::vector<bool> used = used_vertices(mesh);
  for (std::size_t j = 0; j < modes.mode_count; ++j) {
    const std::size_t kind = dice.below(5);
    const Vec3 wave = any() * (6 / size), push = any() * size;
    const std::array<Vec3, 3> rows{any(), any(), any()};
    for (std::size_t i = 0; i < mesh.vertex_count(); ++i) {
      const Vec3 d = used[i] ? mesh.positions[i] - box.center() : Vec3{};
      switch (kind) {
        case 0:
          modes.displacements.push_back(std::sin(dot(wave, d)) * push);
          break;
        case 1:
          modes.displacements.push_back(any() * size);
          break;
        case 2:
          modes.displacements.push_back({dot(rows[0], d), dot(rows[1], d), dot(rows[2], d)});
          break;
        case 3:
          modes.displacements.push_back(dice.chance(0.1) ? push : Vec3{});
          break;
        default:
          modes.displacements.push_back(push);
      }
    }
  }
  return modes;
}

}  // namespace

Actor::Actor(const Specimen& specimen, Dice& dice, Record& record) : mesh_(specimen.mesh), built_(specimen.model) {
  if (record.place.mesh.facets.empty()) record.place.mesh = mesh_;
  if (dice.chance(0.05)) round_trip(mesh_, *built_, record);
  start(random_rules(dice), record);
  judge_now(dice, record, "-rest");
}

void Actor::start(UpdateOptions options, Record& record) {
  record.place.description += " | " + name(options);
  promised_ = promised(built_->tree, options);
  covers_ = std::find(promised_.begin(), promised_.end(), 0) == promised_.end();
  body_ = std::make_unique<Body>(mesh_, built_, std::move(options));
  rest_hash_ = body_->hash();
  positions_ = mesh_.positions;
  points_ = points_of(positions_);
}

void Actor::make_modal(Dice& dice, Record& record) {
  UpdateOptions options;
  options.rules.clear();
  for (int n = dice.between(0, 2); n > 0; --n)
    options.rules.push_back(dice.pick({Rule::modal, Rule::exact, Rule::wrapped, Rule::approach2, Rule::modal}));
  options.rules.push_back(dice.chance(0.9) ? Rule::modal : Rule::exact);
  options.conservative = std::find(options.rules.begin(), options.rules.end(), Rule::approach2) != options.rules.end();
  options.details.modal_bound = dice.pick({RuleOptions::ModalBound::gradient, RuleOptions::ModalBound::shift});
  options.modes = random_modes(mesh_, dice);
  start(std::move(options), record);
  judge_now(dice, record, "-modal-rest");
}

void Actor::make_skinned(Dice& dice, Record& record) {
  UpdateOptions options;
  options.rules.clear();
  for (int n = dice.between(0, 2); n > 0; --n)
    options.rules.push_back(dice.pick({Rule::skinned, Rule::exact, Rule::wrapped, Rule::approach2, Rule::skinned}));
  options.rules.push_back(dice.chance(0.9) ? Rule::skinned : Rule::exact);
  options.conservative = std::find(options.rules.begin(), options.rules.end(), Rule::approach2) != options.rules.end();
  options.skin = random_skin(mesh_, dice);
  if (dice.chance(0.5)) options.modes = random_modes(mesh_, dice);
  start(std::move(options), record);
  judge_now(dice, record, "-skinned-rest");
}

void Actor::judge_now(Dice& dice, Record& record, const std::string& suffix) {
  std::vector<Sphere> spheres;
  body_->copy_spheres(spheres);
  const auto balls = balls_of(spheres);
  const oracle::Effort effort{.cuts = dice.chance(0.1) ? 1000u : 120u, .scattered = 4};
  judge({mesh_, built_->tree, built_->cover, points_, balls, promised_}, dice, record, effort, suffix);
}

void Actor::reach_all(Dice& dice, Record& record) {
  // From the root downwards in any order, and judged on the way: what is reached covers, what is not is not looked at.
  std::vector<std::uint32_t> open{0};
  const std::size_t stop = dice.below(body_->spheres().size() + 1);
  for (std::size_t n = 0; !open.empty(); ++n) {
    std::swap(open[dice.below(open.size())], open.back());
    const std::uint32_t node = open.back();
    open.pop_back();
    if (n == stop) {
      std::vector<std::uint8_t> reached = promised_;
      for (std::uint32_t i = 0; i < reached.size(); ++i) reached[i] &= static_cast<std::uint8_t>(body_->is_fresh(i));
      std::vector<Sphere> spheres;
      body_->copy_spheres(spheres);
      judge({mesh_, built_->tree, built_->cover, points_, balls_of(spheres), reached}, dice, record, {.cuts = 40},
            "-lazy");
    }
    body_->refresh_children(node);
    for (std::uint32_t c = 0; c < built_->tree.child_count[node]; ++c)
      open.push_back(built_->tree.first_child[node] + c);
  }
  record.expect(body_->is_complete(), "lazy", "not complete after all nodes were reached");
}

UpdateStatus Actor::feed(const Pose& pose, bool whole_only, Dice& dice, Record& record) {
  const std::size_t count = mesh_.vertex_count();
  Positions given = pose.positions;
  UpdateStatus status;
  std::size_t way = dice.below(6);
  if (whole_only && way == 1) way = 2;
  std::vector<VertexRange> moved;
  const auto accept = [&] {
    positions_ = given;
    points_ = points_of(positions_);
  };
  switch (way) {
    case 0: {
      floats_.clear();
      for (Vec3& p : given) {
        floats_.emplace_back(p);
        p = Vec3(floats_.back());
      }
      record.place.frame += " as floats";
      status = body_->update(floats_);
      if (status) accept();
      break;
    }
    case 1: {
      given = partial_pose(mesh_, positions_, dice, moved).positions;
      record.place.frame += " in part";
      Body whole = *body_;
      status = body_->update(given, moved);
      if (status) accept();
      const UpdateStatus at_once = whole.update(given);
      record.expect(at_once.code == status.code && whole.hash() == body_->hash(), "partial-bits",
                    "an update of ranges is not the full one");
      break;
    }
    case 2: {
      record.place.frame += " lazily";
      Body whole = *body_;
      status = body_->update_lazily(given, dice.below(built_->tree.level_count()));
      if (status) {
        accept();
        reach_all(dice, record);
        record.expect(whole.update(given) && whole.hash() == body_->hash(), "lazy-bits",
                      "a lazy update, completed, is not the full one");
      }
      break;
    }
    case 3: {
      record.place.frame += " through an index";
      std::vector<Vec3> nodes(2 * count + 1, {std::numeric_limits<double>::quiet_NaN(), 0, 0});
      std::vector<std::uint32_t> index;
      for (std::size_t i = 0; i < count; ++i) {
        index.push_back(static_cast<std::uint32_t>(2 * (count - i) - 1));
        nodes[index.back()] = given[i];
      }
      status = body_->update(PositionView::indexed(PositionView(nodes), index));
      if (status) accept();
      break;
    }
    default:
      status = body_->update(given);
      if (status) accept();
  }
  if (!status && reach_of(mesh_, used_vertices(mesh_), given) < far_enough_to_refuse)
    record.fail("refused", "a frame of finite positions, code " + std::to_string(static_cast<int>(status.code)));
  return status;
}

void Actor::move(Dice& dice, Record& record, bool on_lattice) {
  Pose pose = random_pose(mesh_, dice);
  if (on_lattice) {
    const std::vector<bool> used = used_vertices(mesh_);
    snap(pose.positions, used, dice);
    pose.name += " on a lattice";
  }
  record.place.frame = pose.name;
  const UpdateStatus status = feed(pose, on_lattice, dice, record);
  record.place.pose = positions_;
  if (!status) return;
  judge_now(dice, record, "");
  if (dice.chance(0.05)) {
    // A frame that cannot be: nothing changes.
    Positions bad = positions_;
    bad[mesh_.facets[dice.below(mesh_.facet_count())][0]].y = std::numeric_limits<double>::infinity();
    const std::uint64_t before = body_->hash();
    record.expect(!body_->update(bad) && body_->hash() == before, "refused", "an infinite position changed spheres");
    record.expect(body_->update(positions_) && body_->hash() == before, "refused",
                  "the same positions after a refusal gave other spheres");
  }
}

void Actor::return_to_rest(Record& record) {
  record.place.frame = "back at rest";
  record.expect(static_cast<bool>(body_->update(mesh_.positions)), "refused", "the positions at rest");
  positions_ = mesh_.positions;
  points_ = points_of(positions_);
  record.expect(body_->hash() == rest_hash_, "rest-bits", "back at rest, the spheres are others than at the start");
}

void Actor::move_by_modes(Dice& dice, Record& record) {
  const Modes& modes = body_->options().modes;
  std::vector<double> q(modes.mode_count);
  record.place.frame = "modes at";
  for (double& x : q) {
    x = dice.chance(0.15) ? 0 : dice.sign() * dice.logarithmic(1e-9, dice.chance(0.6) ? 10 : 1e6);
    record.place.frame += " " + std::to_string(x);
  }
  // The sums as they are, and in double, modes in order: what is promised to levels of other rules is about the latter.
  std::vector<Point> sums = points_of(mesh_.positions);
  Positions rounded = mesh_.positions;
  for (std::size_t j = 0; j < q.size(); ++j)
    for (std::size_t i = 0; i < sums.size() && q[j] != 0; ++i) {
      const Vec3& u = modes.mode(j)[i];
      sums[i] = sums[i] + static_cast<Real>(q[j]) * Point{u.x, u.y, u.z};
      rounded[i] += u * q[j];
    }
  const std::vector<Rule>& rules = body_->options().rules;
  const bool all_modal = std::all_of(rules.begin(), rules.end(), [](Rule r) { return r == Rule::modal; });
  points_ = points_of(rounded);
  UpdateStatus status;
  if (dice.chance(0.25)) {
    Body whole = *body_;
    status = body_->update_modal_lazily(q, dice.below(built_->tree.level_count()));
    if (status) {
      reach_all(dice, record);
      record.expect(whole.update_modal(q) && whole.hash() == body_->hash(), "lazy-bits",
                    "a lazy modal update, completed, is not the full one");
    }
  } else {
    status = body_->update_modal(q);
  }
  if (!status) {
    if (reach_of(mesh_, used_vertices(mesh_), sums) < far_enough_to_refuse)
      record.fail("refused", "coordinates, code " + std::to_string(static_cast<int>(status.code)));
    return;
  }
  ++record.counts.modal_frames;
  positions_ = std::move(rounded);
  points_ = all_modal && dice.chance(0.5) ? std::move(sums) : points_of(positions_);
  record.place.pose = positions_;
  judge_now(dice, record, "-modal");
  // Any one node, asked for alone.
  const auto node = static_cast<std::uint32_t>(dice.below(built_->tree.node_count()));
  const bool modal_level = rules[std::min<std::size_t>(built_->tree.level_of(node), rules.size() - 1)] == Rule::modal;
  if (modal_level && !body_->options().conservative)
    record.expect(body_->modal_sphere(node, q) == body_->sphere(node), "modal-bits",
                  "modal_sphere is not the sphere of the update");
}

void Actor::move_by_bones(Dice& dice, Record& record) {
  ++record.counts.frames;
  const Skin& skin = body_->options().skin;
  const Modes& modes = body_->options().modes;
  const std::vector<AffineTransform> transforms = random_transforms(mesh_, skin.bone_count, dice);
  record.place.frame = "bones";
  std::vector<double> morphs(modes.mode_count);
  if (dice.chance(0.8))
    for (double& q : morphs)
      if (dice.chance(0.6)) q = dice.sign() * dice.logarithmic(1e-9, dice.chance(0.6) ? 10 : 1e6);
  // The sums as they are, and in double, morph targets and influences in order. reach: bounds of morphed vertices.
  std::vector<Point> sums = points_of(mesh_.positions);
  Mesh reach = mesh_;
  for (std::size_t j = 0; j < morphs.size(); ++j)
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const Vec3& u = modes.mode(j)[i];
      sums[i] = sums[i] + static_cast<Real>(morphs[j]) * Point{u.x, u.y, u.z};
      const double far = max_norm(reach.positions[i]) + std::abs(morphs[j]) * max_norm(u);
      reach.positions[i] = {far, far, far};
    }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const Point rest = sums[i];
    for (std::uint32_t k = skin.begin[i]; k < skin.begin[i + 1]; ++k) {
      const AffineTransform& t = transforms[skin.bones[k]];
      const std::vector<Point> columns = points_of(t.columns);
      const Point moved =
          rest.x * columns[0] + rest.y * columns[1] + rest.z * columns[2] + points_of(std::span(&t.translation, 1))[0];
      sums[i] = sums[i] + static_cast<Real>(skin.weights[k]) * (moved - rest);
    }
  }
  Positions rounded = mesh_.positions;
  const bool has_morphs = std::any_of(morphs.begin(), morphs.end(), [](double q) { return q != 0; });
  if (has_morphs) record.place.frame = "bones and morph targets";
  move_by_skin(skin, modes, mesh_.positions, transforms, morphs, rounded);
  const std::uint64_t before = body_->hash();
  const UpdateStatus status =
      has_morphs || dice.chance(0.5) ? body_->update_skinned(transforms, morphs) : body_->update_skinned(transforms);
  if (!status) {
    record.expect(body_->hash() == before, "refused-changed", "a refused update changed the spheres");
    // The sum of |weights| is below 2^8.
    if (largest_term(reach, transforms) < far_enough_to_refuse / 0x1p8)
      record.fail("refused", "transforms, code " + std::to_string(static_cast<int>(status.code)));
    return;
  }
  ++record.counts.skinned_frames;
  const std::vector<Rule>& rules = body_->options().rules;
  const bool all_skinned = std::all_of(rules.begin(), rules.end(), [](Rule r) { return r == Rule::skinned; });
  positions_ = std::move(rounded);
  points_ = all_skinned && dice.chance(0.5) ? std::move(sums) : points_of(positions_);
  record.place.pose = positions_;
  judge_now(dice, record, "-skinned");
  if (!dice.chance(0.2)) return;
  const std::vector<AffineTransform> at_rest(skin.bone_count);
  record.expect(body_->update_skinned(at_rest) && body_->hash() == rest_hash_, "rest",
                "back at rest, the spheres of a skinned body are not those of the start");
}

}  // namespace morula::properties
