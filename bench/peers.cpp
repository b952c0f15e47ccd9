// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "peers.hpp"

#include <array>

namespace morula::bench {

// What was not found is not made.
#ifndef MORULA_PEER_FCL
std::unique_ptr<BoxPeer> make_fcl_tree_boxes(std::span<const Box>, std::size_t) {
  return nullptr;
}
std::unique_ptr<BoxPeer> make_fcl_sweep_boxes(std::span<const Box>, std::size_t) {
  return nullptr;
}
std::unique_ptr<CrossingPeer> make_fcl_crossings(const Mesh&, const Mesh&) {
  return nullptr;
}
std::unique_ptr<Peer> make_fcl(const Mesh&) {
  return nullptr;
}
#endif
#ifndef MORULA_PEER_BULLET
std::unique_ptr<ContactPeer> make_bullet_contacts(const Mesh&, const Mesh&, bool) {
  return nullptr;
}
std::unique_ptr<BoxPeer> make_bullet_tree_boxes(std::span<const Box>, std::size_t) {
  return nullptr;
}
std::unique_ptr<BoxPeer> make_bullet_sweep_boxes(std::span<const Box>, std::size_t) {
  return nullptr;
}
std::unique_ptr<CrossingPeer> make_bullet_crossings(const Mesh&, const Mesh&) {
  return nullptr;
}
std::unique_ptr<Peer> make_bullet(const Mesh&) {
  return nullptr;
}
#endif
#ifndef MORULA_PEER_EMBREE
std::unique_ptr<CrossingPeer> make_embree_crossings(const Mesh&, const Mesh&) {
  return nullptr;
}
std::unique_ptr<CrossingPeer> make_self_crossing_peer(const Mesh&) {
  return nullptr;
}
std::unique_ptr<Peer> make_embree(const Mesh&) {
  return nullptr;
}
std::unique_ptr<Peer> make_embree_robust(const Mesh&) {
  return nullptr;
}
std::unique_ptr<Peer> make_embree_rebuilt(const Mesh&) {
  return nullptr;
}
#endif

std::span<const PeerKind> peer_kinds() {
  static constexpr std::array kinds{
      PeerKind{"FCL", "libfcl-dev", make_fcl},
      PeerKind{"Bullet", "libbullet-dev", make_bullet},
      PeerKind{"Embree", "libembree-dev", make_embree},
      PeerKind{"Embree, robust", "libembree-dev", make_embree_robust},
  };
  return kinds;
}

std::span<const BoxPeerKind> box_peer_kinds() {
  static constexpr std::array kinds{
      BoxPeerKind{"Bullet, tree", "libbullet-dev", make_bullet_tree_boxes},
      BoxPeerKind{"Bullet, sweep", "libbullet-dev", make_bullet_sweep_boxes},
      BoxPeerKind{"FCL, tree", "libfcl-dev", make_fcl_tree_boxes},
      BoxPeerKind{"FCL, sweep", "libfcl-dev", make_fcl_sweep_boxes},
  };
  return kinds;
}

std::span<const CrossingPeerKind> crossing_peer_kinds() {
  static constexpr std::array kinds{
      CrossingPeerKind{"FCL", "libfcl-dev", false, make_fcl_crossings},
      CrossingPeerKind{"Bullet, GImpact and our test", "libbullet-dev", true, make_bullet_crossings},
      CrossingPeerKind{"Embree and our test", "libembree-dev", true, make_embree_crossings},
  };
  return kinds;
}

}  // namespace morula::bench
