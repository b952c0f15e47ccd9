// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Two bodies, or a body and a simple shape: contacts, crossings, distance, touch, rays, insides.
#include <deque>
#include <morula/morula.hpp>
#include <optional>

#include "contacts.hpp"
#include "held_query.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

void bind_contacts(nb::module_& m) {
  Record<SurfacePoint>(m, "SurfacePoint", doc::SurfacePoint)
      .field("facet", &SurfacePoint::facet)
      .field("barycentric", &SurfacePoint::barycentric)
      .field("point", &SurfacePoint::point);
  Record<Crossings>(m, "Crossings", "Pairs of facets that really intersect, in the order of (facet_a, facet_b).")
      .property("facet_a", MORULA_COLUMN(Crossings, pairs, facet_a), "(n,) uint32.")
      .property("facet_b", MORULA_COLUMN(Crossings, pairs, facet_b), "(n,) uint32.")
      .property("segment_from", MORULA_COLUMN3(Crossings, pairs, segment.from), "(n, 3) float64, in the world.")
      .property("segment_to", MORULA_COLUMN3(Crossings, pairs, segment.to), "(n, 3) float64, in the world.")
      .table([](const Crossings& self) { return self.pairs.size(); });
  Record<ContactSurfaces>(m, "ContactSurfaces", doc::ContactSurface)
      .property("facet_a", MORULA_COLUMN(ContactSurfaces, rows, on_a.facet), "(n,) uint32.")
      .property("facet_b", MORULA_COLUMN(ContactSurfaces, rows, on_b.facet), "(n,) uint32.")
      .property("barycentric_a", MORULA_COLUMN3(ContactSurfaces, rows, on_a.barycentric), "(n, 3) float64.")
      .property("barycentric_b", MORULA_COLUMN3(ContactSurfaces, rows, on_b.barycentric), "(n, 3) float64.")
      .property("point_a", MORULA_COLUMN3(ContactSurfaces, rows, on_a.point), "(n, 3) float64, in the world.")
      .property("point_b", MORULA_COLUMN3(ContactSurfaces, rows, on_b.point), "(n, 3) float64, in the world.")
      .property("normal", MORULA_COLUMN3(ContactSurfaces, rows, normal), doc::ContactSurface_normal)
      .property("depth", MORULA_COLUMN(ContactSurfaces, rows, depth), doc::ContactSurface_depth)
      .table([](const ContactSurfaces& self) { return self.rows.size(); });
  Record<Containment>(m, "Containment", doc::Containment)
      .property(
          "inside", [](const Containment& c) { return std::vector<bool>(c.inside.begin(), c.inside.end()); },
          doc::Containment_inside)
      .field("inside_count", &Containment::inside_count)
      .field("certified", &Containment::certified)
      .property("all", [](const Containment& c) { return c.all(); })
      .property("any", [](const Containment& c) { return c.any(); });
  Record<MutualContainment>(m, "MutualContainment", doc::MutualContainment)
      .field("a_in_b", &MutualContainment::a_in_b)
      .field("b_in_a", &MutualContainment::b_in_a);
  Record<Contacts>(m, "Contacts",
                   "Pairs of nodes whose spheres meet; every crossing of the surfaces lies in one of them.")
      .property("pair", MORULA_COLUMN(Contacts, contacts, pair), doc::Contact_pair)
      .property("node_a", MORULA_COLUMN(Contacts, contacts, node_a), "(n,) uint32.")
      .property("node_b", MORULA_COLUMN(Contacts, contacts, node_b), "(n,) uint32.")
      .property("finished", MORULA_COLUMN(Contacts, contacts, finished), doc::Contact_finished)
      .property("point", MORULA_COLUMN3(Contacts, contacts, point), doc::Contact_point)
      .property("normal", MORULA_COLUMN3(Contacts, contacts, normal), doc::Contact_normal)
      .property("depth", MORULA_COLUMN(Contacts, contacts, depth), doc::Contact_depth)
      .property("lens_volume", MORULA_COLUMN(Contacts, contacts, lens_volume), doc::Contact_lens_volume)
      .property("error_bound", MORULA_COLUMN(Contacts, contacts, error_bound), doc::Contact_error_bound)
      .property(
          "surfaces", [](const Contacts& c) { return ContactSurfaces{c.surfaces}; }, doc::Contacts_surfaces)
      .property(
          "crossings", [](const Contacts& c) { return Crossings{c.crossings}; }, doc::Contacts_crossings)
      .property("crossings_begin", [](const Contacts& c) { return c.crossings_begin; })
      .property(
          "containment", [](const Contacts& c) { return c.containment; }, doc::Contacts_containment)
      .property(
          "finished_count", [](const Contacts& c) { return c.finished_count; }, doc::Contacts_finished_count)
      .property(
          "is_finished", [](const Contacts& c) { return c.finished; }, doc::Contacts_finished)
      .property(
          "pair_tests", [](const Contacts& c) { return c.pair_tests; }, doc::Contacts_pair_tests)
      .property(
          "achieved_level", [](const Contacts& c) { return c.achieved_level; }, doc::Contacts_achieved_level)
      .table([](const Contacts& self) { return self.contacts.size(); });
}

