// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula batch: a tree for each of many meshes, one process each; a failure is a row of the table.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/file_reference.hpp>
#include <morula/io/files.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <optional>
#include <platform/console.hpp>
#include <random>
#include <set>
#include <system_error>
#include <utility>

#include "batch/bytes.hpp"
#include "batch/manifest.hpp"
#include "batch/options.hpp"
#include "batch/task.hpp"
#include "batch/worker.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/interrupt.hpp"
#include "shared/name_text.hpp"
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
  bool resume = false, retry = false, no_trees = false, measure = false, quiet = false, json = false;
  // Options of every build; empty or none: the default of `morula build`.
  std::string method, quality, depth, reducers, optimizer;
  std::optional<unsigned> branching;
  std::optional<std::size_t> spheres;
  std::optional<double> max_protrusion, balance_excess;
  std::optional<std::size_t> seed;
  bool nested = false;
};

// Options of `morula build`, and --measure. They distinguish the results of different batches.
std::vector<std::string> build_words(const BatchArguments& o) {
  std::vector<std::string> words;
  const auto add = [&](const char* option, const std::string& value) { words.insert(words.end(), {option, value}); };
  if (!o.method.empty()) add("--method", o.method);
  if (!o.quality.empty()) add("--quality", o.quality);
  if (!o.depth.empty()) add("--depth", o.depth);
  if (o.branching) add("--branching", std::to_string(*o.branching));
  if (o.spheres) add("--spheres", std::to_string(*o.spheres));
  if (o.max_protrusion) add("--max-protrusion", fmt::format("{}", *o.max_protrusion));
  if (o.seed) add("--seed", std::to_string(*o.seed));
  if (!o.reducers.empty()) add("--reducers", o.reducers);
  if (!o.optimizer.empty()) add("--optimizer", o.optimizer);
  if (o.balance_excess) add("--balance-excess", fmt::format("{}", *o.balance_excess));
  if (o.nested) words.emplace_back("--nested");
  if (o.measure) words.emplace_back("--measure");
  return words;
}

// The kept result of earlier batches under a key.
struct Kept {
  std::optional<Json> result;
  bool is_damaged = false;  // a result that has changed since it was written, or whose tree has
};

Kept find_kept(const BatchPlaces& places, const std::string& key, bool no_trees) {
  constexpr std::uintmax_t most = 1 << 22;  // bytes; a result has a few hundred
  Kept kept;
  const fs::path path = places.result(key);
  const std::optional<std::string> text = bytes_of_file(path, most);
  if (text) kept.result = whole_result(*text, key);
  std::error_code none;
  kept.is_damaged = !kept.result && fs::symlink_status(path, none).type() != fs::file_type::not_found;
  if (!kept.result || no_trees) return kept;
  const std::optional<std::string> expected = tree_file_hash(*kept.result);
  Hash128 found;
  // mutant batch-tree-hash: `found.text() == *expected` -> `!expected->empty()`
  if (!expected || (!hash_file(places.tree(key), found) && found.text() == *expected)) return kept;
  return {std::nullopt, true};
}

BatchTask task_of(const BatchArguments& o, const BatchPlaces& places, const fs::path& mesh, const std::string& key) {
  return {.key = key,
          .mesh = fs::absolute(mesh),
          .tree = places.tree(key),
          .result = places.result(key),
          .words = build_words(o),
          .time_limit = o.time_limit,
          .megabytes = o.memory_limit,
          .no_trees = o.no_trees};
}

#ifdef _WIN32
constexpr const char* temporary_variable = "TMP";
#else
constexpr const char* temporary_variable = "TMPDIR";
#endif

// A folder of its own, gone in the end, also where a signal ends the program.
WholeFolder temporary_folder() {
  std::error_code error;
  const fs::path among = fs::temp_directory_path(error);
  if (error)
    throw UsageError(
        fmt::format("the folder for temporary files, which {0} names, is not there: {1}; set {0} to one that is",
                    temporary_variable, error.message()));
  try {
    WholeFolder folder(among / fmt::format("morula-batch-{:08x}", std::random_device()()));
    fs::permissions(folder.path(), fs::perms::owner_all, error);
    return folder;
  } catch (const FileError& failure) {
    throw UsageError(failure.what());
  }
}

struct Work {
  std::vector<TableRow> rows;           // of this shard
  std::vector<fs::path> meshes;         // of each row
  std::map<std::string, Json> results;  // by key
  std::vector<std::size_t> waiting;     // rows, one per key without a result
  std::size_t damaged = 0;              // keys among them that have had one
};

