// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sine and cosine with the same bits on every machine; library ones differ between processors.
#pragma once

namespace morula {

struct SinCos {
  double sin, cos;
};
/// Absolute error below 3e-16 for |radians| ≤ 1000. sin_cos(0) is exactly {0, 1}.
SinCos sin_cos(double radians);

}  // namespace morula
