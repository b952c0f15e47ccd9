// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The whole library in one include. The extras have their own headers: morula/robot (robots), morula/grains (clumps of
// spheres), morula/study and morula/page.
#pragma once

// MSVC keeps __cplusplus at 199711 without /Zc:__cplusplus; _MSVC_LANG has its language version.
#if !(__cplusplus >= 202002L || (defined(_MSVC_LANG) && _MSVC_LANG >= 202002L))
#error "Morula needs C++20: -std=c++20, /std:c++20, or target_compile_features(... cxx_std_20)"
#endif

#include <morula/accuracy/measure.hpp>
#include <morula/collide/collider.hpp>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/containment.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/moving_spheres.hpp>
#include <morula/collide/pair_walk.hpp>
#include <morula/collide/penetration.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/collide/sweep.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/geometry/solid_surface.hpp>
#include <morula/geometry/weld.hpp>
#include <morula/io/file_reference.hpp>
#include <morula/io/files.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/modal_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/paraview_file.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/medial/medial_balls.hpp>
#include <morula/parallel/interrupt.hpp>
#include <morula/parallel/snapshots.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/scene/broad_phase.hpp>
#include <morula/scene/scene.hpp>
#include <morula/surface/haptic_probe.hpp>
#include <morula/surface/haptic_tool.hpp>
#include <morula/surface/layer_patches.hpp>
#include <morula/surface/modal_certificate.hpp>
#include <morula/surface/obstacles.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <morula/tree/cover.hpp>
#include <morula/tree/sphere_state.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <morula/tree/walk.hpp>
#include <morula/update/body.hpp>
#include <morula/update/kdop_tree.hpp>
#include <morula/update/known_poses.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <morula/update/sample_motions.hpp>
#include <morula/update/skin_bounds.hpp>
#include <morula/version.hpp>
