// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "cases.hpp"

#include <morula/collide/contact_query.hpp>
#include <morula/update/known_poses.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <set>
#include <tuple>

#include "actor.hpp"
#include "contacts.hpp"
#include "covering.hpp"

namespace morula::properties {
namespace {

// Where the bodies of a case come from.
struct Source {
  std::uint64_t seed, number;
  Specimens& specimens;
  Specimen operator()(std::size_t most_facets, Dice& dice, Record& record) const {
    return specimens.choose(seed, number, most_facets, dice, record);
  }
};

// Something small, to be held at any place of a mesh: it meets what is there and nothing else.
Specimen probe(const Mesh& mesh, Dice& dice, Record& record) {
  const double size = bounding_box(mesh).diagonal();
  const double small = (size > 0 ? size : 1) * dice.pick({0.1, 0.01, 0x1p-7, 1e-4});
  Specimen s{"a small probe",
             {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}},
             nullptr};
  if (dice.chance(0.5)) s.mesh = {{{-1, -1, -1}, {1, 1, -1}, {0, 0, 2}}, {{0, 1, 2}}};
  scale(s.mesh.positions, small);
  record.place.description += s.name;
  s.model = std::make_shared<const CoveredTree>(build(s.mesh, {.method = Method::octree, .branching = 8, .depth = 1}));
  return s;
}

// One body, some frames, back at rest.
void one_body(const Source& source, Dice& dice, Record& record) {
  Actor body(source(300, dice, record), dice, record);
  for (int frame = dice.between(2, 5); frame > 0; --frame) body.move(dice, record);
  body.return_to_rest(record);
}

// A modal body at random coordinates.
void modal_body(const Source& source, Dice& dice, Record& record) {
  Actor body(source(60, dice, record), dice, record);
  body.make_modal(dice, record);
  for (int frame = dice.between(3, 6); frame > 0; --frame) body.move_by_modes(dice, record);
}

// A skinned body at random transforms.
void skinned_body(const Source& source, Dice& dice, Record& record) {
  Actor body(source(60, dice, record), dice, record);
  body.make_skinned(dice, record);
  for (int frame = dice.between(3, 6); frame > 0; --frame) body.move_by_bones(dice, record);
}

// Trees for poses that the body may or may not come to, however little they are worth; degenerate ones too.
CoveredTree with_known_poses(const Mesh& mesh, const CoveredTree& home, Dice& dice, Record& record) {
  CoveredTree model = home;
  for (int left = dice.between(1, 3); left > 0; --left) {
    Pose pose = random_pose(mesh, dice);
    try {
      const CoveredTree tree = build({pose.positions, mesh.facets}, {.method = Method::octree, .depth = 2});
      if (!(surface_area(MeshView{pose.positions, mesh.facets}) > 0)) continue;
      model.poses.push_back({pose.name, std::move(pose.positions), std::make_shared<const CoveredTree>(tree)});
    } catch (const std::invalid_argument&) {  // a pose beyond what can be built
    }
  }
  record.place.description += " | trees for " + std::to_string(model.poses.size()) + " poses";
  return model;
}

// A body that is built anew again and again, judged in each frame; beside it, now and then, another one.
void rebuilt_body(const Source& source, Dice& dice, Record& record) {
  Specimen specimen = source(40, dice, record);
  // Looseness is estimated at points spread by area: without any there is nothing to tell when to re-fit.
  while (!(surface_area(specimen.mesh) > 0)) {
    record.place.description += " without area; then: ";
    specimen = source(40, dice, record);
  }
  const Mesh& mesh = specimen.mesh;
  const CoveredTree& home = *specimen.model;
  record.place.mesh = mesh;
  const Method method =
      home.tree.node_count() > 10 || dice.chance(0.9) ? Method::octree : dice.pick({Method::grid, Method::optimized});
  const int every = dice.pick({0, 1, 1, 2});
  RebuildOptions options{.method = method,
                         .quality = Quality::draft,
                         .rest_quality = Quality::fast,
                         .check_every = 1,
                         .rebuild_every = every > 0 ? std::optional(every) : std::nullopt,
                         .min_improvement = dice.pick({-1e9, -1e9, 0.05}),
                         .look_ahead = dice.pick({0, 1}) != 0,
                         .thread = dice.chance(0.2) ? RebuildThread::none : RebuildThread::caller};
  record.place.description +=
      std::string(" | rebuilt by ") + std::string(name(options.method)) + " every " + std::to_string(every);
  RebuiltBody body(mesh, dice.chance(0.5) ? with_known_poses(mesh, home, dice, record) : home, options);
  const std::uint64_t rest_hash = body.body().hash();
  const Body other(mesh, home);
  const bool beside = dice.chance(0.5);
  std::optional<Collider> side;
  Collider still(mesh, other);
  std::uint64_t seen = body.tree_version();
  Pose pose{"at rest", mesh.positions};
  std::size_t swaps = 0;
  for (int frame = dice.between(4, 9); frame > 0; --frame) {
    if (dice.chance(0.7)) pose = random_pose(mesh, dice);
    record.place.frame = pose.name;
    record.place.pose = pose.positions;
    const RebuildStatus status = body.update(pose.positions);
    record.expect(static_cast<bool>(status), "refused", "a frame of finite positions");
    if (!status) continue;
    swaps += status.swapped;
    const Body& now = body.body();
    std::vector<Sphere> spheres;
    now.copy_spheres(spheres);
    const std::vector<std::uint8_t> all(spheres.size(), 1);
    judge({mesh, now.rest_tree(), now.cover(), points_of(pose.positions), balls_of(spheres), all}, dice, record,
          {.cuts = 80}, "-rebuild");
    if (!beside) continue;
    if (!side || body.tree_version() != seen) side.emplace(mesh, now);
    seen = body.tree_version();
    side->set_positions(pose.positions);
    still.set_transform(touching_transform(*side, still, dice));
    const PairJudge judge_of(*side, still, dice);
    judge_of.judge_facets(record);
    judge_of.judge_contacts(collide(*side, still, {.budget = dice.below(100)}), 0, 0, record, "beside a rebuilt body");
  }
  record.place.frame = "back at rest";
  record.expect(static_cast<bool>(body.update(mesh.positions)), "refused", "the positions at rest");
  record.expect(body.body().hash() == rest_hash, "rest-bits", "back at rest, a rebuilt body has other spheres");
  record.expect(body.report().failed == 0, "rebuild", body.report().failure);
  record.counts.swaps += swaps;
}

using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
std::set<Key> keys(const Contacts& contacts) {
  std::set<Key> all;
  for (const Contact& c : contacts.contacts) all.insert({c.pair, c.node_a, c.node_b});
  return all;
}

CollideOptions random_options(const Actor& a, const Actor& b, const Collider& side, Dice& dice) {
  CollideOptions options;
  if (dice.chance(0.2))
    options.level =
        static_cast<std::uint32_t>(dice.below(std::max(a.model().tree.level_count(), b.model().tree.level_count())));
  if (dice.chance(0.4)) {
    Box box;
    for (const Facet& f : side.mesh_facets())
      for (const std::uint32_t v : f) box.add(side.positions()[v]);
    options.margin = box.diagonal() * dice.pick({1e-6, 0.01, 0.1, 0.5});
  }
  options.priority = dice.pick({Priority::level, Priority::overlap, Priority::importance});
  options.find_crossings = dice.chance(0.4);
  options.surfaces = dice.chance(0.1);
  return options;
}

Budget some_budget(Dice& dice) {
  return Budget(dice.pick({0, 1, 2, 3, 5, 10, 20, 50, static_cast<int>(dice.below(2000))}));
}

// Two bodies that touch, deeply or just so, asked about once and in one go, and by a query that is interrupted, resumed
// and carried from frame to frame; complete at every stop.
void two_bodies(const Source& source, Dice& dice, Record& record) {
  const Specimen specimen = source(100, dice, record);
  Actor first(specimen, dice, record);
  record.place.description += " | second: ";
  // Now and then the same body twice.
  const bool twin = dice.chance(0.15);
  if (twin) record.place.description += "the same";
  const bool probing = !twin && dice.chance(0.3);
  Actor second(twin      ? specimen
               : probing ? probe(specimen.mesh, dice, record)
                         : source(100, dice, record),
               dice, record);
  if (!first.covers() || !second.covers()) {
    for (int frame = dice.between(1, 3); frame > 0; --frame) first.move(dice, record), second.move(dice, record);
    return;
  }
  Collider a(first.mesh(), first.body()), b(second.mesh(), second.body());
  a.set_positions(first.view());
  b.set_positions(second.view());
  // On a lattice all pairs are known exactly, those that just touch, too.
  const bool on_lattice = dice.chance(0.3);
  if (on_lattice) {
    first.move(dice, record, true);
    second.move(dice, record, true);
    if (!first.body().is_current() || !second.body().is_current()) return;
    a.set_positions(first.view());
    b.set_positions(second.view());
  } else if (dice.chance(0.7)) {
    a.set_transform(touching_transform(a, a, dice));
  }
  b.set_transform(touching_transform(a, b, dice, on_lattice));

  CollideOptions options = random_options(first, second, a, dice);
  const bool also_swapped = dice.chance(0.2);  // two pairs in one queue: (a, b) and (b, a)
  ContactQuery query(options);
  query.add(a, b, 1);
  if (also_swapped) query.add(b, a, 2);
  const auto judge_query = [&](const PairJudge& pair, const std::optional<PairJudge>& other, const std::string& when) {
    pair.judge_contacts(query.contacts(), 0, options.margin, record, when);
    if (other) other->judge_contacts(query.contacts(), 1, options.margin, record, when);
    if (options.find_crossings && query.contacts().finished && !options.level) {
      pair.judge_listed(query.contacts(), 0, record);
      if (other) other->judge_listed(query.contacts(), 1, record);
    }
  };

  const int frames = dice.between(1, 4);
  for (int frame = 0; frame < frames; ++frame) {
    if (frame > 0) {
      if (dice.chance(0.7)) {
        first.move(dice, record, on_lattice);
        a.set_positions(first.view());
      }
      if (dice.chance(0.3)) {
        second.move(dice, record, on_lattice);
        b.set_positions(second.view());
      }
      if (!first.body().is_current() || !second.body().is_current()) return;
      if (dice.chance(0.7)) b.set_transform(touching_transform(a, b, dice, on_lattice));
    }
    if (probing)
      for (int n = 0; n < 10; ++n) {
        b.set_transform(touching_transform(a, b, dice, on_lattice));
        const PairJudge pair(a, b, dice);
        pair.judge_facets(record);
        options.budget = some_budget(dice);
        pair.judge_contacts(collide(a, b, options), 0, options.margin, record, "with a probe");
      }
    record.place.frame += ", frame " + std::to_string(frame);
    const PairJudge pair(a, b, dice);
    pair.judge_facets(record);
    std::optional<PairJudge> other;
    if (also_swapped) {
      other.emplace(b, a, dice);
      other->judge_facets(record);
    }
    // Once, to some budget.
    options.budget = dice.chance(0.3) ? Budget() : some_budget(dice);
    const Contacts once = collide(a, b, options);
    pair.judge_contacts(once, 0, options.margin, record, "at once");
    if (options.find_crossings && once.finished && !options.level) pair.judge_listed(once, 0, record);

    // Again and again.
    for (int step = 0; step < 7; ++step) {
      options.budget = step == 6 || dice.chance(0.05) ? Budget() : some_budget(dice);
      query.set_options(options);
      const char* when = step > 0 ? "resumed" : frame > 0 && dice.chance(0.85) ? "carried" : "started";
      const ContactStatus status = step > 0                              ? query.resume()
                                   : std::string_view(when) == "carried" ? query.carry()
                                                                         : query.start();
      if (!status) {
        record.fail("query", message(status));
        return;
      }
      judge_query(pair, other,
                  when + std::string(" in frame ") + std::to_string(frame) + ", step " + std::to_string(step));
      if (query.contacts().finished || dice.chance(0.15)) break;
    }
    if (query.contacts().finished) {
      options.budget = {};
      ContactQuery fresh(options);
      fresh.add(a, b, 1);
      if (also_swapped) fresh.add(b, a, 2);
      record.expect(fresh.start() && keys(fresh.contacts()) == keys(query.contacts()), "front",
                    "a finished query has other contacts than a fresh one");
    }
  }
  // Lazily: only what the query reaches is brought up to date.
  const std::vector<Rule>& rules = first.body().options().rules;
  if (dice.chance(0.3) && std::all_of(rules.begin(), rules.end(), [](Rule r) { return r == Rule::exact; })) {
    const Pose pose = random_pose(first.mesh(), dice);
    record.place.frame = pose.name + ", reached by a query";
    record.place.pose = pose.positions;
    if (!first.body().update_lazily(pose.positions, 0)) return;
    a.set_positions(pose.positions);
    b.set_transform(touching_transform(a, b, dice));
    const PairJudge pair(a, b, dice);
    options.budget = dice.chance(0.5) ? Budget() : some_budget(dice);
    options.find_crossings = false;
    options.refresh_children = [&](const Collider& which, std::uint32_t node) {
      if (which == a) first.body().refresh_children(node);
      return true;
    };
    pair.judge_contacts(collide(a, b, options), 0, options.margin, record, "lazily");
  }
}

}  // namespace

void run_case(std::uint64_t seed, std::uint64_t number, Specimens& specimens, Record& record) {
  record.begin(seed, number);
  Dice dice(seed, number + 1);
  const Source source{seed, number, specimens};
  try {
    const double kind = dice.uniform();
    if (kind < 0.55)
      one_body(source, dice, record);
    else if (kind < 0.87)
      two_bodies(source, dice, record);
    else if (kind < 0.91)
      modal_body(source, dice, record);
    else if (kind < 0.95)
      skinned_body(source, dice, record);
    else
      rebuilt_body(source, dice, record);
  } catch (const std::exception& error) {
    record.fail("exception", error.what());
  }
}

void run_far_build(std::uint64_t seed, std::uint64_t number, std::optional<Method> method, Record& record) {
  record.begin(seed, number);
  Dice dice(seed ^ 0x666172u, number + 1);
  try {
    far_tree(method, dice, record);
  } catch (const std::exception& error) {
    record.fail("exception", error.what());
  }
}

}  // namespace morula::properties
