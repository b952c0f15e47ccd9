// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Extension: the subcommands, options and texts that an extra (robot, grains, study, page) adds to the command.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/crossings.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/command.hpp"

namespace morula::cli {

/// A file that shows what `morula collide` finds, frame after frame.
class CollideView {
 public:
  virtual ~CollideView() = default;
  /// Marks the finished contacts of a pair of bodies in the present frame. surfaces: one per contact, or empty.
  virtual void mark(std::span<const Contact> contacts, std::span<const ContactSurface> surfaces) = 0;
  /// Ends the present frame: the bodies are drawn in their present places.
  virtual void end_frame(const std::string& name) = 0;
  /// Ends the present frame with the contact patches of its bodies. crossings: all pairs of facets that intersect.
  virtual void end_frame_with_patches(const std::string& name, std::span<const ContactPatch> patches,
                                      std::span<const Crossing> crossings) = 0;
  /// The file's text, after the last frame.
  virtual std::string text() const = 0;
};

/// `morula collide --page FILE`.
struct CollideViews {
  /// Throws UsageError, before anything is read, for a file that cannot be written and for one of the inputs.
  void (*require)(const std::string& file, const std::vector<std::filesystem::path>& inputs) = nullptr;
  /// bodies: at rest, where they are placed; borrowed, at least one. rule: how their spheres follow.
  std::unique_ptr<CollideView> (*make)(const std::string& title, std::vector<const Collider*> bodies,
                                       const std::string& rule) = nullptr;
  explicit operator bool() const { return make != nullptr; }
};

struct Extension {
  /// In the order of the help.
  std::vector<void (*)(CLI::App& app, Run& run)> commands{};
  /// The command whose --format has names of its own, and these; for `morula formats`.
  std::string format_command{};
  std::vector<std::string> format_names{};
  /// Notices of code that the extension compiles in; for `morula --licenses`.
  std::vector<std::string_view> notices{};
  CollideViews collide_views{};
};

/// The extensions of the extras that this command was built with.
const std::vector<Extension>& extensions();
/// The views of the extension that has them; false when there is none.
CollideViews collide_views();

}  // namespace morula::cli
