// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Holders: the library's objects with their additions for Python: locks, since updates run without the GIL, and the
// arrays and objects that the library borrows.
#pragma once

#include <chrono>
#include <memory>
#include <morula/collide/budget.hpp>
#include <morula/collide/collider.hpp>
#include <morula/morula.hpp>
#include <morula/parallel/interrupt.hpp>
#include <mutex>
#include <shared_mutex>
#include <span>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "collected.hpp"

namespace morula::python {

/// Throws the exception of an interruption: to be called from time to time with the GIL.
inline void check_signals() {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

/// Acquires the GIL at most every 20 ms, to check whether Ctrl-C was pressed.
class SignalCheck {
 public:
  /// To be called without the GIL. Throws the exception that the signal's handler has raised.
  void operator()() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(20)) return;
    last_ = now;
    const nb::gil_scoped_acquire gil;
    check_signals();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Runs f without the GIL. Ctrl-C ends the work of f with the exception of its handler: KeyboardInterrupt.
template <class F>
auto without_gil(const F& f) {
  const nb::gil_scoped_release released;
  SignalCheck check;
  const Interrupt interrupt([&check] { check(); });
  return f();
}

/// The same for a call that may exchange what `holder` keeps of Python.
template <class F>
auto without_gil(const Exchanging& holder, const F& f) {
  const Exchanging::Call call(holder);
  return without_gil(f);
}

/// A pool of threads, for one call at a time; others wait.
struct Threads {
  Workers workers;
  std::mutex mutex;

  explicit Threads(unsigned count) : workers(count) {}
};

/// The workers of a call: the given ones; otherwise the caller's own thread, or one per processor for long functions.
/// Made without the GIL.
class CallWorkers {
 public:
  explicit CallWorkers(Threads* threads) {
    if (threads) {
      lock_ = std::unique_lock(threads->mutex);
      workers_ = &threads->workers;
    } else {
      workers_ = &serial_workers();
    }
  }
  operator Workers&() { return *workers_; }
  operator WorkersOrAll() { return lock_ ? WorkersOrAll(*workers_) : WorkersOrAll(); }

 private:
  std::unique_lock<std::mutex> lock_;
  Workers* workers_;
};

/// Throws ValueError with the words of a status that is not ok.
inline void require(const Status& status) {
  if (!status) throw std::invalid_argument(message(status));
}

/// The object that colliders read: spheres that may move.
struct Posed {
  virtual ~Posed() = default;
  virtual const SphereState& sphere_state() const = 0;
  /// The body whose spheres these are; nothing of spheres without one.
  virtual Body* body() { return nullptr; }
  /// Counts changes of the tree itself, whose colliders are then out of date.
  virtual std::uint64_t tree_version() const { return 0; }

  /// The positions that the body borrows: none or one.
  virtual std::span<const Positions> borrowed() const { return {}; }

  std::uint64_t frame() const { return sphere_state().frame + (tree_version() << 40); }

  mutable std::shared_mutex mutex;
};

struct PosedBody : Posed {
  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<const CoveredTree> model;  // which the body borrows
  std::unique_ptr<Body> owned;
  std::vector<Positions> last;  // what the body borrows until the next update: none or one

  void visit(References& references) const {
    references(mesh);
    references(model);
  }
  const SphereState& sphere_state() const override { return owned->sphere_state(); }
  std::span<const Positions> borrowed() const override { return last; }
  Body* body() override { return owned.get(); }
};

struct PosedRebuilt : Posed {
  std::shared_ptr<const Mesh> mesh;
  std::unique_ptr<RebuiltBody> owned;
  std::vector<Positions> last;

  void visit(References& references) const { references(mesh); }
  const SphereState& sphere_state() const override { return owned->body().sphere_state(); }
  std::span<const Positions> borrowed() const override { return last; }
  Body* body() override { return const_cast<Body*>(&owned->body()); }
  std::uint64_t tree_version() const override { return owned->tree_version(); }
};

struct PosedRows : Posed {
  std::unique_ptr<PosedSpheres> owned;
  const SphereState& sphere_state() const override { return owned->sphere_state(); }
};

/// A collider and what it borrows.
struct Side {
  std::shared_ptr<Posed> posed;
  std::shared_ptr<const Mesh> mesh;          // or none
  std::shared_ptr<const CoveredTree> model;  // or none
  std::unique_ptr<Collider> collider;
  std::uint64_t tree_version = 0;
  std::vector<Positions> given;  // none or one

  void visit(References& references) const {
    references(posed);
    references(mesh);
    references(model);
  }
  /// Throws RuntimeError when the body has changed its tree.
  const Collider& current() const {
    if (posed->tree_version() != tree_version) {
      throw std::runtime_error("the body was rebuilt and has another tree: make another Collider");
    }
    return *collider;
  }
};

/// Locks the sides that a query reads. To be made without the GIL.
class Reading {
 public:
  /// exclusive: the query brings spheres up to date itself.
  explicit Reading(std::vector<const Side*> sides, bool exclusive = false);

 private:
  std::vector<std::shared_lock<std::shared_mutex>> shared_;
  std::vector<std::unique_lock<std::shared_mutex>> exclusive_;
};

/// A collider, or a body that becomes one for this call.
std::shared_ptr<Side> side_of(const ColliderGiven& given, const char* name);
/// The same for a holder that keeps it: always an object of Python's, through which the collector sees the body.
std::shared_ptr<Side> kept_side_of(const ColliderGiven& given, const char* name);

/// Calls f with the half space, capsule, convex hull or sphere that is given. Throws TypeError for anything else.
template <class F>
auto with_shape(const ShapeGiven& given, const F& f) {
  if (nb::isinstance<HalfSpace>(given.object)) return f(nb::cast<HalfSpace>(given.object));
  if (nb::isinstance<Capsule>(given.object)) return f(nb::cast<Capsule>(given.object));
  if (nb::isinstance<ConvexHull>(given.object)) return f(nb::cast<const ConvexHull&>(given.object));
  Sphere sphere;
  if (!nb::try_cast(given.object, sphere)) {
    throw nb::type_error(("shape: " + describe(given.object) +
                          ", but a HalfSpace, a Capsule, a ConvexHull or a sphere (x, y, z, radius) is needed")
                             .c_str());
  }
  return f(sphere);
}

/// The transform of a matrix (4, 4) or (3, 4) that acts on columns. Throws ValueError or TypeError.
RigidTransform matrix_transform(nb::handle given, const char* name);
/// A RigidTransform, a matrix, or three numbers: a translation. Throws ValueError or TypeError.
RigidTransform transform_of(const TransformGiven& given, const char* name = "transform");

/// None: unlimited; an integer: pair tests; a datetime.timedelta or a text such as "200us": time.
Budget budget_of(const BudgetGiven& given, const char* name = "budget");

template <class Value>
std::vector<std::string> names_of(std::span<const Value> values) {
  std::vector<std::string> all;
  for (const Value& value : values) all.emplace_back(name(value));
  return all;
}

/// The value that a text names. Throws ValueError with the names there are.
template <class Value, class Find, class All>
Value choice(std::string_view text, const char* argument, const Find& find, const All& all) {
  if (const auto found = find(text)) return *found;
  std::string known;
  for (const auto& value : all) known += (known.empty() ? "" : ", ") + std::string(name(value));
  throw std::invalid_argument(std::string(argument) + ": '" + std::string(text) + "', but there are only " + known);
}
template <class Value>
Value choice(std::string_view text, const char* argument, std::initializer_list<std::pair<const char*, Value>> all) {
  std::string known;
  for (const auto& [word, value] : all) {
    if (text == word) return value;
    known += (known.empty() ? "" : ", ") + std::string(word);
  }
  throw std::invalid_argument(std::string(argument) + ": '" + std::string(text) + "', but there are only " + known);
}

}  // namespace morula::python
