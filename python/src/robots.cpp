// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The submodule robot: robots as files describe them, spheres of their links, and what these meet.
#include <algorithm>
#include <morula/morula.hpp>
#include <morula/robot/output.hpp>
#include <morula/robot/robot_tree.hpp>
#include <morula/robot/sphere_robot.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

std::optional<std::size_t> index_or_none(std::size_t index) {
  if (index == robot::none) return std::nullopt;
  return index;
}

/// (n, 3, 4) or (n, 4, 4), or a sequence of RigidTransform.
std::vector<RigidTransform> poses_of(nb::handle given, const char* name) {
  std::vector<RigidTransform> poses;
  if (PyList_Check(given.ptr()) || PyTuple_Check(given.ptr())) {
    for (nb::handle pose : nb::borrow<nb::object>(given)) {
      if (!nb::isinstance<RigidTransform>(pose))
        throw nb::type_error(
            (std::string(name) + ": " + describe(pose) + ", but RigidTransform objects are needed").c_str());
      poses.push_back(nb::cast<RigidTransform>(pose));
    }
    return poses;
  }
  std::vector<std::size_t> shape;
  const std::vector<double> numbers = numbers_of(given, name, {-1, -1, 4}, shape);
  if (shape[1] != 3 && shape[1] != 4)
    throw std::invalid_argument(std::string(name) + ": " + describe(given) +
                                ", but RigidTransform objects or shape (links, 4, 4) is needed");
  for (std::size_t i = 0; i < shape[0]; ++i) {
    RigidTransform pose;
    for (int row = 0; row < 3; ++row) {
      const double* r = &numbers[(i * shape[1] + static_cast<std::size_t>(row)) * 4];
      pose.rows[static_cast<std::size_t>(row)] = {r[0], r[1], r[2]};
      pose.translation[row] = r[3];
    }
    poses.push_back(pose);
  }
  return poses;
}

std::vector<double> values_of(const ArrayGiven& given, const char* name = "values") {
  std::vector<std::size_t> shape;
  return numbers_of(given.object, name, {-1}, shape);
}

std::map<std::string, std::vector<robot::ClipPlane>> clip_of(nb::handle given) {
  std::map<std::string, std::vector<robot::ClipPlane>> clip;
  if (given.is_none()) return clip;
  for (const auto& item : nb::cast<nb::dict>(given)) {
    const auto link = nb::cast<std::string>(item.first);
    const std::string argument = "clip['" + link + "']";
    std::vector<std::size_t> shape;
    const std::vector<double> rows = numbers_of(item.second, argument.c_str(), {-1, 4}, shape);
    for (std::size_t i = 0; i < rows.size(); i += 4)
      clip[link].push_back({{rows[i], rows[i + 1], rows[i + 2]}, rows[i + 3]});
  }
  return clip;
}

robot::RoundShapes round_of(std::string_view text, const char* name) {
  return choice<robot::RoundShapes>(text, name,
                                    {{"around", robot::RoundShapes::around}, {"inside", robot::RoundShapes::inside}});
}

