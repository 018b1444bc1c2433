// SPDX-License-Identifier: Apache-2.0
// The name that may have been meant. Distances by hand.
#include "drivers/ifog/nearest.h"

#include <gtest/gtest.h>

#include <vector>

namespace ifog {
namespace {

TEST(Nearest, TheFirstOfTheNearestAndNothingThatIsFar) {
  const std::vector<std::string> names{"denoise", "diagnose", "drivers", "tune"};
  EXPECT_EQ(did_you_mean("denoize", names), ", did you mean 'denoise'?");
  EXPECT_EQ(did_you_mean("dignose", names), ", did you mean 'diagnose'?");
  EXPECT_EQ(did_you_mean("tnue", names), ", did you mean 'tune'?");
  EXPECT_EQ(did_you_mean("plot", names), "");
  EXPECT_EQ(did_you_mean("t", names), "");  // of one letter anything could be meant
  EXPECT_EQ(did_you_mean("", names), "");
  EXPECT_EQ(did_you_mean(std::string(1000, 'd'), names), "");
}

TEST(Nearest, AValueThatIsNoneOfItsWordsIsToldAllAndTheNear) {
  const std::vector<std::string> words{"overlapping", "modified"};
  EXPECT_EQ(one_of("overlaping", words), "one of overlapping, modified; did you mean 'overlapping'?");
  EXPECT_EQ(one_of("total", words), "one of overlapping, modified");
  EXPECT_EQ(one_of("modifed", words, ", or both"),
            "one of overlapping, modified, or both; did you mean 'modified'?");
}

}  // namespace
}  // namespace ifog
