// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Robots: links with their shapes, and the joints between them, from URDF, MJCF and SDF.
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
  RigidTransform origin{};               ///< pose in the link; a mesh is scaled first and placed then
  Vec3 size{};                           ///< edges of a box, axes of an ellipsoid, full lengths
  double radius = 0;                     ///< radius of a cylinder, sphere or capsule
  double length = 0;                     ///< length of a cylinder, or of a capsule without its caps
  std::string file_name;                 ///< mesh file as the robot's file names it
  std::filesystem::path file;            ///< mesh file that was found
  Vec3 scale{1, 1, 1};                   ///< scale of a mesh; negative numbers mirror
  int line = 0;                          ///< line in the robot's file
  RigidTransform before{};               ///< transform of a mesh ahead of its scale
  std::string part{};                    ///< the only node of a mesh's scene that is used; empty: all nodes
  bool part_centered = false;            ///< center the box of this part on the origin first
  std::filesystem::path described_in{};  ///< the file of the shape, if the robot's file includes others
};
std::string_view name(Shape::Kind kind);  ///< the name: "mesh", "box", …

struct Inertial {
  double mass = 0;
  RigidTransform origin{};
  std::array<double, 6> inertia{};  ///< moments xx, xy, xz, yy, yz, zz about the center, along the origin's axes
};

struct Link {
  std::string name;
  std::vector<Shape> collision, visual;
  std::optional<Inertial> inertial;
  std::size_t joint = none;  ///< joint to the parent; none: the root
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
  std::size_t parent = none, child = none;  ///< links that the joint connects
  RigidTransform origin{};                  ///< pose of the child in the parent, at value 0
  Vec3 axis{1, 0, 0};                       ///< unit vector in the child
  double lower = 0, upper = 0;              ///< limits, radians or mesh units; −π and π for a continuous joint
  /// False if the file gives no usable range for a rotating or sliding joint: it is kept at 0, and the real joint may
  /// have any value.
  bool range_known = true;
  double velocity = 0, effort = 0;  ///< 0 if not given
  std::optional<Mimic> mimic{};
  int line = 0;

  bool moves() const { return kind == Kind::revolute || kind == Kind::continuous || kind == Kind::prismatic; }
};
std::string_view name(Joint::Kind kind);  ///< the name in URDF: "fixed", "revolute", …

struct Robot {
  enum class Format { urdf, mjcf, sdf };
  std::string name;
  std::filesystem::path file;
  Format format = Format::urdf;
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::size_t root = none;         ///< root link
  std::vector<std::size_t> order;  ///< joints, each after the joint of its parent
  /// Moving joints that follow no other joint: the coordinates of a configuration.
  std::vector<std::size_t> independent_joints;
  std::vector<std::string> notes;                 ///< skipped parts of the file, as text
  std::vector<std::filesystem::path> included{};  ///< files that the robot's file includes
  /// Pairs of links that the file excludes from collision, or joins into a loop.
  std::vector<std::array<std::string, 2>> ignored{};

  std::size_t find_link(std::string_view name) const;   ///< returns `none` if there is no such link
  std::size_t find_joint(std::string_view name) const;  ///< returns `none` if there is no such joint
};

struct ReadOptions {
  /// Folders of packages: `package://NAME/PATH` is searched in them first. Meshes and included files must lie in these
  /// folders, or in the folders around the robot's file that extras/robot/docs/robot_files.md lists, after links are
  /// resolved.
  std::vector<std::filesystem::path> package_paths{};
  bool visual = false;           ///< visual instead of collision shapes are needed; only needed meshes have to exist
  std::set<std::string> skip{};  ///< links whose shapes are not needed

  bool needs(const std::string& link, bool is_visual) const { return is_visual == visual && skip.count(link) == 0; }
};

/// Reads a URDF, MJCF or SDF; the first element of the file determines the format. Throws FileError, with file, line
/// and remedy: malformed XML or XML that declares entities, a repeated link or joint, joints to missing links, links in
/// a circle or without a common root, invalid numbers, a missing mesh (with all searched places), and unsupported
/// elements (by name).
///
/// Joints of several degrees of freedom become chains of single joints, with links without shapes in between. In MJCF,
/// `collision` are the geoms that collide and `visual` the geoms of groups 0 to 2; geoms of the world are skipped. The
/// root is the only body of the world if it is free or at the origin, otherwise a link "world".
Robot read_robot(const std::filesystem::path& path, const ReadOptions& options = {});

/// The path of a mesh that a robot's file names. Throws FileError that lists the searched places, or the folders that
/// the mesh must lie in.
std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& robot_file,
                                std::span<const std::filesystem::path> package_paths, int line);

/// The polyhedra that approximate cylinders, capsules and ellipsoids.
enum class RoundShapes {
  around,  ///< polyhedra that contain the true shapes
  inside,  ///< polyhedra inside the true shapes
};
/// A link's surface in the link's own axes: meshes are scaled, then placed; facets of mirrored meshes are reversed.
/// Boxes are exact. The polyhedra of round shapes differ from these by at most 0.3 % of the radius, or of each half
/// axis of an ellipsoid. Spheres are separate, because they are their own cover.
struct LinkSurface {
  Mesh mesh;
  std::vector<Sphere> spheres;
  std::vector<std::string> notes{};  ///< notes on meshes: meshes without facets, and unread parts of the others
  bool empty() const { return mesh.facets.empty() && spheres.empty(); }
};
/// The surface of a link's shapes. Throws FileError for meshes that cannot be read.
LinkSurface surface_of(const std::filesystem::path& robot_file, std::span<const Shape> shapes,
                       RoundShapes round = RoundShapes::around);

/// Poses of the links in the root's axes. values: one per joint of robot.independent_joints, in that order. Joints that
/// follow others are computed; floating and planar joints stay at 0.
std::vector<RigidTransform> link_poses(const Robot& robot, std::span<const double> values);
/// Rest values of the independent joints: 0 if the limits allow it, otherwise the middle between them.
std::vector<double> rest_values(const Robot& robot);

/// Reads COLLADA: triangles and polygons of the scene, converted to meters; axes as in the file, like other robot
/// tools. Holes of polygons are filled. part: a name or id; only the contents of its nodes and geometries are read.
/// Throws FileError, also for a missing part.
Mesh read_collada(const std::filesystem::path& path, const std::string& part = {});
/// Reads COLLADA, with facts about the file for the user.
Mesh read_collada(const std::filesystem::path& path, const std::string& part, MeshInfo& info);

}  // namespace morula::robot
