// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Engines of the rules that move a body's spheres, each for the nodes of one rule or of a few similar ones.
#pragma once

#include <memory>
#include <morula/parallel/workers.hpp>
#include <morula/query/triangle_bvh.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/body.hpp>
#include <optional>
#include <span>
#include <vector>

#include "update/points/local_points.hpp"
#include "update/points/ownership.hpp"

namespace morula::detail {

class ModalPoser;
struct ModalPose;
class SkinPoser;
struct BonePose;

/// One frame, as input of the engines.
struct RuleFrame {
  Vec3 origin{};                         ///< origin of the spheres
  std::span<const LocalPoint> points{};  ///< points of the frame; empty if no level reads them
  Rounding rounding{};                   ///< rounding of the points
  const ModalPose* modes = nullptr;      ///< modes of an update by coordinates; null otherwise
  const BonePose* bones = nullptr;       ///< bones of an update by transforms; null otherwise
};

/// Rules of a tree; the body's plan decides them before any engine is bound.
struct TreeRules {
  std::vector<Rule> of_level{};
  std::vector<Rule> of_node{};  ///< rule of each node: that of its level, except for leaves without anything to read
};

/// Posers of the nodes of some rules; the body makes them before any engine. Null if the body has no such model.
struct Posers {
  ModalPoser* modal;  ///< the engine of `modal` adds the rows of its nodes
  SkinPoser* skin;    ///< the engine of `skinned` adds the rest data of its nodes
};

/// Inputs of engines while a body is made; the body fills them once, before its first engine.
struct Binding {
  MeshView mesh;
  const CoveredTree& model;
  const UpdateOptions& options;
  const TreeRules& rules;
  const LeafOrder& order;
  const Ownership& ownership;
  const TriangleBvh* bvh;    ///< index of the mesh's facets; null if no node follows a link
  const LocalPoints& local;  ///< points at rest
  const RuleFrame& rest;     ///< frame at rest, without modes and bones
  Posers posers;
  std::span<const Spheref> tree_spheres;  ///< spheres of the tree, about the rest origin
  std::span<Spheref>
      spheres;  ///< spheres at rest: engines write those of their nodes; no engine has written the tree's
  BindReport& report;
  Workers& workers;
};

class RuleEngine {
 public:
  virtual ~RuleEngine() = default;
  virtual std::unique_ptr<RuleEngine> clone() const = 0;

  /// First step of a frame: writes the spheres of those of its nodes that read no other sphere, among the tree's nodes
  /// before node_end, which are whole levels.
  virtual void update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
                      Workers& workers) noexcept = 0;
  /// Second step, for one level after the other from the deepest up: writes the spheres of those of its nodes that read
  /// their children, which any engine may have written.
  virtual void update_level(std::size_t /*level*/, const RuleFrame& /*frame*/, std::span<Spheref> /*spheres*/,
                            Workers& /*workers*/) noexcept {}

  /// Number of points that all its nodes test in a frame.
  virtual std::size_t tested_points() const { return 0; }
  /// Points that the engine moves by itself in a frame.
  struct MovedPoints {
    std::size_t vertices = 0, cut_points = 0;
  };
  virtual MovedPoints moved_points() const { return {}; }

  /// Whether update() can run for fewer levels than all, and update_one() for the other nodes, if there is no other
  /// engine.
  virtual bool is_lazy() const { return false; }
  /// Updates one node, in the frame of the last update().
  virtual void update_one(std::uint32_t /*node*/, const RuleFrame& /*frame*/, std::span<Spheref> /*spheres*/) noexcept {
  }
  /// Number of points that the tree's nodes before node_end test.
  virtual std::size_t tested_points(std::size_t /*node_end*/) const { return 0; }

  /// Whether an update costs less if few vertices have moved. Then update_changed() replaces update().
  virtual bool follows_changes() const { return false; }
  /// Updates after a change of only these blocks of vertices since the last frame. Returns how many points were tested.
  virtual std::size_t update_changed(const RuleFrame& /*frame*/, const Marks& /*changed_blocks*/,
                                     std::span<Spheref> /*spheres*/) noexcept {
    return 0;
  }

  /// A node's sphere, if the engine serves it and needs no points for that.
  virtual std::optional<Spheref> sphere_alone(std::uint32_t /*node*/, const RuleFrame& /*frame*/) const noexcept {
    return std::nullopt;
  }
};

/// Engines of a body, in the order in which they are bound and run. A value: copies are independent.
class EngineList {
 public:
  EngineList() = default;
  EngineList(const EngineList& other) {
    for (const auto& engine : other.engines_) engines_.push_back(engine->clone());
  }
  EngineList(EngineList&&) noexcept = default;
  EngineList& operator=(const EngineList&) = delete;
  EngineList& operator=(EngineList&&) noexcept = default;
  ~EngineList() = default;

  void add(std::unique_ptr<RuleEngine> engine) { engines_.push_back(std::move(engine)); }
  std::size_t size() const { return engines_.size(); }
  RuleEngine& operator[](std::size_t i) const { return *engines_[i]; }
  auto begin() const { return engines_.begin(); }
  auto end() const { return engines_.end(); }

 private:
  std::vector<std::unique_ptr<RuleEngine>> engines_;
};

}  // namespace morula::detail
