#include "plumbline/apps/output_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "plumbline/test/temp_file.h"

namespace plumbline {
namespace {

TEST(OutputFolderTest, IsMadeWithTheFoldersAboveIt) {
  const OutputFolder folder(TempFolder() + "a/b");
  ASSERT_TRUE(folder.Make().ok());
  EXPECT_TRUE(folder.Make().ok());  // it is there
  EXPECT_TRUE(std::filesystem::is_directory(folder.path()));
  EXPECT_EQ(folder.File("map.png"), folder.path() + "/map.png");
}

TEST(OutputFolderTest, CannotReplaceAFile) {
  const std::string path = TempFolder() + "file";
  WriteFile(path, "in the way");
  const Status status = OutputFolder(path).Make();
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), testing::HasSubstr("cannot make the folder '" + path + "'"));
}

}  // namespace
}  // namespace plumbline
