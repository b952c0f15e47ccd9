// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of `morula collide`: all bodies as one, their spheres below one root, and a mark at each contact.
#pragma once

#include <filesystem>
#include <morula/collide/collider.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/page/page.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula::cli {

/// A mark for each finished contact; where the surfaces were asked for, with their depth, and none where they are
/// apart. surfaces: as Contacts::surfaces, or empty.
void add_marks(std::span<const Contact> contacts, std::span<const ContactSurface> surfaces,
               std::vector<PageContact>& marks);

/// Refuses, before anything is read: a build without the page, a place that cannot be written, an input.
void require_page(const std::string& page, const std::vector<std::filesystem::path>& inputs);

class CollidePage {
 public:
  /// The bodies at rest, where they are placed. Borrowed; at least one.
  CollidePage(const std::string& title, std::vector<const Collider*> bodies, const std::string& rule);
  /// The bodies as they are now, and what was found of them, frame after frame.
  void add(const std::string& frame_name, std::vector<PageContact> marks);
  /// After the last frame.
  std::string text() const;

 private:
  std::vector<Sphere> spheres() const;

  std::vector<const Collider*> bodies_;
  PageContent content_;
};

}  // namespace morula::cli