struct CollideArguments {
  CollideOptions options;
  bool reach = false;
};

CollideOptions collide_options(std::optional<std::uint32_t> level, double margin, const BudgetGiven& budget,
                               std::string_view priority, bool surfaces, bool exact, bool containment) {
  CollideOptions options;
  options.level = level;
  options.margin = margin;
  options.budget = budget_of(budget);
  options.priority = choice<Priority>(
      priority, "priority",
      {{"level", Priority::level}, {"overlap", Priority::overlap}, {"importance", Priority::importance}});
  options.surfaces = surfaces;
  options.exact = exact;
  options.containment = containment;
  return options;
}

/// Brings nodes of lazily updated bodies up to date as the query comes to them.
void reach_by(CollideOptions& options, const std::vector<const Side*>& sides) {
  options.reach = [sides](const Collider& collider, std::uint32_t node) {
    for (const Side* side : sides) {
      if (side->collider.get() != &collider) continue;
      if (Body* body = side->posed->body()) body->reach(node);
    }
    return true;
  };
}

struct FrontPairs {
  std::vector<FrontPair> rows;
};

/// A query about several pairs of colliders.
struct HeldContactQuery : HeldQuery<ContactQuery, SeenSides> {
  CollideOptions options;

  HeldContactQuery(ContactQuery&& made, CollideOptions&& given, bool reach)
      : HeldQuery(std::move(made), {{}, reach}), options(std::move(given)) {}
};

template <class Call>
Contacts asked(HeldContactQuery& self, Threads* workers, bool keep, const Call& call) {
  Contacts contacts;
  require(self.ask(workers, [&](ContactQuery& query, Workers& threads) {
    if (self.seen.exclusive) {
      CollideOptions options = self.options;
      reach_by(options, self.seen.current());
      query.set_options(std::move(options));
    }
    const ContactStatus status = call(query, threads);
    if (status) contacts = keep ? query.contacts() : query.take_contacts();
    return status;
  }));
  return contacts;
}

