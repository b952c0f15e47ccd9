// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <morula/geometry/status.hpp>
#include <string_view>

namespace morula {
namespace {

// The subject with which a message begins.
enum class Subject : std::uint8_t { none, vertex, coordinate, bone, pair, body, surface };

struct Words {
  Status::Code code;
  Subject subject;
  std::string_view text;
};

using enum Status::Code;
constexpr std::array words{
    Words{ok, Subject::none, ""},
    Words{wrong_vertex_count, Subject::none, "its vertex count is not the mesh's"},
    Words{non_finite_position, Subject::vertex,
          " is not finite, or too far away for single precision: coordinates about the center stay below 1e17"},
    Words{bad_range, Subject::none, "a range of changed vertices ends before it begins, or behind the last vertex"},
    Words{needs_coordinates, Subject::none,
          "the body has levels of the rule modal, which follow coordinates: call update_modal"},
    Words{no_modes, Subject::none, "the body has no modes: give them in UpdateOptions::modes when it is made"},
    Words{wrong_coordinate_count, Subject::none, "the coordinates are not one per mode"},
    Words{bad_coordinate, Subject::coordinate, " is not finite, or moves the body too far for single precision"},
    Words{needs_transforms, Subject::none,
          "the body has levels of the rule skinned, which follow the transforms of bones: call update_skinned"},
    Words{no_skin, Subject::none, "the body has no skin: give it in UpdateOptions::skin when it is made"},
    Words{wrong_transform_count, Subject::none, "the transforms are not one per bone"},
    Words{bad_transform, Subject::bone, " is not finite, or moves the body too far for single precision"},
    Words{body_not_current, Subject::body,
          "'s last update was rejected, so its spheres belong to an older frame: update it first"},
    Words{body_not_complete, Subject::body,
          " was updated lazily, and not all of its nodes have been reached: update it in full, or give "
          "CollideOptions::refresh_children where a query takes it"},
    Words{no_surface, Subject::body,
          " has spheres alone, and the query needs facets: make its collider with a mesh and a cover"},
    Words{positions_not_current, Subject::body,
          " was not given the positions of this frame: call Collider::set_positions after each update"},
    Words{transform_too_far, Subject::body, " is placed 2^200 or more from the origin"},
    Words{surface_not_current, Subject::surface,
          " follows a body that was updated since: call SurfaceTree::follow after each update"},
    Words{inside_out, Subject::body,
          " is inside out where it meets the other: its facets face inward, so turn them over"},
    Words{bad_option, Subject::none,
          "an option of the query is negative or not a number, or a vertex index is out of range"},
    Words{bad_shape, Subject::none,
          "the shape of the query is not finite, has a negative radius or no direction, is 2^200 or more away, or is a "
          "ray whose direction is not longer than 2^-200 and shorter than 2^200: scale the direction"},
    Words{bad_level, Subject::pair, "neither tree has the requested level"},
    Words{no_front, Subject::none, "there is no front: call start() first"},
    Words{other_bodies, Subject::pair, "the front is of other bodies or of another cover: call start()"},
    Words{other_frame, Subject::pair, "a body was updated since the front was made: call carry() or start()"},
    Words{other_transform, Subject::pair,
          "a body was placed elsewhere since the front was made: call carry() or start()"},
    Words{other_options, Subject::none, "the query was started with another margin, level or distance: start it again"},
    Words{bad_front, Subject::none, "the front has indices out of range: call start()"},
    Words{body_replaced, Subject::body, " was destroyed or assigned to: make another collider for the query"},
    Words{in_use, Subject::none,
          "a callback called the object that runs it: use another object, or call it afterwards"},
    Words{ended_by_exception, Subject::none,
          "an exception ended the last call, and its results are lost: call run(), start() or update()"},
    Words{changed_during_call, Subject::body,
          " was moved by a callback of the call that read it, so the call has no results: move bodies and surfaces "
          "after it, and call run(), start() or update() again"},
};
static_assert(
    [] {
      for (std::size_t i = 0; i < words.size(); ++i)
        if (static_cast<std::size_t>(words[i].code) != i) return false;
      return words.back().code == changed_during_call;
    }(),
    "one row for every code, in their order");

std::string subject_of(const Status& status, Subject subject) {
  const std::string pair = status.pair ? "pair " + std::to_string(*status.pair) + ": " : "";
  const std::string which = status.body == 0 ? "the first " : "the second ";
  const std::string index = std::to_string(status.index);
  switch (subject) {
    case Subject::none:
      return {};
    case Subject::vertex:
      return "vertex " + index;
    case Subject::coordinate:
      return "coordinate " + index;
    case Subject::bone:
      return "the transform of bone " + index;
    case Subject::pair:
      return pair;
    case Subject::body:
      return pair + which + "body";
    case Subject::surface:
      return which + "surface";
  }
  return {};
}

}  // namespace

std::string message(const Status& status) {
  const auto i = static_cast<std::size_t>(status.code);
  if (i >= words.size()) return {};
  return subject_of(status, words[i].subject).append(words[i].text);
}

}  // namespace morula
