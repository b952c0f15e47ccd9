// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula_bits: computes one of everything and prints a hash of each, one claim a line; then again with every kind of
// kernels that the processor has, and with other numbers of workers. 1 when these differ among themselves. What another
// build or another machine prints is for scripts/bits to compare.
// usage: morula_bits [--quick | --motions]   with --quick, for emulators: with several workers only what takes little
// time; with --motions only what moves, which is all that kinds of kernels compute
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <string>

#include "claims.hpp"
#include "simd/processors.hpp"

namespace morula::bits {
using namespace detail;
namespace {

// Lines "= HOW: N of M" or, for each that differs, "! HOW: NAME".
bool same(const char* how, const Claims& claims, const Claims& reference) {
  std::size_t equal = 0;
  for (std::size_t i = 0; i < reference.size(); ++i)
    if (i < claims.size() && claims[i] == reference[i])
      ++equal;
    else
      std::printf("! %s: %s\n", how, reference[i].name.c_str());
  std::printf("= %s: %zu of %zu\n", how, equal, reference.size());
  std::fflush(stdout);
  return equal == reference.size() && claims.size() == reference.size();
}

enum class Parts { all, quick, motions };

int run(Parts parts) {
  const std::size_t kinds = runnable_kinds();
  const Claims still = parts == Parts::motions ? Claims() : shapes(serial_workers()),
               moving = motions(serial_workers());
  for (const Claims* claims : {&still, &moving})
    for (const Claim& claim : *claims) std::printf("%016" PRIx64 " %s\n", claim.hash, claim.name.c_str());
  std::fflush(stdout);

  bool all_same = true;
  for (std::size_t kind = 1; kind < kinds; ++kind) {
    allow_kinds(kind);
    all_same &= same(kind_name(kind - 1), motions(serial_workers()), moving);
  }
  allow_kinds(kinds);
  all_same &= same(kind_name(kinds - 1), motions(serial_workers()), moving);
  for (const unsigned count : {2u, 3u}) {
    Workers workers(count);
    if (workers.thread_count() != count) break;
    const std::string how = std::to_string(count) + " workers";
    if (parts == Parts::all) all_same &= same((how + ", shapes").c_str(), shapes(workers), still);
    all_same &= same((how + ", motions").c_str(), motions(workers), moving);
  }
  return all_same ? 0 : 1;
}

}  // namespace
}  // namespace morula::bits

int main(int argc, char** argv) {
  using morula::bits::Parts;
  Parts parts = Parts::all;
  if (argc == 2 && std::strcmp(argv[1], "--quick") == 0) parts = Parts::quick;
  if (argc == 2 && std::strcmp(argv[1], "--motions") == 0) parts = Parts::motions;
  if (argc > 1 && parts == Parts::all) return std::fprintf(stderr, "usage: morula_bits [--quick | --motions]\n"), 2;
  return morula::bits::run(parts);
}
