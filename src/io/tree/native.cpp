// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/hash.hpp"
#include "io/byte_reader.hpp"
#include "io/json_checks.hpp"
#include "io/tree/format_version.hpp"
#include "io/tree/formats.hpp"
#include "io/tree/sphere_archive.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace {

// Named arrays of numbers in one run of bytes, with a JSON table of their places: the body of native files.
class ArrayWriter {
 public:
  // values.size() must be a multiple of width, the numbers of a row.
  void add(const std::string& name, std::size_t width, std::span<const std::uint32_t> values);
  void add(const std::string& name, std::size_t width, std::span<const double> values);

  const nlohmann::ordered_json& table() const { return table_; }
  const std::string& bytes() const { return bytes_; }

 private:
  template <class Value>
  void add_values(const std::string& name, const char* type, std::size_t width, std::span<const Value> values);

  nlohmann::ordered_json table_ = nlohmann::ordered_json::array();
  std::string bytes_;
};

// Throws FileError for arrays that are missing, have another type or width, or do not lie inside the bytes.
class ArrayReader {
 public:
  ArrayReader(const JsonFile& file, const nlohmann::json& table, std::string_view bytes)
      : file_(file), table_(table), bytes_(bytes) {}
  std::vector<std::uint32_t> indices(const std::string& name, std::size_t width) const;
  std::vector<double> numbers(const std::string& name, std::size_t width) const;

 private:
  template <class Value>
  std::vector<Value> values(const std::string& name, const char* type, std::size_t width) const;

  const JsonFile& file_;
  const nlohmann::json& table_;
  std::string_view bytes_;
};

void ArrayWriter::add(const std::string& name, std::size_t width, std::span<const std::uint32_t> values) {
  add_values(name, "uint32", width, values);
}

void ArrayWriter::add(const std::string& name, std::size_t width, std::span<const double> values) {
  add_values(name, "float64", width, values);
}

template <class Value>
void ArrayWriter::add_values(const std::string& name, const char* type, std::size_t width,
                             std::span<const Value> values) {
  // Multiples of 8, so that a program that maps the file can use the arrays where they are.
  bytes_.resize((bytes_.size() + 7) / 8 * 8);
  nlohmann::ordered_json entry;
  entry["name"] = name;
  entry["type"] = type;
  entry["width"] = width;
  entry["rows"] = values.size() / width;
  entry["offset"] = bytes_.size();
  table_.push_back(std::move(entry));
  InterruptPoller poll_interrupt(1u << 16);
  for (const Value value : values) {
    poll_interrupt();
    store(bytes_, value);
  }
}

std::vector<std::uint32_t> ArrayReader::indices(const std::string& name, std::size_t width) const {
  return values<std::uint32_t>(name, "uint32", width);
}

std::vector<double> ArrayReader::numbers(const std::string& name, std::size_t width) const {
  return values<double>(name, "float64", width);
}

template <class Value>
std::vector<Value> ArrayReader::values(const std::string& name, const char* type, std::size_t width) const {
  const std::string label = "array " + name;
  if (!table_.is_array()) file_.fail("the table of arrays is not a list");
  for (const nlohmann::json& entry : table_) {
    if (file_.member(entry, "name", "an array") != name) continue;
    if (file_.member(entry, "type", label) != type || file_.unsigned_member(entry, "width", label) != width)
      file_.fail(label + " is not of type " + type + " and width " + std::to_string(width));
    const std::uint64_t rows = file_.unsigned_member(entry, "rows", label);
    const std::uint64_t offset = file_.unsigned_member(entry, "offset", label);
    // It divides instead of multiplying, so that no number overflows.
    if (offset > bytes_.size() || rows > (bytes_.size() - offset) / (width * sizeof(Value)))
      file_.fail(label + " reaches past the end of the file");
    std::vector<Value> values(rows * width);
    InterruptPoller poll_interrupt(1u << 16);
    for (std::size_t i = 0; i < values.size(); ++i) {
      poll_interrupt();
      values[i] = load<Value>(bytes_.data() + offset + i * sizeof(Value));
    }
    return values;
  }
  file_.fail(label + " is missing");
}

// magic, version (uint32), length of the JSON header (uint32), size of the file (uint64), header, arrays, checksum.
// The magic's line end is destroyed by programs that take the file for text.
constexpr std::string_view magic = "MORULA\r\n";
constexpr std::uint32_t format_version = 1;
constexpr std::size_t before_header = 24;
constexpr std::size_t checksum_size = 8;

std::uint64_t checksum(std::string_view bytes) {
  Hasher hash;
  InterruptPoller poll_interrupt(1u << 20);
  for (const char c : bytes) {
    poll_interrupt();
    hash.add(static_cast<std::uint8_t>(c));
  }
  return hash.value();
}

