#include "plumbline/apps/pictures/overlay_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr int kSidePx = 800;

// With some of the white that the edges of a line have.
bool IsBlue(std::uint32_t rgb) { return Channel(rgb, 0) > 60 + Channel(rgb, 16); }
bool IsOrange(std::uint32_t rgb) { return Channel(rgb, 16) > 60 + Channel(rgb, 0); }
bool IsMagenta(std::uint32_t rgb) { return rgb == 0xcc008cu; }

LoopClosureRecord Match(int from_pose, int to_pose, ClosureOutcome outcome) {
  LoopClosureRecord record;
  record.from_pose = from_pose;
  record.to_pose = to_pose;
  record.outcome = outcome;
  return record;
}

class OverlayPicturesTest : public testing::Test {
 protected:
  OverlayPicturesTest() {
    SyntheticScene scene = Room();
    scene.poses = {Pose2(-2.0, 1.5, 0.0), Pose2(2.0, 1.5, 0.0), Pose2(-2.0, 0.0, 0.0),
                   Pose2(2.0, 0.0, 0.0)};
    graph_ = MakeGraph(scene);
    state_ = graph_.InitialState();
  }
  Picture DrawClosures(const std::vector<LoopClosureRecord>& records) {
    MapPictureOptions closures;
    const Status status = ShowClosures(state_, records, &closures);
    EXPECT_TRUE(status.ok()) << status.message();
    return Draw(closures);
  }
  Picture Draw(MapPictureOptions picture) {
    picture.max_side_px = kSidePx;
    const Status status = WriteMapPicture(path_, graph_, state_, picture);
    EXPECT_TRUE(status.ok()) << status.message();
    return Picture(path_);
  }

  SlamGraph graph_;
  MapState state_;
  const std::string path_ = TempFolder() + "a.png";
};

TEST_F(OverlayPicturesTest, AcceptedAndRefusedClosuresAreToldApart) {
  const LoopClosureRecord accepted = Match(2, 3, ClosureOutcome::kAccepted);
  const LoopClosureRecord ambiguous = Match(0, 1, ClosureOutcome::kAmbiguous);
  const LoopClosureRecord low_overlap = Match(1, 3, ClosureOutcome::kLowOverlap);
  const Picture none = DrawClosures({});
  const Picture one = DrawClosures({accepted});
  EXPECT_EQ(one.height, none.height);
  // 4 m at 1 cm per pixel, and a dot of 3 px radius at both ends.
  const Box map{0, one.width, 44, one.height - 56 - 30};
  EXPECT_NEAR(one.Around(IsBlue, map).right - one.Around(IsBlue, map).left, 406, 2);
  EXPECT_LE(one.Around(IsBlue, map).height(), 7);
  EXPECT_EQ(one.Count(IsOrange), 0);

  const Picture all = DrawClosures({accepted, ambiguous, low_overlap, ambiguous});
  EXPECT_EQ(all.height, none.height + 2 * 30);            // a line of the legend per outcome
  EXPECT_NEAR(all.Count(IsBlue), one.Count(IsBlue), 20);  // one of the others ends on its dot
  EXPECT_GT(all.Count(IsOrange), 200);
}

TEST_F(OverlayPicturesTest, ClosuresOfUnknownPosesAreRefused) {
  MapPictureOptions closures;
  closures.title = "as it was";
  for (const auto& [from, to, unknown] : {std::tuple(0, 4, "no pose 4"), {-1, 2, "no pose -1"}}) {
    const LoopClosureRecord record = Match(from, to, ClosureOutcome::kAccepted);
    EXPECT_THAT(ShowClosures(state_, {record}, &closures).message(), HasSubstr(unknown));
  }
  EXPECT_EQ(closures.title, "as it was");
}

TEST_F(OverlayPicturesTest, ConflictsAreRingsHalfAMetreApart) {
  const auto draw = [this](const std::vector<Eigen::Vector2d>& points) {
    MapConsistency consistency;
    for (const Eigen::Vector2d& point : points) consistency.places.push_back({0, 1, point});
    return Draw(ShowConflicts(consistency));
  };
  const int legend = draw({}).Count(IsMagenta);
  const int one = draw({{0.1, 0.1}}).Count(IsMagenta) - legend;
  EXPECT_GT(one, 30);
  EXPECT_EQ(draw({{0.1, 0.1}, {0.3, 0.4}}).Count(IsMagenta), legend + one);
  EXPECT_EQ(draw({{0.1, 0.1}, {1.1, -1.9}}).Count(IsMagenta), legend + 2 * one);
}

TEST_F(OverlayPicturesTest, TheSameInputGivesTheSameBytes) {
  const std::vector<LoopClosureRecord> records{Match(0, 3, ClosureOutcome::kAccepted),
                                               Match(1, 2, ClosureOutcome::kContradicted)};
  DrawClosures(records);
  const std::string first = ReadFile(path_);
  DrawClosures(records);
  EXPECT_EQ(ReadFile(path_), first);
}

}  // namespace
}  // namespace plumbline
