// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/collide/contact_query.hpp>
#include <stdexcept>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;

Contacts collide(const Collider& a, const Collider& b, const CollideOptions& options) {
  const StandardFloats standard;
  ContactQuery query(options);
  query.add(a, b);
  if (const ContactStatus status = query.run(); !status) {
    Status of_two = status;  // there is one pair only
    of_two.pair.reset();
    throw std::invalid_argument(message(of_two));
  }
  return query.take_contacts();
}

}  // namespace morula
