// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Random cases, one after the other; scripts/properties builds and runs it.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "cases.hpp"
#include "streams.hpp"

namespace {

constexpr const char* help =
    R"(Random bodies, trees, rules and motions, judged by an oracle that shares nothing with the library.

usage: scripts/properties [--cases N] [--seed S] [--first K] [--only K] [--far-builds METHOD] [--keep DIR] [--quiet]

  --cases N    so many cases (100,000)
  --seed S     of all choices (1)
  --first K    the number of the first one (0)
  --only K     case K alone, as it is among others: what a failure's line asks for
  --far-builds METHOD
               instead of these cases: builds of small bodies far from the origin, by this method or by all
  --keep DIR   where to write the mesh, the pose and the description of what fails
  --quiet      no progress

Each case is a mesh of some family, a tree by some generator, rules and some frames; docs/contributing/testing.md lists them. Judged
are the cover of every level in every frame, the contacts of two bodies wherever a query is interrupted, trees by validate(),
and that files give back what they were given. One line for each failure, with the command that repeats it.

Ctrl-C ends it after the case at hand, with the figures so far.

Exit code: 0 all held, 1 something failed or it was stopped, 2 bad use.
example: scripts/properties --cases 2000 --seed 7 --keep build/properties
)";

struct Settings {
  std::uint64_t cases = 100000, seed = 1, first = 0;
  std::string keep;
  std::string far_builds;  // a method's name, or "all"; empty: cases of all kinds
  bool quiet = false;

  std::optional<morula::Method> method() const { return morula::method_from_name(far_builds); }
};

[[noreturn]] void bad_use(const std::string& what) {
  std::fprintf(stderr, "properties: %s; try --help\n", what.c_str());
  std::exit(2);
}

Settings read(int count, char** arguments) {
  Settings settings;
  for (int i = 1; i < count; ++i) {
    const std::string_view name = arguments[i];
    if (name == "--help" || name == "-h") {
      std::fputs(help, stdout);
      std::exit(0);
    }
    if (name == "--quiet") {
      settings.quiet = true;
      continue;
    }
    if (name != "--cases" && name != "--seed" && name != "--first" && name != "--only" && name != "--keep" &&
        name != "--far-builds")
      bad_use("there is no option '" + std::string(name) + "'");
    if (++i == count) bad_use(std::string(name) + " needs a value");
    if (name == "--keep") {
      settings.keep = arguments[i];
      continue;
    }
    if (name == "--far-builds") {
      settings.far_builds = arguments[i];
      if (settings.far_builds != "all" && !settings.method())
        bad_use("--far-builds takes a method or all, not '" + settings.far_builds + "'");
      continue;
    }
    char* end = nullptr;
    const std::uint64_t value = std::strtoull(arguments[i], &end, 10);
    if (*end != '\0' || end == arguments[i] || arguments[i][0] == '-')
      bad_use(std::string(name) + " needs a whole number, not '" + arguments[i] + "'");
    if (name == "--cases") settings.cases = value;
    if (name == "--seed") settings.seed = value;
    if (name == "--first") settings.first = value;
    if (name == "--only") settings.first = value, settings.cases = 1;
  }
  return settings;
}

// The case that is running, for the signals that end a program.
char running[160];

// A run that is asked to end finishes its case and tells what it has judged.
volatile std::sig_atomic_t stop_requested = 0;
extern "C" void stop(int) {
  stop_requested = 1;
}

extern "C" void ended(int signal) {
  morula::properties::write_at_end(running);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

int main(int count, char** arguments) {
  const Settings settings = read(count, arguments);
  for (const int signal : {SIGSEGV, SIGFPE, SIGABRT, SIGILL}) std::signal(signal, ended);
#ifdef SIGBUS
  std::signal(SIGBUS, ended);
#endif
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, stop);
  const bool progress = !settings.quiet && morula::properties::are_errors_seen();
  morula::properties::Record record(settings.keep);
  if (!settings.far_builds.empty()) record.command += " --far-builds " + settings.far_builds;
  morula::properties::Specimens specimens;
  const auto run = [&](std::uint64_t number) {
    if (settings.far_builds.empty())
      morula::properties::run_case(settings.seed, number, specimens, record);
    else
      morula::properties::run_far_build(settings.seed, number, settings.method(), record);
  };
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  const auto start = Clock::now();
  double slowest = 0, shown = 0;
  std::uint64_t slowest_case = 0;
  for (std::uint64_t i = 0; i < settings.cases && stop_requested == 0; ++i) {
    const std::uint64_t number = settings.first + i;
    std::snprintf(running, sizeof running, "ended in: %s --seed %llu --only %llu\n", record.command.c_str(),
                  static_cast<unsigned long long>(settings.seed), static_cast<unsigned long long>(number));
    const auto begun = Clock::now();
    run(number);
    if (const double taken = since(begun); taken > slowest) slowest = taken, slowest_case = number;
    if (progress && since(start) - shown > 0.5) {
      shown = since(start);
      std::fprintf(stderr, "\r%llu of %llu cases, %zu failed ", static_cast<unsigned long long>(i + 1),
                   static_cast<unsigned long long>(settings.cases), record.failed_cases());
    }
  }
  if (progress) std::fprintf(stderr, "\r%60s\r", "");
  std::printf("%s", record.summary(since(start)).c_str());
  std::printf("  slowest case: %llu, %.2f s\n", static_cast<unsigned long long>(slowest_case), slowest);
  const bool stopped = record.counts.cases < settings.cases;
  if (stopped)
    std::printf("stopped; the others: --first %llu --cases %llu\n",
                static_cast<unsigned long long>(settings.first + record.counts.cases),
                static_cast<unsigned long long>(settings.cases - record.counts.cases));
  if (record.failed_cases() == 0) return stopped ? 1 : 0;
  std::printf("%zu of %zu cases failed\n", record.failed_cases(), record.counts.cases);
  return 1;
}