void bind_description(nb::module_& m) {
  using robot::Inertial;
  using robot::Joint;
  using robot::Link;
  using robot::Robot;
  using robot::Shape;
  Record<Shape>(m, "Shape", doc::Shape)
      .property("kind",
                [](const Shape& s) -> std::string {
                  switch (s.kind) {
                    case Shape::Kind::mesh:
                      return "mesh";
                    case Shape::Kind::box:
                      return "box";
                    case Shape::Kind::cylinder:
                      return "cylinder";
                    case Shape::Kind::sphere:
                      return "sphere";
                    case Shape::Kind::capsule:
                      return "capsule";
                    case Shape::Kind::ellipsoid:
                      break;
                  }
                  return "ellipsoid";
                })
      .field("origin", &Shape::origin, doc::Shape_origin)
      .field("size", &Shape::size, doc::Shape_size)
      .field("radius", &Shape::radius, doc::Shape_radius)
      .field("length", &Shape::length, doc::Shape_length)
      .field("file_name", &Shape::file_name, doc::Shape_file_name)
      .field("file", &Shape::file, doc::Shape_file)
      .field("scale", &Shape::scale, doc::Shape_scale)
      .field("line", &Shape::line, doc::Shape_line)
      .field("before", &Shape::before, doc::Shape_before)
      .field("part", &Shape::part, doc::Shape_part)
      .field("part_centered", &Shape::part_centered, doc::Shape_part_centered)
      .field("described_in", &Shape::described_in, doc::Shape_described_in);
  Record<Inertial>(m, "Inertial", "Mass and inertia of a link, as its file gives them.")
      .field("mass", &Inertial::mass)
      .field("origin", &Inertial::origin)
      .field("inertia", &Inertial::inertia, doc::Inertial_inertia);
  Record<Link>(m, "Link", "A link with its shapes.")
      .field("name", &Link::name)
      .field("collision", &Link::collision)
      .field("visual", &Link::visual)
      .field("inertial", &Link::inertial)
      .property(
          "joint", [](const Link& l) { return index_or_none(l.joint); }, "The joint that carries it; None: the root.")
      .field("line", &Link::line);
  Record<Joint::Mimic>(m, "Mimic", "The joint that another follows: value = multiplier * its value + offset.")
      .property("joint", [](const Joint::Mimic& j) { return index_or_none(j.joint); })
      .field("multiplier", &Joint::Mimic::multiplier)
      .field("offset", &Joint::Mimic::offset);
  Record<Joint>(m, "Joint", "A joint between two links.")
      .field("name", &Joint::name)
      .property("kind",
                [](const Joint& j) -> std::string {
                  switch (j.kind) {
                    case Joint::Kind::fixed:
                      return "fixed";
                    case Joint::Kind::revolute:
                      return "revolute";
                    case Joint::Kind::continuous:
                      return "continuous";
                    case Joint::Kind::prismatic:
                      return "prismatic";
                    case Joint::Kind::floating:
                      return "floating";
                    case Joint::Kind::planar:
                      break;
                  }
                  return "planar";
                })
      .property(
          "parent", [](const Joint& j) { return index_or_none(j.parent); }, "A link.")
      .property(
          "child", [](const Joint& j) { return index_or_none(j.child); }, "A link.")
      .field("origin", &Joint::origin, doc::Joint_origin)
      .field("axis", &Joint::axis, doc::Joint_axis)
      .field("lower", &Joint::lower, doc::Joint_lower)
      .field("upper", &Joint::upper, doc::Joint_lower)
      .field("velocity", &Joint::velocity, doc::Joint_velocity)
      .field("effort", &Joint::effort, doc::Joint_velocity)
      .field("mimic", &Joint::mimic)
      .field("line", &Joint::line)
      .python()
      .def_prop_ro(
          "moves", [](const Joint& j) { return j.moves(); }, "Is it revolute, continuous or prismatic?");
  Record<Robot>(m, "Robot", "Links with their shapes, and joints between them; read_robot() reads it.")
      .field("name", &Robot::name)
      .field("file", &Robot::file)
      .property("format",
                [](const Robot& r) -> std::string {
                  return r.format == Robot::Format::urdf ? "urdf" : r.format == Robot::Format::mjcf ? "mjcf" : "sdf";
                })
      .field("links", &Robot::links)
      .field("joints", &Robot::joints)
      .property(
          "root", [](const Robot& r) { return index_or_none(r.root); }, doc::Robot_root)
      .field("order", &Robot::order, doc::Robot_order)
      .field("own", &Robot::own, doc::Robot_own)
      .field("notes", &Robot::notes, doc::Robot_notes)
      .field("included", &Robot::included, doc::Robot_included)
      .field("ignored", &Robot::ignored, doc::Robot_ignored)
      .python()
      .def(
          "find_link", [](const Robot& r, std::string_view name) { return index_or_none(r.find_link(name)); },
          nb::arg("name"), "The index of a link; None: there is none of this name.")
      .def(
          "find_joint", [](const Robot& r, std::string_view name) { return index_or_none(r.find_joint(name)); },
          nb::arg("name"), "The index of a joint; None: there is none of this name.");

  m.def(
      "read_robot",
      [](const FilePath& path, const std::vector<std::filesystem::path>& package_paths, bool visual) {
        return without_gil([&] { return robot::read_robot(path, {package_paths, visual}); });
      },
      nb::arg("path"), nb::kw_only(), nb::arg("package_paths") = std::vector<std::filesystem::path>{},
      nb::arg("visual") = false,
      nb::sig("def read_robot(path: str | os.PathLike[str], *, "
              "package_paths: collections.abc.Sequence[str | os.PathLike[str]] = [], visual: bool = False) -> Robot"),
      with_arguments(doc::read_robot,
                     {{"package_paths", doc::ReadOptions_package_paths}, {"visual", doc::ReadOptions_visual}})
          .c_str());
  m.def(
      "find_mesh",
      [](const std::string& name, const FilePath& robot_file, const std::vector<std::filesystem::path>& package_paths,
         int line) { return robot::find_mesh(name, robot_file, package_paths, line); },
      nb::arg("name"), nb::arg("robot_file"), nb::arg("package_paths") = std::vector<std::filesystem::path>{},
      nb::arg("line") = 0,
      nb::sig("def find_mesh(name: str, robot_file: str | os.PathLike[str], "
              "package_paths: collections.abc.Sequence[str | os.PathLike[str]] = [], line: int = 0) -> pathlib.Path"),
      doc::find_mesh);
  Record<robot::LinkSurface>(m, "LinkSurface", doc::LinkSurface)
      .field("mesh", &robot::LinkSurface::mesh)
      .property("spheres",
                [](nb::handle self) { return sphere_rows(nb::cast<robot::LinkSurface&>(self).spheres, self); });
  m.def(
      "surface_of",
      [](const FilePath& robot_file, const std::vector<Shape>& shapes, std::string_view round) {
        const robot::RoundShapes which = round_of(round, "round");
        return without_gil([&] { return robot::surface_of(robot_file, shapes, which); });
      },
      nb::arg("robot_file"), nb::arg("shapes"), nb::arg("round") = "around",
      with_arguments(doc::LinkSurface,
                     {{"round",
                       "around or inside: do polyhedra contain round shapes, or these them? OSError for "
                       "meshes that cannot be read"}})
          .c_str());
  m.def(
      "link_poses", [](const Robot& robot, ArrayGiven values) { return robot::link_poses(robot, values_of(values)); },
      nb::arg("robot"), nb::arg("values"), doc::link_poses);
  m.def(
      "rest_values", [](const Robot& robot) { return own_numbers(robot::rest_values(robot)); }, nb::arg("robot"),
      doc::rest_values);
  m.def(
      "read_collada",
      [](const FilePath& path, const std::string& part) {
        return std::make_shared<Mesh>(without_gil([&] { return robot::read_collada(path, part); }));
      },
      nb::arg("path"), nb::arg("part") = "", doc::read_collada);
}

