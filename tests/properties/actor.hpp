// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body that goes through frames in every way there is to feed it, judged in each.
#pragma once

#include <memory>
#include <morula/update/body.hpp>

#include "motions.hpp"
#include "trees.hpp"

namespace morula::properties {

class Actor {
 public:
  /// A body of the specimen, by some rules, judged at rest. Throws what the library throws.
  Actor(const Specimen& specimen, Dice& dice, Record& record);

  /// The next frame: some motion, given in some way; its end on a lattice, if asked for.
  void move(Dice& dice, Record& record, bool on_lattice = false);
  /// Back at rest: the spheres of the start, bit for bit.
  void return_to_rest(Record& record);
  /// A frame of the coordinates of its modes; it has some when it was made by make_modal().
  void move_by_modes(Dice& dice, Record& record);
  void make_modal(Dice& dice, Record& record);
  /// A frame of the transforms of its bones; it has some when it was made by make_skinned().
  void move_by_bones(Dice& dice, Record& record);
  void make_skinned(Dice& dice, Record& record);

  /// Follows the rules on every level?
  bool covers() const { return covers_; }
  const Mesh& mesh() const { return mesh_; }
  const CoveredTree& model() const { return *built_; }
  Body& body() { return *body_; }
  const Positions& positions() const { return positions_; }
  PositionView view() const { return positions_; }

 private:
  void start(UpdateOptions options, Record& record);
  void judge_now(Dice& dice, Record& record, const std::string& suffix);
  UpdateStatus feed(const Pose& pose, bool whole, Dice& dice, Record& record);
  void reach_all(Dice& dice, Record& record);

  Mesh mesh_;
  std::shared_ptr<const CoveredTree> built_;
  std::unique_ptr<Body> body_;
  std::vector<std::uint8_t> promised_;
  bool covers_ = false;
  std::uint64_t rest_hash_ = 0;
  Positions positions_;                // of the last good frame
  std::vector<oracle::Point> points_;  // the same; of a modal body in the judge's arithmetic
  std::vector<Vec3f> floats_;
};

}  // namespace morula::properties
