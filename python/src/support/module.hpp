// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The parts of the extension, each of one subject.
#pragma once

#include <nanobind/nanobind.h>

namespace morula::python {

void bind_accuracy(nanobind::module_& m);
void bind_batch(nanobind::module_& m);
void bind_build(nanobind::module_& m);
void bind_choices(nanobind::module_& m);
void bind_command(nanobind::module_& m);
void bind_extras(nanobind::module_& m);
void bind_files(nanobind::module_& m);
void bind_io(nanobind::module_& m);
void bind_mass(nanobind::module_& m);
void bind_meshes(nanobind::module_& m);
void bind_motion(nanobind::module_& m);
void bind_power_diagram(nanobind::module_& m);
void bind_shapes(nanobind::module_& m);
void bind_solids(nanobind::module_& m);
void bind_streams(nanobind::module_& m);
void bind_topology(nanobind::module_& m);

// collide
void bind_collider(nanobind::module_& m);
void bind_contact_patches(nanobind::module_& m);
void bind_contact_query(nanobind::module_& m);
void bind_contacts(nanobind::module_& m);
void bind_crossings(nanobind::module_& m);
void bind_distance(nanobind::module_& m);
void bind_inside(nanobind::module_& m);
void bind_moving_spheres(nanobind::module_& m);
void bind_haptic_probe(nanobind::module_& m);
void bind_haptic_tool(nanobind::module_& m);
void bind_rays(nanobind::module_& m);
void bind_touch(nanobind::module_& m);

// scene
void bind_broad_phase(nanobind::module_& m);
void bind_scene_class(nanobind::module_& m);
void bind_scene_results(nanobind::module_& m);

// surface
void bind_layer_patch_records(nanobind::module_& m);
void bind_obstacles(nanobind::module_& m);
void bind_pair_queries(nanobind::module_& m);
void bind_pair_records(nanobind::module_& m);
void bind_pairs(nanobind::module_& m);
void bind_surface_tree(nanobind::module_& m);

// tree
void bind_cover(nanobind::module_& m);
void bind_covered_tree(nanobind::module_& m);
void bind_sphere_tree(nanobind::module_& m);

// update
void bind_body(nanobind::module_& m);
void bind_kdop_tree(nanobind::module_& m);
void bind_skin_bounds(nanobind::module_& m);
void bind_looseness_estimate(nanobind::module_& m);
void bind_posed_spheres(nanobind::module_& m);
void bind_rebuilt_body(nanobind::module_& m);
void bind_rules(nanobind::module_& m);
void bind_spheres_view(nanobind::module_& m);

}  // namespace morula::python
