// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Robots: links with their shapes, and the joints between them, read from URDF, MJCF and SDF files. Lengths have the
// unit of the file, by convention meters; angles are in radians.
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

/// The index that stands for no link or joint.
inline constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// A geometry of a link. In its own axes, a shape that is not a mesh is centered on the origin; cylinders and capsules
/// lie along z.
struct Shape {
  enum class Kind { mesh, box, cylinder, sphere, capsule, ellipsoid };
  Kind kind = Kind::mesh;
  RigidTransform origin{};     ///< pose in the link's axes
  Vec3 size{};                 ///< lengths of a box's edges or of an ellipsoid's whole axes, mesh units
  double radius = 0;           ///< radius of a cylinder, sphere or capsule, mesh units
  double length = 0;           ///< length of a cylinder, or of a capsule without its caps, mesh units
  std::string file_name;       ///< mesh file as the robot's file names it
  std::filesystem::path file;  ///< path of the mesh file that was found
  Vec3 scale{1, 1, 1};         ///< factors of a mesh's coordinates, before `origin`; negative ones mirror
  int line = 0;                ///< line of the shape in the robot's file
  RigidTransform before{};     ///< transform of a mesh before `scale`
  std::string part{};          ///< name or id of the only node or geometry of a COLLADA file to use; empty: all
  bool part_centered = false;  ///< true: first move the mesh so that its box is centered on the origin
  std::filesystem::path described_in{};  ///< included file that has the shape; empty: the robot's file
};
std::string_view name(Shape::Kind kind);  ///< the name: "mesh", "box", …

/// The mass of a link, in units of the robot's file (kg, kg m²).
struct Inertial {
  double mass = 0;
  RigidTransform origin{};          ///< center of mass, and axes of `inertia`, in the link's axes
  std::array<double, 6> inertia{};  ///< moments xx, xy, xz, yy, yz, zz about the center of mass, along these axes
};

struct Link {
  std::string name;
  std::vector<Shape> collision, visual;
  std::optional<Inertial> inertial;
  std::size_t joint = none;  ///< joint to the parent; none: the root
  int line = 0;              ///< line in the robot's file
};

/// A joint between two links. A revolute joint rotates between limits, a continuous one without; a prismatic joint
/// slides. Floating and planar joints are read and kept at value 0.
struct Joint {
  enum class Kind { fixed, revolute, continuous, prismatic, floating, planar };
  /// The rule of a joint that follows another one: its value is multiplier × value of `joint` + offset.
  struct Mimic {
    std::size_t joint = none;
    double multiplier = 1, offset = 0;
  };
  std::string name;
  Kind kind = Kind::fixed;
  std::size_t parent = none, child = none;  ///< links that the joint connects
  RigidTransform origin{};                  ///< pose of the child in the parent, at value 0
  Vec3 axis{1, 0, 0};                       ///< unit vector in the child
  double lower = 0, upper = 0;              ///< limits of the value, radians or mesh units; −π and π if continuous
  /// False if the file has no limits for a revolute or prismatic joint. Both limits are then 0, but the real joint may
  /// have any value.
  bool range_known = true;
  double velocity = 0, effort = 0;  ///< limits of speed (rad/s or m/s) and of torque or force (N m or N); 0: not given
  std::optional<Mimic> mimic{};     ///< no value: the joint follows no other
  int line = 0;                     ///< line in the robot's file

  /// True if the joint has a value. False for floating and planar joints, which also move, but are kept at value 0.
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
  std::size_t root = none;         ///< index of the link without a parent
  std::vector<std::size_t> order;  ///< indices of all joints, each after the joint to its parent link
  /// Indices of the joints with a value that follow no other joint, in `order`. Their values are a configuration.
  std::vector<std::size_t> independent_joints;
  std::vector<std::string> notes;  ///< skipped or corrected parts of the file, as text
  /// Files that the robot's file includes; those of xacro are the ones that the program lists with `--deps`.
  std::vector<std::filesystem::path> included{};
  std::string expanded{};  ///< the URDF that xacro made of the file; empty: xacro did not run
  /// Names of pairs of links that the file excludes from collision, or connects so that they close a loop.
  std::vector<std::array<std::string, 2>> ignored{};

  std::size_t find_link(std::string_view name) const;   ///< index of the link with this name; `none` if there is none
  std::size_t find_joint(std::string_view name) const;  ///< index of the joint with this name; `none` if there is none
};

