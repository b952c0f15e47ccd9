// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Status: the outcome of a call that does not throw.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace morula {

/// Calls of every frame return a status, alone or as the base of a result with counters. Other calls throw
/// std::invalid_argument with its message instead. A rejected call changes nothing.
struct [[nodiscard]] Status {
  enum class Code : std::uint8_t {
    ok,
    // Updates
    wrong_vertex_count,
    non_finite_position,     ///< `index`: the lowest such vertex
    bad_range,               ///< vertices: the range ends before it begins, or beyond the last vertex
    needs_coordinates,       ///< positions or transforms given to a body with a level of the rule `modal`
    no_modes,                ///< coordinates given to a body without modes
    wrong_coordinate_count,  ///< another number of coordinates than modes
    bad_coordinate,    ///< not finite, or so large that the body leaves the range of float; `index`: the lowest one not
                       ///< finite, or the one that moves the body most
    needs_transforms,  ///< positions or coordinates given to a body with a level of the rule `skinned`
    no_skin,           ///< transforms given to a body without a skin
    wrong_transform_count,  ///< another number of transforms than bones
    bad_transform,  ///< not finite, or so large that the body leaves the range of float; `index`: the lowest bone
    // Queried bodies
    body_not_current,       ///< the last update was rejected: the spheres belong to an older frame
    body_not_complete,      ///< a lazy update has left nodes behind, and there is no CollideOptions::refresh_children
    no_surface,             ///< facets are required, and the collider has spheres alone
    positions_not_current,  ///< the spheres have moved without positions: Collider::set_positions
    transform_too_far,      ///< translation of 2^200 or more: squares would leave the range of double
    surface_not_current,    ///< the body that a surface follows has moved: SurfaceTree::follow
    // Queries
    bad_option,  ///< not a number, negative where it must not be, or a vertex out of range
    bad_shape,   ///< plane, sphere, capsule, ray or point that is not finite, of negative radius, without direction, or
                 ///< 2^200 or more away; ray with a direction out of range (Ray)
    bad_level,   ///< level that neither tree of a pair has
    // Fronts
    no_front,         ///< no search was started
    other_bodies,     ///< the front belongs to another number of bodies, or to another cover
    other_frame,      ///< a body was updated: carry() the front
    other_transform,  ///< a body has another transform: carry() the front
    other_options,    ///< the front was started with another margin, level or distance
    bad_front,        ///< set_front() got indices out of range
    // Reused objects
    body_replaced,        ///< the body was destroyed or assigned to: create the query or collider again
    in_use,               ///< a callback called the object that runs it
    ended_by_exception,   ///< an exception ended the last call and its results are lost: start again
    changed_during_call,  ///< a callback moved a body or surface that the call read; the call has no results
  };
  Code code = Code::ok;
  std::uint8_t body = 0;                ///< body of the error: 0 for a or the only one, 1 for b
  std::optional<std::uint32_t> pair{};  ///< pair of bodies, if a query has several
  std::size_t index = 0;                ///< index of a vertex, a coordinate or a bone

  explicit operator bool() const { return code == Code::ok; }
  bool operator==(const Status&) const = default;
};

/// The status as text, with the remedy; empty for ok.
std::string message(const Status& status);

}  // namespace morula
