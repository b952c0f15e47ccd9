// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/geometry/status.hpp>

namespace morula {

std::string message(const Status& status) {
  using Code = Status::Code;
  const std::string pair = status.pair ? "pair " + std::to_string(*status.pair) + ": " : "";
  const std::string body = pair + (status.body == 0 ? "the first body" : "the second body");
  const std::string index = std::to_string(status.index);
  switch (status.code) {
    case Code::ok:
      return {};
    case Code::wrong_vertex_count:
      return "its vertex count is not the mesh's";
    case Code::non_finite_position:
      return "vertex " + index +
             " is not finite, or too far away for single precision: coordinates about the center stay below 1e17";
    case Code::bad_range:
      return "a range of changed vertices ends before it begins, or behind the last vertex";
    case Code::needs_coordinates:
      return "the body has levels of the rule modal, which follow coordinates: call update_modal";
    case Code::no_modes:
      return "the body has no modes: give them in UpdateOptions::modes when it is made";
    case Code::wrong_coordinate_count:
      return "the coordinates are not one per mode";
    case Code::bad_coordinate:
      return "coordinate " + index + " is not finite, or moves the body too far for single precision";
    case Code::needs_transforms:
      return "the body has levels of the rule skinned, which follow the transforms of bones: call update_skinned";
    case Code::no_skin:
      return "the body has no skin: give it in UpdateOptions::skin when it is made";
    case Code::wrong_transform_count:
      return "the transforms are not one per bone";
    case Code::bad_transform:
      return "the transform of bone " + index + " is not finite, or moves the body too far for single precision";
    case Code::body_not_current:
      return body + "'s last update was refused, so its spheres are those of an older frame: update it first";
    case Code::body_not_complete:
      return body +
             " was updated lazily, and not all of its nodes have been reached: update it in full, or give "
             "CollideOptions::reach where a query takes it";
    case Code::no_surface:
      return body + " has spheres alone, and facets are asked for: make its collider with a mesh and a cover";
    case Code::positions_not_current:
      return body + " was not given the positions of this frame: call Collider::set_positions after each update";
    case Code::transform_too_far:
      return body + " is placed 2^200 or more from the origin";
    case Code::surface_not_current:
      return std::string(status.body == 0 ? "the first surface" : "the second surface") +
             " follows a body that was updated since: call SurfaceTree::follow after each update";
    case Code::bad_option:
      return "an option of the query is negative or not a number, or names a vertex that is none";
    case Code::bad_shape:
      return "the shape that is asked about is not finite, has a negative radius or no direction, or is too far away";
    case Code::bad_level:
      return pair + "neither tree has the level that contacts are asked for at";
    case Code::no_front:
      return "there is no front: call start() first";
    case Code::other_bodies:
      return pair + "the front is of other bodies or of another ownership: call start()";
    case Code::other_frame:
      return pair + "a body was updated since the front was made: call carry() or start()";
    case Code::other_transform:
      return pair + "a body was placed elsewhere since the front was made: call carry() or start()";
    case Code::other_options:
      return "what was started is of another margin, level or distance: start anew";
    case Code::bad_front:
      return "the front has indices out of range: call start()";
    case Code::body_replaced:
      return body + " is gone, or another was assigned to it: make another collider of the body that is to be asked";
    case Code::in_use:
      return "a callback asked the very object whose call it is part of: ask another object, or ask it afterwards";
    case Code::ended_by_exception:
      return "the last call was ended by an exception, and nothing is left of it: call run(), start() or update()";
    case Code::changed_during_call:
      return body +
             " was moved by a callback of the call that read it, and nothing is left of that call: move bodies and "
             "surfaces after it, and call run(), start() or update() again";
  }
  return {};
}

}  // namespace morula
