// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bullet: the quantized tree of btBvhTriangleMeshShape. Not GImpact's, whose refit keeps the quantization of the pose
// it was built in: boxes of what leaves that pose's box by more than one unit are cut off there.
#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btOptimizedBvh.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <morula/geometry/triangle_intersection.hpp>

#include "peers.hpp"

namespace morula::bench {
namespace {

/// The arrays that Bullet's shapes read: they keep pointers into them.
class BulletMesh {
 public:
  explicit BulletMesh(const Mesh& mesh) : positions_(3 * mesh.vertex_count()) {
    for (const Facet& f : mesh.facets)
      for (const std::uint32_t v : f) indices_.push_back(static_cast<int>(v));
    arrays_.addIndexedMesh(indexed());
    fill([&](std::size_t i) { return mesh.positions[i]; });
  }
  void take(const Frame& frame) {
    fill([&](std::size_t i) { return Vec3(frame[i]); });
  }
  btTriangleIndexVertexArray& arrays() { return arrays_; }
  const btVector3& lower() const { return lower_; }
  const btVector3& upper() const { return upper_; }
  btVector3 corner(std::size_t facet, std::size_t k) const {
    const btScalar* p = &positions_[3 * static_cast<std::size_t>(indices_[3 * facet + k])];
    return {p[0], p[1], p[2]};
  }
  std::size_t facet_count() const { return indices_.size() / 3; }

 private:
  btIndexedMesh indexed() {
    btIndexedMesh m;
    m.m_numTriangles = static_cast<int>(indices_.size() / 3);
    m.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(indices_.data());
    m.m_triangleIndexStride = 3 * sizeof(int);
    m.m_numVertices = static_cast<int>(positions_.size() / 3);
    m.m_vertexBase = reinterpret_cast<const unsigned char*>(positions_.data());
    m.m_vertexStride = 3 * sizeof(btScalar);
    return m;
  }
  template <class Position>
  void fill(const Position& position) {
    constexpr auto far = btScalar(BT_LARGE_FLOAT);
    lower_ = {far, far, far}, upper_ = -lower_;
    for (std::size_t i = 0; i < positions_.size() / 3; ++i) {
      const Vec3 p = position(i);
      for (int axis = 0; axis < 3; ++axis)
        positions_[3 * i + static_cast<std::size_t>(axis)] = static_cast<btScalar>(p[axis]);
      const btScalar* stored = &positions_[3 * i];
      lower_.setMin({stored[0], stored[1], stored[2]});
      upper_.setMax({stored[0], stored[1], stored[2]});
    }
  }

  std::vector<btScalar> positions_;
  std::vector<int> indices_;
  btTriangleIndexVertexArray arrays_;
  btVector3 lower_, upper_;
};

bool contains(const btVector3& lower, const btVector3& upper, const btVector3& p, btScalar tolerance) {
  for (int axis = 0; axis < 3; ++axis)
    if (p[axis] < lower[axis] - tolerance || p[axis] > upper[axis] + tolerance) return false;
  return true;
}

/// Gives access to what Bullet keeps from its users.
struct OpenBvh : btOptimizedBvh {
  btVector3 lower(const btQuantizedBvhNode& node) const { return unQuantize(node.m_quantizedAabbMin); }
  btVector3 upper(const btQuantizedBvhNode& node) const { return unQuantize(node.m_quantizedAabbMax); }
};

class BulletBvh final : public Peer {
 public:
  explicit BulletBvh(const Mesh& mesh) : mesh_(mesh) {
    constexpr bool quantized = true;  // refit does nothing otherwise
    bvh_.build(&mesh_.arrays(), quantized, mesh_.lower(), mesh_.upper());
  }
  void take(const Frame& frame) override { mesh_.take(frame); }
  // What btBvhTriangleMeshShape::refitTree does, without the shape's own box, for which Bullet looks at every vertex
  // six times.
  void refit() override { bvh_.refit(&mesh_.arrays(), mesh_.lower(), mesh_.upper()); }
  bool contains_facets() const override {
    // Sixteen bits are rounded outwards, but in float: boxes fall short of vertices by that much of the whole.
    const btScalar tolerance = btScalar(1e-6) * (mesh_.upper() - mesh_.lower()).length();
    std::size_t leaves = 0;
    auto& nodes = const_cast<OpenBvh&>(bvh_).getQuantizedNodeArray();
    const int used = nodes.size() - 1;  // Bullet makes one too many
    for (int i = 0; i < used; ++i) {
      if (!nodes[i].isLeafNode()) continue;
      ++leaves;
      const auto facet = static_cast<std::size_t>(nodes[i].getTriangleIndex());
      for (std::size_t k = 0; k < 3; ++k)
        if (!contains(bvh_.lower(nodes[i]), bvh_.upper(nodes[i]), mesh_.corner(facet, k), tolerance)) return false;
    }
    return leaves == mesh_.facet_count();
  }

