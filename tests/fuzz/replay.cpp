// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The plain driver: runs a fuzzer's inputs where there is no libFuzzer, then damaged ones, the same on every run for as
// long as there is time.
//
// usage: fuzz_NAME [--seconds S] [--most N] [--keep FILE] FILE|FOLDER...
//   --seconds S  at most so long for damaged inputs; 0: none
//   --most N     at most so many
//   --keep FILE  the present input is always there: what to look at after a crash
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <morula/geometry/reproducible.hpp>
#include <string>
#include <support/scratch_folder.hpp>
#include <vector>

#include "fuzz.hpp"

namespace {

namespace fs = std::filesystem;
using morula::Random;

std::vector<std::string> inputs_of(const std::vector<fs::path>& places) {
  std::vector<fs::path> files;
  for (const fs::path& place : places) {
    if (!fs::is_directory(place)) {
      if (fs::exists(place)) files.push_back(place);
      continue;
    }
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(place))
      if (entry.is_regular_file()) found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  std::vector<std::string> inputs;
  for (const fs::path& file : files) inputs.push_back(morula::test::bytes_of(file));
  return inputs;
}

std::string damaged(const std::vector<std::string>& inputs, Random& random) {
  const auto below = [&](std::size_t bound) { return static_cast<std::size_t>(random.next() % bound); };
  std::string bytes = inputs[below(inputs.size())];
  for (std::size_t n = 1 + below(4); n > 0 && !bytes.empty(); --n) {
    const std::size_t at = below(bytes.size());
    const std::size_t length = 1 + below(std::min<std::size_t>(32, bytes.size() - at));
    switch (below(7)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(random.next());
        break;
      case 2:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 3:
        bytes.erase(at, length);
        break;
      case 4: {  // from another input
        const std::string& other = inputs[below(inputs.size())];
        if (!other.empty()) bytes.replace(at, length, other.substr(below(other.size()), length));
        break;
      }
      case 5: {  // a number such as counts are afraid of
        constexpr const char* words[]{"0", "-1", "2147483648", "4294967295", "4294967296", "1e999", "nan", "1e-400"};
        bytes.replace(at, std::min<std::size_t>(length, 4), words[below(std::size(words))]);
        break;
      }
      default:
        bytes.replace(at, std::min<std::size_t>(4, bytes.size() - at), 4, random.next() % 2 ? '\xff' : '\0');
    }
  }
  return bytes;
}

void run(const std::string& bytes, const std::string& keep) {
  if (!keep.empty()) std::ofstream(keep, std::ios::binary) << bytes;
  // A copy of exactly this size: a byte read beyond it is seen by the sanitizers.
  const std::vector<std::uint8_t> input(bytes.begin(), bytes.end());
  LLVMFuzzerTestOneInput(input.data(), input.size());
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 0;
  std::size_t most = 1'000'000;
  std::string keep;
  std::vector<fs::path> places;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (i + 1 < argc && argument == "--seconds") {
      seconds = std::strtod(argv[++i], nullptr);
    } else if (i + 1 < argc && argument == "--most") {
      most = std::strtoull(argv[++i], nullptr, 10);
    } else if (i + 1 < argc && argument == "--keep") {
      keep = fs::absolute(argv[++i]).string();
    } else {
      places.push_back(fs::absolute(argument));
    }
  }
  const std::vector<std::string> inputs = inputs_of(places);
  if (inputs.empty()) {
    std::fprintf(stderr, "no inputs: name files or folders of seeds\n");
    return 2;
  }
  // The targets may print much, or change the folder: what this program says goes where it was started.
  std::FILE* const out = morula::fuzz::report();
  for (const std::string& bytes : inputs) run(bytes, keep);
  Random random(1);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  std::size_t count = 0;
  while (count < most && elapsed() < seconds) {
    run(damaged(inputs, random), keep);
    ++count;
  }
  std::fprintf(out, "%zu inputs and %zu damaged ones: no findings\n", inputs.size(), count);
  return 0;
}