void bind_collider(nb::module_& m) {
  nb::class_<Side>(m, "Collider", doc::Collider)
      .def(
          "__init__",
          [](Side* self, ColliderGiven body) {
            const std::shared_ptr<Side> made = side_of(body, "body");
            if (nb::isinstance<Side>(body.object)) throw nb::type_error("body: a Collider already");
            new (self) Side(std::move(*made));
          },
          nb::arg("body"), nb::sig("def __init__(self, body: Body | RebuiltBody | PosedSpheres) -> None"),
          doc::Collider_Collider)
      .def(
          "__init__",
          [](Side* self, MeshGiven given, std::shared_ptr<CoveredTree> built, std::shared_ptr<PosedRows> spheres) {
            Side side;
            side.mesh = mesh_of(given);
            side.built = built;
            side.collider = std::make_unique<Collider>(*side.mesh, built->cover, spheres->pose());
            side.posed = std::move(spheres);
            new (self) Side(std::move(side));
          },
          nb::arg("mesh"), nb::arg("built"), nb::arg("spheres"),
          nb::sig(
              "def __init__(self, mesh: morula.typing.MeshLike, built: CoveredTree, spheres: PosedSpheres) -> None"),
          doc::Collider_Collider_2)
      .def(
          "place",
          [](Side& self, const RigidTransform& placement) {
            without_gil([&] {
              const std::unique_lock lock(self.posed->mutex);
              self.collider->place(placement);
            });
          },
          nb::arg("placement"), doc::Collider_place)
      .def(
          "place",
          [](Side& self, Vec3 translation) {
            without_gil([&] {
              const std::unique_lock lock(self.posed->mutex);
              RigidTransform placement;
              placement.translation = translation;
              self.collider->place(placement);
            });
          },
          nb::arg("translation"), "A translation alone, mesh units.")
      .def_prop_ro("placement", [](const Side& self) { return self.collider->placement(); })
      .def(
          "set_positions",
          [](Side& self, PositionsGiven given) {
            std::vector<Positions> positions;
            positions.emplace_back(given.object, "positions");
            {
              const nb::gil_scoped_release released;
              const std::unique_lock lock(self.posed->mutex);
              self.collider->set_positions(positions[0].view());
              std::swap(self.given, positions);
            }
          },
          nb::arg("positions"), doc::Collider_set_positions)
      .def_prop_ro(
          "has_current_positions", [](const Side& self) { return self.current().has_current_positions(); },
          doc::Collider_has_current_positions)
      .def_prop_ro(
          "has_surface", [](const Side& self) { return self.collider->has_surface(); }, doc::Collider_has_surface)
      .def(
          "facets",
          [](const Side& self, std::uint32_t node) {
            if (node >= self.current().tree().node_count()) throw nb::index_error("node");
            const auto facets = self.collider->facets(node);
            return own_indices({facets.begin(), facets.end()});
          },
          nb::arg("node"), doc::Collider_facets)
      .def("__repr__", [](const Side& self) {
        return std::string("<morula.Collider: ") + std::to_string(self.collider->tree().node_count()) + " nodes" +
               (self.collider->has_surface() ? ">" : ", spheres alone>");
      });
}