void bind_fit(nb::module_& m) {
  using robot::LinkFigures;
  using robot::LinkSpheres;
  using robot::RobotSpheres;
  Record<LinkFigures>(m, "LinkFigures", "What was measured of the spheres of a link.")
      .field("facets", &LinkFigures::facets)
      .field("covered", &LinkFigures::covered, doc::LinkFigures_covered)
      .field("gap", &LinkFigures::gap, doc::LinkFigures_gap)
      .field("protrusion_mean", &LinkFigures::protrusion_mean, doc::LinkFigures_protrusion_mean)
      .field("protrusion_p95", &LinkFigures::protrusion_p95, doc::LinkFigures_protrusion_mean)
      .field("protrusion_max", &LinkFigures::protrusion_max, doc::LinkFigures_protrusion_mean)
      .field("object_volume", &LinkFigures::object_volume, doc::LinkFigures_object_volume)
      .field("outside_volume", &LinkFigures::outside_volume, doc::LinkFigures_outside_volume)
      .field("solid", &LinkFigures::solid, doc::UnionMass)
      .field("mass", &LinkFigures::mass, doc::LinkFigures_mass)
      .field("beyond_clip", &LinkFigures::beyond_clip, doc::LinkFigures_beyond_clip);
  Record<LinkSpheres>(m, "LinkSpheres", "The spheres of a link.")
      .property(
          "link", [](const LinkSpheres& l) { return index_or_none(l.link); }, "An index of Robot.links.")
      .property(
          "spheres", [](nb::handle self) { return sphere_rows(nb::cast<LinkSpheres&>(self).spheres, self); },
          (std::string("(n, 4) float64, read-only; no copy. ") + doc::LinkSpheres_spheres).c_str())
      .property(
          "alike", [](const LinkSpheres& l) { return index_or_none(l.alike); }, doc::LinkSpheres_alike)
      .field("surface", &LinkSpheres::surface)
      .property(
          "tree", [](const LinkSpheres& l) { return std::const_pointer_cast<CoveredTree>(l.tree); },
          doc::LinkSpheres_tree)
      .field("figures", &LinkSpheres::figures)
      .property(
          "inner", [](nb::handle self) { return sphere_rows(nb::cast<LinkSpheres&>(self).inner, self); },
          doc::LinkSpheres_inner)
      .field("inner_volume", &LinkSpheres::inner_volume, doc::LinkSpheres_inner_volume)
      .field("notes", &LinkSpheres::notes);
  Record<RobotSpheres>(m, "RobotSpheres", "Spheres for a robot.")
      .field("links", &RobotSpheres::links, doc::RobotSpheres_links)
      .field("notes", &RobotSpheres::notes, doc::RobotSpheres_notes)
      .property("inner_count", [](const RobotSpheres& r) { return r.inner_count(); })
      .property("sphere_count", [](const RobotSpheres& r) { return r.sphere_count(); })
      .property(
          "covered", [](const RobotSpheres& r) { return r.covered(); }, "Are all links covered, proven?")
      .python()
      .def(
          "with_inner_spheres", [](const RobotSpheres& r) { return r.with_inner_spheres(); },
          doc::RobotSpheres_with_inner_spheres)
      .def(
          "of",
          [](const RobotSpheres& r, std::size_t link) -> std::optional<LinkSpheres> {
            const LinkSpheres* found = r.of(link);
            if (!found) return std::nullopt;
            return *found;
          },
          nb::arg("link"), "The spheres of a link of Robot.links; None where it has none.");
  m.def(
      "fit_spheres",
      [](const robot::Robot& robot, std::size_t spheres, std::size_t total,
         const std::map<std::string, std::size_t>& link_spheres, double max_protrusion, double max_protrusion_share,
         double padding, double min_radius, double max_radius, bool visual, const std::set<std::string>& left_out,
         nb::handle kept_given, std::string_view method, std::string_view quality, std::uint64_t seed, double density,
         nb::handle clip, double clip_margin, std::size_t inner, nb::object progress, Threads* workers) {
        robot::FitOptions options;
        options.spheres = spheres;
        options.total = total;
        options.link_spheres = link_spheres;
        options.max_protrusion = max_protrusion;
        options.max_protrusion_share = max_protrusion_share;
        options.padding = padding;
        options.min_radius = min_radius;
        options.max_radius = max_radius;
        options.visual = visual;
        options.left_out = left_out;
        if (!kept_given.is_none()) {
          for (const auto& item : nb::cast<nb::dict>(kept_given)) {
            const auto link = nb::cast<std::string>(item.first);
            options.kept[link] = spheres_of(item.second, ("kept['" + link + "']").c_str());
          }
        }
        options.method = choice<Method>(method, "method", method_from_name, all_methods());
        options.quality = choice<Quality>(quality, "quality", quality_from_name, all_qualities());
        options.seed = seed;
        options.density = density;
        options.clip = clip_of(clip);
        options.clip_margin = clip_margin;
        options.inner = inner;
        options.progress = [&progress, check = SignalCheck()](double share, const std::string& link) mutable {
          check();
          if (progress.is_none()) return;
          const nb::gil_scoped_acquire gil;
          progress(share, link);
        };
        return without_gil([&] { return robot::fit_spheres(robot, options, CallWorkers(workers)); });
      },
      nb::arg("robot"), nb::kw_only(), nb::arg("spheres") = 16, nb::arg("total") = 0,
      nb::arg("link_spheres") = std::map<std::string, std::size_t>{}, nb::arg("max_protrusion") = 0.0,
      nb::arg("max_protrusion_share") = 0.0, nb::arg("padding") = 0.0, nb::arg("min_radius") = 0.0,
      nb::arg("max_radius") = 0.0, nb::arg("visual") = false, nb::arg("left_out") = std::set<std::string>{},
      nb::arg("kept") = nb::none(), nb::arg("method") = "morula", nb::arg("quality") = "fast", nb::arg("seed") = 1,
      nb::arg("density") = 1000.0, nb::arg("clip") = nb::none(), nb::arg("clip_margin") = 0.0, nb::arg("inner") = 0,
      nb::arg("progress") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig("def fit_spheres(robot: Robot, *, spheres: int = 16, total: int = 0, link_spheres: dict[str, int] = {}, "
              "max_protrusion: float = 0.0, max_protrusion_share: float = 0.0, padding: float = 0.0, "
              "min_radius: float = 0.0, max_radius: float = 0.0, visual: bool = False, left_out: set[str] = set(), "
              "kept: dict[str, morula.typing.FloatArray] | None = None, method: str = 'morula', "
              "quality: str = 'fast', seed: int = 1, density: float = 1000.0, "
              "clip: dict[str, morula.typing.FloatArray] | None = None, clip_margin: float = 0.0, inner: int = 0, "
              "progress: collections.abc.Callable[[float, str], object] | None = None, "
              "workers: morula._morula.Workers | None = None) -> RobotSpheres"),
      with_arguments(doc::fit_spheres, {{"spheres", doc::FitOptions_spheres},
                                        {"total", doc::FitOptions_total},
                                        {"link_spheres", doc::FitOptions_link_spheres},
                                        {"max_protrusion", doc::FitOptions_max_protrusion},
                                        {"max_protrusion_share", doc::FitOptions_max_protrusion_share},
                                        {"padding", doc::FitOptions_padding},
                                        {"min_radius", doc::FitOptions_min_radius},
                                        {"max_radius", doc::FitOptions_max_radius},
                                        {"visual", doc::FitOptions_visual},
                                        {"left_out", doc::FitOptions_left_out},
                                        {"kept", doc::FitOptions_kept},
                                        {"density", doc::FitOptions_density},
                                        {"clip",
                                         "by link, planes (n, 4): normal and offset. What lies beyond one is "
                                         "left out: it need not be covered"},
                                        {"clip_margin", doc::FitOptions_clip_margin},
                                        {"inner", doc::FitOptions_inner},
                                        {"progress", "called with a share and a link now and then"}})
          .c_str());
  Record<robot::RobotMesh>(m, "RobotMesh", doc::RobotMesh)
      .field("mesh", &robot::RobotMesh::mesh)
      .field("links", &robot::RobotMesh::links, doc::RobotMesh_links)
      .field("vertex_begin", &robot::RobotMesh::vertex_begin, doc::RobotMesh_vertex_begin);
  m.def(
      "mesh_of",
      [](const robot::Robot& robot, const RobotSpheres& spheres, ArrayGiven given, std::string_view balls) {
        const std::vector<double> values = values_of(given);
        const robot::RoundShapes round = round_of(balls, "balls");
        return without_gil([&] { return robot::mesh_of(robot, spheres, values, round); });
      },
      nb::arg("robot"), nb::arg("spheres"), nb::arg("values"), nb::arg("balls") = "around",
      with_arguments(doc::RobotMesh, {{"values", "one per joint of robot.own"},
                                      {"balls", "around or inside: which polyhedra stand for them"}})
          .c_str());
  Record<robot::RobotTree>(m, "RobotTree", "One tree over all links of a robot.")
      .property(
          "mesh", [](const robot::RobotTree& t) { return std::make_shared<Mesh>(t.mesh); }, doc::RobotTree_mesh)
      .property(
          "built", [](const robot::RobotTree& t) { return std::make_shared<CoveredTree>(t.built); },
          doc::RobotTree_built)
      .field("links", &robot::RobotTree::links, doc::RobotTree_links)
      .field("vertex_begin", &robot::RobotTree::vertex_begin, doc::RobotTree_vertex_begin);
  m.def(
      "tree_of",
      [](const robot::Robot& robot, const RobotSpheres& spheres, ArrayGiven given, Threads* workers) {
        const std::vector<double> values = values_of(given);
        return without_gil([&] { return robot::tree_of(robot, spheres, values, CallWorkers(workers)); });
      },
      nb::arg("robot"), nb::arg("spheres"), nb::arg("values"), nb::arg("workers") = nb::none(), doc::tree_of);
}

