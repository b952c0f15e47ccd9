// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Embree: a wide tree of boxes for rays, refitted when the scene says so.
#if MORULA_PEER_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <cstring>
#include <memory>
#include <morula/geometry/triangle_intersection.hpp>
#include <mutex>

#include "peers.hpp"

namespace morula::bench {
namespace {

template <class T, void (*release)(T*)>
struct Release {
  void operator()(T* object) const { release(object); }
};
using Device = std::unique_ptr<RTCDeviceTy, Release<RTCDeviceTy, rtcReleaseDevice>>;
using Scene = std::unique_ptr<RTCSceneTy, Release<RTCSceneTy, rtcReleaseScene>>;
using Geometry = std::unique_ptr<RTCGeometryTy, Release<RTCGeometryTy, rtcReleaseGeometry>>;

class Embree final : public Peer {
 public:
  Embree(const Mesh& mesh, RTCSceneFlags flags, RTCBuildQuality quality = RTC_BUILD_QUALITY_REFIT)
      : facets_(mesh.facets), vertex_count_(mesh.vertex_count()) {
    rtcSetSceneFlags(scene_.get(), flags);
    // Refitting is for scenes of low quality alone: Embree rebuilds others without a word.
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_LOW);
    rtcSetGeometryBuildQuality(geometry_.get(), quality);
    positions_ = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                             RTC_FORMAT_FLOAT3, sizeof(Vec3f), vertex_count_));
    void* const indices = rtcSetNewGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                  sizeof(Facet), facets_.size());
    std::memcpy(indices, facets_.data(), facets_.size() * sizeof(Facet));
    for (std::size_t i = 0; i < vertex_count_; ++i) positions_[i] = Vec3f(mesh.positions[i]);
    rtcCommitGeometry(geometry_.get());
    rtcAttachGeometry(scene_.get(), geometry_.get());
    rtcCommitScene(scene_.get());
  }
  void take(const Frame& frame) override { std::copy(frame.begin(), frame.end(), positions_); }
  void refit() override {
    rtcUpdateGeometryBuffer(geometry_.get(), RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_.get());
    rtcCommitScene(scene_.get());
  }
  // Embree shows no boxes. At a corner of a facet, a query of hardly any radius has to meet the facet's box and every
  // box above it.
  bool contains_facets() const override {
    const std::size_t step = std::max<std::size_t>(1, facets_.size() / 4000);
    for (std::size_t f = 0; f < facets_.size(); f += step)
      for (const std::uint32_t v : facets_[f])
        if (!finds(static_cast<unsigned>(f), positions_[v])) return false;
    return true;
  }

 private:
  struct Search {
    unsigned facet;
    bool found = false;
  };
  bool finds(unsigned facet, const Vec3f& p) const {
    RTCPointQuery query{p.x, p.y, p.z, 0.0f, 1e-6f * max_norm(p)};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    Search search{facet};
    const auto note = [](RTCPointQueryFunctionArguments* arguments) {
      Search& s = *static_cast<Search*>(arguments->userPtr);
      s.found = s.found || arguments->primID == s.facet;
      return false;  // the radius stays as it is
    };
    rtcPointQuery(scene_.get(), &query, &context, note, &search);
    return search.found;
  }

  std::vector<Facet> facets_;
  std::size_t vertex_count_;
  Device device_{rtcNewDevice("threads=1")};
  Scene scene_{rtcNewScene(device_.get())};
  Geometry geometry_{rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE)};
  Vec3f* positions_;  // Embree's
};

/// A mesh as the boxes of its facets: Embree finds pairs among those alone, and tests no triangles.
class EmbreeBoxes {
 public:
  EmbreeBoxes(RTCDevice device, const Mesh& mesh)
      : facets_(mesh.facets), scene_(rtcNewScene(device)), geometry_(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER)) {
    for (const Vec3& p : mesh.positions) positions_.emplace_back(p);
    rtcSetSceneFlags(scene_.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST));
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_LOW);
    rtcSetGeometryBuildQuality(geometry_.get(), RTC_BUILD_QUALITY_REFIT);
    rtcSetGeometryUserPrimitiveCount(geometry_.get(), static_cast<unsigned>(facets_.size()));
    rtcSetGeometryUserData(geometry_.get(), this);
    rtcSetGeometryBoundsFunction(geometry_.get(), bounds, nullptr);
    rtcCommitGeometry(geometry_.get());
    rtcAttachGeometry(scene_.get(), geometry_.get());
    rtcCommitScene(scene_.get());
  }
  void take(const Frame& frame) {
    positions_ = frame;
    rtcCommitGeometry(geometry_.get());
    rtcCommitScene(scene_.get());
  }
  RTCScene scene() const { return scene_.get(); }
  Triangle triangle(unsigned facet) const {
    const Facet& f = facets_[facet];
    return {Vec3(positions_[f[0]]), Vec3(positions_[f[1]]), Vec3(positions_[f[2]])};
  }

 private:
  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const EmbreeBoxes& self = *static_cast<const EmbreeBoxes*>(arguments->geometryUserPtr);
    const Facet& f = self.facets_[arguments->primID];
    const Vec3f p = self.positions_[f[0]], q = self.positions_[f[1]], r = self.positions_[f[2]];
    const Vec3f lower = min(min(p, q), r), upper = max(max(p, q), r);
    RTCBounds& box = *arguments->bounds_o;
    box.lower_x = lower.x, box.lower_y = lower.y, box.lower_z = lower.z;
    box.upper_x = upper.x, box.upper_y = upper.y, box.upper_z = upper.z;
  }

  std::vector<Facet> facets_;
  std::vector<Vec3f> positions_;
  Scene scene_;
  Geometry geometry_;
};

