// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Do two bodies overlap, which of their facets cross, and walks of one's own down both trees.
#include <morula/morula.hpp>
#include <optional>

#include "contacts.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

void bind_crossings(nb::module_& m) {
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
              require_rows(of_b.size(), of_a.size(), "nodes[1]", 0, "those of nodes[0]");
              for (std::size_t i = 0; i < of_a.size(); ++i) pairs.push_back({of_a[i], of_b[i]});
            }
            Crossings found;
            const bool all = nodes.is_none();
            const Status status = without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              const Reading reading({a.get(), b.get()});
              const Status result =
                  all ? self.query.run(a->current(), b->current()) : self.query.run(a->current(), b->current(), pairs);
              if (result) found.pairs.assign(self.query.pairs().begin(), self.query.pairs().end());
              return result;
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
        // The wait is without the GIL: a thread that holds the bodies may need it.
        std::optional<Reading> reading;
        without_gil([&] { reading.emplace(std::vector<const Side*>{a.get(), b.get()}); });
        return walk_pairs(a->current(), b->current(), {level, margin}, [&](NodePair pair, bool is_final) {
          const nb::object step = visit(pair.a, pair.b, is_final);
          if (step.is_none()) return Step::open;
          return choice<Step>(returned<std::string_view>(step, "visit", "None or a text"), "visit",
                              {{"open", Step::open}, {"skip", Step::skip}, {"stop", Step::stop}});
        });
      },
      nb::arg("a"), nb::arg("b"), nb::arg("visit"), nb::kw_only(), nb::arg("level") = nb::none(),
      nb::arg("margin") = 0.0,
      nb::sig("def walk_pairs(a: morula.typing.ColliderLike, b: morula.typing.ColliderLike, "
              "visit: collections.abc.Callable[[int, int, bool], str | None], *, level: int | None = None, margin: "
              "float = 0.0) -> int"),
      "Walks down the tree of node pairs. visit(node_a, node_b, is_final) is called for each pair whose spheres are no "
      "farther apart than the margin, and returns None or 'open', 'skip' or 'stop'. Returns the number of pair tests. "
      "visit must not update the bodies.");
}

}  // namespace morula::python