void bind_self_collision(nb::module_& m) {
  using robot::IgnoredPair;
  using robot::SelfCollision;
  Record<IgnoredPair>(m, "IgnoredPair", "Two links that need not be tested against each other, and why.")
      .property(
          "a", [](const IgnoredPair& p) { return index_or_none(p.a); }, doc::IgnoredPair_a)
      .property(
          "b", [](const IgnoredPair& p) { return index_or_none(p.b); }, doc::IgnoredPair_a)
      .property(
          "reason",
          [](const IgnoredPair& p) -> std::string {
            switch (p.reason) {
              case robot::IgnoreReason::given:
                return "given";
              case robot::IgnoreReason::adjacent:
                return "adjacent";
              case robot::IgnoreReason::rest:
                return "rest";
              case robot::IgnoreReason::never:
                break;
            }
            return "never";
          },
          "given, adjacent, rest or never.");
  Record<SelfCollision>(m, "SelfCollision", "Pairs of links that a planner need not test against each other.")
      .field("ignored", &SelfCollision::ignored, doc::SelfCollision_ignored)
      .field("samples", &SelfCollision::samples, doc::SelfCollision_samples)
      .field("pairs", &SelfCollision::pairs, doc::SelfCollision_pairs);
  m.def(
      "find_ignored",
      [](const robot::Robot& robot, const robot::RobotSpheres& spheres, std::size_t samples, std::uint64_t seed,
         const std::vector<std::array<std::string, 2>>& given, Threads* workers) {
        return without_gil([&] {
          return robot::find_ignored(robot, spheres, {samples, seed, given}, CallWorkers(workers));
        });
      },
      nb::arg("robot"), nb::arg("spheres"), nb::kw_only(), nb::arg("samples") = 2000, nb::arg("seed") = 1,
      nb::arg("given") = std::vector<std::array<std::string, 2>>{}, nb::arg("workers") = nb::none(),
      nb::sig("def find_ignored(robot: Robot, spheres: RobotSpheres, *, samples: int = 2000, seed: int = 1, "
              "given: collections.abc.Sequence[collections.abc.Sequence[str]] = [], workers: morula._morula.Workers | "
              "None = None) "
              "-> SelfCollision"),
      with_arguments("Which pairs of links need not be tested against each other.",
                     {{"samples", doc::SelfCollisionOptions_samples}, {"given", doc::SelfCollisionOptions_given}})
          .c_str());
  m.def(
      "overlap",
      [](ArrayGiven a, const RigidTransform& at_a, ArrayGiven b, const RigidTransform& at_b) {
        return robot::overlap(spheres_of(a.object, "a"), at_a, spheres_of(b.object, "b"), at_b);
      },
      nb::arg("a"), nb::arg("at_a"), nb::arg("b"), nb::arg("at_b"),
      "Do the spheres of two links overlap, with the links at these places?");
  m.def(
      "read_ignored_pairs", [](const FilePath& srdf) { return robot::read_ignored_pairs(srdf); }, nb::arg("srdf"),
      doc::read_ignored_pairs);
}

