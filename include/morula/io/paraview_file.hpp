// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Points and surfaces with numbers, in the formats of ParaView and VTK: .vtp, and .pvd for motions.
#pragma once

#include <morula/geometry/mesh_view.hpp>
#include <morula/io/mesh_file.hpp>
#include <string>
#include <vector>

namespace morula {

/// One or more numbers for every point or every facet.
struct VtpArray {
  std::string name;
  std::vector<double> values;  ///< values point by point, or facet by facet
  std::size_t components = 1;
  bool whole = false;  ///< written as 32-bit integers
};

struct VtpData {
  std::vector<Vec3> points;
  std::vector<Facet> facets;  ///< empty: the points are shown as points
  std::vector<VtpArray> point_arrays;
  std::vector<VtpArray> facet_arrays;
};

/// Writes XML with its numbers in base64, which any XML reader can parse; points are doubles. Throws
/// std::invalid_argument if an array has the wrong length, or if facets refer to missing points.
void write_vtp(const std::filesystem::path& path, const VtpData& data);

struct PvdEntry {
  double time;
  std::string file;  ///< path relative to the folder of the .pvd
};
/// Writes the list of a motion's files, in the order of time.
void write_pvd(const std::filesystem::path& path, std::span<const PvdEntry> entries);

}  // namespace morula
