// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "holders.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace morula::python {

Reading::Reading(std::vector<const Side*> sides, bool exclusive) {
  // All threads lock in one order, and each body once: no two threads wait for each other.
  std::vector<std::shared_mutex*> mutexes;
  for (const Side* side : sides) mutexes.push_back(&side->posed->mutex);
  std::sort(mutexes.begin(), mutexes.end());
  mutexes.erase(std::unique(mutexes.begin(), mutexes.end()), mutexes.end());
  for (std::shared_mutex* mutex : mutexes) {
    if (exclusive)
      exclusive_.emplace_back(*mutex);
    else
      shared_.emplace_back(*mutex);
  }
}

std::shared_ptr<Side> side_of(const ColliderGiven& given, const char* name) {
  if (nb::isinstance<Side>(given.object)) return nb::cast<std::shared_ptr<Side>>(given.object);
  auto side = std::make_shared<Side>();
  if (nb::isinstance<PosedBody>(given.object)) {
    auto body = nb::cast<std::shared_ptr<PosedBody>>(given.object);
    side->collider = without_gil([&] { return std::make_unique<Collider>(*body->mesh, *body->owned); });
    side->mesh = again(body->mesh);
    side->posed = body;
  } else if (nb::isinstance<PosedRebuilt>(given.object)) {
    auto body = nb::cast<std::shared_ptr<PosedRebuilt>>(given.object);
    without_gil([&] {
      const std::shared_lock lock(body->mutex);
      side->collider = std::make_unique<Collider>(*body->mesh, body->owned->body());
      side->tree_version = body->tree_version();
    });
    side->mesh = again(body->mesh);
    side->posed = body;
  } else if (nb::isinstance<PosedRows>(given.object)) {
    auto spheres = nb::cast<std::shared_ptr<PosedRows>>(given.object);
    side->collider = without_gil([&] { return std::make_unique<Collider>(spheres->sphere_state()); });
    side->posed = spheres;
  } else {
    throw nb::type_error((std::string(name) + ": " + describe(given.object) +
                          ", but a Collider, a Body, a RebuiltBody or PosedSpheres is needed")
                             .c_str());
  }
  return side;
}

std::shared_ptr<Side> kept_side_of(const ColliderGiven& given, const char* name) {
  std::shared_ptr<Side> side = side_of(given, name);
  return nb::isinstance<Side>(given.object) ? side : nb::cast<std::shared_ptr<Side>>(nb::cast(side));
}

RigidTransform matrix_transform(nb::handle given, const char* name) {
  std::vector<std::size_t> shape;
  const std::vector<double> numbers = numbers_of(given, name, {-1, 4}, shape);
  const std::string argument = name;
  if (shape[0] != 3 && shape[0] != 4)
    throw std::invalid_argument(argument + ": " + describe(given) + ", but shape (3, 4) or (4, 4) is needed");
  if (!std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }))
    throw std::invalid_argument(argument + ": a number of the matrix is not finite");
  if (shape[0] == 4 && !(numbers[12] == 0 && numbers[13] == 0 && numbers[14] == 0 && numbers[15] == 1))
    throw std::invalid_argument(argument + ": the last row of a matrix that acts on columns is 0 0 0 1; give " +
                                argument + ".T of one that acts on rows");
  RigidTransform transform;
  for (std::size_t row = 0; row < 3; ++row) {
    const double* r = &numbers[4 * row];
    transform.rows[row] = {r[0], r[1], r[2]};
    transform.translation[static_cast<int>(row)] = r[3];
  }
  return transform;
}

RigidTransform transform_of(const TransformGiven& given, const char* name) {
  if (nb::isinstance<RigidTransform>(given.object)) return nb::cast<RigidTransform>(given.object);
  RigidTransform translation;
  if (nb::try_cast(given.object, translation.translation)) return translation;
  if (nb::hasattr(given.object, "ndim")) return matrix_transform(given.object, name);
  reject_type(given.object, name, "a RigidTransform, a matrix (4, 4) or (3, 4), or a translation (x, y, z)");
}

Budget budget_of(const BudgetGiven& given, const char* name) {
  const nb::handle value = given.object;
  const std::string argument = name;
  if (value.is_none()) return {};
  if (PyLong_Check(value.ptr()) && !PyBool_Check(value.ptr())) {
    const std::int64_t tests = nb::cast<std::int64_t>(value);
    if (tests < 0)
      throw std::invalid_argument(argument + ": " + std::to_string(tests) + " pair tests, but 0 or more are needed");
    return Budget(tests);
  }
  double seconds = -1;
  if (nb::hasattr(value, "total_seconds")) {
    seconds = nb::cast<double>(nb::object(value.attr("total_seconds")()));
  } else if (PyUnicode_Check(value.ptr())) {
    const auto text = nb::cast<std::string>(value);
    char* end = nullptr;
    const double amount = std::strtod(text.c_str(), &end);
    const std::string unit = end;
    if (end != text.c_str())
      seconds = unit == "us" ? amount * 1e-6 : unit == "ms" ? amount * 1e-3 : unit == "s" ? amount : -1;
  }
  if (!(seconds >= 0 && seconds < 1e9)) {
    throw nb::type_error((argument + ": " + nb::cast<std::string>(nb::repr(value)) +
                          ", but None, an int (pair tests), a datetime.timedelta or a text such as '200us', '5ms' or "
                          "'1s' is needed")
                             .c_str());
  }
  return Budget(std::chrono::nanoseconds(std::llround(seconds * 1e9)));
}

}  // namespace morula::python