void bind_output(nb::module_& m) {
  using robot::OutputFormat;
  nb::class_<OutputFormat>(m, "OutputFormat", "A format of a robot's spheres, as another program reads them.")
      .def_prop_ro("name", [](const OutputFormat& f) { return std::string(f.name); })
      .def_prop_ro("files", [](const OutputFormat& f) { return std::string(f.files); })
      .def_prop_ro(
          "reader", [](const OutputFormat& f) { return std::string(f.reader); }, doc::OutputFormat_reader)
      .def(
          "write",
          [](const OutputFormat& format, const robot::Robot& robot, const robot::RobotSpheres& spheres,
             const robot::SelfCollision* ignored, const FilePath& folder, const std::vector<std::string>& tool_frames,
             const std::optional<std::filesystem::path>& srdf, std::uint64_t seed, double density, bool inner) {
            robot::OutputOptions options;
            options.folder = folder.path;
            options.tool_frames = tool_frames;
            options.srdf = srdf;
            options.seed = seed;
            options.density = density;
            options.inner = inner;
            const robot::SelfCollision none;
            const auto files = without_gil([&] {
              return format.write({robot, spheres, ignored ? *ignored : none, options});
            });
            nb::dict all;
            for (const robot::OutputFile& file : files)
              all[nb::str(file.name.c_str(), file.name.size())] = nb::bytes(file.bytes.data(), file.bytes.size());
            return all;
          },
          nb::arg("robot"), nb::arg("spheres"), nb::arg("self_collision") = nb::none(), nb::kw_only(),
          nb::arg("folder"), nb::arg("tool_frames") = std::vector<std::string>{}, nb::arg("srdf") = nb::none(),
          nb::arg("seed") = 1, nb::arg("density") = 1000.0, nb::arg("inner") = false,
          nb::sig(
              "def write(self, robot: Robot, spheres: RobotSpheres, self_collision: SelfCollision | None = None, *, "
              "folder: str | os.PathLike[str], tool_frames: collections.abc.Sequence[str] = [], "
              "srdf: str | os.PathLike[str] | None = None, seed: int = 1, density: float = 1000.0, "
              "inner: bool = False) -> dict[str, bytes]"),
          with_arguments("The files, by their names in the folder: nothing is written yet.",
                         {{"folder", doc::OutputOptions_folder},
                          {"tool_frames", doc::OutputOptions_tool_frames},
                          {"srdf", doc::OutputOptions_srdf},
                          {"seed", doc::OutputOptions_seed},
                          {"density", doc::OutputOptions_density},
                          {"inner", doc::OutputOptions_inner}})
              .c_str())
      .def("__repr__",
           [](const OutputFormat& f) { return "<morula.robot.OutputFormat: " + std::string(f.name) + ">"; });
  m.def(
      "output_formats",
      [] {
        const auto all = robot::output_formats();
        return std::vector<OutputFormat>(all.begin(), all.end());
      },
      doc::output_formats);
  m.def(
      "output_format",
      [](std::string_view name) -> std::optional<OutputFormat> {
        const OutputFormat* found = robot::output_format(name);
        if (!found) return std::nullopt;
        return *found;
      },
      nb::arg("name"), "A format by its name; None where there is none.");
  m.def("guess_tool", &robot::guess_tool, nb::arg("robot"), doc::guess_tool);
  m.def(
      "read_robot_spheres",
      [](const FilePath& path) {
        auto read = without_gil([&] { return robot::read_robot_spheres(path); });
        nb::dict all;
        for (auto& [link, spheres] : read) all[nb::str(link.c_str(), link.size())] = own_spheres(std::move(spheres));
        return all;
      },
      nb::arg("path"),
      nb::sig("def read_robot_spheres(path: str | os.PathLike[str]) -> "
              "dict[str, numpy.typing.NDArray[numpy.float64]]"),
      doc::read_robot_spheres);
}

