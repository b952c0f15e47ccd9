// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Calls that an Interrupt ends wherever they ask.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <morula/parallel/interrupt.hpp>
#include <stdexcept>
#include <string>

namespace morula::test {

/// As what Python throws is: code that turns exceptions of its own into others may not take it for one of them.
struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

/// Ends a call where it asks for the first time, the second, the fourth …; each time Cancelled comes out. It asks
/// `least` times or more.
inline void expect_ends_wherever_it_asks(const std::string& name, int least, const std::function<void()>& call) {
  for (int last = 1;; last *= 2) {
    int asked = 0;
    bool ended = false;
    const Interrupt interrupt([&] {
      if (++asked == last) throw Cancelled();
    });
    try {
      call();
    } catch (const Cancelled&) {
      ended = true;
    } catch (const std::exception& other) {
      FAIL() << name << ", asked " << asked << " times: " << other.what();
    }
    ASSERT_EQ(ended, asked >= last) << name;
    if (ended) continue;
    EXPECT_GE(asked, least) << name;
    return;
  }
}

}  // namespace morula::test
