// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/bounds/rest_data.hpp"

#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "commands/bounds/clusters.hpp"
#include "shared/figures.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

Json bone_json(const GltfBone& bone) {
  Json own{{"node", bone.node}, {"name", bone.name}};
  if (bone.skin) own["skin"] = *bone.skin;
  if (bone.joint) own["joint"] = *bone.joint;
  if (bone.mesh_node) own["mesh_node"] = *bone.mesh_node;
  return own;
}

Json primitives_json(const GltfParts& parts) {
  Json all = Json::array();
  std::size_t first = 0;
  for (const GltfPrimitive& p : parts.primitives) {
    Json own{{"node", p.node}, {"mesh", p.mesh}, {"primitive", p.primitive}};
    own["facet_range"] = {first, first + p.facet_count};
    all.push_back(std::move(own));
    first += p.facet_count;
  }
  return all;
}

Json targets_json(const GltfParts& parts) {
  Json all = Json::array();
  for (const GltfTarget& t : parts.targets)
    all.push_back({{"node", t.node}, {"mesh", t.mesh}, {"target", t.target}, {"rest_weight", t.rest_weight}});
  return all;
}

/// Numbers of floats have the fewest digits that read back as the same float.
template <class... Numbers>
void append_numbers(std::string& text, Numbers... numbers) {
  char before = '[';
  (fmt::format_to(std::back_inserter(text), "{}{}", std::exchange(before, ','), numbers), ...);
  text += ']';
}

void append_cluster(std::string& text, const SkinBoundsCluster& c, const FacetRanges& ranges) {
  text += "{\"facet_ranges\":" + Json(ranges).dump() + ",\"data\":";
  append_numbers(text, c.center.x, c.center.y, c.center.z, c.radius, c.half_extent.x, c.half_extent.y, c.half_extent.z,
                 c.overhang, c.growth, c.rounding, c.first_row, c.row_count);
  text += '}';
}

void append_row(std::string& text, const SkinBoundsRow& r) {
  append_numbers(text, r.bone, r.weight, r.weight_stray, r.moment_stray, r.center.x, r.center.y, r.center.z, r.radius);
}

void append_target(std::string& text, const SkinBoundsTarget& t) {
  append_numbers(text, t.shift.x, t.shift.y, t.shift.z, t.radius, t.half_extent.x, t.half_extent.y, t.half_extent.z,
                 t.target);
}

/// One line for each item.
template <class Append>
void append_list(std::string& text, const char* name, std::size_t count, const Append& append) {
  text += fmt::format(",\n\"{}\":[", name);
  for (std::size_t i = 0; i < count; ++i) {
    text += i == 0 ? "\n" : ",\n";
    append(i);
  }
  text += ']';
}

}  // namespace

std::string bounds_text(const SkinBoundsData& data, const Mesh& mesh, std::span<const std::uint32_t> cluster_of_facet,
                        const GltfParts& parts) {
  Json head{{"format", "morula skin bounds"},
            {"version", 1},
            {"mesh_hash", hash_text(mesh_hash(mesh))},
            {"facet_count", mesh.facet_count()},
            {"bone_count", data.bone_count}};
  if (!parts.bones.empty()) {
    head["bones"] = Json::array();
    for (const GltfBone& bone : parts.bones) head["bones"].push_back(bone_json(bone));
  }
  if (!parts.primitives.empty()) head["primitives"] = primitives_json(parts);
  if (data.target_count > 0) head["target_count"] = data.target_count;
  if (!parts.targets.empty()) head["morph_targets"] = targets_json(parts);
  std::string text = json_text(head, -1);
  text.pop_back();
  text += fmt::format(",\n\"reach\":{},\"largest_size\":{}", data.reach, data.largest_size);
  const std::vector<FacetRanges> ranges = facet_ranges(cluster_of_facet, data.clusters.size());
  append_list(text, "clusters", data.clusters.size(),
              [&](std::size_t i) { append_cluster(text, data.clusters[i], ranges[i]); });
  append_list(text, "rows", data.rows.size(), [&](std::size_t i) { append_row(text, data.rows[i]); });
  if (data.target_count > 0) {
    text += fmt::format(",\n\"target_begin\":{}", Json(data.target_begin).dump());
    append_list(text, "targets", data.targets.size(), [&](std::size_t i) { append_target(text, data.targets[i]); });
  }
  return text + "}";
}

}  // namespace morula::cli
