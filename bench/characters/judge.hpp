// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <morula/update/body.hpp>
#include <morula/update/skin.hpp>
#include <span>

namespace morula::characters {

/// The largest |corner - center| - radius over all nodes of the body and the corners that they own, with positions
/// computed from the definition of a skin in long double; shares no code with the rule and with certify(). Rounded up
/// to double.
double largest_excess(const Body& body, const Mesh& mesh, const Skin& skin,
                      std::span<const AffineTransform> transforms);

}  // namespace morula::characters
