// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Held queries: objects that run repeatedly, with the bodies or surfaces that the library borrows for them.
#pragma once

#include <memory>
#include <morula/surface/feature_pairs.hpp>
#include <mutex>
#include <utility>
#include <vector>

#include "docstrings.hpp"
#include "holders.hpp"

namespace morula::python {

/// A query and the objects that it reads, which are kept until it reads others. One call at a time; others wait without
/// the GIL.
///
/// Seen: reading() locks these objects, and throws if they cannot be read.
template <class Query, class Seen>
struct HeldQuery : Exchanging {
  Query query;
  Seen seen;
  std::mutex mutex;

  explicit HeldQuery(Query&& made, Seen&& looked_at = {}) : query(std::move(made)), seen(std::move(looked_at)) {}

  /// f(query, workers) with all objects locked that it needs, without the GIL.
  template <class F>
  auto call(Threads* workers, const F& f) {
    return without_gil(*this, [&] {
      const std::scoped_lock lock(mutex);
      return look(workers, f);
    });
  }
  template <class F>
  auto call(const F& f) {
    return call(nullptr, [&](Query& own, Workers&) { return f(own); });
  }
  /// The same for other objects, which the query reads afterwards; f returns a status. A rejected call changes nothing:
  /// the query may still be resumed where it stood. `next` gets the objects that are not read any longer.
  template <class F>
  auto call_with(Seen& next, Threads* workers, const F& f) {
    return without_gil(*this, [&] {
      const std::scoped_lock lock(mutex);
      std::swap(seen, next);
      const auto status = look(workers, f);
      if (!status) std::swap(seen, next);
      return status;
    });
  }
  /// f(query) with the query alone locked: for its results, which stay valid when the objects change.
  template <class F>
  auto locked(const F& f) {
    return without_gil(*this, [&] {
      const std::scoped_lock lock(mutex);
      return f(query);
    });
  }

  void visit(References& references) const { seen.visit(references); }

 private:
  // Workers before bodies: in this order updates lock them.
  template <class F>
  auto look(Threads* workers, const F& f) {
    CallWorkers threads(workers);
    const auto reading = seen.reading();
    return f(query, static_cast<Workers&>(threads));
  }
};

/// Colliders that a query borrows.
struct SeenSides {
  std::vector<std::shared_ptr<Side>> sides;
  bool exclusive = false;  // the query brings spheres up to date itself

  std::vector<const Side*> all() const {
    std::vector<const Side*> found;
    for (const auto& side : sides) found.push_back(side.get());
    return found;
  }
  /// Throws RuntimeError when a body has changed its tree.
  Reading reading() const {
    Reading locked(all(), exclusive);
    for (const auto& side : sides) side->current();
    return locked;
  }
  void visit(References& references) const {
    for (const auto& side : sides) references(side);
  }
};

/// A function of Python's that options of the library call through copies of their own: nothing once the collector has
/// dropped it.
using Callback = std::shared_ptr<nb::object>;

/// Throws TypeError for an argument that cannot be called. wanted: "None or a function of a number".
inline Callback callback_of(const nb::object& given, const char* name, const char* wanted) {
  if (given.is_none()) return nullptr;
  if (!PyCallable_Check(given.ptr()))
    throw nb::type_error((std::string(name) + ": " + describe(given) + ", but " + wanted + " is needed").c_str());
  return std::make_shared<nb::object>(given);
}

/// Is what `callback` says of these arguments true? True where it has been dropped.
template <class... Args>
bool says(const Callback& callback, const Args&... args) {
  const nb::gil_scoped_acquire gil;
  if (!callback->is_valid()) return true;
  const nb::object answer = (*callback)(args...);
  const int truth = PyObject_IsTrue(answer.ptr());
  if (truth < 0) throw nb::python_error();
  return truth != 0;
}

/// A query of surfaces, with options of which one is a function of Python's.
template <class Query, class Options, class Seen>
struct HeldSurfaceQuery : HeldQuery<Query, Seen> {
  Options options;
  Callback accepts;

  HeldSurfaceQuery(Options&& given, Callback filter)
      : HeldQuery<Query, Seen>(Query(given)), options(std::move(given)), accepts(std::move(filter)) {}

  /// call(query, seen, workers).
  template <class Call>
  SurfaceQueryStatus run(Seen next, Threads* workers, const Call& call) {
    const SurfaceQueryStatus status = this->call_with(next, workers, [&](Query& query, Workers& threads) {
      return or_restart([&] { return call(query, this->seen, threads); });
    });
    require(status);
    return status;
  }
  void visit(References& references) const {
    HeldQuery<Query, Seen>::visit(references);
    if (accepts) references(*accepts);
  }
  void forget() {
    if (accepts) accepts->reset();
  }
  SurfaceQueryStatus resume(Threads* workers) {
    const SurfaceQueryStatus status = this->call(
        workers, [&](Query& query, Workers& threads) { return or_restart([&] { return query.resume(threads); }); });
    require(status);
    return status;
  }

 private:
  /// An exception of a filter or a field ends the query, which then cannot be resumed.
  template <class F>
  SurfaceQueryStatus or_restart(const F& f) {
    try {
      return f();
    } catch (...) {
      this->query = Query(options);
      throw;
    }
  }
};

/// A copy of the results get(query): a list, as the table `Rows`.
template <class Rows, class Held, class Get>
Rows found_by(Held& self, const Get& get) {
  return self.locked([&](auto& query) {
    const auto found = get(query);
    return Rows{{found.begin(), found.end()}};
  });
}

/// set_budget() of whatever has a query with options.
template <class Held>
void bind_set_budget(nb::class_<Held>& type) {
  type.def(
      "set_budget",
      [](Held& self, BudgetGiven budget) {
        const Budget next = budget_of(budget);
        without_gil([&] {
          const std::scoped_lock lock(self.mutex);
          auto options = self.options;
          options.budget = next;
          self.query.set_options(options);
          self.options = std::move(options);
        });
      },
      nb::arg("budget").none(), "For the next call.");
}

/// resume() and set_budget() of a HeldSurfaceQuery.
template <class Held>
void bind_going_on(nb::class_<Held>& type, const char* resume_text) {
  type.def(
      "resume", [](Held& self, Threads* workers) { return self.resume(workers); }, nb::arg("workers") = nb::none(),
      resume_text);
  bind_set_budget(type);
}

}  // namespace morula::python
