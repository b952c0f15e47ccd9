// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Page: one self-contained HTML file that shows bodies, their spheres in motion, and what was measured of them.
#pragma once

#include <array>
#include <functional>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/rules.hpp>
#include <optional>
#include <string>
#include <vector>

namespace morula {

/// A body of several parts that joints hold together, which the reader moves.
struct PageJoints {
  /// Vertices and spheres that move as one.
  struct Part {
    std::string name;
    std::size_t vertex_begin = 0, vertex_end = 0;
    std::optional<double> protrusion{};  ///< how far its spheres stick out at most, where it has some
  };
  struct Joint {
    enum class Kind { fixed, turns, slides };
    std::string name;
    Kind kind = Kind::fixed;
    std::size_t parent = 0, child = 0;    ///< parts
    RigidTransform origin{};              ///< of the child in the parent, at 0
    Vec3 axis{0, 0, 1};                   ///< unit, in the child
    double lower = 0, upper = 0;          ///< radians or mesh units
    double rest = 0;                      ///< its value in the motion's frame
    std::optional<std::size_t> leader{};  ///< the joint whose value it follows: factor × that + offset
    double factor = 1, offset = 0;
  };
  std::vector<Part> parts;
  std::vector<Joint> joints;  ///< each after the one that carries its parent; every part but one is one's child
  /// Pairs of parts that may overlap; the page names others whose spheres meet. Ascending within a pair.
  std::vector<std::array<std::size_t, 2>> ignored{};
};

/// A mesh, and where its vertices are in every frame.
struct PageMotion {
  std::string body;  ///< what to call the mesh in the page's menus
  std::string name;  ///< and the motion; "rest" when nothing moves
  std::vector<Facet> facets;
  std::vector<std::string> frame_names;
  std::vector<std::vector<Vec3>> frames;  ///< at least one
  std::optional<PageJoints> joints{};     ///< of the only frame; the part that no joint carries stays where it is
};

/// A mark on the picture: where two bodies touch.
struct PageContact {
  Vec3 point;        ///< where the motion's vertices are: in the world
  Vec3 normal;       ///< unit
  double depth = 0;  ///< length of the mark along the normal
};

/// The spheres of a tree that follow one motion by one rule.
struct PageScene {
  std::size_t motion = 0;  ///< index into PageContent::motions
  std::string tree;        ///< what to call it
  std::string rule;
  SphereTree rest;                          ///< with the spheres of the rule at rest: growth counts from their radii
  std::vector<std::vector<Sphere>> frames;  ///< per frame of the motion, one per node
  std::vector<std::vector<LevelMeasure>> measured;  ///< per frame and level; empty when not measured
  /// Per frame and node: share of the sphere's volume outside the body, 0 to 1; empty when not measured.
  std::vector<std::vector<float>> empty_share;
  std::vector<std::vector<PageContact>> contacts{};  ///< per frame of the motion; empty when there is nothing to mark
  bool inside = false;  ///< the spheres are inside the body: the page hides it first, and calls nothing bare
  std::vector<std::uint32_t> parts{};  ///< of a motion with joints: the part of each child of the root
};

/// At least one scene. The page shows the first, and lets the reader choose when there are more.
struct PageContent {
  std::string title;
  std::vector<PageMotion> motions;
  std::vector<PageScene> scenes;
  /// Results of a study (claims, figures, tables, pictures), shown beside the body: the text of a study.json; empty for
  /// none.
  std::string study;
};

/// The spheres of a tree through all frames of a motion, as scene of motion 0; when `measured`, with what the page
/// shows of levels and spheres.
///
/// tree: what to call it. rules: one per level from the root, the last one for all deeper levels. progress: told the
/// share done, or none. Throws std::invalid_argument, naming the frame, for positions that cannot be used.
PageScene follow_motion(const PageMotion& motion, const MeshView& rest, const CoveredTree& model,
                        const std::string& tree, const std::vector<Rule>& rules, bool measured,
                        Workers& workers = serial_workers(), const std::function<void(double)>& progress = {});

/// Spheres that are there already, as scene of motion 0: nothing is updated.
///
/// tree: what to call it. label: what stands in the place of a rule. tree_of_frame: asked for each frame in turn; trees
/// alike but for their spheres.
PageScene show_spheres(const PageMotion& motion, const MeshView& rest, const std::string& tree,
                       const std::string& label, const std::function<SphereTree(std::size_t)>& tree_of_frame,
                       bool measured, Workers& workers = serial_workers(),
                       const std::function<void(double)>& progress = {});

/// Was this library built with the page?
bool has_page();
/// Why it was not, in words that end a sentence; empty when it was.
std::string why_no_page();

/// The page: positions to 1/65535 of the box of all frames, spheres in single precision.
///
/// Throws std::invalid_argument, naming the scene, when sizes do not agree, and when `study` is not the JSON of a study
/// (claims, figures); std::runtime_error when this library was built without the page.
std::string make_page(const PageContent& content);

}  // namespace morula
