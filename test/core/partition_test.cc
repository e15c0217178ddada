#include "plumbline/core/partition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

namespace plumbline {
namespace {

using testing::Each;
using testing::ElementsAre;

// Weight per part.
std::vector<std::size_t> Loads(const std::vector<int>& parts,
                               const std::vector<std::size_t>& weights, int num_parts) {
  std::vector<std::size_t> loads(num_parts);
  for (std::size_t i = 0; i < parts.size(); ++i) loads[parts[i]] += weights[i];
  return loads;
}

TEST(PartitionByPlaceTest, CutsAcrossTheLongerSide) {
  const std::vector<double> along_x = {9.0, 0.0, 1.0, 0.0, 1.0, 0.0, 8.0, 2.0, 0.0, 1.0, 1.0, 0.0};
  EXPECT_THAT(PartitionByPlace(along_x, {1, 1, 1, 1}, 2), ElementsAre(1, 0, 1, 0));
  const std::vector<double> along_y = {0.0, 9.0, 0.0, 1.0, 0.0, 0.0, 2.0, 8.0, 0.0, 1.0, 1.0, 0.0};
  EXPECT_THAT(PartitionByPlace(along_y, {1, 1, 1, 1}, 2), ElementsAre(1, 0, 1, 0));
}

TEST(PartitionByPlaceTest, GivesAllPartsAboutTheSameWeight) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> place(0.0, 100.0);
  std::uniform_int_distribution<std::size_t> weight(1, 200);
  std::vector<double> places;
  std::vector<std::size_t> weights;
  for (int i = 0; i < 5000; ++i) {
    places.insert(places.end(), {place(engine), 0.3 * place(engine), 0.0});
    weights.push_back(weight(engine));
  }
  for (const int num_parts : {1, 2, 3, 4, 7}) {
    const std::vector<int> parts = PartitionByPlace(places, weights, num_parts);
    const std::vector<std::size_t> loads = Loads(parts, weights, num_parts);
    const auto [least, most] = std::minmax_element(loads.begin(), loads.end());
    EXPECT_LT(*most - *least, 800u) << num_parts;
    EXPECT_EQ(parts, PartitionByPlace(places, weights, num_parts));
  }
}

TEST(PartitionByPlaceTest, DividesByWeightRatherThanByNumber) {
  const std::vector<double> places = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0,
                                      0.0, 3.0, 0.0, 0.0, 4.0, 0.0, 0.0};
  EXPECT_THAT(PartitionByPlace(places, {100, 25, 25, 25, 25}, 2), ElementsAre(0, 1, 1, 1, 1));
}

TEST(PartitionByPlaceTest, TakesPlacesThatAreTheSameOrFewerThanParts) {
  EXPECT_THAT(PartitionByPlace(std::vector<double>(12), {1, 1, 1, 1}, 2), ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(PartitionByPlace({0.0, 0.0, 0.0}, {5}, 4), Each(testing::Lt(4)));
  EXPECT_THAT(PartitionByPlace({}, {}, 3), testing::IsEmpty());
}

TEST(PartitionByTimeTest, GivesEachPartAsManyThatFollowEachOther) {
  EXPECT_THAT(PartitionByTime(5, 2), ElementsAre(0, 0, 1, 1, 1));
  EXPECT_THAT(PartitionByTime(2, 4), ElementsAre(1, 3));
  EXPECT_THAT(PartitionByTime(0, 3), testing::IsEmpty());
}

}  // namespace
}  // namespace plumbline
