// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A soft body of Bullet's falls on another one: once with Bullet's own collisions, once with Morula's contacts and a
// penalty response. Both runs are watched by exact tests. docs/collide_recipes.md shows this text.
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <morula/morula.hpp>
#include <vector>

using morula::Vec3;

constexpr double step_seconds = 1.0 / 480, gravity = 10, skin = 0.06;
constexpr int steps = 960;
enum class Response { bullet, morula };

Vec3 to_vec3(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
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

// What both runs share.
struct Model {
  morula::Mesh mesh;
  std::shared_ptr<const morula::Built> built;

  Model(const char* name, int resolution, double z) : mesh(morula::sample_body(name, resolution)) {
    for (Vec3& p : mesh.positions) p.z += z;
    built = std::make_shared<const morula::Built>(morula::build(mesh, {.method = morula::Method::grid}));
  }
};

// Bullet's soft body and the body and collider that follow its nodes. It stays where it was made.
class Soft {
 public:
  Soft(World& world, const Model& model, Response response)
      : mesh_(model.mesh), body_(mesh_, model.built), collider_(mesh_, body_), inside_(collider_), world_(world) {
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
  bool follow() {
    const bool good = static_cast<bool>(body_.update(nodes()));
    collider_.set_positions(nodes());
    return good;
  }

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
  morula::InsideTest inside_;
  World& world_;
  std::unique_ptr<btSoftBody> soft_;
};

// Positive: how far two regions have to move apart until there is the skin between them.
double shortfall(const morula::ContactSurface& s) {
  return skin + (s.depth > 0 ? s.depth : -distance(s.on_a.point, s.on_b.point));
}

// One end of a contact as the solver sees it: three nodes and their weights.
struct End {
  std::array<btSoftBody::Node*, 3> nodes;
  std::array<double, 3> weights;

  End(Soft& body, const morula::SurfacePoint& p) : weights(p.barycentric) {
    for (int k = 0; k < 3; ++k) nodes[k] = &body.node(body.collider().mesh().facets[p.facet][k]);
  }
  Vec3 velocity() const {
    Vec3 sum;
    for (int k = 0; k < 3; ++k) sum += weights[k] * to_vec3(nodes[k]->m_v);
    return sum;
  }
  // Every contact has a share of a node's mass, as large as its wish, so that all of them together do not push it too
  // far.
  double inverse_mass(const Soft& body, const std::vector<double>& wishes, double wish) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += weights[k] * weights[k] * nodes[k]->m_im * wishes[body.number(*nodes[k])] / wish;
    return sum;
  }
  void push(const Vec3& force) const {
    for (int k = 0; k < 3; ++k) {
      const Vec3 f = weights[k] * force;
      nodes[k]->m_f += btVector3(btScalar(f.x), btScalar(f.y), btScalar(f.z));
    }
  }
};

// Pushes the nodes of both bodies apart. Returns |sum of forces| / sum of |forces|.
double respond(Soft& a, Soft& b, const morula::Contacts& found) {
  constexpr double stiffness = 0.5, damping = 1.0;  // of what would do it within one step; above 1 it would swing
  struct Push {
    End a, b;
    Vec3 normal;
    double wish;  // by how much the speed along the normal ought to change
  };
  std::vector<Push> pushes;
  std::vector<double> wishes_a(a.node_count()), wishes_b(b.node_count());  // of all contacts that push at a node
  for (const morula::ContactSurface& s : found.surfaces) {
    const End end_a(a, s.on_a), end_b(b, s.on_b);
    const double speed = dot(end_a.velocity() - end_b.velocity(), s.normal);
    const double wish = stiffness * shortfall(s) / step_seconds - damping * speed;
    if (shortfall(s) <= 0 || wish <= 0) continue;
    pushes.push_back({end_a, end_b, s.normal, wish});
    for (const btSoftBody::Node* n : end_a.nodes) wishes_a[a.number(*n)] += wish;
    for (const btSoftBody::Node* n : end_b.nodes) wishes_b[b.number(*n)] += wish;
  }
  for (const Push& p : pushes) {
    const double mass = 1 / (p.a.inverse_mass(a, wishes_a, p.wish) + p.b.inverse_mass(b, wishes_b, p.wish));
    const Vec3 force = mass * p.wish / step_seconds * p.normal;
    p.a.push(force);
    p.b.push(-force);
  }
  Vec3 sum;
  double total = 0;
  for (Soft* body : {&a, &b})
    for (std::size_t n = 0; n < body->node_count(); ++n) {
      const Vec3 force = to_vec3(body->node(n).m_f);
      sum += force, total += length(force);
    }
  return total > 0 ? length(sum) / total : 0;
}

struct Outcome {
  int first_contact = 0, most_contacts = 0;
  std::size_t most_crossings = 0, last_crossings = 0;
  double deepest = 0, last_deepest = 0, last_distance = 0;
  double imbalance = 0, energy_begin = 0, energy_most = 0, most_motion = 0, last_motion = 0, microseconds = 0;
  int compared = 0, differ = 0;
  std::size_t pairs_compared = 0;
};

Outcome run(Response response, const Model& below, const Model& above) {
  World world;
  Soft lower(world, below, response), upper(world, above, response);
  morula::ContactQuery query({.margin = skin, .surfaces = true, .exact = true, .containment = true});
  query.add(upper.collider(), lower.collider());
  query.start();

  Outcome outcome;
  outcome.energy_begin = outcome.energy_most = upper.energy() + lower.energy();
  std::vector<double> times;
  for (int step = 1; step <= steps; ++step) {
    world.world.stepSimulation(btScalar(step_seconds), 0);
    const auto start = std::chrono::steady_clock::now();
    if (!upper.follow() || !lower.follow() || !query.carry()) {
      ++outcome.differ;
      break;
    }
    times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());

    const morula::Contacts& found = query.contacts();
    int contacts = upper.soft().m_scontacts.size() + lower.soft().m_scontacts.size();
    if (response == Response::morula) {
      contacts = static_cast<int>(std::count_if(found.surfaces.begin(), found.surfaces.end(),
                                                [](const morula::ContactSurface& s) { return shortfall(s) > 0; }));
      outcome.imbalance = std::max(outcome.imbalance, respond(upper, lower, found));
    }
    if (contacts > 0 && outcome.first_contact == 0) outcome.first_contact = step;
    outcome.most_contacts = std::max(outcome.most_contacts, contacts);
    outcome.most_crossings = std::max(outcome.most_crossings, found.crossings.size());
    outcome.last_crossings = found.crossings.size();
    outcome.energy_most = std::max(outcome.energy_most, upper.energy() + lower.energy());
    outcome.last_motion = upper.kinetic_energy() + lower.kinetic_energy();
    outcome.most_motion = std::max(outcome.most_motion, outcome.last_motion);
    if (step % 10 == 0) {  // against all facets with all others
      ++outcome.compared;
      const std::vector<morula::Crossing> all = morula::brute_force::crossings(upper.collider(), lower.collider());
      outcome.differ += found.crossings != all;
      outcome.pairs_compared += all.size();
      const morula::MutualContainment& inside = found.containment[0];
      const bool apart = found.crossings.empty() && !inside.a_in_b.any() && !inside.b_in_a.any();
      outcome.last_deepest = apart ? 0 : std::max(lower.deepest(upper), upper.deepest(lower));
      outcome.deepest = std::max(outcome.deepest, outcome.last_deepest);
    }
  }
  outcome.last_distance = morula::distance(upper.collider(), lower.collider()).lower;
  std::sort(times.begin(), times.end());
  outcome.microseconds = times.empty() ? 0 : times[times.size() / 2];
  return outcome;
}

