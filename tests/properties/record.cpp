// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "record.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>

namespace morula::properties {
namespace {

// Written here: the library's writer is among what is judged, and refuses what is not finite.
void write_obj(const std::filesystem::path& path, const std::vector<Vec3>& positions, const Mesh& mesh) {
  std::ofstream out(path);
  char line[128];
  for (const Vec3& p : positions) {
    const Vec3 q = is_finite(p) ? p : Vec3{};
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", q.x, q.y, q.z);
    out << line;
  }
  for (const Facet& f : mesh.facets) out << "f " << f[0] + 1 << ' ' << f[1] + 1 << ' ' << f[2] + 1 << '\n';
}

}  // namespace

void Record::begin(std::uint64_t seed, std::uint64_t number) {
  ++counts.cases;
  place = {seed, number, {}, {}, {}, {}, {}};
  seen_.clear();
}

void Record::fail(const std::string& kind, const std::string& what) {
  if (std::find(seen_.begin(), seen_.end(), kind) != seen_.end()) return;
  if (seen_.empty()) ++failed_cases_;
  seen_.push_back(kind);
  ++failures_[kind];
  if (!loud_) return;
  std::printf("%s: %s | %s%s%s | %s --seed %llu --only %llu\n", kind.c_str(), what.c_str(), place.description.c_str(),
              place.frame.empty() ? "" : " | ", place.frame.c_str(), command.c_str(),
              static_cast<unsigned long long>(place.seed), static_cast<unsigned long long>(place.number));
  std::fflush(stdout);
  if (!keep_.empty()) keep(kind, what);
}

void Record::keep(const std::string& kind, const std::string& what) const {
  std::filesystem::create_directories(keep_);
  const std::string stem = "seed" + std::to_string(place.seed) + "-case" + std::to_string(place.number);
  if (!place.mesh.facets.empty()) {
    write_obj(keep_ / (stem + "-rest.obj"), place.mesh.positions, place.mesh);
    if (place.pose.size() == place.mesh.positions.size())
      write_obj(keep_ / (stem + "-" + kind + ".obj"), place.pose, place.mesh);
  }
  if (!place.second.facets.empty())
    write_obj(keep_ / (stem + "-" + kind + "-second.obj"), place.second.positions, place.second);
  std::ofstream out(keep_ / (stem + ".txt"), std::ios::app);
  out << kind << ": " << what << "\n  " << place.description << "\n  " << place.frame << "\n  " << command << " --seed "
      << place.seed << " --only " << place.number << "\n";
}

std::string Record::summary(double seconds) const {
  const auto line = [](const char* what, std::size_t count) {
    char text[96];
    std::snprintf(text, sizeof text, "  %-34s %14zu\n", what, count);
    return std::string(text);
  };
  std::string text =
      line("cases", counts.cases) + line("frames judged", counts.frames) + line("level sets judged", counts.levels) +
      line("facets held against a level", counts.cover.facets) + line("  of these proved", counts.cover.proved) +
      line("points sampled", counts.cover.samples) + line("corners in their own sphere", counts.corners) +
      line("builds with spheres enlarged", counts.enlarged) + line("modal frames", counts.modal_frames) +
      line("skinned frames", counts.skinned_frames) + line("swaps of rebuilt bodies", counts.swaps) +
      line("round trips of files", counts.round_trips) + line("poses of pairs", counts.poses_of_pairs) +
      line("  of these decided exactly", counts.exact_poses) +
      line("  with surfaces that follow", counts.followed_pairs) + line("crossings by brute force", counts.crossings) +
      line("points within a margin", counts.near_pairs) + line("interruptions of queries", counts.interruptions);
  std::size_t uncovered = 0, missed = 0, other = 0;
  for (const auto& [kind, count] : failures_) {
    if (kind.starts_with("uncovered"))
      uncovered += count;
    else if (kind.starts_with("missed"))
      missed += count;
    else
      other += count;
  }
  text += line("cases with uncovered surface", uncovered) + line("cases with a missed contact", missed) +
          line("cases with another fault", other);
  for (const auto& [kind, count] : failures_) text += line(("  " + kind).c_str(), count);
  const double of_processor = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  char time[160];
  std::snprintf(time, sizeof time, "  %-34s %14.1f\n  %-34s %14.1f\n", "seconds", seconds, "  of processor",
                of_processor);
  return text + time;
}

}  // namespace morula::properties
