// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skins with morph targets, and skins whose weights do not add up to 1.
//
//   const morula::Skin skin = morula::sample_skin(mesh.positions);          // or those of a file: io/skin_file.hpp
//   const morula::Modes targets = morula::sample_modes(mesh.positions, 4);
//   morula::Body body(mesh, morula::build(mesh), {.rules = {morula::Rule::skinned}, .modes = targets, .skin = skin});
//   const std::vector<morula::AffineTransform> transforms(skin.bone_count);  // every frame: one per bone
//   const std::vector<double> morphs(targets.mode_count, 0.1);               // and a number per target
//   if (const auto status = body.update_skinned(transforms, morphs); !status) std::puts(message(status).c_str());
//   std::vector<morula::Vec3> moved(mesh.vertex_count());                    // if the vertices themselves are needed
//   morula::move_by_skin(skin, targets, mesh.positions, transforms, morphs, moved);
#pragma once

#include <morula/update/modes.hpp>
#include <morula/update/skin.hpp>

namespace morula {

/// Writes the position of each vertex under morph targets and then bones to `positions`: m_i + sum_b w_ib (T_b m_i -
/// m_i) with m_i = rest_i + sum_j morphs_j U_ij. It is computed in double, with modes and influences added in order.
/// Body::update_skinned() uses the same positions.
///
/// modes: the morph targets U, with the vertices of the skin. transforms: one per bone, relative to rest. morphs: one
/// per mode; those that are 0 are skipped. An empty span means that all are 0. rest, positions: one per vertex of the
/// skin. With all morphs 0 and identity transforms, the positions equal `rest` bit for bit. Allocates nothing. The
/// result has the same bits for any number of workers. Cost: linear in influences, and in vertices × morphs that are
/// not 0.
void move_by_skin(const Skin& skin, const Modes& modes, std::span<const Vec3> rest,
                  std::span<const AffineTransform> transforms, std::span<const double> morphs,
                  std::span<Vec3> positions, Workers& workers = serial_workers()) noexcept;

/// The skin with one bone more, number skin.bone_count, which takes the missing weight of each vertex: 1 less the sum
/// of its weights, negative if they exceed 1. A body accepts the result unless the |weights| of a vertex add up to more
/// than 1e8, where sums lose the digits of 1.
///
/// The caller chooses the transform of that bone. With the identity the missing share stays at rest. With the zero
/// transform, {.columns = {}}, vertex i is at sum_b w_ib T_b rest_i, without normalization, as in libigl. Vertices
/// whose weights add up to 1 within `tolerance` keep their influences; a body accepts a tolerance of up to 1e-6.
///
/// Throws std::invalid_argument for influences that do not fit the vertices or the bones, for a weight that is not
/// finite, and for a tolerance that is not in 0…1e-6. Cost: linear in influences.
Skin complete_weights(const Skin& skin, double tolerance = 1e-6);

}  // namespace morula
