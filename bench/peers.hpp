// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Other libraries whose trees of boxes follow a mesh that deforms. Each has a leaf per facet where Morula's leaves have
// hundreds, which is what most of the difference in time comes from, and what it buys: they are a narrow phase as well.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/geometry/box.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <span>
#include <vector>

#include "frames.hpp"

namespace morula::bench {

class Peer {
 public:
  virtual ~Peer() = default;
  /// Brings a frame into the form in which the library reads positions. Not timed.
  virtual void take(const Frame& frame) = 0;
  /// Fits all boxes to the frame taken last. Timed.
  virtual void refit() = 0;
  /// Do the boxes contain the vertices of their facets?
  virtual bool contains_facets() const = 0;
};

struct PeerKind {
  const char* name;
  const char* package;  ///< of Debian and Ubuntu
  /// Nothing where the library was not there when this program was built.
  std::unique_ptr<Peer> (*make)(const Mesh& mesh);
};
std::span<const PeerKind> peer_kinds();

/// Two meshes whose crossing facets a library finds.
class CrossingPeer {
 public:
  virtual ~CrossingPeer() = default;
  /// Takes and fits. Not timed.
  virtual void take(const Frame& a, const Frame& b) = 0;
  /// Appends the pairs (facet of a) << 32 | (facet of b), in any order, perhaps more than once. Timed.
  virtual void find(std::vector<std::uint64_t>& pairs) = 0;
};

struct CrossingPeerKind {
  const char* name;
  const char* package;
  bool our_test;  ///< finds boxes, whose triangles intersect() judges: no pair of its can be wrong
  std::unique_ptr<CrossingPeer> (*make)(const Mesh& a, const Mesh& b);
};
std::span<const CrossingPeerKind> crossing_peer_kinds();

/// Facets of one mesh that cross and share no vertex, each pair once, the lower first; Embree with itself and our test.
/// take() looks at the first frame alone. Nothing where Embree is not there.
std::unique_ptr<CrossingPeer> make_self_crossing_peer(const Mesh& mesh);

/// Boxes of which some move, and the pairs of them that overlap, but for those of two static ones.
class BoxPeer {
 public:
  virtual ~BoxPeer() = default;
  /// Timed, with what follows.
  virtual void move(std::size_t box, const Box& to) = 0;
  /// Appends the pairs a << 32 | b with a < b, in any order, each once. A library may add pairs that are merely near.
  virtual void find(std::vector<std::uint64_t>& pairs) = 0;
};
struct BoxPeerKind {
  const char* name;
  const char* package;
  std::unique_ptr<BoxPeer> (*make)(std::span<const Box> boxes, std::size_t moving_count);
};
std::span<const BoxPeerKind> box_peer_kinds();
/// The first moving_count boxes move.
std::unique_ptr<BoxPeer> make_fcl_tree_boxes(std::span<const Box> boxes, std::size_t moving_count);
std::unique_ptr<BoxPeer> make_fcl_sweep_boxes(std::span<const Box> boxes, std::size_t moving_count);
std::unique_ptr<BoxPeer> make_bullet_tree_boxes(std::span<const Box> boxes, std::size_t moving_count);
std::unique_ptr<BoxPeer> make_bullet_sweep_boxes(std::span<const Box> boxes, std::size_t moving_count);

std::unique_ptr<CrossingPeer> make_fcl_crossings(const Mesh& a, const Mesh& b);
std::unique_ptr<CrossingPeer> make_bullet_crossings(const Mesh& a, const Mesh& b);
std::unique_ptr<CrossingPeer> make_embree_crossings(const Mesh& a, const Mesh& b);

/// A contact that a solver takes: the normal from b to a, and the depth.
struct PeerContact {
  Vec3 normal;
  double depth;
};
/// Two meshes, placed, with the contacts between them.
class ContactPeer {
 public:
  virtual ~ContactPeer() = default;
  /// Appends the contacts. Timed.
  virtual void find(const RigidTransform& a, const RigidTransform& b, std::vector<PeerContact>& contacts) = 0;
};
/// Manifolds of GImpact's shapes, or of the convex hull of a with the facets of b. Nothing where Bullet is not there.
std::unique_ptr<ContactPeer> make_bullet_contacts(const Mesh& a, const Mesh& b, bool hull_of_a);

std::unique_ptr<Peer> make_fcl(const Mesh& mesh);
std::unique_ptr<Peer> make_bullet(const Mesh& mesh);
std::unique_ptr<Peer> make_embree(const Mesh& mesh);
std::unique_ptr<Peer> make_embree_robust(const Mesh& mesh);
/// Its builder of Morton codes in every frame instead of refits.
std::unique_ptr<Peer> make_embree_rebuilt(const Mesh& mesh);

}  // namespace morula::bench
