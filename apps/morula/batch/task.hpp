// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Task: one mesh of a batch, in the form that a worker takes, and its result.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shared/report.hpp"

namespace morula::cli {

struct BatchTask {
  std::string key;
  std::filesystem::path mesh, tree;
  std::filesystem::path result;          ///< file in which the worker keeps the result; empty: the caller keeps it
  std::vector<std::string> words;        ///< options of `morula build`, and --measure
  std::optional<double> time_limit;      ///< seconds of wall time
  std::optional<std::size_t> megabytes;  ///< address space besides the worker's own, MiB
  bool no_trees = false;                 ///< the tree is removed once its hash is taken
};
/// One line of JSON, and the task that it holds. Throws std::invalid_argument for a line that holds none.
std::string task_line(const BatchTask& task);
BatchTask task_of_line(const std::string& line);

/// How the process of one build ended.
struct ProcessEnd {
  enum class How { exited, signaled, out_of_time };
  How how = How::exited;
  int code = 0;                      ///< exit code, or the signal
  std::string out, figures, errors;  ///< the build's report, figures of the fit, messages
  double seconds = 0, cpu_seconds = 0, peak_megabytes = 0;
};

/// The result of a task: status, message, the report, the hash of the tree's file, cost, and a hash of all of it. All
/// but the cost and the last hash are the same on every run. `is_kept` becomes false for a result that does not depend
/// on the mesh: a tree that could not be written.
Json result_of(const ProcessEnd& end, const BatchTask& task, bool& is_kept);
/// The result of a mesh for which no build is started: the status and the message give the reason.
Json result_without_build(const std::string& key, const std::string& status, const std::string& message);

/// The result of a task over which two workers in turn were lost.
Json lost_result(const BatchTask& task);

/// A result with the hash of its other members.
Json with_hash(Json result);
/// A result's text, as it is kept.
std::string result_text(const Json& result);
/// The result that `text` holds. None unless it is one of this key, whole and unchanged.
std::optional<Json> whole_result(const std::string& text, const std::string& key);
/// The hash of the tree's file that belongs to a result; none if there is no tree.
std::optional<std::string> tree_file_hash(const Json& result);

/// The folders and files of a batch.
struct BatchPlaces {
  std::filesystem::path folder;
  static std::string result_name(const std::string& key) { return "results/" + key.substr(0, 2) + "/" + key + ".json"; }
  static std::string tree_name(const std::string& key) { return "trees/" + key.substr(0, 2) + "/" + key + ".morula"; }
  std::filesystem::path result(const std::string& key) const { return folder / result_name(key); }
  std::filesystem::path tree(const std::string& key) const { return folder / tree_name(key); }
};

/// A row of the table: its name as text, and its key, or the message of its rejection.
struct TableRow {
  std::string name, key, message;
};
/// The tables: the same bytes for any interruptions of a batch; only `cost` differs.
struct BatchTables {
  std::string csv, jsonl, cost;
  std::map<std::string, std::size_t> statuses;  ///< rows of each
};
/// results: one for each key of the rows.
BatchTables batch_tables(const std::vector<TableRow>& rows, const std::map<std::string, Json>& results, bool no_trees);

}  // namespace morula::cli
