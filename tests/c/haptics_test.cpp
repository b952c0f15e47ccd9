// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Haptics in C: the steps of the C++ interface, bit for bit; faults as codes with words.
#include <gtest/gtest.h>
#include <morula/morula.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/surface/haptic_probe.hpp>
#include <morula/surface/haptic_tool.hpp>
#include <string>

namespace morula {
namespace {

Vec3 vec(const double* v) {
  return {v[0], v[1], v[2]};
}

class CHaptics : public testing::Test {
 protected:
  CHaptics() {
    EXPECT_EQ(morula_mesh_sample("limb", 12, &mesh_), MORULA_OK);
    morula_build_options options;
    morula_build_options_init(&options);
    options.method = "octree";
    EXPECT_EQ(morula_build(mesh_, &options, &model_), MORULA_OK);
    EXPECT_EQ(morula_body_create(mesh_, model_, nullptr, &c_body), MORULA_OK);
  }
  ~CHaptics() override {
    morula_body_destroy(c_body);
    morula_model_destroy(model_);
    morula_mesh_destroy(mesh_);
  }
  CHaptics(const CHaptics&) = delete;
  CHaptics& operator=(const CHaptics&) = delete;

  morula_body* c_body = nullptr;
  Mesh mesh = sample_body("limb", 12);
  Body body{mesh, build(mesh, {.method = Method::octree})};
  Collider collider{mesh, body};

