// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "batch/task.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <platform/interrupt.hpp>
#include <stdexcept>
#include <string_view>
#include <toolbox/csv.hpp>

#include "batch/bytes.hpp"
#include "batch/manifest.hpp"
#include "shared/command.hpp"
#include "shared/name_text.hpp"

namespace morula::cli {
namespace {

// Members of a result and columns of the table that the build reports, and those that --measure adds.
constexpr std::array reported{"vertices", "facets",  "mesh_hash", "method",   "branching",
                              "depth",    "spheres", "tree_hash", "complete", "covered"};
constexpr std::array measured{"closed", "looseness", "uncovered_area", "uncovered_distance", "protrusion"};
constexpr std::array columns{
    "status",    "message",        "vertices",           "facets",    "method",    "branching", "depth",
    "nodes",     "spheres",        "complete",           "covered",   "mesh_hash", "tree_hash", "closed",
    "looseness", "uncovered_area", "uncovered_distance", "protrusion"};
constexpr std::array costs{"seconds", "cpu_seconds", "peak_mb"};

// Values nested deeper than any of this program are left out: deep input could exhaust the stack of its readers.
std::optional<Json> parsed(const std::string& text) {
  constexpr int deepest = 8;
  const auto is_shallow = [](int depth, Json::parse_event_t, const Json&) { return depth <= deepest; };
  Json json = Json::parse(text, is_shallow, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

bool has_text(const Json& json, const char* name) {
  return json.is_object() && json.contains(name) && json.at(name).is_string();
}

// The error that a build reported with --json, or its first line.
std::string error_of(const std::string& messages) {
  std::string first;
  for (std::size_t begin = 0; begin < messages.size();) {
    const std::size_t end = std::min(messages.find('\n', begin), messages.size());
    const std::string line = messages.substr(begin, end - begin);
    const std::optional<Json> said = parsed(line);
    if (said && has_text(*said, "error")) return said->at("error");
    if (first.empty()) first = said && has_text(*said, "note") ? said->at("note").get<std::string>() : line;
    begin = end + 1;
  }
  return text_of_name(first);
}

std::string replaced(std::string text, const std::string& from, std::string_view to) {
  if (from.empty()) return text;
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string hash_of(const Json& result) {
  Json rest = result;
  rest.erase("hash");
  return hash_of_bytes(json_text(rest, -1));
}

void set_failure(Json& result, const char* status, std::string message) {
  result["status"] = status;
  result["message"] = std::move(message);
}

void add_report(Json& result, const Json& report) {
  for (const char* name : reported) result[name] = report.at(name);
  std::size_t nodes = 0;
  for (const Json& level : report.at("levels")) nodes += level.at("nodes").get<std::size_t>();
  result["nodes"] = nodes;
}

bool is_of_memory(const std::string& error) {
  return error.starts_with("not enough memory") || error.starts_with(strerror(ENOMEM));
}

// Sets status and message of a build that failed.
void judge_end(Json& result, const ProcessEnd& end, const BatchTask& task, const std::string& error) {
  if (end.how == ProcessEnd::How::out_of_time) {
    set_failure(result, "time limit", fmt::format("not done after {} s", task.time_limit.value_or(0)));
  } else if (end.how == ProcessEnd::How::signaled) {
    set_failure(result, "crashed", fmt::format("ended by signal {} ({})", end.code, platform::signal_text(end.code)));
  } else if (end.code == exit_bad_use) {
    set_failure(result, "refused", error);
  } else if (end.code == exit_internal_error && is_of_memory(error)) {
    set_failure(result, "memory limit", error);
  } else if (end.code != exit_done) {
    set_failure(result, "failed", error.empty() ? fmt::format("exit code {}", end.code) : error);
  }
}

std::string cell(const Json& value) {
  return value.is_null() ? "" : toolbox::csv_cell(value.is_string() ? value.get<std::string>() : json_text(value, -1));
}

// The path of a JSON member, and back: names of files need not be UTF-8.
std::filesystem::path path_of(const Json& json, const char* name) {
  return name_of_text(json.at(name).get<std::string>());
}

template <class T>
std::optional<T> number_of(const Json& json, const char* name) {
  return json.at(name).is_null() ? std::nullopt : std::optional<T>(json.at(name).get<T>());
}

}  // namespace

std::string task_line(const BatchTask& task) {
  Json json{{"key", task.key},
            {"mesh", text_of_name(task.mesh.string())},
            {"tree", text_of_name(task.tree.string())},
            {"result", text_of_name(task.result.string())},
            {"words", task.words},
            {"time_limit", nullptr},
            {"megabytes", nullptr},
            {"no_trees", task.no_trees}};
  if (task.time_limit) json["time_limit"] = *task.time_limit;
  if (task.megabytes) json["megabytes"] = *task.megabytes;
  return json_text(json, -1);
}

BatchTask task_of_line(const std::string& line) {
  const std::optional<Json> json = parsed(line);
  try {
    if (!json) throw std::invalid_argument("no JSON");
    return {.key = json->at("key"),
            .mesh = path_of(*json, "mesh"),
            .tree = path_of(*json, "tree"),
            .result = path_of(*json, "result"),
            .words = json->at("words"),
            .time_limit = number_of<double>(*json, "time_limit"),
            .megabytes = number_of<std::size_t>(*json, "megabytes"),
            .no_trees = json->at("no_trees")};
  } catch (const std::exception& error) {
    throw std::invalid_argument(fmt::format("a line that is no task of a batch: {}", error.what()));
  }
}

Json result_of(const ProcessEnd& end, const BatchTask& task, bool& is_kept) {
  Json result{{"status", "ok"}, {"message", ""}};
  const std::string error = error_of(end.errors);
  judge_end(result, end, task, error);
  is_kept = true;
  if (result["status"] == "refused" && error.find(text_of_name(task.tree.string())) != std::string::npos) {
    set_failure(result, "failed", error);
    is_kept = false;
  }
  result["message"] = replaced(result["message"].get<std::string>(), text_of_name(task.mesh.string()), mesh_mark);
  if (const std::optional<Json> report = parsed(end.out); report && has_text(*report, "tree_hash"))
    add_report(result, *report);
  else if (result["status"] == "ok")
    set_failure(result, "failed", "the build reported no tree");
  if (const std::optional<Json> figures = parsed(end.figures); figures && result["status"] == "ok")
    for (const char* name : measured) result[name] = figures->at(name);
  if (result["status"] == "ok") {
    Hash128 hash;
    if (const auto reason = hash_file(task.tree, hash))
      set_failure(result, "failed", fmt::format("{}: {}", text_of_name(task.tree.string()), *reason)), is_kept = false;
    else
      result["tree_file"] = hash.text();
  }
  result["cost"] = {{"seconds", end.seconds}, {"cpu_seconds", end.cpu_seconds}, {"peak_mb", end.peak_megabytes}};
  result["key"] = task.key;
  return with_hash(std::move(result));
}

Json result_without_build(const std::string& key, const std::string& status, const std::string& message) {
  return with_hash({{"status", status},
                    {"message", message},
                    {"cost", {{"seconds", 0.0}, {"cpu_seconds", 0.0}, {"peak_mb", 0.0}}},
                    {"key", key}});
}

Json lost_result(const BatchTask& task) {
  return result_without_build(task.key, "crashed", "two workers in turn were lost over it");
}

Json with_hash(Json result) {
  result["hash"] = hash_of(result);
  return result;
}

std::string result_text(const Json& result) {
  return json_text(result, 1) + "\n";
}

std::optional<Json> whole_result(const std::string& text, const std::string& key) {
  std::optional<Json> result = parsed(text);
  if (!result) return std::nullopt;
  for (const char* name : {"key", "hash", "status", "message"})
    if (!has_text(*result, name)) return std::nullopt;
  // mutant batch-result-hash: `key || result->at("hash") != hash_of(*result)` -> `key`
  if (result->at("key") != key || result->at("hash") != hash_of(*result)) return std::nullopt;
  // The rest is unchanged since it was written. A result with a hash computed by hand must not cause a fault either.
  if (!result->contains("cost") || !result->at("cost").is_object()) return std::nullopt;
  for (const char* name : costs)
    if (!result->at("cost").contains(name) || !result->at("cost").at(name).is_number()) return std::nullopt;
  if (result->at("status") == "ok" && !has_text(*result, "tree_file")) return std::nullopt;
  return result;
}

std::optional<std::string> tree_file_hash(const Json& result) {
  if (result.at("status") != "ok") return std::nullopt;
  return result.at("tree_file").get<std::string>();
}

namespace {

Json table_line(const TableRow& row, const std::map<std::string, Json>& results, bool no_trees) {
  Json line{{"name", row.name}};
  if (row.key.empty()) {
    line.update({{"key", nullptr},
                 {"status", "refused"},
                 {"message", replaced(row.message, std::string(mesh_mark), row.name)}});
    return line;
  }
  const Json& result = results.at(row.key);
  line["key"] = row.key;
  for (const char* column : columns)
    if (result.contains(column)) line[column] = result.at(column);
  line["message"] = replaced(line["message"].get<std::string>(), std::string(mesh_mark), row.name);
  if (!no_trees && tree_file_hash(result)) line["tree"] = BatchPlaces::tree_name(row.key);
  return line;
}

}  // namespace

BatchTables batch_tables(const std::vector<TableRow>& rows, const std::map<std::string, Json>& results, bool no_trees) {
  BatchTables tables{"name,key", "", "name,key", {}};
  for (const char* column : columns) tables.csv += fmt::format(",{}", column);
  for (const char* column : costs) tables.cost += fmt::format(",{}", column);
  tables.csv += ",tree\n";
  tables.cost += "\n";
  for (const TableRow& row : rows) {
    const Json line = table_line(row, results, no_trees);
    ++tables.statuses[line["status"].get<std::string>()];
    tables.jsonl += json_text(line, -1) + "\n";
    const std::string begin = toolbox::csv_cell(row.name) + "," + row.key;
    tables.csv += begin;
    for (const char* column : columns) tables.csv += "," + (line.contains(column) ? cell(line[column]) : "");
    tables.csv += "," + (line.contains("tree") ? cell(line["tree"]) : "") + "\n";
    if (row.key.empty()) continue;
    tables.cost += begin;
    for (const char* column : costs) tables.cost += "," + cell(results.at(row.key).at("cost").at(column));
    tables.cost += "\n";
  }
  return tables;
}

}  // namespace morula::cli
