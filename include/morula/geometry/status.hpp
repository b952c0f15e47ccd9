// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Status: the outcome of a call that rejects bad input without an exception.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace morula {

/// Calls that programs make in every frame return a status, alone or as the base of a result with counters. It converts
/// to true if the call was not rejected. Other calls throw std::invalid_argument with the same message. A rejected call
/// leaves bodies, spheres and fronts as they were; a rejected update of a body also makes Body::is_current() false.
struct [[nodiscard]] Status {
  enum class Code : std::uint8_t {
    ok,
    // Updates
    wrong_vertex_count,
    non_finite_position,  ///< a position not finite, or too far from the center for float; `index`: the lowest vertex
    bad_range,            ///< a range of changed vertices that ends before it begins, or beyond the last vertex
    needs_coordinates,    ///< positions or transforms for a body with a level of the rule `modal`
    no_modes,             ///< coordinates for a body without modes
    wrong_coordinate_count,  ///< another number of coordinates than modes
    bad_coordinate,    ///< not finite, or so large that the body leaves the range of float; `index`: the lowest one not
                       ///< finite, or the one that moves the body most
    needs_transforms,  ///< positions or coordinates for a body with a level of the rule `skinned`
    no_skin,           ///< transforms for a body without a skin
    wrong_transform_count,  ///< another number of transforms than bones
    bad_transform,  ///< not finite, or so large that the body leaves the range of float; `index`: the lowest bone
    // Queried bodies
    body_not_current,       ///< the last update was rejected: the spheres belong to an older frame
    body_not_complete,      ///< a lazy update left nodes of an older frame; CollideOptions::refresh_children is missing
    no_surface,             ///< the query reads facets, and the collider has spheres alone
    positions_not_current,  ///< the query reads facets, and their positions are of another frame:
                            ///< Collider::set_positions
    transform_too_far,      ///< a translation of 2^200 or more, whose squares would leave the range of double
    surface_not_current,    ///< the body that a surface tree follows was updated since: SurfaceTree::follow
    inside_out,             ///< facets face inward where the query needs the inside of the body
    // Queries
    bad_option,  ///< an option not a number or negative; an index out of range
    bad_shape,   ///< a plane, sphere, capsule, ray or point that is not finite, has a negative radius or no direction,
                 ///< or is 2^200 or more away; a ray with a direction out of range (Ray)
    bad_level,   ///< a level that neither tree of a pair has
    // Fronts
    no_front,         ///< there is no front to continue from: start() first
    other_bodies,     ///< the front belongs to another number of pairs, or to bodies with another cover
    other_frame,      ///< a body was updated after the last call: carry() or start()
    other_transform,  ///< a body has another transform than in the last call: carry() or start()
    other_options,    ///< the query was started with another margin, level or distance
    bad_front,        ///< the front of set_front() has indices out of range
    // Reused objects
    body_replaced,        ///< the body was destroyed or assigned to: make another collider and add it
    in_use,               ///< a callback called the object that was calling it
    ended_by_exception,   ///< an exception ended the last call and its results are lost: run(), start() or update()
                          ///< again
    changed_during_call,  ///< a callback moved a body or surface that the call read; the call has no results
  };
  Code code = Code::ok;
  std::uint8_t body = 0;                ///< body of the fault: 0 for a or the only one, 1 for b
  std::optional<std::uint32_t> pair{};  ///< number of the pair of bodies of the fault, for queries of several pairs
  std::size_t index = 0;                ///< index of the vertex, coordinate or bone of the fault; otherwise 0

  explicit operator bool() const { return code == Code::ok; }
  bool operator==(const Status&) const = default;
};

/// The fault and its remedy as text; empty for ok.
std::string message(const Status& status);

}  // namespace morula
