// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres that leave part of a surface uncovered on purpose, moved for little outside volume.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/parallel/threads.hpp>
#include <morula/query/signed_distance.hpp>
#include <span>
#include <vector>

namespace morula::robot {

/// Spheres of one link, judged by samples of its surface and of the space around it. Samples prove nothing: coverage()
/// does.
///
/// A sphere gains the surface that no other sphere covers, times a worth, less the outside volume that no other sphere
/// has. The worth is a length: the thickness of a layer of outside volume that covering is worth. The best radius at a
/// given center follows from the samples sorted by distance; centers are searched one sphere after another.
class PartialCover {
 public:
  /// start: one sphere or more. tolerance: above 0, mesh units. object: the distance of the mesh; where the mesh is
  /// open, outside is where its winding number is at most one half. Copies what it needs.
  PartialCover(const Mesh& mesh, const SignedDistance& object, std::span<const Sphere> start, double tolerance,
               double most_radius, std::uint64_t seed);

  /// Moves every sphere so many times, for a worth in mesh units. Each sphere keeps the samples within the tolerance
  /// that no other sphere keeps there. Ends early on a stop request.
  void improve(double worth, int rounds, const StopToken& stop);

  std::span<const Sphere> spheres() const { return spheres_; }
  void set_spheres(std::span<const Sphere> spheres);
  /// Another tolerance, 0 or more. Spheres grow up to the largest radius where samples are farther from them.
  void set_tolerance(double tolerance);
  double area() const { return area_; }  ///< area of the mesh, mesh units²
  double uncovered_area() const;         ///< by the samples, mesh units²
  double outside_volume() const;         ///< by the samples, mesh units³
  /// The cost that improve() reduces.
  double cost(double worth) const { return outside_volume() + worth * uncovered_area(); }

 private:
  struct Points {
    std::vector<float> x, y, z, amount;  // amount: the area or volume that a point stands for
    void add(const Vec3& p, double amount_of);
    void copy(const Points& from, std::size_t i);
    void clear();
    std::size_t size() const { return x.size(); }
  };
  struct Choice {
    Sphere sphere;
    double gain;
  };
  void sample_surface(const Mesh& mesh);
  void sample_space(const Mesh& mesh, const SignedDistance& object);
  void count(const Sphere& s, int change);
  void count_all();
  void gather();
  Choice best_at(const Vec3& center, double worth, double reach, double most_radius);
  Sphere best_place(const Sphere& s, double worth);

  Vec3 middle_{};  // of the mesh; points are relative to it, as floats
  Points surface_, space_;
  std::vector<std::uint32_t> surface_in_, space_in_;  // number of spheres that contain a point
  std::vector<std::uint32_t> near_;                   // number of spheres within the tolerance of a surface point
  Points bare_, free_, far_;                          // points that only the sphere in turn may cover, have, or reach
  std::vector<float> squares_;
  std::vector<Sphere> spheres_;
  std::vector<Vec3> seats_;  // points inside
  double tolerance_, most_radius_, area_ = 0, reach_ = 0;
  std::uint64_t seed_, turns_ = 0;
};

}  // namespace morula::robot