int main() {
  const Model below("torus", 28, 0.38), above("blob", 20, 2.2);
  const Outcome bullet = run(Response::bullet, below, above), own = run(Response::morula, below, above);
  const auto row = [](const char* what, double a, double b) { std::printf("%-52s %10.4g %10.4g\n", what, a, b); };
  std::printf("%-52s %10s %10s\n", "", "Bullet", "Morula");
  row("first contact, step", bullet.first_contact, own.first_contact);
  row("most contacts in a step", bullet.most_contacts, own.most_contacts);
  row("pairs of facets that cross: most", double(bullet.most_crossings), double(own.most_crossings));
  row("  at the end", double(bullet.last_crossings), double(own.last_crossings));
  row("deepest vertex inside the other body: worst", bullet.deepest, own.deepest);
  row("  at the end", bullet.last_deepest, own.last_deepest);
  row("distance at the end", bullet.last_distance, own.last_distance);
  row("energy of motion and height: at the beginning", bullet.energy_begin, own.energy_begin);
  row("  most", bullet.energy_most, own.energy_most);
  row("energy of motion: most", bullet.most_motion, own.most_motion);
  row("  at the end", bullet.last_motion, own.last_motion);
  std::printf("%-52s %10s %10.4g\n", "sum of the forces, over that of their amounts: most", "", own.imbalance);
  std::printf("%-52s %10s %10.4g\n", "update and query, median, us", "", own.microseconds);
  std::printf("%d steps compared with brute force, %zu crossing pairs of facets in them: %d steps differ\n",
              bullet.compared + own.compared, bullet.pairs_compared + own.pairs_compared, bullet.differ + own.differ);

  constexpr double thickness = 0.7;  // of the torus's tube
  int faults = 0;
  const auto check = [&](bool good, const char* what) {
    faults += !good, std::printf("%s: %s\n", good ? "ok" : "FAILED", what);
  };
  check(bullet.differ + own.differ == 0, "no crossing is missed, none is made up");
  check(own.first_contact > 0 && own.pairs_compared > 0, "the bodies touched, and some facets crossed");
  check(own.imbalance < 1e-5, "forces on one body are those on the other, turned round");
  check(own.energy_most < 1.01 * own.energy_begin, "no energy out of nothing");
  check(own.last_motion < 0.05 * own.most_motion, "they come nearly to rest");
  check(own.deepest < 0.1 * thickness && own.last_crossings == 0, "never deep in each other, and apart in the end");
  return faults == 0 ? 0 : 1;
}
