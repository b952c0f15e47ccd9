// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Points and surfaces with numbers on them, as ParaView and VTK read them: .vtp, and .pvd for those of many frames.
#pragma once

#include <morula/geometry/mesh_view.hpp>
#include <morula/io/mesh_file.hpp>
#include <string>
#include <vector>

namespace morula {

/// One or more numbers for every point or every facet.
struct VtpArray {
  std::string name;
  std::vector<double> values;  ///< those of one point after those of another
  std::size_t components = 1;
  bool whole = false;  ///< written as whole numbers of 32 bits
};

struct VtpData {
  std::vector<Vec3> points;
  std::vector<Facet> facets;  ///< none: the points are shown as points
  std::vector<VtpArray> point_arrays;
  std::vector<VtpArray> facet_arrays;
};

/// Writes XML with its numbers in base64, so that any reader of XML can parse it; points are doubles. Throws
/// std::invalid_argument where an array has another length than what it belongs to, or facets refer to no point.
void write_vtp(const std::filesystem::path& path, const VtpData& data);

struct PvdEntry {
  double time;
  std::string file;  ///< relative to the folder of the .pvd
};
/// Files of a motion, in the order of time.
void write_pvd(const std::filesystem::path& path, std::span<const PvdEntry> entries);

}  // namespace morula
