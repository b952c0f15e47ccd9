// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula batch: a tree for each of many meshes, one process each; what fails is a row of the table.
#include <fmt/format.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): POSIX has more in it
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <list>
#include <map>
#include <memory>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/csv.hpp>
#include <morula/io/file_reference.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <optional>
#include <set>
#include <thread>

#include "batch/job.hpp"
#include "batch/manifest.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/files.hpp"
#include "shared/interrupt.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {
namespace fs = std::filesystem;

struct BatchArguments {
  std::string manifest;
  std::string output;
  std::string shard = "1/1";
  std::vector<std::string> roots;
  unsigned jobs = 0;
  std::optional<double> time_limit;
  std::optional<std::size_t> memory_limit;
  bool resume = false, retry = false, no_trees = false, json = false;
  // Of every build; empty or nothing: as `morula build` has it.
  std::string method, quality, depth;
  std::optional<unsigned> branching;
  std::optional<std::size_t> spheres;
  std::optional<double> max_protrusion;
  std::optional<std::size_t> seed;
  bool nested = false;
};

// Given to `morula build` as they are; also what tells one batch's results from another's.
std::vector<std::string> build_arguments(const BatchArguments& o) {
  std::vector<std::string> words;
  const auto add = [&](const char* option, const std::string& value) { words.insert(words.end(), {option, value}); };
  if (!o.method.empty()) add("--method", o.method);
  if (!o.quality.empty()) add("--quality", o.quality);
  if (!o.depth.empty()) add("--depth", o.depth);
  if (o.branching) add("--branching", std::to_string(*o.branching));
  if (o.spheres) add("--spheres", std::to_string(*o.spheres));
  if (o.max_protrusion) add("--max-protrusion", fmt::format("{}", *o.max_protrusion));
  if (o.seed) add("--seed", std::to_string(*o.seed));
  if (o.nested) words.emplace_back("--nested");
  return words;
}

// Where everything of a batch is.
struct Places {
  fs::path folder;
  fs::path result(const std::string& key) const { return folder / "results" / key.substr(0, 2) / (key + ".json"); }
  fs::path tree(const std::string& key) const { return folder / "trees" / key.substr(0, 2) / (key + ".morula"); }
  fs::path scratch(const std::string& key) const { return folder / fmt::format(".morula-batch-{}-{}", getpid(), key); }
};

