// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// FCL: a binary tree of boxes in double, refitted from the leaves up.
#include <fcl/broadphase/broadphase_SaP.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/math/bv/utility.h>
#include <fcl/narrowphase/collision.h>

#include <limits>

#include "peers.hpp"

namespace morula::bench {
namespace {

class Fcl final : public Peer {
 public:
  explicit Fcl(const Mesh& mesh) : facets_(mesh.facets) {
    for (const Vec3& p : mesh.positions) positions_.emplace_back(p.x, p.y, p.z);
    std::vector<fcl::Triangle> triangles;
    for (const Facet& f : facets_) triangles.emplace_back(f[0], f[1], f[2]);
    model_.beginModel(static_cast<int>(facets_.size()), static_cast<int>(positions_.size()));
    model_.addSubModel(positions_, triangles);
    model_.endModel();
  }
  void take(const Frame& frame) override {
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const Vec3 p(frame[i]);
      positions_[i] = {p.x, p.y, p.z};
    }
  }
  // Its interface takes new positions as a copy.
  void refit() override {
    constexpr bool refit = true, bottom_up = true;
    model_.beginReplaceModel();
    model_.replaceSubModel(positions_);
    model_.endReplaceModel(refit, bottom_up);
  }
  bool contains_facets() const override {
    std::size_t leaves = 0;
    for (int i = 0; i < model_.getNumBVs(); ++i) {
      const auto& node = model_.getBV(i);
      if (!node.isLeaf()) continue;
      ++leaves;
      for (const std::uint32_t v : facets_[static_cast<std::size_t>(node.primitiveId())])
        if (!node.bv.contain(positions_[v]) || !model_.getBV(0).bv.contain(positions_[v])) return false;
    }
    return leaves == facets_.size();
  }

 private:
  friend class FclCrossings;
  std::vector<Facet> facets_;
  std::vector<fcl::Vector3d> positions_;
  fcl::BVHModel<fcl::AABBd> model_;
};

class FclCrossings final : public CrossingPeer {
 public:
  FclCrossings(const Mesh& a, const Mesh& b) : a_(a), b_(b) {}
  void take(const Frame& a, const Frame& b) override {
    a_.take(a), b_.take(b);
    a_.refit(), b_.refit();
  }
  void find(std::vector<std::uint64_t>& pairs) override {
    constexpr bool contact_points = false;
    const fcl::CollisionRequestd request(std::numeric_limits<std::size_t>::max(), contact_points);
    const fcl::Transform3d here = fcl::Transform3d::Identity();
    fcl::CollisionResultd result;
    fcl::collide(&a_.model_, here, &b_.model_, here, request, result);
    for (std::size_t i = 0; i < result.numContacts(); ++i) {
      const fcl::Contactd& contact = result.getContact(i);
      pairs.push_back(static_cast<std::uint64_t>(contact.b1) << 32 | static_cast<std::uint32_t>(contact.b2));
    }
  }

 private:
  Fcl a_, b_;
};

/// A manager of FCL's with boxes that are turned nowhere.
template <class Manager>
class FclBoxes final : public BoxPeer {
 public:
  FclBoxes(std::span<const Box> boxes, std::size_t moving_count) : moving_count_(moving_count) {
    std::vector<fcl::CollisionObjectd*> all;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3 e = boxes[i].extent();
      objects_.push_back(
          std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(e.x, e.y, e.z), placed(boxes[i])));
      objects_.back()->setUserData(reinterpret_cast<void*>(i));
      objects_.back()->computeAABB();
      all.push_back(objects_.back().get());
    }
    manager_.registerObjects(all);
    manager_.setup();
  }
  void move(std::size_t box, const Box& to) override {
    objects_[box]->setTransform(placed(to));
    objects_[box]->computeAABB();
    moved_.push_back(objects_[box].get());
  }
  void find(std::vector<std::uint64_t>& pairs) override {
    manager_.update(moved_);
    moved_.clear();
    found_ = &pairs;
    manager_.collide(this, [](fcl::CollisionObjectd* x, fcl::CollisionObjectd* y, void* data) {
      auto* self = static_cast<FclBoxes*>(data);
      const auto i = reinterpret_cast<std::uint64_t>(x->getUserData());
      const auto j = reinterpret_cast<std::uint64_t>(y->getUserData());
      if (std::min(i, j) < self->moving_count_) self->found_->push_back(std::min(i, j) << 32 | std::max(i, j));
      return false;
    });
  }

 private:
  static fcl::Transform3d placed(const Box& box) {
    fcl::Transform3d t = fcl::Transform3d::Identity();
    const Vec3 c = box.center();
    t.translation() = fcl::Vector3d(c.x, c.y, c.z);
    return t;
  }
  std::size_t moving_count_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  std::vector<fcl::CollisionObjectd*> moved_;
  std::vector<std::uint64_t>* found_ = nullptr;
  Manager manager_;
};

}  // namespace

std::unique_ptr<BoxPeer> make_fcl_tree_boxes(std::span<const Box> boxes, std::size_t moving_count) {
  return std::make_unique<FclBoxes<fcl::DynamicAABBTreeCollisionManagerd>>(boxes, moving_count);
}
std::unique_ptr<BoxPeer> make_fcl_sweep_boxes(std::span<const Box> boxes, std::size_t moving_count) {
  return std::make_unique<FclBoxes<fcl::SaPCollisionManagerd>>(boxes, moving_count);
}
std::unique_ptr<Peer> make_fcl(const Mesh& mesh) {
  return std::make_unique<Fcl>(mesh);
}
std::unique_ptr<CrossingPeer> make_fcl_crossings(const Mesh& a, const Mesh& b) {
  return std::make_unique<FclCrossings>(a, b);
}

}  // namespace morula::bench
