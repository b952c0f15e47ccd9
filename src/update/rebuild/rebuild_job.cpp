// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/rebuild_job.hpp"

#include <chrono>
#include <exception>
#include <stdexcept>
#include <utility>
#ifdef MORULA_THREADS
#include <condition_variable>
#include <mutex>
#include <thread>
#endif

#include "parallel/float_environment.hpp"
#include "update/fitted_body.hpp"

namespace morula::detail {
namespace {

// Extrapolates the position of a point that was at a, b, c: with the last speed and the last rotation. Straight lines
// and circles are continued exactly: v_{k+1} = 2 cos θ v_k − v_{k−1} turns by θ in the plane of the last two.
Vec3 gone_on(const Vec3& a, const Vec3& b, const Vec3& c, int steps) {
  const Vec3 last = c - b, first = b - a;
  const double speed = length(last), first_speed = length(first);
  if (!(speed > 0)) return c;
  Vec3 before = first_speed > 0 ? first * (speed / first_speed) : last, velocity = last, point = c;
  const double twice_cosine = 2 * dot(before, velocity) / (speed * speed);
  for (int k = 0; k < steps; ++k) {
    const Vec3 next = velocity * twice_cosine - before;
    before = velocity;
    velocity = next;
    point += velocity;
  }
  return point;
}

}  // namespace

RebuildJob::RebuildJob(const MeshView& home, const BuildOptions& build, std::size_t levels, bool fits_leaves,
                       Builder builder)
    : snapshot_(to_mesh(home)),
      build_(build),
      builder_(std::move(builder)),
      estimator_(home),
      levels_(levels),
      fits_leaves_(fits_leaves) {
  earlier_.fill(snapshot_.positions);
  last_pose_ = snapshot_.positions;
}

void RebuildJob::set_pose(std::size_t which, const PositionView& positions) {
  std::vector<Vec3>& pose = which < earlier_.size() ? earlier_[which] : snapshot_.positions;
  for (std::size_t v = 0; v < pose.size(); ++v) pose[v] = positions[v];
}

void RebuildJob::queue(int steps, Quality quality) {
  if (build_.method == Method::optimized) build_.quality = quality;
  steps_ = steps;
  stop_ = StopSource();
  build_.stop = stop_.get_token();
  stage_.store(Stage::queued, std::memory_order_release);
}

RebuildJob::Result RebuildJob::take() {
  stage_.store(Stage::idle, std::memory_order_relaxed);
  return std::exchange(result_, {});
}

void RebuildJob::run() noexcept {
  const StandardFloats standard;
  if (stage() != Stage::queued) return;
  const auto start = std::chrono::steady_clock::now();
  retired_.reset();
  result_ = {};
  try {
    result_.tree = rebuilt();
  } catch (const BuildStopped&) {
  } catch (const std::exception& error) {
    result_.failure = error.what();
  } catch (...) {  // of the builder
    result_.failure = "an exception of another type than std::exception";
  }
  result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  stage_.store(Stage::done, std::memory_order_release);
}

CoveredTree RebuildJob::built(Workers& workers) const {
  if (!builder_) return build(snapshot_, build_, workers);
  CoveredTree model = builder_(snapshot_, build_);
  // mutant rebuild-tree-of-builder: `!faults.empty()` -> `false`
  if (const std::vector<std::string> faults = validate(snapshot_, model); !faults.empty())
    throw std::invalid_argument("rebuild: the builder's tree: " + faults.front());
  return model;
}

std::unique_ptr<TreeVersion> RebuildJob::rebuilt() {
  Workers one;  // the shared workers may be busy on the caller's thread
  last_pose_ = snapshot_.positions;
  if (steps_ > 0)
    for (std::size_t v = 0; v < snapshot_.positions.size(); ++v)
      snapshot_.positions[v] = gone_on(earlier_[0][v], earlier_[1][v], snapshot_.positions[v], steps_);
  auto model = std::make_shared<const CoveredTree>(built(one));
  if (build_.stop.stop_requested()) throw BuildStopped();
  // A collider of the new tree then costs nothing on the caller's thread.
  static_cast<void>(model->facet_lists.get(model->tree, model->cover));
  auto tree = std::make_unique<TreeVersion>(FittedBody::make(snapshot_, std::move(model), fits_leaves_, one), snapshot_,
                                            estimator_, levels_);
  // The frame that takes the tree lies between the pose of the request and the one that the tree was made for.
  tree->strain_elsewhere = tree->gauge.strain(last_pose_);
  if (tree->strain_elsewhere > 0 && tree->body.update(last_pose_, one)) {
    estimator_.pose(last_pose_);
    estimator_.estimate(tree->body, tree->looseness_elsewhere);
  } else {
    tree->strain_elsewhere = 0;
  }
  return tree;
}

#ifdef MORULA_THREADS

struct OwnThread::State {
  std::mutex mutex;
  std::condition_variable wake;
  std::shared_ptr<RebuildJob> waiting;
  bool quits = false;
  std::thread thread;

  ~State() {
    {
      const std::lock_guard lock(mutex);
      quits = true;
    }
    wake.notify_one();
    if (thread.joinable()) thread.join();
  }

  void serve() {
    std::unique_lock lock(mutex);
    for (;;) {
      wake.wait(lock, [this] { return quits || waiting != nullptr; });
      if (quits) return;
      const std::shared_ptr<RebuildJob> job = std::exchange(waiting, nullptr);
      lock.unlock();
      job->run();
      lock.lock();
    }
  }
};

OwnThread::OwnThread() : state_(std::make_unique<State>()) {
  state_->thread = std::thread([s = state_.get()] { s->serve(); });
}

void OwnThread::run(std::shared_ptr<RebuildJob> job) {
  {
    const std::lock_guard lock(state_->mutex);
    state_->waiting = std::move(job);
  }
  state_->wake.notify_one();
}

#else

struct OwnThread::State {};
OwnThread::OwnThread() {
  throw std::invalid_argument("rebuild: no background thread in a library built without threads");
}
void OwnThread::run(std::shared_ptr<RebuildJob>) {}

#endif

OwnThread::~OwnThread() = default;

}  // namespace morula::detail
