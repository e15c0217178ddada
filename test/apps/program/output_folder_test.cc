#include "plumbline/apps/program/output_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

TEST(OutputFolderTest, IsMadeWithTheFoldersAboveIt) {
  OutputFolder folder(TempFolder() + "a/b");
  ASSERT_TRUE(folder.Make().ok());
  EXPECT_TRUE(folder.Make().ok());  // it is there
  EXPECT_TRUE(std::filesystem::is_directory(folder.path()));
  EXPECT_EQ(folder.File("map.png"), folder.path() + "/map.png");
}

TEST(OutputFolderTest, KnowsTheFoldersThatItMade) {
  const std::string there = TempFolder();
  OutputFolder inner(there + "a/b/");
  ASSERT_TRUE(inner.Make().ok());
  EXPECT_THAT(inner.made_folders(), testing::ElementsAre(there + "a/b", there + "a"));
  OutputFolder old(there);
  ASSERT_TRUE(old.Make().ok());
  EXPECT_THAT(old.made_folders(), testing::IsEmpty());
}

TEST(OutputFolderTest, CannotReplaceAFile) {
  const std::string path = TempFolder() + "file";
  WriteFile(path, "in the way");
  const Status status = OutputFolder(path).Make();
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), testing::HasSubstr("cannot make the folder '" + path + "'"));
}

TEST(OutputFolderTest, RefusesAFolderThatTakesNoFiles) {
  // Not even the administrator may write here.
  const Status status = OutputFolder("/proc").Make();
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(status.message(), testing::HasSubstr("'/proc/summary.json'"));
}

TEST(OutputFolderTest, RemovesOldResultsAndNothingElse) {
  const std::string path = TempFolder();
  for (const char* name : {"summary.json", "points.ply", "map.pgm.12-0.tmp", "graph.g2o"}) {
    WriteFile(path + name, "old");
  }
  const OutputFolder folder(path);
  for (const char* name : {"notes.txt", "notes.txt.12-0.tmp", "points.ply.bak"}) {
    WriteFile(path + name, "mine");
  }
  EXPECT_THAT(ResultsIn(path), testing::Contains(path + "map.pgm.12-0.tmp"));
  ASSERT_TRUE(folder.RemoveOldResults().ok());
  EXPECT_EQ(NumFilesIn(path), 3);
  for (const char* name : {"notes.txt", "notes.txt.12-0.tmp", "points.ply.bak"}) {
    EXPECT_EQ(ReadFile(path + name), "mine");
  }
}

TEST(OutputFolderTest, RemovesTheMapsOfSeveralSessions) {
  const std::string path = TempFolder();
  const OutputFolder folder(path);
  EXPECT_EQ(folder.MapFolder(2), path + "map_2");
  for (const char* name : {"map_1", "map_2", "map_x", "elsewhere"}) {
    std::filesystem::create_directory(path + name);
    WriteFile(path + name + "/points.ply", "old");
  }
  std::filesystem::create_directory_symlink("elsewhere", path + "map_3");
  WriteFile(path + "map_2/notes.txt", "mine");
  WriteFile(path + "trajectory_12.tum", "old");
  WriteFile(path + "trajectory_1a.tum", "mine");
  EXPECT_THAT(ResultsIn(path),
              testing::IsSupersetOf({path + "trajectory_12.tum", path + "map_1/points.ply",
                                     path + "map_2/summary.json"}));
  ASSERT_TRUE(folder.RemoveOldResults().ok());
  EXPECT_FALSE(std::filesystem::exists(path + "map_1"));
  EXPECT_FALSE(std::filesystem::exists(path + "map_2/points.ply"));
  EXPECT_FALSE(std::filesystem::exists(path + "trajectory_12.tum"));
  for (const char* name :
       {"map_2/notes.txt", "map_x/points.ply", "elsewhere/points.ply", "trajectory_1a.tum"}) {
    EXPECT_TRUE(std::filesystem::exists(path + name)) << name;
  }
}

TEST(OutputFolderTest, RemovesWhatALinkLeadsToButNoLinkAndNoDevice) {
  const std::string path = TempFolder();
  WriteFile(path + "elsewhere", "old");
  std::filesystem::create_symlink("elsewhere", path + "map.pgm");
  std::filesystem::create_symlink("/dev/null", path + "points.ply");
  std::filesystem::create_symlink("none", path + "points.pcd");
  ASSERT_TRUE(OutputFolder(path).RemoveOldResults().ok());
  EXPECT_FALSE(std::filesystem::exists(path + "elsewhere"));
  for (const char* link : {"map.pgm", "points.ply", "points.pcd"}) {
    EXPECT_TRUE(std::filesystem::is_symlink(path + link)) << link;
  }
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(OutputFolderTest, BelongsToOneRunAtATime) {
  const std::string path = TempFolder();
  std::filesystem::create_directory_symlink(".", path + "link");
  {
    OutputFolder folder(path);
    ASSERT_TRUE(folder.Make().ok());
    ASSERT_TRUE(folder.Make().ok());
    for (const std::string& name : {path, path + "link"}) {
      OutputFolder other(name);
      const Status status = other.Make();
      EXPECT_EQ(status.code(), StatusCode::kUnavailable);
      EXPECT_THAT(status.message(), testing::HasSubstr("the folder '" + name + "' is in use"));
    }
  }
  EXPECT_TRUE(OutputFolder(path).Make().ok());
  EXPECT_EQ(NumFilesIn(path), 1);
}

TEST(OutputFolderTest, NamesWhatCannotBeRemoved) {
  const std::string path = TempFolder();
  std::filesystem::create_directories(path + "map.pgm/inside");
  EXPECT_THAT(OutputFolder(path).RemoveOldResults().message(),
              testing::HasSubstr("cannot remove '" + path + "map.pgm'"));
  EXPECT_THAT(OutputFolder(path + "none").RemoveOldResults().message(),
              testing::HasSubstr("none': No such file"));
}

}  // namespace
}  // namespace plumbline