struct HeldRobot {
  robot::SphereRobot robot;
  std::size_t own_count;
  std::mutex mutex;
};

std::shared_ptr<Posed> posed_of(nb::handle given) {
  if (nb::isinstance<PosedBody>(given)) return nb::cast<std::shared_ptr<PosedBody>>(given);
  if (nb::isinstance<PosedRebuilt>(given)) return nb::cast<std::shared_ptr<PosedRebuilt>>(given);
  if (nb::isinstance<PosedRows>(given)) return nb::cast<std::shared_ptr<PosedRows>>(given);
  return nullptr;
}

void bind_sphere_robot(nb::module_& m) {
  using robot::ObstacleBox;
  Record<ObstacleBox> box(m, "ObstacleBox", doc::ObstacleBox);
  box.field("pose", &ObstacleBox::pose).field("half", &ObstacleBox::half, doc::ObstacleBox_half);
  box.python().def(
      "__init__",
      [](ObstacleBox* self, Vec3 half, const RigidTransform& pose) {
        new (self) ObstacleBox{pose, half};
      },
      nb::arg("half"), nb::arg("pose") = RigidTransform{});
  nb::class_<HeldRobot>(m, "SphereRobot", doc::SphereRobot)
      .def(
          "__init__",
          [](HeldRobot* self, const robot::Robot& robot, const robot::RobotSpheres& spheres,
             const robot::SelfCollision* ignored) {
            robot::SphereRobot made = without_gil(
                [&] { return robot::SphereRobot(robot, spheres, ignored ? *ignored : robot::SelfCollision{}); });
            new (self) HeldRobot{std::move(made), robot.own.size(), {}};
          },
          nb::arg("robot"), nb::arg("spheres"), nb::arg("self_collision") = nb::none(), doc::SphereRobot_SphereRobot)
      .def(
          "pose",
          [](HeldRobot& self, ArrayGiven given) {
            const std::vector<double> values = values_of(given);
            const std::scoped_lock lock(self.mutex);
            self.robot.pose(values);
          },
          nb::arg("values"), doc::SphereRobot_pose)
      .def(
          "place",
          [](HeldRobot& self, nb::handle given) {
            const std::vector<RigidTransform> poses = poses_of(given, "link_poses");
            const std::scoped_lock lock(self.mutex);
            self.robot.place(poses);
          },
          nb::arg("link_poses"),
          nb::sig("def place(self, link_poses: collections.abc.Sequence[morula._morula.RigidTransform] | "
                  "morula.typing.FloatArray) -> None"),
          doc::SphereRobot_place)
      .def_prop_ro(
          "links",
          [](const HeldRobot& self) {
            return std::vector<std::size_t>(self.robot.links().begin(), self.robot.links().end());
          },
          doc::SphereRobot_links)
      .def_prop_ro("sphere_count", [](const HeldRobot& self) { return self.robot.sphere_count(); })
      .def(
          "spheres",
          [](HeldRobot& self) {
            const std::scoped_lock lock(self.mutex);
            return own_spheres(self.robot.spheres());
          },
          (std::string("(n, 4) float64. ") + doc::SphereRobot_spheres).c_str())
      .def(
          "self_collision",
          [](HeldRobot& self) {
            return without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              return self.robot.self_collision();
            });
          },
          doc::SphereRobot_self_collision)
      .def(
          "self_collisions",
          [](HeldRobot& self, ArrayGiven given) {
            std::vector<std::size_t> shape;
            const std::vector<double> all =
                numbers_of(given.object, "values", {-1, static_cast<std::int64_t>(self.own_count)}, shape);
            auto [found, owner] = kept(without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              SignalCheck check;
              std::vector<std::uint8_t> collides(shape[0]);
              for (std::size_t i = 0; i < shape[0]; ++i) {
                self.robot.pose(std::span(all).subspan(i * shape[1], shape[1]));
                collides[i] = self.robot.self_collision().has_value();
                if (i % 64 == 63) check();
              }
              return collides;
            }));
            return View<bool, -1>(reinterpret_cast<const bool*>(found->data()), {found->size()}, owner);
          },
          nb::arg("values"),
          "pose() and self_collision() for many configurations, (n, coordinates), in one call: (n,) bool. The robot "
          "stays in the last one.")
      .def(
          "meets",
          [](HeldRobot& self, nb::handle obstacle, const RigidTransform& placement) {
            if (const std::shared_ptr<Posed> posed = posed_of(obstacle)) {
              return without_gil([&] {
                const std::scoped_lock lock(self.mutex);
                const std::shared_lock reading(posed->mutex);
                return self.robot.meets(posed->pose(), placement);
              });
            }
            if (nb::isinstance<ObstacleBox>(obstacle)) {
              const auto& box = nb::cast<const ObstacleBox&>(obstacle);
              const ObstacleBox placed{relative_to(inverse(placement), box.pose), box.half};
              const bool moved = !(placement == RigidTransform{});
              const std::scoped_lock lock(self.mutex);
              return self.robot.meets(moved ? placed : box);
            }
            Sphere sphere;
            if (!nb::try_cast(obstacle, sphere))
              throw nb::type_error(("obstacle: " + describe(obstacle) +
                                    ", but a sphere (x, y, z, radius), an ObstacleBox, a Body, a RebuiltBody or "
                                    "PosedSpheres is needed")
                                       .c_str());
            sphere.center = placement(sphere.center);
            const std::scoped_lock lock(self.mutex);
            return self.robot.meets(sphere);
          },
          nb::arg("obstacle"), nb::arg("placement") = RigidTransform{},
          nb::sig("def meets(self, obstacle: morula.typing.Vector | ObstacleBox | morula._morula.Body | "
                  "morula._morula.RebuiltBody | morula._morula.PosedSpheres, "
                  "placement: morula._morula.RigidTransform = ...) -> bool"),
          (std::string("Does a sphere of the robot meet it? ") + doc::SphereRobot_meets_2).c_str())
      .def_prop_ro(
          "sphere_tests", [](const HeldRobot& self) { return self.robot.sphere_tests(); },
          doc::SphereRobot_sphere_tests)
      .def("__repr__", [](const HeldRobot& self) {
        return "<morula.robot.SphereRobot: " + std::to_string(self.robot.sphere_count()) + " spheres on " +
               std::to_string(self.robot.links().size()) + " links>";
      });
}

}  // namespace

void bind_robots(nb::module_& m) {
  nb::module_ robots = m.def_submodule("robot", "Robots: URDF, MJCF and SDF in, spheres of their links out.");
  bind_description(robots);
  bind_fit(robots);
  bind_self_collision(robots);
  bind_output(robots);
  bind_sphere_robot(robots);
}

}  // namespace morula::python