/// Embree calls back with denormal numbers switched off. Our test would switch them on and off again for each pair.
class [[maybe_unused]] DenormalNumbers {
#if defined(__SSE2__)
 public:
  DenormalNumbers() {
    _mm_setcsr(before_ & ~0x8040u);
  }
  ~DenormalNumbers() {
    _mm_setcsr(before_);
  }
  DenormalNumbers(const DenormalNumbers&) = delete;
  DenormalNumbers& operator=(const DenormalNumbers&) = delete;

 private:
  unsigned before_ = _mm_getcsr();
#endif
};

class EmbreeCrossings final : public CrossingPeer {
 public:
  EmbreeCrossings(const Mesh& a, const Mesh& b) : a_(device_.get(), a), b_(device_.get(), b) {}
  void take(const Frame& a, const Frame& b) override { a_.take(a), b_.take(b); }
  void find(std::vector<std::uint64_t>& pairs) override {
    found_ = &pairs;
    rtcCollide(a_.scene(), b_.scene(), note, this);
  }

 private:
  static void note(void* user, RTCCollision* collisions, unsigned count) {
    EmbreeCrossings& self = *static_cast<EmbreeCrossings*>(user);
    const std::lock_guard lock(self.mutex_);  // one thread, but Embree may have its own ideas
    [[maybe_unused]] const DenormalNumbers kept{};
    for (unsigned i = 0; i < count; ++i)
      if (intersect(self.a_.triangle(collisions[i].primID0), self.b_.triangle(collisions[i].primID1)))
        self.found_->push_back(std::uint64_t{collisions[i].primID0} << 32 | collisions[i].primID1);
  }

  Device device_{rtcNewDevice("threads=1")};
  EmbreeBoxes a_, b_;
  std::mutex mutex_;
  std::vector<std::uint64_t>* found_ = nullptr;
};

class EmbreeSelfCrossings final : public CrossingPeer {
 public:
  explicit EmbreeSelfCrossings(const Mesh& mesh) : facets_(mesh.facets), boxes_(device_.get(), mesh) {}
  void take(const Frame& frame, const Frame&) override { boxes_.take(frame); }
  void find(std::vector<std::uint64_t>& pairs) override {
    found_ = &pairs;
    rtcCollide(boxes_.scene(), boxes_.scene(), note, this);
  }

 private:
  static void note(void* user, RTCCollision* collisions, unsigned count) {
    EmbreeSelfCrossings& self = *static_cast<EmbreeSelfCrossings*>(user);
    const std::lock_guard lock(self.mutex_);
    [[maybe_unused]] const DenormalNumbers kept{};
    for (unsigned i = 0; i < count; ++i) {
      // Pairs come both ways round, or once: the lower first.
      const unsigned f = std::min(collisions[i].primID0, collisions[i].primID1);
      const unsigned g = std::max(collisions[i].primID0, collisions[i].primID1);
      bool share = f == g;
      for (const std::uint32_t v : self.facets_[f])
        for (const std::uint32_t w : self.facets_[g]) share = share || v == w;
      if (!share && intersect(self.boxes_.triangle(f), self.boxes_.triangle(g)))
        self.found_->push_back(std::uint64_t{f} << 32 | g);
    }
  }

  std::vector<Facet> facets_;
  Device device_{rtcNewDevice("threads=1")};
  EmbreeBoxes boxes_;
  std::mutex mutex_;
  std::vector<std::uint64_t>* found_ = nullptr;
};

}  // namespace

std::unique_ptr<CrossingPeer> make_self_crossing_peer(const Mesh& mesh) {
  return std::make_unique<EmbreeSelfCrossings>(mesh);
}

std::unique_ptr<CrossingPeer> make_embree_crossings(const Mesh& a, const Mesh& b) {
  return std::make_unique<EmbreeCrossings>(a, b);
}
std::unique_ptr<Peer> make_embree(const Mesh& mesh) {
  return std::make_unique<Embree>(mesh, RTC_SCENE_FLAG_DYNAMIC);
}
std::unique_ptr<Peer> make_embree_rebuilt(const Mesh& mesh) {
  return std::make_unique<Embree>(mesh, RTC_SCENE_FLAG_DYNAMIC, RTC_BUILD_QUALITY_LOW);
}

std::unique_ptr<Peer> make_embree_robust(const Mesh& mesh) {
  return std::make_unique<Embree>(mesh, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST));
}

}  // namespace morula::bench