// Folders in which all meshes of a batch have to lie.
FileRoots roots_of(const BatchArguments& o) {
  FileRoots roots({o.roots.begin(), o.roots.end()});
  const fs::path manifest(o.manifest);
  roots.add(fs::is_directory(manifest) ? manifest : manifest.parent_path());
  return roots;
}

Work plan(const std::vector<ManifestRow>& all, const BatchArguments& o, const BatchPlaces& places, const Shard& shard) {
  const std::vector<std::string> words = build_words(o);
  const FileRoots roots = roots_of(o);
  Work work;
  std::set<std::string> seen;
  Progress progress("reading");
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!shard.has(i)) continue;
    progress.update(static_cast<double>(i) / static_cast<double>(all.size()));
    const auto [key, message] = key_of_file(all[i], words, &roots);
    work.rows.push_back({text_of_name(all[i].name), key, message});
    work.meshes.push_back(all[i].mesh);
    if (key.empty() || !seen.insert(key).second) continue;
    Kept kept = find_kept(places, key, o.no_trees);
    work.damaged += kept.is_damaged ? 1 : 0;
    if (kept.result && (!o.retry || kept.result->at("status") == "ok"))
      work.results.emplace(key, std::move(*kept.result));
    else
      work.waiting.push_back(work.rows.size() - 1);
  }
  return work;
}

// A bar for a person; otherwise a line after each tenth of the meshes, and after a minute without one.
class BatchProgress {
 public:
  BatchProgress(std::size_t count, bool is_quiet)
      : count_(count), is_quiet_(is_quiet), is_for_person_(platform::is_terminal(platform::Stream::errors)) {
    if (is_for_person_ && !is_quiet_) bar_.emplace("building");
  }
  void update(std::size_t done, std::size_t failures) {
    const std::string failed = failures == 0 ? "" : fmt::format(", {} failed", failures);
    const std::string text = fmt::format("{} of {} meshes{}", done, count_, failed);
    const double share = static_cast<double>(done) / static_cast<double>(count_);
    if (bar_) bar_->update(share, text);
    const bool is_due = 10 * done / count_ > 10 * reported_ / count_ || since(line_) > 60;
    if (is_quiet_ || is_for_person_ || !is_due || done == count_) return;
    note("{}{}", text, done == 0 ? "" : time_left(since(begun_) * (1 - share) / share));
    reported_ = done;
    line_ = Clock::now();
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

  std::size_t count_, reported_ = 0;
  bool is_quiet_, is_for_person_;
  std::optional<Progress> bar_;
  Clock::time_point begun_ = Clock::now(), line_ = begun_;
};

// The workers of a batch, and the row that each is at.
class Crew {
 public:
  Crew(Work& work, const BatchArguments& o, const BatchPlaces& places, unsigned jobs)
      : work_(work), o_(o), places_(places), seats_(std::min<std::size_t>(jobs, work.waiting.size())) {}

  // Returns false when a signal requested the end.
  bool work_off(const Interrupt& interrupt) {
    BatchProgress progress(std::max<std::size_t>(work_.waiting.size(), 1), o_.quiet);
    while (done_ < work_.waiting.size()) {
      if (interrupt.requested()) return false;
      for (Seat& seat : seats_)
        if (!seat.row && next_ < work_.waiting.size()) begin(seat, work_.waiting[next_++]);
      wait();
      for (Seat& seat : seats_)
        if (seat.row) look_at(seat);
      progress.update(done_, failures_);
    }
    return true;
  }

 private:
  struct Seat {
    std::unique_ptr<BatchWorker> worker;
    std::optional<std::size_t> row;
    bool is_second_try = false;
  };

  void begin(Seat& seat, std::size_t row) {
    if (!seat.worker || seat.worker->is_gone()) seat.worker = std::make_unique<BatchWorker>();
    seat.row = row;
    seat.worker->give(task_of(o_, places_, work_.meshes[row], work_.rows[row].key));
  }
  void wait() {
    std::vector<const platform::ChildProgram*> waits;
    for (const Seat& seat : seats_)
      if (seat.row) waits.push_back(&seat.worker->program());
    platform::ChildProgram::wait_for_any(waits, 100);
  }
  void look_at(Seat& seat) {
    const std::string& key = work_.rows[*seat.row].key;
    const std::optional<std::string> answer = seat.worker->answer();
    if (!answer && !seat.worker->is_gone()) return;
    std::optional<Json> result = answer ? whole_result(*answer, key) : std::nullopt;
    if (!result && !std::exchange(seat.is_second_try, true)) {
      seat.worker.reset();
      return begin(seat, *seat.row);
    }
    if (!result) {
      seat.worker.reset();
      result = lost_result(task_of(o_, places_, work_.meshes[*seat.row], key));
    }
    seat.row.reset();
    seat.is_second_try = false;
    failures_ += result->at("status") != "ok" ? 1 : 0;
    ++done_;
    work_.results.insert_or_assign(key, std::move(*result));
  }

