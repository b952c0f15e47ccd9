// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// VAMP's collision checks of its panda among boxes, for scripts/planning_peers, which compiles this file against VAMP's
// sources (Apache-2.0) and calls it from Python. No target of the build contains it.
#include <array>
#include <cstddef>
#include <vamp/collision/factory.hh>
#include <vamp/planning/validate.hh>
#include <vamp/robots/panda.hh>

namespace {

using Panda = vamp::robots::Panda;
constexpr std::size_t lanes = vamp::FloatVectorWidth, joints = Panda::dimension;
using Block = Panda::ConfigurationBlock<lanes>;
using World = vamp::collision::Environment<vamp::FloatVector<lanes>>;
constexpr std::size_t padded = (joints + lanes - 1) / lanes * lanes;  // configurations are loaded by whole registers

struct alignas(64) Values {
  std::array<float, padded> value{};

  explicit Values(const float* configuration) {
    for (std::size_t j = 0; j < joints; ++j) value[j] = configuration[j];
  }
};

}  // namespace

extern "C" {

/// Makes a world of boxes, each given by nine numbers: center, angles around x, y and z, half edges. It stays
/// until the process ends.
void* peer_vamp_world(const float* boxes, std::size_t count) {
  vamp::collision::Environment<float> world;
  for (std::size_t i = 0; i < count; ++i) {
    const float* b = boxes + 9 * i;
    world.cuboids.push_back(
        vamp::collision::factory::cuboid::flat(b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8]));
  }
  world.sort();
  return new World(world);
}

std::size_t peer_vamp_spheres() {
  return Panda::n_spheres;
}
std::size_t peer_vamp_lanes() {
  return lanes;
}
std::size_t peer_vamp_resolution() {
  return Panda::resolution;
}  // samples of an edge per radian

/// One verdict for each configuration. VAMP has one verdict for a register, so all its lanes have this configuration.
void peer_vamp_check(const void* world, const float* configurations, std::size_t count, unsigned char* free) {
  for (std::size_t i = 0; i < count; ++i) {
    Block block;
    for (std::size_t j = 0; j < joints; ++j) block[j] = vamp::FloatVector<lanes, 1>(configurations[i * joints + j]);
    free[i] = Panda::fkcc<lanes>(*static_cast<const World*>(world), block);
  }
}

/// One verdict for each group of as many configurations as a register has lanes: whether all are free.
void peer_vamp_check_groups(const void* world, const float* configurations, std::size_t groups, unsigned char* free) {
  for (std::size_t i = 0; i < groups; ++i) {
    Block block;
    for (std::size_t j = 0; j < joints; ++j) {
      alignas(64) std::array<float, lanes> lane{};
      for (std::size_t k = 0; k < lanes; ++k) lane[k] = configurations[(i * lanes + k) * joints + j];
      block[j] = vamp::FloatVector<lanes, 1>(lane.data());
    }
    free[i] = Panda::fkcc<lanes>(*static_cast<const World*>(world), block);
  }
}

/// One verdict for each edge, by samples.
void peer_vamp_check_motions(const void* world, const float* starts, const float* ends, std::size_t count,
                             unsigned char* free) {
  for (std::size_t i = 0; i < count; ++i) {
    const Values start(starts + i * joints), end(ends + i * joints);
    free[i] = vamp::planning::validate_motion<Panda, lanes, Panda::resolution>(Panda::Configuration(start.value.data()),
                                                                               Panda::Configuration(end.value.data()),
                                                                               *static_cast<const World*>(world));
  }
}

}  // extern "C"