 private:
  BulletMesh mesh_;
  OpenBvh bvh_;
};

/// Bullet's own way for two meshes, but for the triangles: pairs of GImpact's boxes. A shape is made anew for each
/// frame, so that quantized boxes are those of the frame.
class BulletCrossings final : public CrossingPeer {
 public:
  BulletCrossings(const Mesh& a, const Mesh& b) : a_(a), b_(b) {}
  void take(const Frame& a, const Frame& b) override {
    a_.take(a), b_.take(b);
    shape_a_ = made(a_), shape_b_ = made(b_);
  }
  void find(std::vector<std::uint64_t>& pairs) override {
    btPairSet boxes;
    const btTransform here = btTransform::getIdentity();
    btGImpactBoxSet::find_collision(shape_a_->getMeshPart(0)->getBoxSet(), here, shape_b_->getMeshPart(0)->getBoxSet(),
                                    here, boxes);
    for (int i = 0; i < boxes.size(); ++i) {
      const auto facet_a = static_cast<std::uint32_t>(boxes[i].m_index1);
      const auto facet_b = static_cast<std::uint32_t>(boxes[i].m_index2);
      if (intersect(triangle(a_, facet_a), triangle(b_, facet_b)))
        pairs.push_back(std::uint64_t{facet_a} << 32 | facet_b);
    }
  }

 private:
  static std::unique_ptr<btGImpactMeshShape> made(BulletMesh& mesh) {
    auto shape = std::make_unique<btGImpactMeshShape>(&mesh.arrays());
    shape->updateBound();
    return shape;
  }
  static Triangle triangle(const BulletMesh& mesh, std::uint32_t facet) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const btVector3 p = mesh.corner(facet, k);
      t[k] = {static_cast<double>(p.x()), static_cast<double>(p.y()), static_cast<double>(p.z())};
    }
    return t;
  }

  BulletMesh a_, b_;
  std::unique_ptr<btGImpactMeshShape> shape_a_, shape_b_;
};

/// Static boxes and others are in groups, as btDiscreteDynamicsWorld has them.
class BulletBoxes final : public BoxPeer {
 public:
  BulletBoxes(std::unique_ptr<btBroadphaseInterface> broad, std::span<const Box> boxes, std::size_t moving_count)
      : broad_(std::move(broad)) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const bool moves = i < moving_count;
      proxies_.push_back(broad_->createProxy(
          vector(boxes[i].lower), vector(boxes[i].upper), BOX_SHAPE_PROXYTYPE, reinterpret_cast<void*>(i),
          moves ? btBroadphaseProxy::DefaultFilter : btBroadphaseProxy::StaticFilter,
          moves ? btBroadphaseProxy::AllFilter : btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter,
          &dispatcher_));
    }
  }
  ~BulletBoxes() override {
    for (btBroadphaseProxy* proxy : proxies_) broad_->destroyProxy(proxy, &dispatcher_);
  }
  void move(std::size_t box, const Box& to) override {
    broad_->setAabb(proxies_[box], vector(to.lower), vector(to.upper), &dispatcher_);
  }
  void find(std::vector<std::uint64_t>& pairs) override {
    broad_->calculateOverlappingPairs(&dispatcher_);
    btOverlappingPairCache& cache = *broad_->getOverlappingPairCache();
    const btBroadphasePair* const all = cache.getOverlappingPairArrayPtr();
    for (int k = 0; k < cache.getNumOverlappingPairs(); ++k) {
      const auto i = reinterpret_cast<std::uint64_t>(all[k].m_pProxy0->m_clientObject);
      const auto j = reinterpret_cast<std::uint64_t>(all[k].m_pProxy1->m_clientObject);
      pairs.push_back(std::min(i, j) << 32 | std::max(i, j));
    }
  }

 private:
  static btVector3 vector(const Vec3& v) {
    return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
  }
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  std::unique_ptr<btBroadphaseInterface> broad_;
  std::vector<btBroadphaseProxy*> proxies_;
};

