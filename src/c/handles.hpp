// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the opaque handles of the C interface hold, and how exceptions become status codes.
#pragma once

#include <morula/morula.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/collide/contact_query.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/update/body.hpp>
#include <stdexcept>
#include <string>
#include <vector>

struct morula_mesh {
  std::shared_ptr<const morula::Mesh> mesh;
};

struct morula_model {
  std::shared_ptr<const morula::CoveredTree> model;
};

struct morula_body {
  morula_body(const morula_mesh& of, const morula_model& model, const morula::UpdateOptions& options, unsigned threads)
      : mesh(of.mesh), workers(threads), body(*mesh, model.model, options, workers), collider(*mesh, body) {}

  std::shared_ptr<const morula::Mesh> mesh;
  morula::Workers workers;
  morula::Body body;
  morula::Collider collider;  // borrows mesh and body: a handle never moves
};

struct morula_contacts {
  morula::ContactQuery query;
  std::vector<morula_contact> found;
  bool finished = false;
};

namespace morula::detail {

/// Keeps the words for morula_message() and returns the code.
morula_status fails(morula_status code, const char* words) noexcept;

/// A status of ours, as this interface tells it.
morula_status told(const Status& status);

/// Runs what may throw.
template <class Call>
morula_status guarded(const Call& call) noexcept;

/// Throws std::invalid_argument, naming it, for a pointer that must not be NULL.
inline void require_pointer(const void* pointer, const char* name) {
  if (pointer == nullptr) throw std::invalid_argument(std::string(name) + " is NULL");
}

/// The caller's options over the defaults: as much of the struct as the caller's header knew.
template <class Options>
Options over_defaults(const Options* given, void (*init)(Options*)) {
  Options options;
  init(&options);
  if (given == nullptr) return options;
  if (given->size < sizeof(std::size_t) || given->size > 4096)
    throw std::invalid_argument("options: their size is not set: call the _init function first");
  std::memcpy(&options, given, std::min(given->size, sizeof options));
  options.size = sizeof options;
  return options;
}

/// Threads asked for: 1 or more.
inline unsigned thread_count(int threads) {
  if (threads < 1 || threads > 1024)
    throw std::invalid_argument("threads is " + std::to_string(threads) + ": 1 to 1024 are possible");
  return static_cast<unsigned>(threads);
}

/// The code and words of the exception that is being handled.
morula_status of_current_exception() noexcept;

template <class Call>
morula_status guarded(const Call& call) noexcept {
  try {
    return call();
  } catch (...) {
    return of_current_exception();
  }
}

}  // namespace morula::detail