  Work& work_;
  const BatchArguments& o_;
  const BatchPlaces& places_;
  std::vector<Seat> seats_;
  std::size_t next_ = 0, done_ = 0, failures_ = 0;
};

void require_sense(const BatchArguments& o) {
  parse_shard(o.shard);
  if (o.time_limit && !(*o.time_limit > 0)) throw UsageError("--time-limit: give seconds above 0");
}

// An option that no build takes is an error before any mesh is read: a small body is built with all of them.
void try_options(const BatchArguments& o, const StopToken& stop = {}) {
  const WholeFolder folder = temporary_folder();
  const BatchPlaces places{folder.path()};
  write_mesh(folder.path() / "bar.obj", sample_body("bar", 3));
  BatchTask task = task_of(o, places, folder.path() / "bar.obj", "trial");
  task.time_limit = 60;
  task.megabytes.reset();
  const std::optional<Json> result = BatchSeat().build(task, stop);
  if (!result) return;
  if (result->at("status") == "crashed")
    throw UsageError(fmt::format("a small build with these options {}; is there room for temporary files in {}?",
                                 result->at("message").get<std::string>(), fs::temp_directory_path().string()));
  if (result->at("status") == "refused") throw UsageError(result->at("message").get<std::string>());
}

void require_no_results(const BatchArguments& o, const BatchPlaces& places, const Shard& shard) {
  if (!fs::exists(places.folder / "results") || o.resume || o.retry || !shard.is_all()) return;
  throw UsageError(o.output +
                   " holds results of an earlier batch: add --resume to go on with them, or name another folder");
}

void write_batch_tables(const BatchTables& tables, const BatchPlaces& places, const std::string& suffix) {
  write_whole(places.folder / ("table" + suffix + ".csv"), tables.csv);
  write_whole(places.folder / ("table" + suffix + ".jsonl"), tables.jsonl);
  write_whole(places.folder / ("cost" + suffix + ".csv"), tables.cost);
}

int report_batch(const BatchArguments& o, const Work& work, std::size_t kept, const BatchTables& tables,
                 const fs::path& table) {
  if (o.json) {
    print_json({{"meshes", work.rows.size()},
                {"built", work.waiting.size()},
                {"kept", kept},
                {"remade", work.damaged},
                {"statuses", tables.statuses},
                {"table", table.string()}});
  } else {
    fmt::print("{}, {} built, {} kept\n", counted(work.rows.size(), "mesh", "meshes"), work.waiting.size(), kept);
    for (const auto& [status, count] : tables.statuses) fmt::print("  {:<14} {}\n", status, count);
    fmt::print("table: {}\n", table.string());
  }
  const auto good = tables.statuses.find("ok");
  // A shard may have no row.
  return (good != tables.statuses.end() ? good->second : 0) == work.rows.size() ? exit_done : exit_check_failed;
}

int run_batch(const BatchArguments& o) {
  require_sense(o);
  const Shard shard = parse_shard(o.shard);
  const BatchPlaces places{fs::absolute(o.output)};
  require_no_results(o, places, shard);
  const std::vector<ManifestRow> rows = read_manifest(o.manifest);
  {
    const Interrupt interrupt;
    try_options(o, interrupt.token());
    if (interrupt.requested()) return say_interrupted(interrupt.exit_code(), "; nothing was written");
  }
  require_folder_place(o.output);
  fs::create_directories(places.folder);
  Work work = plan(rows, o, places, shard);
  const std::size_t kept = work.results.size();
  if (work.damaged > 0) note_text(remade_text(work.damaged));
  const Workers workers = make_workers(o.jobs);
  const Interrupt interrupt;
  if (!Crew(work, o, places, static_cast<unsigned>(workers.thread_count())).work_off(interrupt))
    return say_interrupted(interrupt.exit_code(), "; what is done is kept, and the same command with --resume goes on");
  const std::string suffix = shard.is_all() ? "" : fmt::format("-{}-of-{}", shard.number, shard.count);
  const BatchTables tables = batch_tables(work.rows, work.results, o.no_trees);
  write_batch_tables(tables, places, suffix);
  return report_batch(o, work, kept, tables, fs::path(o.output) / ("table" + suffix + ".csv"));
}

void add_batch_options(CLI::App& command, BatchArguments& o) {
  add_option(command, "manifest", o.manifest, "A folder of meshes, a .csv with a column mesh, or a list of paths")
      ->required()
      ->type_name("MANIFEST");
  add_option(command, "-o,--output", o.output, "Folder of results: trees, table.csv, table.jsonl, cost.csv")
      ->required()
      ->type_name("FOLDER");
  add_option(command, "--root", o.roots, "Folder besides the manifest's own that may contain meshes; may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
  add_option(command, "--jobs", o.jobs, "Number of processes at once; default: one per processor")
      ->type_name("N")
      ->transform(whole_number(1, 1024));
  add_option(command, "--shard", o.shard, "Only every n-th mesh: 2/8 is the second of eight parts, for job arrays")
      ->type_name("I/N");
  add_option(command, "--time-limit", o.time_limit, "Seconds per mesh; a mesh that takes longer gives a failed row")
      ->type_name("S")
      ->transform(number_above_zero());
  add_option(command, "--memory-limit", o.memory_limit,
             "Memory per mesh, besides the program's own, from 64; a mesh that needs more gives a failed row")
      ->type_name("MB")
      ->transform(whole_number(64, std::size_t{1} << 30));
  add_flag(command, "--resume", o.resume,
           "Continue with the results in the folder; a damaged result or tree is built again");
  add_flag(command, "--retry", o.retry, "Like --resume, and retry failed meshes");
  add_flag(command, "--no-trees", o.no_trees, "Write only the table");
  add_flag(command, "--measure", o.measure,
           "Also measure looseness, uncovered area and distance, and protrusion of every level, as columns");
  add_flag(command, "--quiet", o.quiet, "No progress on stderr");
  add_option(command, "--method", o.method, "Options of morula build, like the next ones")->type_name("NAME");
  add_option(command, "--quality", o.quality, "draft, fast, default, best")->type_name("NAME");
  add_option(command, "--depth", o.depth, "Levels below the root, or auto")->type_name("N");
  add_option(command, "--branching", o.branching, "Largest number of children of a node")
      ->type_name("N")
      ->transform(whole_number());
  add_option(command, "--spheres", o.spheres, "A flat set of at most N spheres")
      ->type_name("N")
      ->transform(whole_number());
  add_option(command, "--max-protrusion", o.max_protrusion,
             "Protrusion of at most LENGTH with as few spheres as possible")
      ->type_name("LENGTH")
      ->transform(number_above_zero());
  add_flag(command, "--nested", o.nested, "Every sphere contains its children's");
  add_option(command, "--seed", o.seed, "Seed of all random choices")->type_name("N")->transform(whole_number());
  add_option(command, "--reducers", o.reducers, "For medial and combined")->type_name("LIST");
  add_option(command, "--optimizer", o.optimizer, "none, recenter, simplex, balance")->type_name("NAME");
  add_option(command, "--balance-excess", o.balance_excess, "For the optimizer balance")
      ->type_name("SHARE")
      ->transform(real_number(0));
  add_json(command, o.json);
}

}  // namespace

std::string remade_text(std::size_t count) {
  return fmt::format("{} in the folder {} damaged or had lost {} and {} built again", counted(count, "result"),
                     count == 1 ? "was" : "were", count == 1 ? "its tree," : "their trees,", count == 1 ? "is" : "are");
}

std::vector<std::string> checked_build_words(const std::vector<std::string>& options) {
  CLI::App app("", "morula");
  CLI::App* const command = add_command(app, "batch", "");
  BatchArguments o;
  add_batch_options(*command, o);
  std::vector<std::string> words{"batch", "manifest", "-o", "output"};
  words.insert(words.end(), options.begin(), options.end());
  std::reverse(words.begin(), words.end());  // as the parser takes them
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    throw UsageError(parse_message(app, error));
  }
  require_sense(o);
  try_options(o);
  return build_words(o);
}

void add_batch(CLI::App& app, Run& run) {
  const auto o = std::make_shared<BatchArguments>();
  CLI::App* command = add_command(app, "batch", "Build a tree for each of many meshes, one process each");
  add_batch_options(*command, *o);
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
