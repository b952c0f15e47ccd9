// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of bodies that collide: all as one motion, their spheres below one root, and a mark at each contact.
#pragma once

#include <morula/collide/collider.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/page/page.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula {

/// Adds a mark for each finished contact. surfaces: one per contact, or empty; if given, marks use their normal and
/// depth, and contacts whose regions are apart get no mark.
void add_marks(std::span<const Contact> contacts, std::span<const ContactSurface> surfaces,
               std::vector<PageContact>& marks);

/// The page that `morula collide --page` writes.
class CollidePage {
 public:
  /// bodies: at rest, at their transforms; borrowed, at least one, each with a surface. rule: the rule of their
  /// spheres, as the page names it.
  CollidePage(const std::string& title, std::vector<const Collider*> bodies, const std::string& rule);

  /// Adds a frame: the bodies at their present positions, and their contacts.
  void add(const std::string& frame_name, std::vector<PageContact> marks);
  /// The file's text, after the last frame.
  std::string text() const;

 private:
  std::vector<Sphere> spheres() const;

  std::vector<const Collider*> bodies_;
  PageContent content_;
};

}  // namespace morula
