// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A client whose solver owns the positions: a soft body of Bullet's falls on an obstacle, and a Morula body follows its
// nodes. Nothing is copied: the view reads the solver's own records. Cover is proved after every step.
//
// usage: bullet_softbody [steps]
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <morula/morula.hpp>

namespace {

constexpr btScalar step_seconds = btScalar(1.0 / 60);

/// Bullet's world with a ball and a floor in it, gravity along −z.
class World {
 public:
  World() {
    world_.setGravity({0, 0, -10});
    world_.getWorldInfo().m_gravity.setValue(0, 0, -10);
    world_.getWorldInfo().m_sparsesdf.Initialize();
    add_obstacle(ball_, {0, 0, btScalar(-1.8)});
    add_obstacle(floor_, {0, 0, -4});
  }
  ~World() {
    if (soft_) world_.removeSoftBody(soft_.get());
    for (const auto& body : obstacles_) world_.removeRigidBody(body.get());
  }

  btSoftBody& add(const morula::Mesh& mesh) {
    std::vector<btScalar> positions;
    for (const morula::Vec3& p : mesh.positions)
      for (int axis = 0; axis < 3; ++axis) positions.push_back(static_cast<btScalar>(p[axis]));
    std::vector<int> indices;
    for (const morula::Facet& f : mesh.facets)
      for (const std::uint32_t v : f) indices.push_back(static_cast<int>(v));
    constexpr bool shuffle = false;  // constraints in random order: other results on every run
    soft_.reset(btSoftBodyHelpers::CreateFromTriMesh(world_.getWorldInfo(), positions.data(), indices.data(),
                                                     static_cast<int>(mesh.facet_count()), shuffle));
    soft_->generateBendingConstraints(2);
    soft_->m_cfg.piterations = 8;
    soft_->m_cfg.kDF = btScalar(0.5);
    soft_->m_cfg.kPR = 20;  // pressure keeps it from folding flat
    soft_->m_materials[0]->m_kLST = btScalar(0.5);
    soft_->setTotalMass(2, true);
    soft_->getCollisionShape()->setMargin(btScalar(0.05));
    world_.addSoftBody(soft_.get());
    return *soft_;
  }
  void step() { world_.stepSimulation(step_seconds, 0); }

 private:
  void add_obstacle(btCollisionShape& shape, const btVector3& at) {
    constexpr btScalar immovable = 0;
    const btRigidBody::btRigidBodyConstructionInfo info(immovable, nullptr, &shape);
    obstacles_.push_back(std::make_unique<btRigidBody>(info));
    obstacles_.back()->setWorldTransform(btTransform(btQuaternion::getIdentity(), at));
    world_.addRigidBody(obstacles_.back().get());
  }

  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btSoftRigidDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  btSphereShape ball_{btScalar(0.8)};
  btBoxShape floor_{{10, 10, 1}};  // not a plane: soft bodies meet convex shapes only
  std::vector<std::unique_ptr<btRigidBody>> obstacles_;
  std::unique_ptr<btSoftBody> soft_;
};

/// The solver's node array as it is: a position every sizeof(Node) bytes, float or double as Bullet was built.
morula::PositionView view_of(const btSoftBody& soft) {
  const btSoftBody::Node& first = soft.m_nodes[0];
  return morula::PositionView::strided(&first.m_x.m_floats[0], static_cast<std::size_t>(soft.m_nodes.size()),
                                       sizeof(btSoftBody::Node));
}

double lowest(const morula::PositionView& positions) {
  double z = positions[0].z;
  for (std::size_t i = 1; i < positions.size(); ++i) z = std::min(z, positions[i].z);
  return z;
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Returns how many steps were not covered.
int fall(int steps) {
  const morula::Mesh mesh = morula::sample_body("blob", 48);
  World world;
  const btSoftBody& soft = world.add(mesh);
  morula::Body body(mesh, morula::build(mesh, {.method = morula::Method::grid, .depth = 3}));
  std::printf("%zu vertices, %zu spheres; a node of Bullet's is %zu bytes\n", mesh.vertex_count(),
              body.spheres().size(), sizeof(btSoftBody::Node));
  std::printf("%6s %10s %12s %12s %14s  %s\n", "step", "lowest z", "step ms", "spheres ms", "inside by", "covered");

  const morula::PositionView nodes = view_of(soft);
  std::vector<morula::Sphere> spheres;
  int uncovered = 0;
  for (int step = 1; step <= steps; ++step) {
    auto start = std::chrono::steady_clock::now();
    world.step();
    const double step_ms = milliseconds_since(start);

    start = std::chrono::steady_clock::now();
    const morula::UpdateStatus status = body.update(nodes);
    const double update_ms = milliseconds_since(start);

    body.copy_spheres(spheres);
    const morula::Certificate certificate = morula::certify(body.cover(), nodes, spheres);
    const bool covered = status && certificate.covered;
    uncovered += !covered;
    if (step % 20 == 0 || !covered)
      std::printf("%6d %10.3f %12.3f %12.3f %14.3g  %s\n", step, lowest(nodes), step_ms, update_ms,
                  -certificate.worst_excess, covered ? "yes" : "NO");
  }
  std::printf("%d of %d steps covered\n", steps - uncovered, steps);
  return uncovered;
}

}  // namespace

int main(int argc, char** argv) {
  const int steps = argc > 1 ? std::atoi(argv[1]) : 240;
  if (steps < 1) {
    std::fprintf(stderr, "usage: bullet_softbody [steps]\n");
    return 2;
  }
  return fall(steps) == 0 ? 0 : 1;
}
