// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario build: every generator, branching 8, depth 3.
#include <morula/build/build.hpp>

#include "scenario.hpp"

namespace morula::bench {

std::vector<Result> run_build(const Input& input, const Settings& settings) {
  std::vector<Result> results;
  for (const Method method : all_methods()) {
    Result result{.scenario = "build", .item = std::string(name(method)), .mesh = input.name};
    const BuildOptions options{.method = method, .branching = 8, .depth = 3};

    Built built;
    std::vector<std::uint64_t> hashes;
    result.seconds = timed(settings, [&] { built = build(input.mesh, options, *settings.workers); });
    hashes.push_back(tree_hash(built.tree));
    if (settings.workers->thread_count() > 1) hashes.push_back(tree_hash(build(input.mesh, options).tree));

    result.expect(hashes.front() == hashes.back(), "another tree on one thread");
    for (const std::string& fault : validate(input.mesh, built)) result.faults.push_back(fault);
    const Certificate certificate = certify(built.cover, input.mesh.positions, built.tree.spheres, *settings.workers);
    result.expect(certificate.covered, "surface outside the spheres");

    result.figures = {{"spheres", static_cast<double>(built.tree.node_count())},
                      {"leaves", static_cast<double>(built.tree.leaf_count())},
                      {"patches", static_cast<double>(built.cover.patch_count())},
                      {"cut points", static_cast<double>(built.cover.cut_points.size())},
                      {"us/facet", 1e6 * median(result.seconds) / static_cast<double>(input.mesh.facet_count())}};
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace morula::bench
