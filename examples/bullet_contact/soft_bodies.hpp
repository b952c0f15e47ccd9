// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bullet's world and soft bodies, each with the Morula body that follows its nodes.
#pragma once

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <memory>
#include <morula/morula.hpp>
#include <vector>

using morula::Vec3;

inline constexpr double step_seconds = 1.0 / 480, gravity = 10;
inline constexpr double skin = 0.06;  // kept between bodies, by all three responses
enum class Response { bullet, penalty, positions };

inline Vec3 to_vec3(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

inline btVector3 to_bullet(const Vec3& v) {
  return {btScalar(v.x), btScalar(v.y), btScalar(v.z)};
}

// Bullet's world: gravity along −z, a floor at z = 0.
struct World {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  btBoxShape box{{10, 10, 1}};
  btRigidBody floor{btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &box)};

  World() {
    world.setGravity({0, 0, btScalar(-gravity)});
    world.getWorldInfo().m_gravity.setValue(0, 0, btScalar(-gravity));
    world.getWorldInfo().m_sparsesdf.Initialize();
    floor.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, 0, -1}));
    world.addRigidBody(&floor);
  }
  ~World() { world.removeRigidBody(&floor); }
};

// What all runs share.
struct Model {
  morula::Mesh mesh;
  std::shared_ptr<const morula::CoveredTree> model;

  Model(const char* name, int resolution, double z) : mesh(morula::sample_body(name, resolution)) {
    for (Vec3& p : mesh.positions) p.z += z;
    model =
        std::make_shared<const morula::CoveredTree>(morula::build(mesh, {.method = morula::Method::grid, .depth = 3}));
  }
};

// Bullet's soft body and the body and collider that follow its nodes. It stays where it was made.
class Soft {
 public:
  Soft(World& world, const Model& model, Response response)
      : mesh_(model.mesh), body_(mesh_, model.model), collider_(mesh_, body_), inside_(collider_), world_(world) {
    std::vector<btScalar> positions;
    for (const Vec3& p : mesh_.positions)
      for (int axis = 0; axis < 3; ++axis) positions.push_back(static_cast<btScalar>(p[axis]));
    std::vector<int> indices;
    for (const morula::Facet& f : mesh_.facets) indices.insert(indices.end(), f.begin(), f.end());
    soft_.reset(btSoftBodyHelpers::CreateFromTriMesh(world.world.getWorldInfo(), positions.data(), indices.data(),
                                                     static_cast<int>(mesh_.facet_count()), false));
    soft_->generateBendingConstraints(2);
    soft_->m_cfg.piterations = 4;
    soft_->m_cfg.kDP = btScalar(0.005);
    soft_->m_cfg.kMT = btScalar(0.1);  // it goes back to its shape
    soft_->m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
    if (response == Response::bullet) soft_->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
    soft_->setTotalMass(1, false);
    soft_->setPose(false, true);
    soft_->getCollisionShape()->setMargin(btScalar(skin / 2));
    world.world.addSoftBody(soft_.get());
    follow();
  }
  ~Soft() { world_.world.removeSoftBody(soft_.get()); }

  // The solver's node array as it is: a position every sizeof(Node) bytes, float or double as Bullet was built.
  morula::PositionView nodes() const {
    const btSoftBody::Node& first = soft_->m_nodes[0];
    return morula::PositionView::strided(&first.m_x.m_floats[0], mesh_.vertex_count(), sizeof(btSoftBody::Node));
  }
  bool follow() { return static_cast<bool>(body_.update(nodes())); }

  btSoftBody::Node& node(std::size_t number) { return soft_->m_nodes[static_cast<int>(number)]; }
  std::size_t node_count() const { return mesh_.vertex_count(); }
  std::size_t number(const btSoftBody::Node& n) const { return static_cast<std::size_t>(&n - &soft_->m_nodes[0]); }
  double kinetic_energy() const {
    double sum = 0;
    for (int i = 0; i < soft_->m_nodes.size(); ++i)
      sum += 0.5 * soft_->m_nodes[i].m_v.length2() / soft_->m_nodes[i].m_im;
    return sum;
  }
  double energy() const {  // of motion and height; what is stored in springs is not in it
    double sum = kinetic_energy();
    for (int i = 0; i < soft_->m_nodes.size(); ++i) sum += gravity * soft_->m_nodes[i].m_x.z() / soft_->m_nodes[i].m_im;
    return sum;
  }
  // How deep a vertex of the other one is inside this one.
  double deepest(const Soft& other) {
    double depth = 0;
    for (std::uint32_t v = 0; v < other.mesh_.vertex_count(); ++v) {
      const morula::Probe probe = inside_.probe({other.collider_.vertex(v), 0});
      depth = std::max(depth, probe.inside ? probe.depth : 0.0);
    }
    return depth;
  }
  const morula::Collider& collider() const { return collider_; }
  btSoftBody& soft() { return *soft_; }

 private:
  const morula::Mesh& mesh_;
  morula::Body body_;
  morula::Collider collider_;
  morula::InsideQuery inside_;
  World& world_;
  std::unique_ptr<btSoftBody> soft_;
};
