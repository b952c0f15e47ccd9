// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of bodies that collide. It shows them as one motion of one body: their trees hang below a common root
// sphere, and each contact has a mark.
#pragma once

#include <morula/collide/collider.hpp>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/page/page.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula {

/// Appends a mark for each finished contact (Contact::finished) to `marks`. surfaces: one per contact, or empty for
/// marks with the normals and depths of the spheres. With surfaces, a mark has the surface's normal and depth, and a
/// contact whose regions are apart (depth 0) gets no mark.
void add_marks(std::span<const Contact> contacts, std::span<const ContactSurface> surfaces,
               std::vector<PageContact>& marks);

/// The page that `morula collide --page` writes.
class CollidePage {
 public:
  /// bodies: at least one; the page borrows them. Each has a surface, and is at rest and at its transform: the page
  /// shows the growth of spheres relative to their radii here. title: heading of the page. rule: name of the spheres'
  /// rule in the page.
  CollidePage(const std::string& title, std::vector<const Collider*> bodies, const std::string& rule);

  /// Adds a frame: the present positions, transforms and spheres of all bodies, and the marks of their contacts
  /// (add_marks).
  void add(const std::string& frame_name, std::vector<PageContact> marks);
  /// Adds a frame with the contact patches of the first two bodies, or of the only body with itself: their regions on
  /// both surfaces, the segments of `crossings`, and a mark at each point of a patch along its force. crossings: pairs
  /// of facets of the same two bodies; may be empty.
  void add(const std::string& frame_name, std::span<const ContactPatch> patches, std::span<const Crossing> crossings);
  /// The page as HTML, with all frames that were added, at least one. Throws like make_page().
  std::string text() const;

 private:
  std::vector<Sphere> spheres() const;
  void add_frame(const std::string& name, std::vector<PageContact> marks);

  std::vector<const Collider*> bodies_;
  PageContent content_;
};

}  // namespace morula