std::string hex(std::uint64_t value) {
  std::string digits(16, '0');
  for (std::size_t i = 0; i < 16; ++i) digits[15 - i] = "0123456789abcdef"[(value >> (4 * i)) & 15];
  return digits;
}

std::uint64_t from_hex(const JsonFile& file, const nlohmann::json& text) {
  const std::string digits = text.is_string() ? text.get<std::string>() : "";
  std::uint64_t value = 0;
  const char* const end = digits.data() + digits.size();
  const std::from_chars_result parsed = std::from_chars(digits.data(), end, value, 16);
  if (digits.size() != 16 || parsed.ec != std::errc() || parsed.ptr != end)
    file.fail("the mesh hash is not a string of 16 hexadecimal digits");
  return value;
}

// JSON has no infinities, but a growth factor over a minute radius may be one.
nlohmann::ordered_json number_json(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

double number_member(const JsonFile& file, const nlohmann::json& object, const char* key) {
  const nlohmann::json& value = file.member(object, key, "the report");
  if (value.is_number()) return value.get<double>();
  if (value == "inf") return std::numeric_limits<double>::infinity();
  if (value == "-inf") return -std::numeric_limits<double>::infinity();
  if (value == "nan") return std::numeric_limits<double>::quiet_NaN();
  file.fail("\"" + std::string(key) + "\" of the report is not a number");
}

std::uint32_t index_member(const JsonFile& file, const nlohmann::json& object, const char* key,
                           const std::string& owner) {
  const std::uint64_t value = file.unsigned_member(object, key, owner);
  if (value > 0xffffffffu) file.fail("\"" + std::string(key) + "\" of " + owner + " does not fit 32 bits");
  return static_cast<std::uint32_t>(value);
}

std::string text_member(const JsonFile& file, const nlohmann::json& value, const std::string& what) {
  if (!value.is_string()) file.fail(what + " is not a string");
  return value.get<std::string>();
}

nlohmann::ordered_json report_json(const BuildReport& report) {
  nlohmann::ordered_json json;
  json["method"] = report.method;
  json["branching"] = report.branching;
  json["depth"] = report.depth;
  json["seed"] = report.seed;
  json["early_leaves"] = report.early_leaves;
  json["leftover_patches"] = report.leftover_patches;
  json["dropped_spheres"] = report.dropped_spheres;
  json["growth"] = nlohmann::ordered_json::array();
  for (const LevelGrowth& level : report.growth) {
    nlohmann::ordered_json entry;
    entry["grown"] = level.grown;
    entry["largest_factor"] = number_json(level.largest_factor);
    entry["largest_growth"] = number_json(level.largest_growth);
    json["growth"].push_back(std::move(entry));
  }
  json["notes"] = report.notes;
  return json;
}

BuildReport read_report(const JsonFile& file, const nlohmann::json& json) {
  const std::string owner = "the report";
  BuildReport report;
  report.method = text_member(file, file.member(json, "method", owner), "the method");
  report.branching = index_member(file, json, "branching", owner);
  report.depth = index_member(file, json, "depth", owner);
  report.seed = file.unsigned_member(json, "seed", owner);
  report.early_leaves = file.unsigned_member(json, "early_leaves", owner);
  report.leftover_patches = file.unsigned_member(json, "leftover_patches", owner);
  report.dropped_spheres = file.unsigned_member(json, "dropped_spheres", owner);
  const nlohmann::json& growth = file.member(json, "growth", owner);
  const nlohmann::json& notes = file.member(json, "notes", owner);
  if (!growth.is_array() || !notes.is_array()) file.fail("\"growth\" or \"notes\" of the report is not a list");
  for (const nlohmann::json& level : growth)
    report.growth.push_back({static_cast<std::size_t>(file.unsigned_member(level, "grown", owner)),
                             number_member(file, level, "largest_factor"),
                             number_member(file, level, "largest_growth")});
  for (const nlohmann::json& note : notes) report.notes.push_back(text_member(file, note, "a note"));
  return report;
}

// Arrays of the tree for known pose k, and its positions; arrays of the tree at rest have names without a prefix. A
// library without known poses skips arrays and members of unknown names, and reads the tree at rest.
std::string pose_prefix(std::size_t k) {
  return "pose " + std::to_string(k) + " ";
}

// Child counts and levels determine the tree's other arrays; these are computed again, so they cannot disagree.
SphereTree read_nodes(const std::filesystem::path& path, const JsonFile& file, const ArrayReader& arrays,
                      const std::string& prefix, std::uint32_t branching) {
  const std::vector<double> numbers = arrays.numbers(prefix + "spheres", 4);
  const std::vector<std::uint32_t> child_count = arrays.indices(prefix + "child_count", 1);
  const std::vector<std::uint32_t> level_begin = arrays.indices(prefix + "level_begin", 1);
  const std::size_t nodes = numbers.size() / 4;
  if (child_count.size() != nodes) file.fail("spheres and child_count differ in length");
  std::vector<Sphere> spheres(nodes);
  for (std::size_t i = 0; i < nodes; ++i)
    spheres[i] = {{numbers[4 * i], numbers[4 * i + 1], numbers[4 * i + 2]}, numbers[4 * i + 3]};
  return tree_of_counts(path, spheres, child_count, level_begin, branching);
}

Cover read_cover(const JsonFile& file, const ArrayReader& arrays, const std::string& prefix,
                 const nlohmann::json& mesh) {
  Cover cover;
  cover.vertex_count = index_member(file, mesh, "vertices", "the mesh");
  cover.facet_count = index_member(file, mesh, "facets", "the mesh");
  const std::vector<std::uint32_t> vertices = arrays.indices(prefix + "cut_point_vertices", 3);
  const std::vector<double> weights = arrays.numbers(prefix + "cut_point_weights", 3);
  if (vertices.size() != weights.size()) file.fail("cut_point_vertices and cut_point_weights differ in length");
  cover.cut_points.resize(vertices.size() / 3);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    cover.cut_points[i / 3].vertex[i % 3] = vertices[i];
    cover.cut_points[i / 3].weight[i % 3] = weights[i];
  }
  cover.patch_facet = arrays.indices(prefix + "patch_facet", 1);
  cover.corner_begin = arrays.indices(prefix + "corner_begin", 1);
  cover.corners = arrays.indices(prefix + "corners", 1);
  cover.region_begin = arrays.indices(prefix + "region_begin", 1);
  cover.region_end = arrays.indices(prefix + "region_end", 1);
  return cover;
}

