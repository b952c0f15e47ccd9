// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Page: one self-contained HTML file that shows bodies, their spheres in motion, and their measurements.
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

/// A body of several parts that are connected by joints, which the reader can move.
struct PageJoints {
  /// Vertices and spheres that move as one rigid part.
  struct Part {
    std::string name;
    std::size_t vertex_begin = 0, vertex_end = 0;
    std::optional<double> protrusion{};  ///< largest protrusion of its spheres, mesh units; no value without spheres
  };
  struct Joint {
    enum class Kind { fixed, turns, slides };
    std::string name;
    Kind kind = Kind::fixed;
    std::size_t parent = 0, child = 0;    ///< parts that the joint connects
    RigidTransform origin{};              ///< pose of the child in the parent, at value 0
    Vec3 axis{0, 0, 1};                   ///< unit vector in the child
    double lower = 0, upper = 0;          ///< limits, radians or mesh units
    double rest = 0;                      ///< value in the motion's frame
    std::optional<std::size_t> leader{};  ///< joint whose value it follows: factor × value + offset
    double factor = 1, offset = 0;
  };
  std::vector<Part> parts;
  std::vector<Joint> joints;  ///< each after the joint of its parent; every part except one is the child of a joint
  /// Pairs of parts that may overlap, ascending within a pair; the page reports other pairs whose spheres overlap.
  std::vector<std::array<std::size_t, 2>> ignored{};
};

/// A mesh, and the positions of its vertices in every frame.
struct PageMotion {
  std::string body;  ///< name of the mesh in the page's menus
  std::string name;  ///< name of the motion; "rest" if nothing moves
  std::vector<Facet> facets;
  std::vector<std::string> frame_names;
  std::vector<std::vector<Vec3>> frames;  ///< at least one frame
  std::optional<PageJoints> joints{};     ///< joints of the only frame; the part without a joint is fixed
};

/// A mark in the picture at a contact of two bodies.
struct PageContact {
  Vec3 point;        ///< position in the coordinates of the motion's vertices: the world
  Vec3 normal;       ///< unit vector
  double depth = 0;  ///< length of the mark along the normal, mesh units
};

/// The spheres of a tree that follow one motion by one rule.
struct PageScene {
  std::size_t motion = 0;  ///< index in PageContent::motions
  std::string tree;        ///< name of the tree
  std::string rule;
  SphereTree rest;                          ///< tree with the rule's spheres at rest; growth is relative to their radii
  std::vector<std::vector<Sphere>> frames;  ///< per frame of the motion, one per node
  std::vector<std::vector<LevelMeasure>> measured;  ///< per frame and level; empty if not measured
  /// Share of the sphere's volume outside the body per frame and node, 0 to 1; empty if not measured.
  std::vector<std::vector<float>> empty_share;
  std::vector<std::vector<PageContact>> contacts{};  ///< per frame of the motion; empty if there are no marks
  /// The spheres are inside the body: the page first hides the body, and reports no uncovered surface.
  bool inside = false;
  std::vector<std::uint32_t> parts{};  ///< for a motion with joints: the part of each child of the root
};

/// The content of a page, at least one scene. The page shows the first scene; the reader can select others.
struct PageContent {
  std::string title;
  std::vector<PageMotion> motions;
  std::vector<PageScene> scenes;
  /// Results of a study (claims, figures, tables, pictures), shown next to the body: the text of a study.json; empty
  /// for none.
  std::string study;
};

/// The spheres of a tree through all frames of a motion, as scene of motion 0; if `measured`, with the page's
/// measurements of levels and spheres.
///
/// tree: name of the tree. rules: one per level from the root; the last rule serves all deeper levels. progress: called
/// with the completed share; may be empty. Throws std::invalid_argument, naming the frame, for positions that cannot be
/// used.
PageScene follow_motion(const PageMotion& motion, const MeshView& rest, const CoveredTree& model,
                        const std::string& tree, const std::vector<Rule>& rules, bool measured,
                        Workers& workers = serial_workers(), const std::function<void(double)>& progress = {});

/// Existing spheres as scene of motion 0, without updates.
///
/// tree: name of the tree. label: text in place of a rule. tree_of_frame: called for each frame in turn; all trees are
/// the same except for their spheres.
PageScene show_spheres(const PageMotion& motion, const MeshView& rest, const std::string& tree,
                       const std::string& label, const std::function<SphereTree(std::size_t)>& tree_of_frame,
                       bool measured, Workers& workers = serial_workers(),
                       const std::function<void(double)>& progress = {});

/// True if this library was built with the page.
bool has_page();
/// The reason if it was not, as the end of a sentence; empty if it was.
std::string why_no_page();

/// The page as HTML: positions to 1/65535 of the box of all frames, spheres in single precision.
///
/// Throws std::invalid_argument, naming the scene, if sizes disagree, and if `study` is not the JSON of a study
/// (claims, figures); throws std::runtime_error if this library was built without the page.
std::string make_page(const PageContent& content);

}  // namespace morula