class BulletContacts final : public ContactPeer {
 public:
  BulletContacts(const Mesh& a, const Mesh& b, bool hull_of_a) : a_(a), b_(b) {
    if (hull_of_a) {
      auto hull = std::make_unique<btConvexHullShape>();
      for (std::size_t f = 0; f < a_.facet_count(); ++f)
        for (std::size_t k = 0; k < 3; ++k) hull->addPoint(a_.corner(f, k), false);
      hull->recalcLocalAabb();
      hull->setMargin(0);
      shapes_[0] = std::move(hull);
      auto facets = std::make_unique<btBvhTriangleMeshShape>(&b_.arrays(), true);
      facets->setMargin(0);
      shapes_[1] = std::move(facets);
    } else {
      btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
      for (std::size_t k = 0; k < 2; ++k) {
        auto shape = std::make_unique<btGImpactMeshShape>(&(k == 0 ? a_ : b_).arrays());
        shape->setMargin(0);
        shape->updateBound();
        shapes_[k] = std::move(shape);
      }
    }
    for (std::size_t k = 0; k < 2; ++k) {
      objects_[k].setCollisionShape(shapes_[k].get());
      world_.addCollisionObject(&objects_[k]);
    }
  }
  ~BulletContacts() override {
    for (btCollisionObject& object : objects_) world_.removeCollisionObject(&object);
  }
  void find(const RigidTransform& a, const RigidTransform& b, std::vector<PeerContact>& contacts) override {
    objects_[0].setWorldTransform(placed(a));
    objects_[1].setWorldTransform(placed(b));
    world_.performDiscreteCollisionDetection();
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      const double sign = manifold.getBody0() == &objects_[0] ? 1 : -1;
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold.getContactPoint(k);
        const btVector3& n = point.m_normalWorldOnB;
        contacts.push_back(
            {Vec3{static_cast<double>(n.x()), static_cast<double>(n.y()), static_cast<double>(n.z())} * sign,
             -static_cast<double>(point.getDistance())});
      }
    }
  }

 private:
  static btTransform placed(const RigidTransform& t) {
    const auto row = [&](const Vec3& v) {
      return btVector3(static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z));
    };
    const btVector3 x = row(t.rows[0]), y = row(t.rows[1]), z = row(t.rows[2]);
    return btTransform({x.x(), x.y(), x.z(), y.x(), y.y(), y.z(), z.x(), z.y(), z.z()}, row(t.translation));
  }
  BulletMesh a_, b_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_;
  btCollisionWorld world_{&dispatcher_, &broad_, &configuration_};
  std::unique_ptr<btCollisionShape> shapes_[2];
  btCollisionObject objects_[2];
};

}  // namespace

std::unique_ptr<ContactPeer> make_bullet_contacts(const Mesh& a, const Mesh& b, bool hull_of_a) {
  return std::make_unique<BulletContacts>(a, b, hull_of_a);
}
std::unique_ptr<BoxPeer> make_bullet_tree_boxes(std::span<const Box> boxes, std::size_t moving_count) {
  return std::make_unique<BulletBoxes>(std::make_unique<btDbvtBroadphase>(), boxes, moving_count);
}
std::unique_ptr<BoxPeer> make_bullet_sweep_boxes(std::span<const Box> boxes, std::size_t moving_count) {
  const btVector3 room(100, 100, 100);
  return std::make_unique<BulletBoxes>(std::make_unique<bt32BitAxisSweep3>(-room, room, 20000u), boxes, moving_count);
}
std::unique_ptr<CrossingPeer> make_bullet_crossings(const Mesh& a, const Mesh& b) {
  return std::make_unique<BulletCrossings>(a, b);
}
std::unique_ptr<Peer> make_bullet(const Mesh& mesh) {
  return std::make_unique<BulletBvh>(mesh);
}

}  // namespace morula::bench