 private:
  morula_mesh* mesh_ = nullptr;
  morula_model* model_ = nullptr;
};

TEST_F(CHaptics, probes_have_the_bits_of_the_other_interface) {
  morula_haptic_options options;
  morula_haptic_options_init(&options);
  options.radius = 0.05, options.stiffness = 300, options.friction = 0.2, options.smooth_normals = 1;
  morula_haptic_probe* probe = nullptr;
  ASSERT_EQ(morula_haptic_probe_create(&options, &probe), MORULA_OK) << morula_message();
  HapticProbe expected({.radius = 0.05, .stiffness = 300, .smooth_normals = true, .friction = 0.2});
  int touched = 0;
  for (int k = 0; k < 50; ++k) {
    const double device[3] = {0.5 * std::cos(0.2 * k), k == 0 ? 3.0 : 0.1, 0.5 * std::sin(0.2 * k)};
    morula_haptic_step step;
    ASSERT_EQ(morula_haptic_probe_step(probe, c_body, device, &step), MORULA_OK) << morula_message();
    const HapticStep other = expected.step(collider, vec(device));
    EXPECT_EQ(vec(step.proxy), other.proxy);
    EXPECT_EQ(vec(step.force), other.force);
    EXPECT_EQ(vec(step.normal), other.normal);
    EXPECT_EQ(step.touches != 0, other.touches);
    EXPECT_EQ(step.settled != 0, other.settled);
    EXPECT_EQ(step.jammed != 0, other.jammed);
    EXPECT_EQ(step.certified != 0, other.certified);
    EXPECT_EQ(step.moves, other.moves);
    EXPECT_EQ(step.facet, other.contact ? other.contact->facet : UINT32_MAX);
    if (other.contact) {
      EXPECT_EQ(vec(step.point), other.contact->point);
      EXPECT_EQ(vec(step.barycentric),
                (Vec3{other.contact->barycentric[0], other.contact->barycentric[1], other.contact->barycentric[2]}));
    }
    touched += step.touches;
  }
  EXPECT_GT(touched, 10);
  morula_haptic_probe_reset(probe);
  const double far[3] = {4, 4, 4};
  morula_haptic_step step;
  ASSERT_EQ(morula_haptic_probe_step(probe, c_body, far, &step), MORULA_OK);
  EXPECT_EQ(vec(step.proxy), vec(far));
  morula_haptic_probe_destroy(probe);
}

TEST_F(CHaptics, tools_have_the_bits_of_the_other_interface) {
  const morula_sphere balls[3] = {{-0.2, 0, 0, 0.05}, {0, 0, 0, 0.05}, {0.2, 0, 0, 0.02}};
  const std::vector<Sphere> same{{{-0.2, 0, 0}, 0.05}, {{0, 0, 0}, 0.05}, {{0.2, 0, 0}, 0.02}};
  morula_haptic_tool* tool = nullptr;
  ASSERT_EQ(morula_haptic_tool_create(balls, 3, nullptr, &tool), MORULA_OK) << morula_message();
  HapticTool expected(same);
  std::uint32_t touched = 0;
  for (int k = 0; k < 40; ++k) {
    const RigidTransform device = RigidTransform::from_axis({1, 2, 3}, 0.1 * k, {k == 0 ? 5.0 : 0.3, 0.0, 0.02 * k});
    double rotation[9];
    for (std::size_t n = 0; n < 9; ++n) rotation[n] = device.rows[n / 3][static_cast<int>(n % 3)];
    const double translation[3] = {device.translation.x, device.translation.y, device.translation.z};
    morula_haptic_tool_result step;
    ASSERT_EQ(morula_haptic_tool_step(tool, c_body, rotation, translation, &step), MORULA_OK) << morula_message();
    const HapticToolStep other = expected.step(collider, device);
    for (std::size_t row = 0; row < 3; ++row) EXPECT_EQ(vec(step.rotation + 3 * row), other.proxy.rows[row]);
    EXPECT_EQ(vec(step.translation), other.proxy.translation);
    EXPECT_EQ(vec(step.force), other.force);
    EXPECT_EQ(vec(step.torque), other.torque);
    EXPECT_EQ(step.settled != 0, other.settled);
    EXPECT_EQ(step.jammed != 0, other.jammed);
    ASSERT_EQ(step.contact_count, other.contacts.size());
    for (std::uint32_t n = 0; n < step.contact_count; ++n) {
      const morula_tool_contact& contact = morula_haptic_tool_contacts(tool)[n];
      EXPECT_EQ(contact.ball, other.contacts[n].ball);
      EXPECT_EQ(contact.facet, other.contacts[n].point.facet);
      EXPECT_EQ(contact.distance, other.contacts[n].distance);
      EXPECT_EQ(vec(contact.point), other.contacts[n].point.point);
      EXPECT_EQ(vec(contact.normal), other.contacts[n].normal);
    }
    touched += step.contact_count;
  }
  EXPECT_GT(touched, 5u);
  morula_haptic_tool_reset(tool);
  morula_haptic_tool_destroy(tool);
}

TEST_F(CHaptics, reject_bad_arguments_in_words) {
  morula_haptic_options options;
  morula_haptic_options_init(&options);
  morula_haptic_probe* probe = nullptr;
  options.radius = -1;
  EXPECT_EQ(morula_haptic_probe_create(&options, &probe), MORULA_BAD_ARGUMENT);
  EXPECT_NE(std::string(morula_message()).find("radius"), std::string::npos);
  EXPECT_EQ(probe, nullptr);
  options.radius = 0, options.max_moves = 0;
  EXPECT_EQ(morula_haptic_probe_create(&options, &probe), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_haptic_probe_create(nullptr, nullptr), MORULA_BAD_ARGUMENT);
  ASSERT_EQ(morula_haptic_probe_create(nullptr, &probe), MORULA_OK);
  morula_haptic_step step;
  const double bad[3] = {0, std::numeric_limits<double>::quiet_NaN(), 0};
  EXPECT_NE(morula_haptic_probe_step(probe, c_body, bad, &step), MORULA_OK);
  EXPECT_NE(morula_haptic_probe_step(probe, nullptr, bad, &step), MORULA_OK);
  EXPECT_NE(morula_haptic_probe_step(nullptr, c_body, bad, &step), MORULA_OK);
  morula_haptic_probe_destroy(probe);
  morula_haptic_probe_destroy(nullptr);
  morula_haptic_tool* tool = nullptr;
  const morula_sphere ball{0, 0, 0, -1};
  EXPECT_EQ(morula_haptic_tool_create(&ball, 1, nullptr, &tool), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_haptic_tool_create(&ball, 0, nullptr, &tool), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_haptic_tool_contacts(nullptr), nullptr);
  morula_haptic_tool_destroy(nullptr);
}

}  // namespace
}  // namespace morula
