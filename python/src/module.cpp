// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The extension morula._morula: everything of the library, under the same names.
#include "module.hpp"

#include <morula/io/files.hpp>
#include <morula/morula.hpp>
#include <stdexcept>
#include <string>
#include <typeinfo>

#include "calls.hpp"
#include "holders.hpp"
#include "records.hpp"
#include "text.hpp"

namespace morula::python {
namespace {

/// Raises the OSError that Python has for the system's error, with its number and the file.
void raise_os_error(const SystemFileError& error) {
  const std::string file = error.file().string();
  // Python shows the file next to the problem.
  const std::string problem = error.what() + file.size() + 2;
  const nb::object made = nb::handle(PyExc_OSError)(error.error(), python_text(problem), python_text(file));
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
}

void raise(PyObject* kind, const char* message) {
  PyErr_SetObject(kind, python_text(message).ptr());
}

}  // namespace

}  // namespace morula::python

NB_MODULE(_morula, m) {
  using namespace morula;
  using namespace morula::python;
  m.doc() = "Certified sphere trees for deforming triangle meshes: the compiled part of the package morula.";
  m.attr("version") = morula::version;
  // NumPy keeps arrays that others hold when the interpreter ends, so a mesh whose positions a body follows is still
  // there then. nanobind would print a report of that for the user of any such program.
  nb::set_leak_warnings(false);

  nb::register_exception_translator([](const std::exception_ptr& p, void*) {
    try {
      std::rethrow_exception(p);
    } catch (const SystemFileError& error) {
      raise_os_error(error);
    } catch (const FileError& error) {
      raise(PyExc_OSError, error.what());
    } catch (const std::invalid_argument& error) {
      raise(PyExc_ValueError, error.what());
    } catch (const std::bad_cast&) {
      PyErr_SetString(PyExc_TypeError, "an argument is of another type than is needed");
    }
  });
  nb::exception<BuildStopped>(m, "BuildStopped", PyExc_RuntimeError).doc() = doc::BuildStopped;

  nb::class_<Threads>(m, "Workers", "A pool of threads. Results do not depend on its size.")
      .def(nb::init<unsigned>(), nb::arg("thread_count") = 0, doc::Workers_Workers_2)
      .def_prop_ro("thread_count", [](const Threads& self) { return self.workers.thread_count(); })
      .def("__repr__", [](const Threads& self) {
        return "Workers(thread_count=" + std::to_string(self.workers.thread_count()) + ")";
      });

  bind_meshes(m);
  bind_sphere_tree(m);
  bind_cover(m);
  bind_covered_tree(m);
  bind_build(m);
  bind_choices(m);
  bind_motion(m);
  bind_spheres_view(m);
  bind_rules(m);
  bind_body(m);
  bind_rebuilt_body(m);
  bind_posed_spheres(m);
  bind_kdop_tree(m);
  bind_skin_bounds(m);
  bind_looseness_estimate(m);
  bind_shapes(m);
  bind_power_diagram(m);
  bind_accuracy(m);
  bind_mass(m);
  bind_contacts(m);
  bind_collider(m);
  bind_contact_patches(m);
  bind_contact_query(m);
  bind_crossings(m);
  bind_distance(m);
  bind_moving_spheres(m);
  bind_touch(m);
  bind_rays(m);
  bind_inside(m);
  bind_haptic_probe(m);
  bind_haptic_tool(m);
  bind_scene_results(m);
  bind_scene_class(m);
  bind_broad_phase(m);
  bind_surface_tree(m);
  bind_pair_records(m);
  bind_layer_patch_records(m);
  bind_pair_queries(m);
  bind_pairs(m);
  bind_obstacles(m);
  bind_solids(m);
  bind_topology(m);
  bind_io(m);
  bind_streams(m);
  bind_files(m);
  bind_extras(m);
#ifdef MORULA_PYTHON_COMMAND
  bind_command(m);
  bind_batch(m);
#endif
  name_arguments(m);
}
