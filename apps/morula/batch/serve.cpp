// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "batch/serve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <new>
#include <platform/apart.hpp>
#include <platform/console.hpp>
#include <string_view>
#include <system_error>

#include "batch/task.hpp"
#include "batch/worker.hpp"
#include "command_line.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/interrupt.hpp"

namespace morula::cli {
namespace {
namespace fs = std::filesystem;

constexpr const char* measure_word = "--measure";
// A line that begins so is a task for this very process, where a system cannot fork.
constexpr std::string_view apart_word = "apart ";

struct Streams {
  platform::ScratchFile out, figures, errors;
};

// Figures of the fit, per level, of the tree that the build has written: those of `morula measure`.
Json figures_of(const BatchTask& task) {
  const Mesh mesh = read_mesh(task.mesh);
  MeasureOptions options;
  options.open_by_winding = true;
  const std::vector<LevelMeasure> levels = measure(mesh, read_tree(task.tree).tree, options, serial_workers());
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  Json figures{{"closed", inspect(mesh).closed}};
  for (const char* name : {"looseness", "uncovered_area", "uncovered_distance", "protrusion"})
    figures[name] = Json::array();
  for (const LevelMeasure& level : levels) {
    figures["looseness"].push_back(number(level.looseness.looseness));
    figures["uncovered_area"].push_back(level.coverage.uncovered_area);
    figures["uncovered_distance"].push_back(level.coverage.uncovered_distance);
    figures["protrusion"].push_back(number(level.protrusion ? std::optional(level.protrusion->worst) : std::nullopt));
  }
  return figures;
}

int measure_built(const BatchTask& task, std::uint64_t figures) {
  try {
    return platform::write_scratch(figures, json_text(figures_of(task), -1)) ? exit_done : exit_check_failed;
  } catch (const std::bad_alloc&) {
    return complain_text(exit_internal_error, "not enough memory");
  } catch (const std::exception& error) {
    return complain_text(exit_check_failed, error.what());
  }
}

// `morula build`, then figures if they are requested. Returns the exit code.
int build_and_measure(const BatchTask& task, std::uint64_t figures) {
  std::vector<std::string> words{"morula", "build", task.mesh.string(), "-o", task.tree.string(), "--threads",
                                 "1",      "--json"};
  bool measures = false;
  for (const std::string& word : task.words) {
    if (word == measure_word)
      measures = true;
    else
      words.push_back(word);
  }
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const int code = command_line(static_cast<int>(words.size()), pointers.data());
  return code == exit_done && measures ? measure_built(task, figures) : code;
}

// The whole of a process that builds one tree. figures: the number of the file for them.
int run_build(const BatchTask& task, std::uint64_t figures) {
  try {
    write_messages_as_json(true);
    watch_signals();
    return build_and_measure(task, figures);
  } catch (const std::bad_alloc&) {
    return complain_text(exit_internal_error, "not enough memory");
  }
}

ProcessEnd build_apart(const BatchTask& task, const Streams& streams) {
  for (const platform::ScratchFile* stream : {&streams.out, &streams.figures, &streams.errors}) stream->clear();
  const std::uint64_t figures = streams.figures.number();
  const platform::ApartWork work{.run = [&] { return run_build(task, figures); },
                                 .program = worker_path(),
                                 .words = worker_words(),
                                 .input = fmt::format("{}{} {}\n", apart_word, figures, task_line(task))};
  const platform::ApartEnd done =
      platform::run_apart(work, {.out = streams.out, .errors = streams.errors, .extra = streams.figures},
                          {.seconds = task.time_limit, .megabytes = task.megabytes});
  if (done.how == platform::ApartEnd::How::abandoned) std::_Exit(exit_done);
  ProcessEnd end;
  if (done.how == platform::ApartEnd::How::out_of_time)
    end.how = ProcessEnd::How::out_of_time;
  else if (done.status.by_signal)
    end.how = ProcessEnd::How::signaled;
  end.code = done.status.code;
  end.seconds = done.seconds;
  end.cpu_seconds = done.cpu_seconds;
  end.peak_megabytes = done.peak_megabytes;
  constexpr std::size_t most = 1 << 24;  // bytes; more is no report
  end.out = streams.out.text(most);
  end.figures = streams.figures.text(most);
  end.errors = streams.errors.text(most);
  return end;
}

Json keep(const Json& result, const BatchTask& task) {
  std::error_code ignored;
  if (task.no_trees || result.at("status") != "ok") fs::remove(task.tree, ignored);
  if (!task.result.empty()) write_whole(task.result, result_text(result));
  return result;
}

// A write to a link goes to its target, which may be the kept result of another mesh.
void remove_link(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_symlink(fs::symlink_status(path, ignored))) fs::remove(path, ignored);
}

// Nothing that happens to one mesh ends the worker; a result that cannot be kept is one that failed, and is tried again
// the next time.
Json result_of_task(const BatchTask& task, const Streams& streams) {
  try {
    fs::create_directories(task.tree.parent_path());
    if (!task.result.empty()) fs::create_directories(task.result.parent_path());
    for (const fs::path* path : {&task.tree, &task.result}) remove_link(*path);
    bool is_kept = true;
    const Json result = result_of(build_apart(task, streams), task, is_kept);
    return is_kept ? keep(result, task) : result;
  } catch (const std::exception& error) {
    return result_without_build(task.key, "failed", fmt::format("cannot be kept: {}", error.what()));
  }
}

bool read_line(std::string& waiting, std::string& line) {
  for (;;) {
    if (const std::size_t end = waiting.find('\n'); end != std::string::npos) {
      line = waiting.substr(0, end);
      waiting.erase(0, end + 1);
      return true;
    }
    if (!platform::read_input(waiting)) return false;
  }
}

// This process is the one that builds: no fork made it.
int build_here(std::string_view order) {
  platform::open_standard_streams();
  platform::leave_with_input(take_signal);
  std::uint64_t figures = 0;
  const auto number = std::from_chars(order.data(), order.data() + order.size(), figures);
  return run_build(task_of_line({number.ptr, order.data() + order.size()}), figures);
}

}  // namespace

bool is_worker(int argc, char** argv) {
  return argc == 2 && std::strcmp(argv[1], worker_word) == 0;
}

int serve_batch() {
  platform::become_worker();
  try {
    const Streams streams;
    std::string waiting, line;
    while (read_line(waiting, line)) {
      if (line.starts_with(apart_word)) return build_here(std::string_view(line).substr(apart_word.size()));
      const Json result = result_of_task(task_of_line(line), streams);
      if (!platform::write_output(json_text(result, -1) + "\n")) break;
    }
  } catch (const std::exception& error) {
    return complain_text(exit_internal_error, error.what());
  }
  return exit_done;
}

}  // namespace morula::cli
