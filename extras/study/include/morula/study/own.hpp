// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One's own rules, generators and metrics: entries of a plan that the study treats like its own.
#pragma once

#include <functional>
#include <memory>
#include <morula/geometry/mesh.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace morula::study {

// Names appear in tables and in names of files: letters, digits, "_", "-" and "." only, each once per kind.
// version: cells are cached under it, so change it with the code; cells of an entry without a version are not cached.
// Functions are called on several threads at once, an object of a rule on one at a time.

/// Spheres that follow one motion of one body.
class OwnFollower {
 public:
  virtual ~OwnFollower() = default;
  /// The tree with its spheres at these positions, one per vertex. Frames come in the order of the motion, and then the
  /// first one again.
  virtual SphereTree follow(const std::vector<Vec3>& positions) = 0;
};

struct OwnRule {
  std::string name;
  std::string version;
  std::function<std::unique_ptr<OwnFollower>(const Mesh& rest, const CoveredTree& model)> make;
};

/// A rule of one's own. make: (const Mesh&, const CoveredTree&) → object with SphereTree follow(const
/// std::vector<Vec3>&). Mesh and tree outlive the object.
template <class Make>
std::shared_ptr<const OwnRule> own_rule(std::string name, Make make, std::string version = {}) {
  using Object = decltype(make(std::declval<const Mesh&>(), std::declval<const CoveredTree&>()));
  struct Held final : OwnFollower {
    explicit Held(Object given) : object(std::move(given)) {}
    SphereTree follow(const std::vector<Vec3>& positions) override { return object.follow(positions); }
    Object object;
  };
  return std::make_shared<const OwnRule>(
      OwnRule{std::move(name), std::move(version),
              [make = std::move(make)](const Mesh& rest, const CoveredTree& model) -> std::unique_ptr<OwnFollower> {
                return std::make_unique<Held>(make(rest, model));
              }});
}

struct OwnGenerator {
  std::string name;
  std::string version;
  std::function<CoveredTree(const Mesh&)> build;
};

/// A generator of one's own. build: const Mesh& → CoveredTree or SphereTree; cover() makes the latter cover.
template <class Build>
std::shared_ptr<const OwnGenerator> own_generator(std::string name, Build build, std::string version = {}) {
  return std::make_shared<const OwnGenerator>(
      OwnGenerator{std::move(name), std::move(version), [build = std::move(build)](const Mesh& mesh) -> CoveredTree {
                     if constexpr (std::is_convertible_v<decltype(build(mesh)), CoveredTree>)
                       return build(mesh);
                     else
                       return cover(mesh, build(mesh), {}, serial_workers());
                   }});
}

/// A measurement of a level's spheres. A value that is not finite counts as none.
struct OwnMetric {
  std::string name;
  std::string unit;
  std::function<double(const Mesh& deformed, std::span<const Sphere> spheres, std::size_t level)> value;
  std::string version{};
};

}  // namespace morula::study
