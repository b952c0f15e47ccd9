// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Stop requests of standard libraries without std::stop_token, against std::stop_token where this one has it.
#include <version>
#ifdef __cpp_lib_jthread
#include <stop_token>
#define MORULA_TEST_HAS_STANDARD
#undef __cpp_lib_jthread
#endif
#include <gtest/gtest.h>

#include <morula/parallel/threads.hpp>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

namespace morula {
namespace {

TEST(StopRequests, a_token_without_a_source_never_stops) {
  EXPECT_FALSE(StopToken().stop_requested());
  const StopToken copy = StopToken();
  EXPECT_FALSE(copy.stop_requested());
}

TEST(StopRequests, reach_every_copy_once) {
  StopSource source;
  const StopToken early = source.get_token(), copy = early;
  const StopSource other = source;
  EXPECT_FALSE(copy.stop_requested());
  EXPECT_TRUE(source.request_stop());
  EXPECT_FALSE(other.request_stop());
  EXPECT_TRUE(early.stop_requested() && copy.stop_requested() && other.stop_requested());
  EXPECT_TRUE(other.get_token().stop_requested());
}

TEST(StopRequests, sources_that_were_moved_from_may_be_asked) {
  StopSource source;
  const StopToken token = source.get_token();
  StopSource moved = std::move(source);
  StopSource assigned;
  assigned = std::move(moved);
  for (const StopSource& empty : {source, moved}) EXPECT_FALSE(empty.stop_requested());
  EXPECT_TRUE(assigned.request_stop());
  EXPECT_TRUE(token.stop_requested());
}

#ifdef MORULA_TEST_HAS_STANDARD
static_assert(!std::is_same_v<StopToken, std::stop_token>, "the replacement is what this file tests");

TEST(StopRequests, behave_as_those_of_the_standard_in_random_sequences) {
  std::mt19937 random(7);
  std::vector<StopSource> sources(3);
  std::vector<std::stop_source> standard(3);
  std::vector<StopToken> tokens(3);
  std::vector<std::stop_token> standard_tokens(3);
  for (int i = 0; i < 5000; ++i) {
    const std::size_t a = random() % 3, b = random() % 3;
    switch (random() % 6) {
      case 0:
        sources[a] = sources[b], standard[a] = standard[b];
        break;
      case 1:
        tokens[a] = sources[b].get_token(), standard_tokens[a] = standard[b].get_token();
        break;
      case 2:
        tokens[a] = tokens[b], standard_tokens[a] = standard_tokens[b];
        break;
      case 3:
        sources[a] = StopSource(), standard[a] = std::stop_source();
        break;
      case 4:
        tokens[a] = StopToken(), standard_tokens[a] = std::stop_token();
        break;
      case 5:
        ASSERT_EQ(sources[a].request_stop(), standard[a].request_stop());
        break;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(sources[k].stop_requested(), standard[k].stop_requested());
      ASSERT_EQ(tokens[k].stop_requested(), standard_tokens[k].stop_requested());
    }
  }
}
#endif

}  // namespace
}  // namespace morula
