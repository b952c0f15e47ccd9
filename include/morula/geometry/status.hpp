// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Status: what came of a call that does not throw.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace morula {

/// Calls that are made every frame return one, alone or as the base of a result with counters; calls that are made once
/// throw std::invalid_argument with its message instead. A call that is refused changes nothing.
struct [[nodiscard]] Status {
  enum class Code : std::uint8_t {
    ok,
    // Updates
    wrong_vertex_count,
    non_finite_position,     ///< `index`: the lowest such vertex
    bad_range,               ///< of vertices: ends before it begins, or behind the last one
    needs_coordinates,       ///< positions or transforms given to a body with a level of the rule `modal`
    no_modes,                ///< coordinates given to a body without modes
    wrong_coordinate_count,  ///< not one per mode
    bad_coordinate,    ///< not finite, or so large that the body leaves the range of float; `index`: the lowest not
                       ///< finite, or the one that moves most
    needs_transforms,  ///< positions or coordinates given to a body with a level of the rule `skinned`
    no_skin,           ///< transforms given to a body without a skin
    wrong_transform_count,  ///< not one per bone
    bad_transform,  ///< not finite, or so large that the body leaves the range of float; `index`: the lowest bone
    // Bodies that are asked
    body_not_current,       ///< the last update was refused: the spheres are those of an older frame
    body_not_complete,      ///< a lazy update has left nodes behind, and there is no CollideOptions::refresh_children
    no_surface,             ///< facets are asked for, and the collider has spheres alone
    positions_not_current,  ///< the spheres have moved, and nobody gave the positions: Collider::set_positions
    transform_too_far,      ///< a translation of 2^200 or more: squares would leave the range of double
    surface_not_current,    ///< the body that a surface follows has moved: SurfaceTree::follow
    // Questions
    bad_option,  ///< not a number, negative where it must not be, or a vertex that is none
    bad_shape,   ///< a plane, sphere, capsule, ray or point that is not finite, of negative radius, without direction,
                 ///< or 2^200 or more away
    bad_level,   ///< both trees of a pair have fewer levels
    // Fronts
    no_front,         ///< nothing was started
    other_bodies,     ///< the front is of another number of bodies, or of another cover
    other_frame,      ///< a body was updated: carry() the front
    other_transform,  ///< a body was placed elsewhere: carry() the front
    other_options,    ///< what was started is of another margin, level or distance
    bad_front,        ///< one from set_front() has indices out of range
    // Objects that are asked again
    body_replaced,        ///< the body was destroyed or assigned to: create the query or collider again
    in_use,               ///< a callback asks the object whose call it is part of
    ended_by_exception,   ///< an exception ended the last call and its results are gone: start again
    changed_during_call,  ///< a callback moved a body or surface that the call read; nothing is left of the call
  };
  Code code = Code::ok;
  std::uint8_t body = 0;                ///< which one: 0 for a or the only one, 1 for b
  std::optional<std::uint32_t> pair{};  ///< of bodies, where a query has several
  std::size_t index = 0;                ///< of a vertex, a coordinate or a bone

  explicit operator bool() const { return code == Code::ok; }
  bool operator==(const Status&) const = default;
};

/// In words, with the remedy; empty for ok.
std::string message(const Status& status);

}  // namespace morula
