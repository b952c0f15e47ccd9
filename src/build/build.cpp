// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <morula/build/build.hpp>
#include <stdexcept>

#include "build/top_down.hpp"

namespace morula {
namespace {

struct Entry {
  Method method;
  std::string_view name;
  Built (*build)(const Mesh&, const BuildOptions&, Workers&);
};
constexpr std::array<Entry, 3> entries{{
    {Method::octree, "octree", build_octree},
    {Method::grid, "grid", build_grid},
    {Method::morula, "morula", build_own},
}};
constexpr std::array<Method, entries.size()> methods{Method::octree, Method::grid, Method::morula};

const Entry& entry(Method method) {
  for (const Entry& e : entries)
    if (e.method == method) return e;
  throw std::invalid_argument("build: unknown method");
}

}  // namespace

std::string_view name(Method method) {
  return entry(method).name;
}

std::optional<Method> method_from_name(std::string_view wanted) {
  for (const Entry& e : entries)
    if (e.name == wanted) return e.method;
  return std::nullopt;
}

std::span<const Method> all_methods() {
  return methods;
}

Built build(const Mesh& mesh, const BuildOptions& options, Workers& workers) {
  const Entry& chosen = entry(options.method);
  if (options.branching < 2 || options.branching > max_branching)
    throw std::invalid_argument("build: branching " + std::to_string(options.branching) + " is not in 2…64");
  if (options.depth < 0 || options.depth > max_depth)
    throw std::invalid_argument("build: depth " + std::to_string(options.depth) + " is not in 0…8");
  require_usable(mesh);
  return chosen.build(mesh, options, workers);
}

}  // namespace morula