std::optional<Json> parsed(const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

// What a build said of its failure; with --json that is a document of its own.
std::string first_line(const std::string& text) {
  const std::string line = text.substr(0, text.find('\n'));
  if (const std::optional<Json> said = parsed(line); said && said->is_object())
    for (const char* key : {"error", "note"})
      if (said->contains(key)) return said->at(key).get<std::string>();
  constexpr std::string_view begin = "morula: error: ";
  return line.rfind(begin, 0) == 0 ? line.substr(begin.size()) : line;
}

// What is kept of one build. All but `cost` is the same on every run.
Json result_of(const JobResult& job, const BatchArguments& o) {
  Json result{{"status", "ok"}, {"message", ""}};
  const auto failed = [&](const char* status, std::string message) {
    result["status"] = status, result["message"] = std::move(message);
  };
  const std::string words = first_line(job.err);
  if (job.end == JobResult::End::out_of_time) {
    failed("time limit", fmt::format("not done after {} s", *o.time_limit));
  } else if (job.end == JobResult::End::signalled) {
    failed("crashed", fmt::format("ended by signal {} ({})", job.code, strsignal(job.code)));
  } else if (job.code == exit_bad_use) {
    failed("refused", words);
  } else if (job.code == exit_internal_error && words.find("memory") != std::string::npos) {
    failed("memory limit", words);
  } else if (job.code != exit_done) {
    failed("failed", words.empty() ? fmt::format("exit code {}", job.code) : words);
  }
  if (const std::optional<Json> report = parsed(job.out); report && report->contains("tree_hash")) {
    for (const char* key : {"vertices", "facets", "mesh_hash", "method", "branching", "depth", "spheres", "tree_hash",
                            "complete", "covered"})
      result[key] = report->at(key);
    std::size_t nodes = 0;
    for (const Json& level : report->at("levels")) nodes += level.at("nodes").get<std::size_t>();
    result["nodes"] = nodes;
  } else if (result["status"] == "ok") {
    failed("failed", "the build said nothing of its tree");
  }
  result["cost"] = {{"seconds", job.seconds}, {"cpu_seconds", job.cpu_seconds}, {"peak_mb", job.peak_megabytes}};
  return result;
}

std::optional<Json> read_result(const fs::path& path) {
  std::error_code missing;
  if (!fs::exists(path, missing)) return std::nullopt;
  std::string text;
  if (std::FILE* file = std::fopen(path.c_str(), "rb")) {
    std::array<char, 4096> part;
    while (const std::size_t count = std::fread(part.data(), 1, part.size(), file)) text.append(part.data(), count);
    std::fclose(file);
  }
  std::optional<Json> result = parsed(text);
  // Results appear whole; one that cannot be read is somebody else's doing, and is made again.
  if (!result || !result->is_object() || !result->contains("status")) return std::nullopt;
  return result;
}

// An option that no build takes is told before any mesh is read.
void try_options(const BatchArguments& o) {
  const fs::path scratch = fs::temp_directory_path() / fmt::format("morula-batch-{}", getpid());
  const fs::path mesh = scratch.string() + ".obj";
  struct Remove {
    const fs::path& path;
    ~Remove() {
      std::error_code ignored;
      fs::remove(path, ignored);
    }
  } const remove{mesh};
  write_mesh(mesh, sample_body("bar", 3));
  const fs::path tree = scratch.string() + ".morula";
  std::vector<std::string> arguments{"build", mesh.string(), "-o", tree.string(), "--threads", "1"};
  const auto words = build_arguments(o);
  arguments.insert(arguments.end(), words.begin(), words.end());
  Job job(arguments, scratch, {});
  std::optional<JobResult> result;
  while (!(result = job.poll())) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  std::error_code ignored;
  fs::remove(tree, ignored);
  if (result->end == JobResult::End::exited && result->code == exit_bad_use) throw UsageError(first_line(result->err));
}

struct Work {
  std::vector<ManifestRow> rows;        // of this shard
  std::vector<std::string> keys;        // one per row; empty where the file cannot be read
  std::vector<std::string> unreadable;  // its message
  std::map<std::string, Json> results;  // by key
  std::vector<std::size_t> waiting;     // rows, one per key without a result
};

// In which all meshes of a batch have to lie.
FileRoots roots_of(const BatchArguments& o) {
  FileRoots roots({o.roots.begin(), o.roots.end()});
  const fs::path manifest(o.manifest);
  roots.add(fs::is_directory(manifest) ? manifest : manifest.parent_path());
  return roots;
}

Work plan(const std::vector<ManifestRow>& all, const BatchArguments& o, const Places& places, const Shard& shard) {
  std::string options;
  for (const std::string& word : build_arguments(o)) options += word + " ";
  Work work;
  const FileRoots roots = roots_of(o);
  std::set<std::string> seen;
  Progress progress("reading");
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!shard.has(i)) continue;
    progress.update(static_cast<double>(i) / static_cast<double>(all.size()));
    work.rows.push_back(all[i]);
    std::string key, message;
    try {
      if (const std::optional<std::string> outside = roots.refusal(all[i].mesh, "--root"))
        throw FileError(fmt::format("{}: {}", all[i].mesh.string(), *outside));
      key = content_key(all[i].mesh, options + extension(all[i].mesh));
    } catch (const FileError& error) {
      message = error.what();
    }
    if (!key.empty() && seen.insert(key).second) {
      std::optional<Json> result = read_result(places.result(key));
      if (result && (!o.retry || result->at("status") == "ok"))
        work.results.emplace(key, std::move(*result));
      else
        work.waiting.push_back(work.rows.size() - 1);
    }
    work.keys.push_back(std::move(key));
    work.unreadable.push_back(std::move(message));
  }
  return work;
}

