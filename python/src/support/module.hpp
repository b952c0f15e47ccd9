// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The parts of the extension, each of one subject.
#pragma once

#include <nanobind/nanobind.h>

namespace morula::python {

void bind_accuracy(nanobind::module_& m);
void bind_build(nanobind::module_& m);
void bind_collide(nanobind::module_& m);
void bind_command(nanobind::module_& m);
void bind_files(nanobind::module_& m);
void bind_grains(nanobind::module_& m);
void bind_io(nanobind::module_& m);
void bind_meshes(nanobind::module_& m);
void bind_motion(nanobind::module_& m);
void bind_obstacles(nanobind::module_& m);
void bind_page(nanobind::module_& m);
void bind_robots(nanobind::module_& m);
void bind_scene(nanobind::module_& m);
void bind_shapes(nanobind::module_& m);
void bind_solids(nanobind::module_& m);
void bind_study(nanobind::module_& m);
void bind_surface(nanobind::module_& m);
void bind_topology(nanobind::module_& m);
void bind_tree(nanobind::module_& m);
void bind_update(nanobind::module_& m);

}  // namespace morula::python