// Empty for files of older libraries, and of trees without poses.
std::vector<KnownPose> read_poses(const std::filesystem::path& path, const JsonFile& file, const ArrayReader& arrays,
                                  const nlohmann::json& mesh) {
  std::vector<KnownPose> poses;
  if (!file.root().contains("poses")) return poses;
  const nlohmann::json& list = file.root()["poses"];
  if (!list.is_array()) file.fail("\"poses\" is not a list");
  for (const nlohmann::json& entry : list) {
    const std::string owner = "a pose", prefix = pose_prefix(poses.size());
    KnownPose pose;
    pose.name = text_member(file, file.member(entry, "name", owner), "the name of a pose");
    auto model = std::make_shared<CoveredTree>();
    model->tree = read_nodes(path, file, arrays, prefix, index_member(file, entry, "branching", owner));
    model->cover = read_cover(file, arrays, prefix, mesh);
    if (const auto faults = validate(model->tree, model->cover); !faults.empty())
      file.fail("pose " + std::to_string(poses.size()) + ": " + faults.front());
    model->report = read_report(file, file.member(entry, "report", owner));
    model->report.mesh_hash = from_hex(file, file.member(entry, "hash", owner));
    model->report.most_patches_of_a_facet = model->cover.most_patches_of_a_facet();
    const std::vector<double> numbers = arrays.numbers(prefix + "positions", 3);
    for (std::size_t i = 0; i + 3 <= numbers.size(); i += 3)
      pose.positions.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    if (pose.positions.size() != model->cover.vertex_count)
      file.fail("pose " + std::to_string(poses.size()) + " has " + std::to_string(pose.positions.size()) +
                " positions for " + std::to_string(model->cover.vertex_count) + " vertices");
    pose.model = std::move(model);
    poses.push_back(std::move(pose));
  }
  return poses;
}

void add_tree(ArrayWriter& arrays, const std::string& prefix, const CoveredTree& model) {
  const Cover& cover = model.cover;
  std::vector<double> numbers;
  for (const Sphere& s : model.tree.spheres)
    numbers.insert(numbers.end(), {s.center.x, s.center.y, s.center.z, s.radius});
  arrays.add(prefix + "spheres", 4, numbers);
  arrays.add(prefix + "child_count", 1, model.tree.child_count);
  arrays.add(prefix + "level_begin", 1, model.tree.level_begin);
  std::vector<std::uint32_t> vertices;
  numbers.clear();
  for (const CutPoint& point : cover.cut_points) {
    vertices.insert(vertices.end(), point.vertex.begin(), point.vertex.end());
    numbers.insert(numbers.end(), point.weight.begin(), point.weight.end());
  }
  arrays.add(prefix + "cut_point_vertices", 3, vertices);
  arrays.add(prefix + "cut_point_weights", 3, numbers);
  arrays.add(prefix + "patch_facet", 1, cover.patch_facet);
  arrays.add(prefix + "corner_begin", 1, cover.corner_begin);
  arrays.add(prefix + "corners", 1, cover.corners);
  arrays.add(prefix + "region_begin", 1, cover.region_begin);
  arrays.add(prefix + "region_end", 1, cover.region_end);
}