// Builds what waits, `jobs` at a time. False when a signal asked for the end.
bool work_off(Work& work, const BatchArguments& o, const Places& places, unsigned jobs, const Interrupt& interrupt) {
  struct Running {
    Job job;
    std::size_t row;
  };
  std::list<Running> running;
  std::size_t next = 0, done = 0, failures = 0;
  const auto options = build_arguments(o);
  Progress progress("building");
  while (next < work.waiting.size() || !running.empty()) {
    if (interrupt.requested()) return false;
    while (running.size() < jobs && next < work.waiting.size()) {
      const std::size_t row = work.waiting[next++];
      const std::string& key = work.keys[row];
      fs::create_directories(places.tree(key).parent_path());
      fs::create_directories(places.result(key).parent_path());
      std::vector<std::string> arguments{
          "build", work.rows[row].mesh.string(), "-o", places.tree(key).string(), "--threads", "1", "--json"};
      arguments.insert(arguments.end(), options.begin(), options.end());
      running.push_back({Job(arguments, places.scratch(key), {o.time_limit, o.memory_limit}), row});
    }
    bool any = false;
    for (auto it = running.begin(); it != running.end();) {
      const std::optional<JobResult> ended = it->job.poll();
      if (!ended) {
        ++it;
        continue;
      }
      const std::string& key = work.keys[it->row];
      Json result = result_of(*ended, o);
      std::error_code ignored;
      if (o.no_trees || result["status"] != "ok") fs::remove(places.tree(key), ignored);
      write_whole(places.result(key), json_text(result, 1) + "\n");
      failures += result["status"] != "ok" ? 1 : 0;
      work.results.insert_or_assign(key, std::move(result));
      it = running.erase(it);
      ++done;
      any = true;
    }
    progress.update(static_cast<double>(done) / static_cast<double>(work.waiting.size()),
                    failures == 0 ? fmt::format("{} of {} meshes", done, work.waiting.size())
                                  : fmt::format("{} of {} meshes, {} failed", done, work.waiting.size(), failures));
    if (!any) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

constexpr std::array columns{"status", "message", "vertices", "facets",  "method",    "branching", "depth",
                             "nodes",  "spheres", "complete", "covered", "mesh_hash", "tree_hash"};

std::string cell(const Json& value) {
  return value.is_string() ? csv_cell(value.get<std::string>()) : value.is_null() ? "" : value.dump();
}

Json row_json(const Work& work, const BatchArguments& o, std::size_t row) {
  Json line{{"name", work.rows[row].name}};
  if (work.keys[row].empty()) {
    line["key"] = nullptr;
    line["status"] = "refused", line["message"] = work.unreadable[row];
    return line;
  }
  const Json& result = work.results.at(work.keys[row]);
  line["key"] = work.keys[row];
  for (const char* column : columns)
    if (result.contains(column)) line[column] = result.at(column);
  if (!o.no_trees && result["status"] == "ok")
    line["tree"] = fmt::format("trees/{}/{}.morula", work.keys[row].substr(0, 2), work.keys[row]);
  return line;
}

// The tables: the same bytes whenever and however often the batch was interrupted. What it cost is in one of its own.
std::map<std::string, std::size_t> write_tables(const Work& work, const BatchArguments& o, const Places& places,
                                                const std::string& suffix) {
  std::string csv = "name,key", lines, costs = "name,key,seconds,cpu_seconds,peak_mb\n";
  for (const char* column : columns) csv += fmt::format(",{}", column);
  csv += ",tree\n";
  std::map<std::string, std::size_t> counts;
  for (std::size_t row = 0; row < work.rows.size(); ++row) {
    const Json line = row_json(work, o, row);
    ++counts[line["status"].get<std::string>()];
    lines += json_text(line, -1) + "\n";
    csv += csv_cell(work.rows[row].name) + "," + work.keys[row];
    for (const char* column : columns) csv += "," + (line.contains(column) ? cell(line[column]) : "");
    csv += "," + (line.contains("tree") ? cell(line["tree"]) : "") + "\n";
    if (work.keys[row].empty()) continue;
    const Json& cost = work.results.at(work.keys[row]).at("cost");
    costs += fmt::format("{},{},{},{},{}\n", csv_cell(work.rows[row].name), work.keys[row], cost["seconds"].dump(),
                         cost["cpu_seconds"].dump(), cost["peak_mb"].dump());
  }
  write_whole(places.folder / ("table" + suffix + ".csv"), csv);
  write_whole(places.folder / ("table" + suffix + ".jsonl"), lines);
  write_whole(places.folder / ("cost" + suffix + ".csv"), costs);
  return counts;
}

int run_batch(const BatchArguments& o) {
  const Shard shard = parse_shard(o.shard);
  if (o.time_limit && !(*o.time_limit > 0)) throw UsageError("--time-limit: give seconds above 0");
  if (o.memory_limit && *o.memory_limit < 64) throw UsageError("--memory-limit: give at least 64 MB");
  const Places places{o.output};
  if (fs::exists(places.folder / "results") && !o.resume && !o.retry && shard.is_all())
    throw UsageError(o.output +
                     " holds results of an earlier batch: add --resume to go on with them, or name another folder");
  const std::vector<ManifestRow> rows = read_manifest(o.manifest);
  try_options(o);
  require_folder_place(places.folder);
  fs::create_directories(places.folder);
  Work work = plan(rows, o, places, shard);
  const std::size_t kept = work.results.size();
  const Workers workers = make_workers(o.jobs);
  const Interrupt interrupt;
  if (!work_off(work, o, places, static_cast<unsigned>(workers.thread_count()), interrupt))
    return say_interrupted(interrupt.exit_code(),
                           fmt::format("what is done is kept; the same command with --resume goes on"));
  const std::string suffix = shard.is_all() ? "" : fmt::format("-{}-of-{}", shard.number, shard.count);
  const auto counts = write_tables(work, o, places, suffix);
  const std::size_t good = counts.contains("ok") ? counts.at("ok") : 0;
  if (o.json) {
    print_json({{"meshes", work.rows.size()},
                {"built", work.waiting.size()},
                {"kept", kept},
                {"statuses", counts},
                {"table", (places.folder / ("table" + suffix + ".csv")).string()}});
  } else {
    fmt::print("{} meshes, {} built now, {} kept from before\n", work.rows.size(), work.waiting.size(), kept);
    for (const auto& [status, count] : counts) fmt::print("  {:<14} {}\n", status, count);
    fmt::print("table: {}\n", (places.folder / ("table" + suffix + ".csv")).string());
  }
  return good == work.rows.size() ? exit_done : exit_check_failed;
}

}  // namespace

void add_batch(CLI::App& app, Run& run) {
  const auto o = std::make_shared<BatchArguments>();
  CLI::App* command = add_command(app, "batch", "Build a tree for each of many meshes, one process each");
  add_option(*command, "manifest", o->manifest, "A folder of meshes, a .csv with a column mesh, or a list of paths")
      ->required()
      ->type_name("MANIFEST");
  add_option(*command, "-o,--output", o->output, "Folder of results: trees, table.csv, table.jsonl, cost.csv")
      ->required()
      ->type_name("FOLDER");
  add_option(*command, "--root", o->roots,
             "Folder, besides the manifest's own, in which its meshes may lie; may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
  add_option(*command, "--jobs", o->jobs, "Processes at once; all processors when not given")
      ->type_name("N")
      ->transform(whole_number(1, 1024));
  add_option(*command, "--shard", o->shard, "Only every n-th mesh: 2/8 is the second of eight parts, for job arrays")
      ->type_name("I/N");
  add_option(*command, "--time-limit", o->time_limit, "Seconds for a mesh; what is not done by then is a failed row")
      ->type_name("S")
      ->transform(number_above_zero());
  add_option(*command, "--memory-limit", o->memory_limit, "Memory for a mesh; what needs more is a failed row")
      ->type_name("MB")
      ->transform(whole_number());
  add_flag(*command, "--resume", o->resume, "Go on with the results that the folder holds");
  add_flag(*command, "--retry", o->retry, "The same, and try again what failed");
  add_flag(*command, "--no-trees", o->no_trees, "Keep the table alone");
  add_option(*command, "--method", o->method, "As of morula build, as are the next ones")->type_name("NAME");
  add_option(*command, "--quality", o->quality, "draft, fast, default, best")->type_name("NAME");
  add_option(*command, "--depth", o->depth, "Levels below the root, or auto")->type_name("N");
  add_option(*command, "--branching", o->branching, "Most children of a node")
      ->type_name("N")
      ->transform(whole_number());
  add_option(*command, "--spheres", o->spheres, "A flat set of at most N spheres")
      ->type_name("N")
      ->transform(whole_number());
  add_option(*command, "--max-protrusion", o->max_protrusion, "As few spheres as needed to stick out by at most LENGTH")
      ->type_name("LENGTH")
      ->transform(number_above_zero());
  add_flag(*command, "--nested", o->nested, "Every sphere contains its children's");
  add_option(*command, "--seed", o->seed, "Of every random choice")->type_name("N")->transform(whole_number());
  add_json(*command, o->json);
  set_footer(
      *command,
      "Example:\n"
      "  morula batch meshes/ -o trees --quality fast\n"
      "  morula batch list.csv -o out --shard \"$SLURM_ARRAY_TASK_ID/64\" --time-limit 600 --resume\n\n"
      "A mesh that crashes the build, takes too long or cannot be read is a row of the table, and the exit code 1.\n"
      "Killed at any instant and resumed, it ends with the same table.");
  on_use(*command, [&run, o] { run = [o] { return run_batch(*o); }; });
}

}  // namespace morula::cli
