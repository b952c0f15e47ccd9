// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Memory that nested calls share: blocks never overlap, whatever the order, and what is given back in order is free.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <morula/geometry/reproducible.hpp>
#include <query/stack_memory.hpp>
#include <vector>

namespace morula::detail {
namespace {

constexpr std::size_t room = 512;

struct Block {
  void* memory;
  std::size_t bytes, alignment;
  int filled_with;
};

Block filled_block(StackMemory<room>& memory, std::size_t bytes, std::size_t alignment, int with) {
  Block block{memory.allocate(bytes, alignment), bytes, alignment, with};
  std::memset(block.memory, with, bytes);
  return block;
}

void expect_untouched(const Block& block) {
  const auto* const bytes = static_cast<const unsigned char*>(block.memory);
  for (std::size_t i = 0; i < block.bytes; ++i) ASSERT_EQ(bytes[i], static_cast<unsigned char>(block.filled_with));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block.memory) % block.alignment, 0u);
}

// Some blocks fit, some do not, some are aligned more than any type asks for.
std::size_t some_bytes(Random& random) {
  return static_cast<std::size_t>(random.uniform(0, 200));
}
std::size_t some_alignment(Random& random) {
  return std::size_t{1} << static_cast<int>(random.uniform(0, 7.99));
}

void call(StackMemory<room>& memory, Random& random, int depth) {
  const std::size_t before = memory.used();
  const Block own = filled_block(memory, some_bytes(random), some_alignment(random), depth);
  for (int i = 0; i < 2 && depth < 9; ++i) call(memory, random, depth + 1);
  expect_untouched(own);
  memory.deallocate(own.memory, own.bytes, own.alignment);
  ASSERT_EQ(memory.used(), before);
}

TEST(StackMemory, is_free_again_when_nested_calls_return) {
  Random random(3);
  StackMemory<room> memory;
  for (int trial = 0; trial < 20; ++trial) call(memory, random, 1);
  EXPECT_EQ(memory.used(), 0u);
}

TEST(StackMemory, keeps_blocks_apart_in_any_order) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    StackMemory<room> memory;
    std::vector<Block> blocks;
    for (int step = 0; step < 200; ++step) {
      if (blocks.empty() || random.uniform() < 0.6) {
        blocks.push_back(filled_block(memory, some_bytes(random), some_alignment(random), step % 251));
        continue;
      }
      const auto k = static_cast<std::size_t>(random.uniform(0, static_cast<double>(blocks.size()) - 0.01));
      expect_untouched(blocks[k]);
      memory.deallocate(blocks[k].memory, blocks[k].bytes, blocks[k].alignment);
      blocks.erase(blocks.begin() + static_cast<std::ptrdiff_t>(k));
    }
    for (const Block& block : blocks) {
      expect_untouched(block);
      memory.deallocate(block.memory, block.bytes, block.alignment);
    }
  }
}

TEST(StackMemory, gives_its_last_byte_and_then_the_heap) {
  StackMemory<room> memory;
  void* const all = memory.allocate(room, 1);
  EXPECT_EQ(memory.used(), room);
  void* const more = memory.allocate(1, 1);
  EXPECT_EQ(memory.used(), room);
  memory.deallocate(more, 1, 1);
  memory.deallocate(all, room, 1);
  EXPECT_EQ(memory.used(), 0u);
}

}  // namespace
}  // namespace morula::detail