void bind_contact_query(nb::module_& m) {
  const std::initializer_list<std::pair<const char*, const char*>> arguments{
      {"level", doc::CollideOptions_level},
      {"margin", doc::CollideOptions_margin},
      {"budget", "None: all there is; an int: pair tests; a datetime.timedelta or a text such as '200us': time"},
      {"priority", "level, overlap or importance: which pair is looked into next, when there is a budget"},
      {"surfaces", doc::CollideOptions_surfaces},
      {"exact", doc::CollideOptions_exact},
      {"containment", doc::CollideOptions_containment},
      {"reach", "brings nodes of lazily updated bodies up to date where the query goes"}};
  nb::enum_<FrontPair::State>(m, "FrontPairState", nb::is_arithmetic(), "What is known of a pair of the cut.")
      .value("separated", FrontPair::State::separated)
      .value("finished", FrontPair::State::finished)
      .value("waiting", FrontPair::State::waiting);
  Record<FrontPairs>(m, "FrontPairs", "The complete cut of a query: pairs of nodes.")
      .property("pair", MORULA_COLUMN(FrontPairs, rows, pair), "(n,) uint32: which pair of bodies.")
      .property("node_a", MORULA_COLUMN(FrontPairs, rows, a), "(n,) uint32.")
      .property("node_b", MORULA_COLUMN(FrontPairs, rows, b), "(n,) uint32.")
      .property(
          "state",
          [](nb::handle self) {
            const auto& all = nb::cast<const FrontPairs&>(self).rows;
            const auto* first = all.empty() ? nullptr : reinterpret_cast<const std::uint8_t*>(&all[0].state);
            return column<FrontPair>(std::span<const FrontPair>(all), first, self);
          },
          "(n,) uint8: morula.FrontPairState of each.")
      .table([](const FrontPairs& self) { return self.rows.size(); });
  nb::class_<HeldContactQuery> query(m, "ContactQuery", doc::ContactQuery);
  query
      .def(
          "__init__",
          [](HeldContactQuery* self, std::optional<std::uint32_t> level, double margin, BudgetGiven budget,
             std::string_view priority, bool surfaces, bool exact, bool containment, bool reach) {
            CollideOptions options = collide_options(level, margin, budget, priority, surfaces, exact, containment);
            ContactQuery query(options);
            new (self) HeldContactQuery(std::move(query), std::move(options), reach);
          },
          nb::kw_only(), nb::arg("level") = nb::none(), nb::arg("margin") = 0.0, nb::arg("budget") = nb::none(),
          nb::arg("priority") = "overlap", nb::arg("surfaces") = false, nb::arg("exact") = false,
          nb::arg("containment") = false, nb::arg("reach") = false,
          with_arguments(doc::ContactQuery_ContactQuery, arguments).c_str())
      .def(
          "add",
          [](HeldContactQuery& self, std::shared_ptr<Side> a, std::shared_ptr<Side> b, double weight) {
            return self.locked([&](ContactQuery& all) {
              const std::uint32_t number = all.add(a->current(), b->current(), weight);
              self.seen.sides.push_back(a);
              self.seen.sides.push_back(b);
              return number;
            });
          },
          nb::arg("a"), nb::arg("b"), nb::arg("weight") = 1.0, doc::ContactQuery_add)
      .def("clear", [](HeldContactQuery& self) {
        std::vector<std::shared_ptr<Side>> sides;
        self.locked([&](ContactQuery& all) {
          all.clear();
          std::swap(self.seen.sides, sides);
        });
      });
  bind_set_budget(query);
  query
      .def(
          "warm_up",
          [](HeldContactQuery& self, Threads* workers) {
            require(self.ask(workers, [](ContactQuery& q, Workers& c) { return q.warm_up(c); }));
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_warm_up)
      .def(
          "run",
          [](HeldContactQuery& self, Threads* w) {
            return asked(self, w, false, [](ContactQuery& q, Workers& c) { return q.run(c); });
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_run)
      .def(
          "start",
          [](HeldContactQuery& self, Threads* w) {
            return asked(self, w, true, [](ContactQuery& q, Workers& c) { return q.start(c); });
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_start)
      .def(
          "resume",
          [](HeldContactQuery& self, Threads* w) {
            return asked(self, w, true, [](ContactQuery& q, Workers& c) { return q.resume(c); });
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_resume)
      .def(
          "carry",
          [](HeldContactQuery& self, Threads* w) {
            return asked(self, w, true, [](ContactQuery& q, Workers& c) { return q.carry(c); });
          },
          nb::arg("workers") = nb::none(), doc::ContactQuery_carry)
      .def(
          "surface",
          [](HeldContactQuery& self, std::size_t contact) {
            return ContactSurfaces{{self.ask([&](ContactQuery& q) { return q.surface(contact); })}};
          },
          nb::arg("contact"), doc::ContactQuery_surface)
      .def(
          "cut",
          [](HeldContactQuery& self) {
            FrontPairs cut;
            self.ask([&](ContactQuery& q) { q.cut(cut.rows); });
            return cut;
          },
          doc::ContactQuery_cut);

  m.def(
      "collide",
      [](ColliderGiven ga, ColliderGiven gb, std::optional<std::uint32_t> level, double margin, BudgetGiven budget,
         std::string_view priority, bool surfaces, bool exact, bool containment, bool reach) {
        CollideOptions options = collide_options(level, margin, budget, priority, surfaces, exact, containment);
        const auto a = side_of(ga, "a"), b = side_of(gb, "b");
        return without_gil([&] {
          const Reading reading({a.get(), b.get()}, reach);
          if (reach) reach_by(options, {a.get(), b.get()});
          return collide(a->current(), b->current(), options);
        });
      },
      nb::arg("a"), nb::arg("b"), nb::kw_only(), nb::arg("level") = nb::none(), nb::arg("margin") = 0.0,
      nb::arg("budget") = nb::none(), nb::arg("priority") = "overlap", nb::arg("surfaces") = false,
      nb::arg("exact") = false, nb::arg("containment") = false, nb::arg("reach") = false,
      (with_arguments(doc::collide, arguments) +
       "\n\nA body may stand in for its collider; making one costs as much as its tree is large.")
          .c_str());
  m.def(
      "overlap",
      [](ColliderGiven ga, ColliderGiven gb) {
        const auto a = side_of(ga, "a"), b = side_of(gb, "b");
        return without_gil([&] {
          const Reading reading({a.get(), b.get()});
          return overlap(a->current(), b->current());
        });
      },
      nb::arg("a"), nb::arg("b"), doc::overlap);
  m.def(
      "crossings",
      [](ColliderGiven ga, ColliderGiven gb) {
        const auto a = side_of(ga, "a"), b = side_of(gb, "b");
        return Crossings{without_gil([&] {
          const Reading reading({a.get(), b.get()});
          return crossings(a->current(), b->current());
        })};
      },
      nb::arg("a"), nb::arg("b"), doc::CrossingQuery_run);
  struct HeldCrossings {
    CrossingQuery query;
    std::mutex mutex;
  };
  nb::class_<HeldCrossings>(m, "CrossingQuery", doc::CrossingQuery)
      .def(nb::init<>())
      .def(
          "run",
          [](HeldCrossings& self, ColliderGiven ga, ColliderGiven gb, nb::handle nodes) {
            const auto a = side_of(ga, "a"), b = side_of(gb, "b");
            std::vector<NodePair> pairs;
            if (!nodes.is_none()) {
              if (!PyTuple_Check(nodes.ptr()) || PyTuple_Size(nodes.ptr()) != 2)
                throw nb::type_error(
                    ("nodes: " + describe(nodes) + ", but None or a tuple (nodes_a, nodes_b) of two arrays is needed")
                        .c_str());
              const auto of_a = indices_of(nb::object(nodes[0]), "nodes[0]"),
                         of_b = indices_of(nb::object(nodes[1]), "nodes[1]");
              if (of_a.size() != of_b.size()) throw std::invalid_argument("nodes: both need the same length");
              for (std::size_t i = 0; i < of_a.size(); ++i) pairs.push_back({of_a[i], of_b[i]});
            }
            Crossings found;
            const bool all = nodes.is_none();
            const Status status = without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              const Reading reading({a.get(), b.get()});
              const Status asked =
                  all ? self.query.run(a->current(), b->current()) : self.query.run(a->current(), b->current(), pairs);
              if (asked) found.pairs.assign(self.query.pairs().begin(), self.query.pairs().end());
              return asked;
            });
            require(status);
            return found;
          },
          nb::arg("a"), nb::arg("b"), nb::arg("nodes") = nb::none(),
          nb::sig("def run(self, a: morula.typing.ColliderLike, b: morula.typing.ColliderLike, "
                  "nodes: tuple[morula.typing.Array, morula.typing.Array] | None = None) -> Crossings"),
          with_arguments(doc::CrossingQuery_run, {{"nodes", doc::CrossingQuery_run_2}}).c_str())
      .def_prop_ro(
          "leaf_pairs", [](const HeldCrossings& self) { return self.query.leaf_pairs(); },
          doc::CrossingQuery_leaf_pairs)
      .def_prop_ro(
          "facets_read", [](const HeldCrossings& self) { return self.query.facets_read(); },
          doc::CrossingQuery_facets_read)
      .def_prop_ro(
          "pairs_tested", [](const HeldCrossings& self) { return self.query.pairs_tested(); },
          doc::CrossingQuery_pairs_tested);
  m.def(
      "walk_pairs",
      [](ColliderGiven ga, ColliderGiven gb, nb::callable visit, std::optional<std::uint32_t> level, double margin) {
        const auto a = side_of(ga, "a"), b = side_of(gb, "b");
        // Waited for without the interpreter's lock, which whoever holds the bodies may ask for.
        std::optional<Reading> reading;
        without_gil([&] { reading.emplace(std::vector<const Side*>{a.get(), b.get()}); });
        return walk_pairs(a->current(), b->current(), {level, margin}, [&](NodePair pair, bool is_final) {
          const nb::object step = visit(pair.a, pair.b, is_final);
          if (step.is_none()) return Step::open;
          return choice<Step>(nb::cast<std::string_view>(step), "visit",
                              {{"open", Step::open}, {"skip", Step::skip}, {"stop", Step::stop}});
        });
      },
      nb::arg("a"), nb::arg("b"), nb::arg("visit"), nb::kw_only(), nb::arg("level") = nb::none(),
      nb::arg("margin") = 0.0,
      nb::sig("def walk_pairs(a: morula.typing.ColliderLike, b: morula.typing.ColliderLike, "
              "visit: collections.abc.Callable[[int, int, bool], str | None], *, level: int | None = None, margin: "
              "float = 0.0) -> int"),
      "Down the tree of node pairs. visit(node_a, node_b, is_final) is called for each pair whose spheres are no "
      "farther apart "
      "than the margin and returns None or 'open', 'skip' or 'stop'. Returns the pair tests done. It must not update "
      "the bodies.");
}

void bind_distance(nb::module_& m) {
  Record<DistanceBounds>(m, "DistanceBounds",
                         "Bounds of a distance that hold, with the points that show the upper one.")
      .field("lower", &DistanceBounds::lower, doc::DistanceBounds_lower)
      .field("upper", &DistanceBounds::upper)
      .field("a", &DistanceBounds::a, doc::DistanceBounds_a)
      .field("b", &DistanceBounds::b)
      .field("crossing", &DistanceBounds::crossing, doc::DistanceBounds_crossing)
      .field("farther", &DistanceBounds::farther, doc::DistanceBounds_farther)
      .field("complete", &DistanceBounds::complete, doc::DistanceBounds_complete)
      .field("certified", &DistanceBounds::certified, doc::DistanceBounds_certified)
      .field("sphere_tests", &DistanceBounds::sphere_tests)
      .field("facet_tests", &DistanceBounds::facet_tests);
  struct HeldDistance {
    DistanceQuery query;
    std::mutex mutex;
  };
  const auto run = [](DistanceQuery& query, ColliderGiven ga, ColliderGiven gb, bool exact, double tolerance,
                      const BudgetGiven& budget, double only_within, double near_enough, bool warm_start) {
    const DistanceOptions options{exact, tolerance, budget_of(budget), only_within, near_enough, warm_start, {}};
    const auto a = side_of(ga, "a"), b = side_of(gb, "b");
    const DistanceBounds bounds = without_gil([&] {
      const Reading reading({a.get(), b.get()});
      return query.run(a->current(), b->current(), options);
    });
    require(bounds.status);
    return bounds;
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::initializer_list<std::pair<const char*, const char*>> arguments{
      {"exact", doc::DistanceOptions_exact},
      {"tolerance", doc::DistanceOptions_tolerance},
      {"budget", doc::DistanceOptions_budget},
      {"only_within", doc::DistanceOptions_only_within},
      {"near_enough", doc::DistanceOptions_near_enough}};
  nb::class_<HeldDistance>(m, "DistanceQuery", doc::DistanceQuery)
      .def(nb::init<>())
      .def(
          "run",
          [run](HeldDistance& self, ColliderGiven a, ColliderGiven b, bool exact, double tolerance, BudgetGiven budget,
                double only_within, double near_enough, bool warm_start) {
            std::unique_lock<std::mutex> lock(self.mutex, std::defer_lock);
            without_gil([&] { lock.lock(); });
            return run(self.query, a, b, exact, tolerance, budget, only_within, near_enough, warm_start);
          },
          nb::arg("a"), nb::arg("b"), nb::kw_only(), nb::arg("exact") = true, nb::arg("tolerance") = 0.0,
          nb::arg("budget") = nb::none(), nb::arg("only_within") = infinity, nb::arg("near_enough") = 0.0,
          nb::arg("warm_start") = true, with_arguments(doc::DistanceQuery_run, arguments).c_str());
  m.def(
      "distance",
      [run](ColliderGiven a, ColliderGiven b, bool exact, double tolerance, BudgetGiven budget, double only_within,
            double near_enough) {
        DistanceQuery query;
        return run(query, a, b, exact, tolerance, budget, only_within, near_enough, true);
      },
      nb::arg("a"), nb::arg("b"), nb::kw_only(), nb::arg("exact") = true, nb::arg("tolerance") = 0.0,
      nb::arg("budget") = nb::none(), nb::arg("only_within") = infinity, nb::arg("near_enough") = 0.0,
      with_arguments("Distance of two bodies' surfaces: bounds that hold, with the points that show the upper one.",
                     arguments)
          .c_str());
}

void bind_primitives(nb::module_& m) {
  nb::class_<HalfSpace>(m, "HalfSpace", doc::HalfSpace)
      .def(
          "__init__",
          [](HalfSpace* self, Vec3 normal, double offset) {
            new (self) HalfSpace{normal, offset};
          },
          nb::arg("normal") = Vec3{0, 0, 1}, nb::arg("offset") = 0.0);
  nb::class_<Capsule>(m, "Capsule", doc::Capsule)
      .def(
          "__init__",
          [](Capsule* self, Vec3 p, Vec3 q, double radius) {
            new (self) Capsule{p, q, radius};
          },
          nb::arg("p"), nb::arg("q"), nb::arg("radius"));
  Record<TouchingFacet>(m, "TouchingFacet", doc::TouchingFacet)
      .field("point", &TouchingFacet::point)
      .field("depth", &TouchingFacet::depth, doc::TouchingFacet_depth)
      .field("normal", &TouchingFacet::normal, doc::TouchingFacet_normal);
  Record<Touch>(m, "Touch", "What touch() found.")
      .field("touches", &Touch::touches, doc::Touch_touches)
      .field("clear", &Touch::clear, doc::Touch_clear)
      .field("certified", &Touch::certified, doc::Touch_certified)
      .field("lower", &Touch::lower, doc::Touch_lower)
      .field("deepest", &Touch::deepest, doc::Touch_deepest)
      .field("facets", &Touch::facets, doc::Touch_facets)
      .field("leaves", &Touch::leaves, doc::Touch_leaves)
      .field("sphere_tests", &Touch::sphere_tests)
      .field("facet_tests", &Touch::facet_tests);
  m.def(
      "touch",
      [](ColliderGiven given, ShapeGiven shape, double margin, bool nearest, bool any, bool list) {
        const auto side = side_of(given, "body");
        const TouchOptions options{margin, nearest, any, list};
        return with_shape(shape, [&](const auto& s) {
          return without_gil([&] {
            const Reading reading({side.get()});
            return touch(side->current(), s, options);
          });
        });
      },
      nb::arg("body"), nb::arg("shape"), nb::kw_only(), nb::arg("margin") = 0.0, nb::arg("nearest") = false,
      nb::arg("any") = false, nb::arg("list") = false,
      with_arguments("Does the body's surface touch a half space, a capsule, a ConvexHull or a sphere (x, y, z, "
                     "radius), and where?",
                     {{"margin", doc::TouchOptions_margin},
                      {"nearest", doc::TouchOptions_nearest},
                      {"any", doc::TouchOptions_any},
                      {"list", doc::TouchOptions_list}})
          .c_str());

  Record<RayPoint>(m, "RayPoint", doc::RayPoint)
      .field("t", &RayPoint::t, doc::RayPoint_t)
      .field("point", &RayPoint::point, doc::RayPoint_point)
      .field("normal", &RayPoint::normal, doc::RayPoint_normal);
  Record<RayHit>(m, "RayHit", "What first_hit() found.")
      .field("first", &RayHit::first, doc::RayHit_first)
      .field("certified", &RayHit::certified, doc::RayHit_certified)
      .field("sphere_tests", &RayHit::sphere_tests)
      .field("facet_tests", &RayHit::facet_tests)
      .python()
      .def("__bool__", [](const RayHit& h) { return h.first.has_value(); });
  struct RayHits {
    std::vector<double> t;
    std::vector<std::uint32_t> facet;
    std::vector<Vec3> point, normal;
  };
  Record<RayHits>(m, "RayHits", "First hits of many rays; t is infinite and facet morula.no_node where a ray misses.")
      .property(
          "t", [](nb::handle self) { return numbers(nb::cast<RayHits&>(self).t, self); }, doc::RayPoint_t)
      .property(
          "facet", [](nb::handle self) { return indices(nb::cast<RayHits&>(self).facet, self); }, "(n,) uint32.")
      .property(
          "point", [](nb::handle self) { return points(nb::cast<RayHits&>(self).point, self); }, "(n, 3) float64.")
      .property(
          "normal", [](nb::handle self) { return points(nb::cast<RayHits&>(self).normal, self); }, doc::RayPoint_normal)
      .table([](const RayHits& self) { return self.t.size(); });
  m.def(
      "first_hit",
      [](ColliderGiven given, Vec3 origin, Vec3 direction, double t_end) {
        const auto side = side_of(given, "body");
        return without_gil([&] {
          const Reading reading({side.get()});
          return first_hit(side->current(), Ray{origin, direction, t_end});
        });
      },
      nb::arg("body"), nb::arg("origin"), nb::arg("direction"),
      nb::arg("t_end") = std::numeric_limits<double>::infinity(), doc::RayQuery);
  m.def(
      "first_hits",
      [](ColliderGiven given, ArrayGiven from, ArrayGiven along, double t_end) {
        const auto side = side_of(given, "body");
        const std::vector<Vec3> origins = points_of(from.object, "origins"),
                                directions = points_of(along.object, "directions");
        if (origins.size() != directions.size()) throw std::invalid_argument("directions: one per origin is needed");
        return without_gil([&] {
          const Reading reading({side.get()});
          RayHits hits;
          const RayQuery query;
          SignalCheck check;
          for (std::size_t i = 0; i < origins.size(); ++i) {
            const RayHit hit = query.run(side->current(), {origins[i], directions[i], t_end});
            if (!hit.status) throw std::invalid_argument("ray " + std::to_string(i) + ": " + message(hit.status));
            hits.t.push_back(hit.first ? hit.first->t : std::numeric_limits<double>::infinity());
            hits.facet.push_back(hit.first ? hit.first->point.facet : no_node);
            hits.point.push_back(hit.first ? hit.first->point.point : Vec3{});
            hits.normal.push_back(hit.first ? hit.first->normal : Vec3{});
            if (i % 1024 == 1023) check();
          }
          return hits;
        });
      },
      nb::arg("body"), nb::arg("origins"), nb::arg("directions"),
      nb::arg("t_end") = std::numeric_limits<double>::infinity(),
      "First hits of many rays. origins, directions: (n, 3).");
}

using HeldInside = HeldQuery<InsideQuery, SeenSides>;

void bind_inside(nb::module_& m) {
  Record<PointLocation>(m, "PointLocation", "Where a point is.")
      .field("inside", &PointLocation::inside, doc::PointLocation_inside)
      .field("on_surface", &PointLocation::on_surface, doc::PointLocation_on_surface)
      .field("winding", &PointLocation::winding, doc::PointLocation_winding)
      .field("certified", &PointLocation::certified, doc::PointLocation_certified);
  Record<Probe>(m, "Probe", doc::Probe)
      .field("inside", &Probe::inside, doc::Probe_inside)
      .field("touches", &Probe::touches, doc::Probe_touches)
      .field("distance", &Probe::distance, doc::Probe_distance)
      .field("depth", &Probe::depth, doc::Probe_depth)
      .field("nearest", &Probe::nearest, doc::Probe_nearest)
      .field("normal", &Probe::normal, doc::Probe_normal);
  nb::class_<HeldInside>(m, "InsideQuery", doc::InsideQuery)
      .def(
          "__init__",
          [](HeldInside* self, ColliderGiven body) {
            auto side = side_of(body, "body");
            InsideQuery query = without_gil([&] {
              const Reading reading({side.get()});
              return InsideQuery(side->current());
            });
            new (self) HeldInside(std::move(query), {{std::move(side)}});
          },
          nb::arg("body"), doc::InsideQuery_InsideQuery)
      .def(
          "locate",
          [](HeldInside& self, Vec3 point) {
            const PointLocation location = self.ask([&](InsideQuery& query) { return query.locate(point); });
            require(location.status);
            return location;
          },
          nb::arg("point"), doc::InsideQuery_locate)
      .def(
          "inside",
          [](HeldInside& self, ArrayGiven given) {
            const std::vector<Vec3> points = points_of(given.object, "points");
            auto [values, owner] = kept(self.ask([&](InsideQuery& query) {
              std::vector<std::uint8_t> inside;
              for (const Vec3& p : points) {
                const PointLocation location = query.locate(p);
                require(location.status);
                inside.push_back(location.inside);
              }
              return inside;
            }));
            return View<bool, -1>(reinterpret_cast<const bool*>(values->data()), {values->size()}, owner);
          },
          nb::arg("points"), "Is each point inside the solid or on its surface? points: (n, 3); returns (n,) bool.")
      .def(
          "probe",
          [](HeldInside& self, Sphere ball) {
            const Probe probe = self.ask([&](InsideQuery& query) { return query.probe(ball); });
            require(probe.status);
            return probe;
          },
          nb::arg("ball"), doc::InsideQuery_probe)
      .def_prop_ro("is_oriented", [](const HeldInside& self) { return self.query.is_oriented(); });
  m.def(
      "component_vertices", [](MeshGiven given) { return own_indices(component_vertices(*mesh_of(given))); },
      nb::arg("mesh"), doc::component_vertices);
}

}  // namespace

void bind_collide(nb::module_& m) {
  bind_contacts(m);
  bind_collider(m);
  bind_contact_query(m);
  bind_distance(m);
  bind_primitives(m);
  bind_inside(m);
}

}  // namespace morula::python
