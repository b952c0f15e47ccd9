// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A capsule with lines through it.
#pragma once

#include <generators/fit/object_lines.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/query/signed_distance.hpp>

namespace morula::test {

struct OnCapsule {
  Mesh mesh = sample_body("capsule", 24);
  detail::ObjectShape shape{mesh};
  detail::ObjectLines lines{mesh, shape, 400, serial_workers()};
};

}  // namespace morula::test
