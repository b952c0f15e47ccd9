// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Engines of the rules that move a body's spheres, each for the nodes of one rule or of a few akin.
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

/// One frame, as engines see it.
struct RuleFrame {
  Vec3 origin{};                         ///< of the spheres
  std::span<const LocalPoint> points{};  ///< none where no level looks at them
  Rounding rounding{};                   ///< of the points
  const ModalPose* modes = nullptr;      ///< of an update by coordinates
  const BonePose* bones = nullptr;       ///< of an update by transforms
};

/// Rules of a tree; the body's plan settles them before anything is bound.
struct TreeRules {
  std::vector<Rule> of_level{};
  std::vector<Rule> of_node{};  ///< what each node follows: that of its level, but where a leaf has nothing to read
};

/// What poses the nodes of some rules; the body makes it before any engine. Null where it has no such model.
struct Posers {
  ModalPoser* modal;  ///< the engine of `modal` adds the rows of its nodes
  const SkinPoser* skin;
};

/// What a body is made from, while it is being made; the body fills it once, before its first engine.
struct Binding {
  MeshView mesh;
  const CoveredTree& model;
  const UpdateOptions& options;
  const TreeRules& rules;
  const LeafOrder& order;
  const Ownership& ownership;
  const TriangleBvh* bvh;    ///< of the mesh; none where no node follows a link
  const LocalPoints& local;  ///< at rest
  const RuleFrame& rest;     ///< without modes and bones
  Posers posers;
  std::span<const Spheref> tree_spheres;  ///< the tree's, about the rest origin
  std::span<Spheref> spheres;  ///< at rest: engines write those of their nodes; nobody has written the tree's
  BindReport& report;
  Workers& workers;
};

class RuleEngine {
 public:
  virtual ~RuleEngine() = default;
  virtual std::unique_ptr<RuleEngine> clone() const = 0;

  /// First of a frame: writes the spheres of its nodes that look at no other sphere, of the tree's nodes before
  /// node_end, which are whole levels.
  virtual void update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
                      Workers& workers) noexcept = 0;
  /// Then, for one level after the other from the deepest up: those of its nodes that read their children, whatever
  /// engine has written these.
  virtual void update_level(std::size_t /*level*/, const RuleFrame& /*frame*/, std::span<Spheref> /*spheres*/,
                            Workers& /*workers*/) noexcept {}

  /// Points that all its nodes look at in a frame.
  virtual std::size_t tested_points() const { return 0; }

  /// Can update() take fewer levels than all, and update_one() the other nodes, where no other engine is?
  virtual bool is_lazy() const { return false; }
  /// One node, in the frame of the last update().
  virtual void update_one(std::uint32_t /*node*/, const RuleFrame& /*frame*/, std::span<Spheref> /*spheres*/) noexcept {
  }
  /// Points that the tree's nodes before node_end look at.
  virtual std::size_t tested_points(std::size_t /*node_end*/) const { return 0; }

  /// Is there less to do where few vertices have moved? Then update_changed() takes the place of update().
  virtual bool follows_changes() const { return false; }
  /// Only these blocks of vertices differ from the frame before. Returns how many points were tested.
  virtual std::size_t update_changed(const RuleFrame& /*frame*/, const Marks& /*changed_blocks*/,
                                     std::span<Spheref> /*spheres*/) noexcept {
    return 0;
  }

  /// A node's sphere, where the engine serves it and needs no points for that.
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
