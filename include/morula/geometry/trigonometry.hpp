// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sine, cosine and arctangent with the same bits on every machine; library ones differ between processors.
#pragma once

namespace morula {

struct SinCos {
  double sin, cos;
};
/// Absolute error below 3e-16 for |radians| ≤ 1000; it grows with the number of turns, but sine and cosine are those of
/// one angle for every finite number. NaN for what is not finite. sin_cos(0) is exactly {0, 1}.
SinCos sin_cos(double radians);

/// Angle of the point (x, y) from the positive x axis, -π…π: what std::atan2(y, x) approximates. Relative error below
/// 5e-16; zeros and infinities as there.
double angle_of(double y, double x);

}  // namespace morula