void add_poses(ArrayWriter& arrays, nlohmann::ordered_json& json, std::span<const KnownPose> poses) {
  if (poses.empty()) return;
  json["poses"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    nlohmann::ordered_json entry;
    entry["name"] = poses[k].name;
    entry["hash"] = hex(poses[k].model->report.mesh_hash);
    entry["branching"] = poses[k].model->tree.branching;
    entry["report"] = report_json(poses[k].model->report);
    json["poses"].push_back(std::move(entry));
    add_tree(arrays, pose_prefix(k), *poses[k].model);
    std::vector<double> numbers;
    for (const Vec3& p : poses[k].positions) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    arrays.add(pose_prefix(k) + "positions", 3, numbers);
  }
}

}  // namespace

std::string native_bytes(const CoveredTree& model) {
  const Cover& cover = model.cover;
  ArrayWriter arrays;
  add_tree(arrays, "", model);

  nlohmann::ordered_json json;
  json["mesh"]["hash"] = hex(model.report.mesh_hash);
  json["mesh"]["vertices"] = cover.vertex_count;
  json["mesh"]["facets"] = cover.facet_count;
  json["tree"]["branching"] = model.tree.branching;
  if (model.tree.nested) json["tree"]["nested"] = true;
  json["report"] = report_json(model.report);
  add_poses(arrays, json, model.poses);
  json["arrays"] = arrays.table();
  // Notes are free text; a byte that is not UTF-8 must not make the tree unwritable.
  std::string header = json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
  header.resize((header.size() + 7) / 8 * 8, ' ');

  std::string bytes(magic);
  store(bytes, format_version);
  store(bytes, static_cast<std::uint32_t>(header.size()));
  store(bytes, std::uint64_t{before_header + header.size() + arrays.bytes().size() + checksum_size});
  bytes += header;
  bytes += arrays.bytes();
  store(bytes, checksum(bytes));
  return bytes;
}

TreeFile read_native(const std::filesystem::path& path, std::string_view bytes) {
  ByteReader in(path, bytes, std::endian::little);
  if (bytes.substr(0, magic.size()) != magic)
    in.fail("not a .morula file, or changed by a program that took it for text; build the tree again");
  in.skip(magic.size(), "the header");
  if (const auto given = in.read<std::uint32_t>("the header"); given == 0 || given > format_version)
    in.fail(unknown_format_version(given, format_version, "build the tree again"));
  const std::size_t header_size = in.read<std::uint32_t>("the header");
  const auto file_size = in.read<std::uint64_t>("the header");
  if (file_size != bytes.size())
    in.fail("the file has " + std::to_string(bytes.size()) + " bytes instead of " + std::to_string(file_size) +
            "; copy it again, or build the tree again");
  if (header_size > in.bytes_left() || in.bytes_left() - header_size < checksum_size)
    in.fail("the header claims " + std::to_string(header_size) + " bytes, more than there are; build the tree again");
  const std::string_view covered = bytes.substr(0, bytes.size() - checksum_size);
  if (checksum(covered) != load<std::uint64_t>(covered.data() + covered.size()))
    throw FileError(platform::text_of(path) +
                    ": the checksum does not match, the file was damaged; build the tree again");

  const JsonFile file(path, bytes.substr(before_header, header_size));
  const ArrayReader arrays(file, file.member(file.root(), "arrays", "the header"),
                           covered.substr(before_header + header_size));
  TreeFile result;
  const nlohmann::json& mesh = file.member(file.root(), "mesh", "the header");
  const nlohmann::json& tree = file.member(file.root(), "tree", "the header");
  result.tree = read_nodes(path, file, arrays, "", index_member(file, tree, "branching", "the tree"));
  result.tree.nested = file.flag(tree, "nested", "the tree");
  require_valid(path, result.tree);
  result.cover = read_cover(file, arrays, "", mesh);
  if (const auto faults = validate(result.tree, *result.cover); !faults.empty()) file.fail(faults.front());
  result.report = read_report(file, file.member(file.root(), "report", "the header"));
  result.report.mesh_hash = from_hex(file, file.member(mesh, "hash", "the mesh"));
  result.report.most_patches_of_a_facet = result.cover->most_patches_of_a_facet();
  result.poses = read_poses(path, file, arrays, mesh);
  return result;
}

}  // namespace morula::detail
