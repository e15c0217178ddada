#include "plumbline/solvers/association/tangent_lines.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(TangentLines, NoReturnHasALineAtFirst) {
  const TangentLines lines(3);
  EXPECT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines.CountReturns(), 0u);
  EXPECT_EQ(lines[2].normal_x, 0.0);
  EXPECT_EQ(lines[2].normal_y, 0.0);
}

TEST(TangentLines, ReturnsShareLinesAndTheZeroNormalIsNone) {
  TangentLines lines({{1.0, 0.0, 2.0}, {0.0, 0.0, 0.0}}, {0, 1, TangentLines::kNone, 0});
  EXPECT_TRUE(lines.HasLine(0));
  EXPECT_FALSE(lines.HasLine(1));
  EXPECT_FALSE(lines.HasLine(2));
  EXPECT_EQ(lines[3].offset, 2.0);
  EXPECT_EQ(lines.CountReturns(), 2u);
  lines.Assign(1, lines.Add({0.0, -1.0, 4.0}));
  lines.Assign(3, TangentLines::kNone);
  EXPECT_EQ(lines[1].normal_y, -1.0);
  EXPECT_EQ(lines[1].offset, 4.0);
  EXPECT_FALSE(lines.HasLine(3));
  EXPECT_EQ(lines.CountReturns(), 2u);
}

}  // namespace
}  // namespace plumbline
