// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Robots: links with their shapes, joints between them, as URDF, MJCF and SDF describe them.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/io/mesh_file.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula::robot {

inline constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// A geometry of a link. A cylinder and a capsule lie along z about the origin.
struct Shape {
  enum class Kind { mesh, box, cylinder, sphere, capsule, ellipsoid };
  Kind kind = Kind::mesh;
  RigidTransform origin{};               ///< in the link; a mesh is scaled first and placed then
  Vec3 size{};                           ///< of a box, whole edges; of an ellipsoid, whole axes
  double radius = 0;                     ///< of a cylinder, sphere, capsule
  double length = 0;                     ///< of a cylinder; of a capsule without its caps
  std::string file_name;                 ///< of a mesh, as it is written
  std::filesystem::path file;            ///< of a mesh, where it was found
  Vec3 scale{1, 1, 1};                   ///< of a mesh; negative numbers mirror
  int line = 0;                          ///< of the robot's file
  RigidTransform before{};               ///< of a mesh: what moves it before it is scaled
  std::string part{};                    ///< of a mesh: the only node of its scene that is meant; empty: all
  bool part_centered = false;            ///< its box is centered on the origin before everything else
  std::filesystem::path described_in{};  ///< the file that describes it, where the robot's file includes others
};
std::string_view name(Shape::Kind kind);  ///< "mesh", "box", …

struct Inertial {
  double mass = 0;
  RigidTransform origin{};
  std::array<double, 6> inertia{};  ///< xx, xy, xz, yy, yz, zz about the center, along the origin's axes
};

struct Link {
  std::string name;
  std::vector<Shape> collision, visual;
  std::optional<Inertial> inertial;
  std::size_t joint = none;  ///< the joint that carries it; none: the root
  int line = 0;
};

struct Joint {
  enum class Kind { fixed, revolute, continuous, prismatic, floating, planar };
  struct Mimic {
    std::size_t joint = none;
    double multiplier = 1, offset = 0;
  };
  std::string name;
  Kind kind = Kind::fixed;
  std::size_t parent = none, child = none;  ///< links
  RigidTransform origin{};                  ///< of the child in the parent, at 0
  Vec3 axis{1, 0, 0};                       ///< unit, in the child
  double lower = 0, upper = 0;              ///< radians or mesh units; of a continuous joint −π and π
  /// False where the file gives a joint that turns or slides no usable range: it is held at 0, and the real one may
  /// stand anywhere.
  bool range_known = true;
  double velocity = 0, effort = 0;  ///< 0: not given
  std::optional<Mimic> mimic{};
  int line = 0;

  bool moves() const { return kind == Kind::revolute || kind == Kind::continuous || kind == Kind::prismatic; }
};
std::string_view name(Joint::Kind kind);  ///< as URDF has it: "fixed", "revolute", …

struct Robot {
  enum class Format { urdf, mjcf, sdf };
  std::string name;
  std::filesystem::path file;
  Format format = Format::urdf;
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::size_t root = none;         ///< link
  std::vector<std::size_t> order;  ///< joints, each after the one that carries its parent
  std::vector<std::size_t>
      independent_joints;          ///< joints that move and follow no other: the coordinates of a configuration
  std::vector<std::string> notes;  ///< what was passed over, in words
  std::vector<std::filesystem::path> included{};  ///< files that the robot's file includes
  std::vector<std::array<std::string, 2>>
      ignored{};  ///< pairs of links that the file itself excludes from collision, or joins into a loop

  std::size_t find_link(std::string_view name) const;   ///< none: there is none
  std::size_t find_joint(std::string_view name) const;  ///< none: there is none
};

struct ReadOptions {
  /// Folders that hold packages: `package://NAME/PATH` is looked for in them first. They, and the folders around the
  /// robot's file that extras/robot/docs/robot_files.md lists, are the only ones that its meshes and included files may
  /// lie in, after links are resolved.
  std::vector<std::filesystem::path> package_paths{};
  bool visual = false;  ///< the visual shapes are needed, not those of collision: only needed meshes have to be there
  std::set<std::string> skip{};  ///< links whose shapes are not needed

  bool needs(const std::string& link, bool is_visual) const { return is_visual == visual && skip.count(link) == 0; }
};

/// Reads a URDF, MJCF or SDF, as the first element says. Throws FileError, with file, line and remedy: XML that is
/// broken or declares entities, a link or joint twice, joints to links that are not there, links in a circle or without
/// a common root, numbers that are none, a mesh that is missing, with all places where it was searched, and elements
/// that are not supported, by name.
///
/// Joints of several degrees of freedom become chains of single ones with links in between that have no shapes. Of
/// MJCF, `collision` are the geoms that collide and `visual` those of groups 0 to 2, and what belongs to the world is
/// passed over; the root is the only body of the world where it is free or stands in its origin, else a link "world".
Robot read_robot(const std::filesystem::path& path, const ReadOptions& options = {});

/// Where a mesh named in a robot's file is; throws FileError that lists the places searched, or says which folders it
/// lies outside of.
std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& robot_file,
                                std::span<const std::filesystem::path> package_paths, int line);

/// Which polyhedra stand for cylinders, capsules and ellipsoids.
enum class RoundShapes {
  around,  ///< they contain the true shapes
  inside,  ///< the true shapes contain them
};
/// A link's surface in the link's own axes: meshes scaled, then placed; facets of mirrored ones turned round. Boxes are
/// exact. The polyhedra of round shapes differ from these by at most 0.3 % of the radius, of ellipsoids of each half
/// axis. Spheres are apart: they are their own cover.
struct LinkSurface {
  Mesh mesh;
  std::vector<Sphere> spheres;
  std::vector<std::string> notes{};  ///< of meshes: those without a facet, and what is not read of the others
  bool empty() const { return mesh.facets.empty() && spheres.empty(); }
};
/// Throws FileError for meshes that cannot be read.
LinkSurface surface_of(const std::filesystem::path& robot_file, std::span<const Shape> shapes,
                       RoundShapes round = RoundShapes::around);

/// Where the links are, in the root's axes. values: one per joint of robot.independent_joints, in that order. Joints
/// that follow others are computed; floating and planar ones stay at 0.
std::vector<RigidTransform> link_poses(const Robot& robot, std::span<const double> values);
/// The middle between the limits where 0 is outside of them, else 0.
std::vector<double> rest_values(const Robot& robot);

/// COLLADA: triangles and polygons of the scene, in its units turned to meters; axes as written, as robots' tools take
/// them. Holes of polygons are filled. Not all of it where a part is named: what is below the nodes, or belongs to the
/// geometries, of this name or id. Throws FileError, also where there is no such part.
Mesh read_collada(const std::filesystem::path& path, const std::string& part = {});
/// The same, with what a user may have to know about the file.
Mesh read_collada(const std::filesystem::path& path, const std::string& part, MeshInfo& info);

}  // namespace morula::robot