struct ReadOptions {
  /// Folders of packages, in which `package://NAME/PATH` is searched first. Meshes and included files must lie in these
  /// folders or in the folders around the robot's file that extras/robot/docs/robot_files.md lists; symbolic links are
  /// resolved first.
  std::vector<std::filesystem::path> package_paths{};
  /// true: the visual shapes are needed, otherwise the collision shapes. A mesh must exist only if it is needed.
  bool visual = false;
  std::set<std::string> skip{};  ///< names of links whose shapes are not needed
  /// Program that expands xacro, a path or a name on PATH; it runs only for files with xacro elements or expressions,
  /// without a shell. xacro evaluates expressions of the file: use it for files that you trust. Empty: none.
  std::string xacro{};
  std::vector<std::string> xacro_arguments{};  ///< arguments of the file, as "NAME:=VALUE"

  /// True if a shape of this link is needed. is_visual: the shape is a visual one.
  bool needs(const std::string& link, bool is_visual) const { return is_visual == visual && skip.count(link) == 0; }
};

/// Reads a robot from a URDF, MJCF or SDF file; the first element of the file determines the format.
///
/// A joint of several degrees of freedom becomes a chain of joints of one degree, with links without shapes between
/// them. In MJCF, Link::collision has the geoms that can collide and Link::visual those of the groups 0 to 2; geoms of
/// the world body are skipped. The root is the body in the world if there is only one and it is free or at the origin,
/// otherwise a link "world".
///
/// Throws FileError, with file, line and remedy, for malformed XML and XML that declares entities; repeated names of
/// links or joints; joints to missing links; links in a circle or without a common root; invalid numbers; a missing
/// mesh that is needed, with all searched places; unsupported elements, by name; and xacro that is not expanded because
/// ReadOptions::xacro is empty, cannot be run or fails. Throws std::invalid_argument for arguments of xacro that are
/// not NAME:=VALUE. Errors of an expanded file name the lines of what xacro made of it.
Robot read_robot(const std::filesystem::path& path, const ReadOptions& options = {});

/// Finds the mesh that a robot's file names, and returns its absolute path. name: the name in the file. line: its line,
/// for the error. package_paths: ReadOptions::package_paths. Throws FileError if there is no such file, with the
/// searched places, or if it is outside the folders where it must lie, with these folders.
std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& robot_file,
                                std::span<const std::filesystem::path> package_paths, int line);

/// The side on which polyhedra approximate cylinders, capsules and ellipsoids.
enum class RoundShapes {
  around,  ///< the polyhedron contains the true shape
  inside,  ///< the true shape contains the polyhedron
};
/// The surface of a link's shapes in the link's axes. Boxes are exact. The surface of a polyhedron is at most 0.3 % of
/// the radius, or of each half axis of an ellipsoid, from that of its round shape. Facets of mirrored meshes are
/// reversed, so that they still face outward.
struct LinkSurface {
  Mesh mesh;                         ///< all shapes except spheres
  std::vector<Sphere> spheres;       ///< the shapes that are spheres: each covers itself
  std::vector<std::string> notes{};  ///< meshes without facets, and parts of meshes that were not read, as text
  /// True if there is neither a facet nor a sphere.
  bool empty() const { return mesh.facets.empty() && spheres.empty(); }
};
/// Reads the meshes of shapes and makes their surface. robot_file: the file that errors name. Throws FileError, with
/// the line of the shape, for a mesh that cannot be read and for a shape with coordinates beyond greatest_usable_scale.
LinkSurface surface_of(const std::filesystem::path& robot_file, std::span<const Shape> shapes,
                       RoundShapes round = RoundShapes::around);

/// The poses of all links in the axes of the root link. values: one per joint of robot.independent_joints, in that
/// order, radians or mesh units; they may exceed the limits. Joints that follow others get their values from these;
/// floating and planar joints stay at 0. Throws std::invalid_argument for another number of values.
std::vector<RigidTransform> link_poses(const Robot& robot, std::span<const double> values);
/// The values of the independent joints at rest: 0 if it is within the limits, otherwise the middle between them.
std::vector<double> rest_values(const Robot& robot);

/// Reads a COLLADA file (.dae): the triangles and polygons of its scene, in meters. Axes stay as in the file (`up_axis`
/// is ignored), as in other tools for robots. Holes of polygons are filled. part: name or id of a node or geometry
/// whose contents alone are read; empty: all. Throws FileError for a file that cannot be read, and if the scene or the
/// part has no facet.
Mesh read_collada(const std::filesystem::path& path, const std::string& part = {});
/// Reads a COLLADA file and writes facts about it, such as filled holes, to `info`.
Mesh read_collada(const std::filesystem::path& path, const std::string& part, MeshInfo& info);

}  // namespace morula::robot
