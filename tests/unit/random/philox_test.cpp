// SPDX-License-Identifier: Apache-2.0
// Known answers of Random123's own test file (kat_vectors, philox4x32 and philox4x64, 10 rounds).
#include "filters/random/philox.h"

#include <gtest/gtest.h>

#include "filters/random/philox_wide.h"

namespace {

using ifog::philox;
using ifog::PhiloxBlock;

TEST(Philox, GivesThePublishedAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (PhiloxBlock{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t kAll = 0xffffffff;
  EXPECT_EQ(philox({kAll, kAll, kAll, kAll}, {kAll, kAll}),
            (PhiloxBlock{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (PhiloxBlock{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(WidePhilox, GivesThePublishedAnswers) {
  const auto drawn = [](const ifog::WidePhiloxBlock& counter, std::array<std::uint64_t, 2> key) {
    return ifog::philox_wide(counter, ifog::philox_wide_keys(key));
  };
  using Block = ifog::WidePhiloxBlock;
  EXPECT_EQ(drawn({0, 0, 0, 0}, {0, 0}),
            (Block{0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b, 0x7e68b68aec7ba23b}));
  constexpr std::uint64_t kAll = ~0ULL;
  EXPECT_EQ(drawn({kAll, kAll, kAll, kAll}, {kAll, kAll}),
            (Block{0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0}));
  EXPECT_EQ(drawn({0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89},
                  {0x452821e638d01377, 0xbe5466cf34e90c6c}),
            (Block{0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6}));
}

}  // namespace
