// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "holders.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace morula::python {

Reading::Reading(std::vector<const Side*> sides, bool exclusive) {
  // One order for everybody, and each body once: nobody waits for one who waits for him.
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
    side->mesh = body->mesh;
    side->posed = body;
  } else if (nb::isinstance<PosedRebuilt>(given.object)) {
    auto body = nb::cast<std::shared_ptr<PosedRebuilt>>(given.object);
    without_gil([&] {
      const std::shared_lock lock(body->mutex);
      side->collider = std::make_unique<Collider>(*body->mesh, body->owned->body());
      side->epoch = body->epoch();
    });
    side->mesh = body->mesh;
    side->posed = body;
  } else if (nb::isinstance<PosedRows>(given.object)) {
    auto spheres = nb::cast<std::shared_ptr<PosedRows>>(given.object);
    side->collider = without_gil([&] { return std::make_unique<Collider>(spheres->pose()); });
    side->posed = spheres;
  } else {
    throw nb::type_error((std::string(name) + ": " + describe(given.object) +
                          ", but a Collider, a Body, a RebuiltBody or PosedSpheres is needed")
                             .c_str());
  }
  return side;
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
