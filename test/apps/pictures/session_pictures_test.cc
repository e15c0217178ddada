#include "plumbline/apps/pictures/session_pictures.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/test/apps/pictures/picture.h"
#include "plumbline/test/apps/two_sessions.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

constexpr int kSidePx = 600;

bool IsBlue(std::uint32_t rgb) { return Channel(rgb, 0) > 60 + Channel(rgb, 16); }
bool IsRed(std::uint32_t rgb) { return Channel(rgb, 16) > 60 + Channel(rgb, 0); }

class SessionPicturesTest : public testing::Test {
 protected:
  static Status Draw(const std::string& path, const SlamGraph& graph, MapPictureOptions picture) {
    picture.max_side_px = kSidePx;
    return WriteMapPicture(path, graph, graph.InitialState(), picture);
  }

  const std::string path_ = TempFolder() + "a.png";
};

TEST_F(SessionPicturesTest, EachSessionHasAColour) {
  // A wall that the second session alone shows, on the right.
  const TwoSessions sessions = MakeTwoSessions({}, {{{1.0, 0.5}, {1.0, 2.0}}});
  ASSERT_TRUE(Draw(path_, sessions.graph, ShowSessions(sessions.marks)).ok());
  const Picture picture(path_);
  const Box map{0, picture.width, 44, picture.height - 56 - 2 * 30};
  EXPECT_GT(picture.Count(IsBlue), 200);  // what is behind that wall
  EXPECT_GT(picture.Count(IsRed), 200);
  EXPECT_GT(picture.Around(IsBlue, map).right, picture.Around(IsRed, map).right - 5);
}

TEST_F(SessionPicturesTest, ProcessesDrawItTogether) {
  const TwoSessions sessions = MakeTwoSessions({}, {{{1.0, 0.5}, {1.0, 2.0}}});
  ASSERT_TRUE(Draw(path_, sessions.graph, ShowSessions(sessions.marks)).ok());
  const std::string of_all = path_ + ".all.png";
  RunOnParts(sessions.graph, 2, [&](const SlamGraph& part) {
    ASSERT_TRUE(Draw(of_all, part, ShowSessions(sessions.marks)).ok());
  });
  EXPECT_TRUE(ReadFile(of_all) == ReadFile(path_));
}

TEST_F(SessionPicturesTest, ChangesHaveRingsInTheColourOfTheirSession) {
  const TwoSessions sessions = MakeTwoSessions({}, {});
  SessionChange change;
  change.shown_by = 1;
  change.looked_through_by = {0};
  change.center = {-1.0, 0.5};
  const auto draw = [&](const std::vector<SessionChange>& changes) {
    const Status status = Draw(path_, sessions.graph, ShowChanges(sessions.marks, changes));
    EXPECT_TRUE(status.ok()) << status.message();
    return Picture(path_);
  };
  const Picture none = draw({}), one = draw({change});
  EXPECT_EQ(one.height, none.height);
  const Box map{0, one.width, 44, one.height - 56 - 2 * 30};
  EXPECT_EQ(none.Around(IsRed, map).height(), none.Around(IsRed, map).bottom - none.height);
  EXPECT_NEAR(one.Around(IsRed, map).height(), 20, 2);
}

TEST_F(SessionPicturesTest, NoLineLeadsFromOneSessionToTheNext) {
  TwoSessions sessions = MakeTwoSessions({}, {});
  SlamGraph& graph = sessions.graph;
  const auto is_line = [](std::uint32_t rgb) { return Channel(rgb, 16) > 90 + Channel(rgb, 0); };
  const auto draw = [&] {
    EXPECT_TRUE(WriteMapPicture(path_, graph, graph.InitialState(), MapPictureOptions()).ok());
    return Picture(path_).Count(is_line);
  };
  const int joined = draw();
  for (const int pose : {1, 2, 4, 5}) {
    graph.AddOdometry({pose - 1, pose, Pose2(0.5, 0.0, 0.0)});
  }
  EXPECT_LT(draw(), 0.7 * joined);  // a metre back, of two
}

}  // namespace
}  // namespace plumbline
