// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The contents of the opaque handles of the C interface, and the conversion of exceptions into status codes.
#pragma once

#include <morula/morula.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/containment.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/scene/scene.hpp>
#include <morula/surface/haptic_probe.hpp>
#include <morula/surface/haptic_tool.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/update/body.hpp>
#include <morula/update/skin_bounds.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

struct morula_mesh {
  std::shared_ptr<const morula::Mesh> mesh;
};

struct morula_model {
  std::shared_ptr<const morula::CoveredTree> model;
};

struct morula_skin {
  morula::Skin skin;
};

struct morula_skin_bounds {
  morula::SkinBounds bounds;
  std::vector<morula::AffineTransform> transforms;
};

struct morula_body {
  morula_body(const morula_mesh& of, const morula_model& model, const morula::UpdateOptions& options, unsigned threads)
      : mesh(of.mesh),
        workers(threads),
        transforms(options.skin.bone_count),
        body(*mesh, model.model, options, workers),
        collider(*mesh, body) {}

  std::shared_ptr<const morula::Mesh> mesh;
  morula::Workers workers;
  std::vector<morula::AffineTransform> transforms;  // of the last skinned update, one per bone
  morula::Body body;
  morula::Collider collider;  // borrows mesh and body: a handle never moves
  // The surface for morula_self_crossings and morula_pairs, made by their first call.
  std::optional<morula::SurfaceTree> surface;
  std::uint64_t surface_frame = 0;  // of the collider when the surface followed it last, with surface_transform
  std::optional<morula::RigidTransform> surface_transform;
  morula::SurfaceCrossingQuery self_crossings;
  std::optional<morula::InsideQuery> inside;  // for morula_locate, made by its first call
  // The caller's share of the handle, until morula_body_destroy: scenes hold shares of their own.
  std::shared_ptr<morula_body> of_caller;
};

struct morula_contacts {
  std::shared_ptr<morula_body> a, b;  // declared ahead of the queries, which borrow their colliders for a resume
  morula::ContactQuery query, other;  // other: for a search that may be rejected, while `query` has one to continue
  std::vector<morula_contact> found;
  std::size_t final_count = 0;  // first contacts of `found`, which a resume keeps: the finished ones
  bool finished = false;
};

struct morula_haptic_probe {
  morula::HapticProbe probe;
};

struct morula_haptic_tool {
  morula::HapticTool tool;
  std::vector<morula_tool_contact> contacts;
};

struct morula_scene {
  struct Member {
    std::shared_ptr<morula_body> body;
    morula::BodyId id;
  };
  morula_scene(const morula::SceneOptions& options, unsigned threads) : workers(threads), scene(options) {}

  morula::Workers workers;
  std::vector<Member> members;  // declared ahead of the scene, which borrows their colliders
  morula::Scene scene;
  std::vector<morula_scene_pair> pairs;
  std::vector<morula_contact> contacts;  // contacts of all pairs, one pair after the other
};

namespace morula::detail {

/// Stores the text for morula_message() and returns the code.
morula_status fails(morula_status code, const char* words) noexcept;

/// Converts a status of the library into a code, with its message.
morula_status code_of(const Status& status);
/// The same for a search that cannot continue.
morula_status code_of_resume(const Status& status);

/// Converts a contact of the library.
morula_contact contact_of(const Contact& contact);

/// Runs a call that may throw.
template <class Call>
morula_status guarded(const Call& call) noexcept;

/// Throws std::invalid_argument, naming it, for a pointer that must not be NULL.
inline void require_pointer(const void* pointer, const char* name) {
  if (pointer == nullptr) throw std::invalid_argument(std::string(name) + " is NULL");
}

inline void copy(const Vec3& from, double* to) {
  to[0] = from.x, to[1] = from.y, to[2] = from.z;
}

/// A path from UTF-8, which on Windows need not be the encoding of narrow paths.
inline std::filesystem::path path_of(const char* text) {
  return reinterpret_cast<const char8_t*>(text);
}

/// Writes defaults into a struct of the caller's header. It may have fewer fields than ours, or more, which become 0.
template <class Options, class Fill>
void write_defaults(Options* options, std::size_t size, const Fill& fill) {
  if (options == nullptr || size < sizeof(std::size_t)) return;
  Options defaults;
  std::memset(&defaults, 0, sizeof defaults);
  fill(defaults);
  defaults.size = size;
  std::memset(options, 0, size);
  // mutant c-options-size: `std::min(size, sizeof defaults)` -> `sizeof defaults`
  std::memcpy(options, &defaults, std::min(size, sizeof defaults));
}

/// The caller's options over the defaults: the part of the struct that the caller's header declares.
template <class Options>
Options over_defaults(const Options* given, void (*write)(Options*, std::size_t)) {
  Options options;
  write(&options, sizeof options);
  if (given == nullptr) return options;
  if (given->size < sizeof(std::size_t) || given->size > 4096)
    throw std::invalid_argument("options: their size is not set: call the _init function first");
  std::memcpy(&options, given, std::min(given->size, sizeof options));
  options.size = sizeof options;
  return options;
}

/// Transforms of bones from the rows of their matrices, 12 numbers each.
void read_transforms(const double* rows, std::span<morula::AffineTransform> transforms);

/// The requested number of threads, 1 or more.
inline unsigned thread_count(int threads) {
  if (threads < 1 || threads > 1024)
    throw std::invalid_argument("threads is " + std::to_string(threads) + ": 1 to 1024 are possible");
  return static_cast<unsigned>(threads);
}

/// The code and message of the exception that is being handled.
morula_status of_current_exception() noexcept;

template <class Call>
morula_status guarded(const Call& call) noexcept {
  try {
    return call();
  } catch (...) {
    return of_current_exception();
  }
}

/// A number of tests or a time, of which a negative one is none. tests_name: of the number in messages. Throws
/// std::invalid_argument if both are set.
inline Budget budget_of(std::int64_t tests, std::int64_t nanoseconds, const char* tests_name) {
  if (tests >= 0 && nanoseconds >= 0)
    throw std::invalid_argument(std::string(tests_name) + " and nanoseconds are both set: one budget at a time");
  if (tests >= 0) return tests;
  if (nanoseconds >= 0) return std::chrono::nanoseconds(nanoseconds);
  return {};
}

/// The surface of a body at its present positions and transform, in `result`; or the code of a rejection.
morula_status surface_of(morula_body& body, const SurfaceTree*& result);

/// Level, margin and budget, for CollideOptions and SceneOptions alike. Throws std::invalid_argument.
template <class Options>
Options contact_options(const morula_contact_options* given) {
  const morula_contact_options wanted = over_defaults(given, &morula_contact_options_defaults);
  Options options;
  options.margin = wanted.margin;
  if (wanted.level < -1) throw std::invalid_argument("level is below -1");
  if (wanted.level >= 0) options.level = static_cast<std::uint32_t>(wanted.level);
  options.budget = budget_of(wanted.pair_tests, wanted.nanoseconds, "pair_tests");
  return options;
}

}  // namespace morula::detail
