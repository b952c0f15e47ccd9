// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the demo and the study share: bodies, motions by their words, and the positions of their frames.
#pragma once

#include <morula/deform/deformation.hpp>
#include <morula/geometry/mesh.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula::cli {

struct NamedMesh {
  std::string name;
  Mesh mesh;
};

/// A motion, and the positions of one body at each of its frames.
struct MovedFrames {
  std::string name;
  std::vector<std::vector<Vec3>> frames;
};

/// "stretch 2, twist 180": as describe() says it; it is also the option of morula deform.
std::string describe_all(const Deformations& deformations);

/// The stretch, the twist and the bend of the standard motions: those of the paper.
std::vector<Deformations> paper_motions();

/// Motions of the mesh, one frame per parameter. What it cannot do is left out and said in `skipped`.
std::vector<MovedFrames> move_frames(const NamedMesh& body, std::span<const Deformations> motions,
                                     std::span<const double> parameters, std::vector<std::string>& skipped);

/// "limb-twist-180": a file name from the words of a motion.
std::string file_stem(const std::string& body, const std::string& motion);

}  // namespace morula::cli
