// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Page: an HTML file that needs no other file and no network, and shows bodies, their spheres in motion, and
// measurements.
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

/// A body of several rigid parts, connected by joints that the reader of the page can move.
struct PageJoints {
  /// A rigid part: vertices that move together, with the spheres that PageScene::parts assigns to it.
  struct Part {
    std::string name;
    std::size_t vertex_begin = 0, vertex_end = 0;  ///< the part has the vertices [vertex_begin, vertex_end)
    std::optional<double> protrusion{};  ///< largest protrusion of its spheres, mesh units; no value without spheres
    /// Its spheres in the part's axes, as a file stores them. The reader can edit the spheres of parts that have some.
    std::vector<Sphere> spheres{};
    std::vector<Sphere>
        balls{};  ///< spheres among its shapes, in the part's axes; each lies in one sphere of the cover
  };
  struct Joint {
    enum class Kind { fixed, turns, slides };
    std::string name;
    Kind kind = Kind::fixed;
    std::size_t parent = 0, child = 0;    ///< indices of the parts that the joint connects
    RigidTransform origin{};              ///< pose of the child in the parent's axes, at value 0
    Vec3 axis{0, 0, 1};                   ///< unit vector in the child's axes
    double lower = 0, upper = 0;          ///< limits of the value: radians if it turns, mesh units if it slides
    double rest = 0;                      ///< value in the only frame of the motion
    std::optional<std::size_t> leader{};  ///< index of the joint that it follows; no value: the reader sets its value
    double factor = 1, offset = 0;        ///< value of a following joint: factor × value of the leader + offset
  };
  std::vector<Part> parts;
  /// Joints, each after the joint of its parent part. Every part except one is the child of one joint.
  std::vector<Joint> joints;
  /// Pairs of parts that may overlap, the lower index first. The page reports the overlap of spheres of other pairs.
  std::vector<std::array<std::size_t, 2>> ignored{};
  std::vector<std::string> reasons{};  ///< the reason of each ignored pair, as text; empty: none is given
  std::string command{};  ///< command line that certifies saved spheres, as text for the reader; empty: none is shown
};

/// A mesh, and the positions of its vertices in every frame.
struct PageMotion {
  std::string body;  ///< name of the mesh in the page's menus
  std::string name;  ///< name of the motion; "rest" if nothing moves
  std::vector<Facet> facets;
  std::vector<std::string> frame_names;
  std::vector<std::vector<Vec3>> frames;  ///< positions of all vertices, for at least one frame
  std::optional<PageJoints> joints{};     ///< parts and joints of a motion of one frame; no value: none
};

/// A mark in the picture at a contact of two bodies.
struct PageContact {
  Vec3 point;        ///< position, in the coordinates of the motion's vertices
  Vec3 normal;       ///< direction of the mark, a unit vector
  double depth = 0;  ///< length of the mark, mesh units
};

/// A facet of which the region of a contact patch contains the whole or a part.
struct PagePatchFacet {
  std::uint32_t facet;  ///< index in PageMotion::facets
  double share = 1;     ///< share of the facet's area in the region, 0 to 1
};

/// The contact patches of a frame: the page fills their facets with a color and draws the curves.
struct PagePatches {
  struct Patch {
    double volume = 0, depth = 0;  ///< mesh units³, mesh units
    std::vector<PagePatchFacet> facets;
  };
  std::vector<Patch> patches;
  std::vector<std::array<Vec3, 2>> curves;  ///< segments in which the surfaces cross, in the vertices' coordinates
};

/// The spheres of one tree during one motion, with their measurements.
struct PageScene {
  std::size_t motion = 0;  ///< index in PageContent::motions
  std::string tree;        ///< name of the tree in the page's menus
  std::string rule;        ///< name of the rule of its spheres
  SphereTree rest;         ///< tree with the rule's spheres at rest; the page shows growth relative to their radii
  std::vector<std::vector<Sphere>> frames;          ///< for each frame of the motion, the spheres of all nodes
  std::vector<std::vector<LevelMeasure>> measured;  ///< for each frame, the measures of all levels; empty: not measured
  /// For each frame and node, the share of the sphere's volume outside the body, 0 to 1; empty: not measured.
  std::vector<std::vector<float>> empty_share;
  std::vector<std::vector<PageContact>> contacts{};  ///< for each frame, its marks; empty: no frame has marks
  std::vector<PagePatches> patches{};                ///< for each frame, its contact patches; empty: not computed
  /// true: the spheres are inside the body and do not cover it. The page then opens without the body, and reports no
  /// uncovered surface.
  bool inside = false;
  std::vector<std::uint32_t> parts{};  ///< for a motion with joints: the index of the part of each child of the root
};

/// The content of a page: at least one scene. The page opens with the first scene, and the reader can select others.
struct PageContent {
  std::string title;
  std::vector<PageMotion> motions;
  std::vector<PageScene> scenes;
  /// The text of a study.json, whose claims, figures, tables and pictures the page shows next to the body; empty: none.
  std::string study;
};

/// Updates a body of the model through all frames of a motion, and returns its spheres as a scene of motion 0.
/// measured: true adds the measurements of levels and of single spheres, which takes far longer than the updates.
///
/// rest: the mesh at rest. tree: name of the tree in the page. rules: one per level from the root; the last rule serves
/// all deeper levels. progress: called on the calling thread with the completed share, 0 to 1; may be empty. Throws
/// std::invalid_argument, with the frame, for positions that Body::update() rejects, and like the constructor of Body.
PageScene follow_motion(const PageMotion& motion, const MeshView& rest, const CoveredTree& model,
                        const std::string& tree, const std::vector<Rule>& rules, bool measured,
                        Workers& workers = serial_workers(), const std::function<void(double)>& progress = {});

/// Returns existing spheres as a scene of motion 0, without updates.
///
/// tree: name of the tree in the page. label: text in place of the name of a rule. tree_of_frame: called for frame 0,
/// 1, … in this order; it returns the tree with the spheres of that frame, and all trees are the same except for their
/// spheres. measured, progress: as for follow_motion().
PageScene show_spheres(const PageMotion& motion, const MeshView& rest, const std::string& tree,
                       const std::string& label, const std::function<SphereTree(std::size_t)>& tree_of_frame,
                       bool measured, Workers& workers = serial_workers(),
                       const std::function<void(double)>& progress = {});

/// True if this library was built with the page, which make_page() needs.
bool has_page();
/// The reason why this library was built without the page, as the end of a sentence; empty if it was built with it.
std::string why_no_page();

/// The page as the text of an HTML file. It stores positions to 1/65535 of the box of all frames, and spheres in float.
///
/// Throws std::invalid_argument, with the motion or scene, if sizes disagree, for content without a scene, and if
/// `study` is not the JSON of a study (claims, figures). Throws std::runtime_error if this library was built without
/// the page.
std::string make_page(const PageContent& content);

}  // namespace morula
