#include "plumbline/apps/program/file_flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class FileFlagsTest : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_ + name; }

  static Status Check(const std::string& one, FileUse one_use, const std::string& other,
                      FileUse other_use) {
    return CheckFileFlags({{"one", &one, one_use}, {"other", &other, other_use}});
  }
  static void ExpectRefused(const std::string& one, const std::string& other) {
    const std::string text = "--one and --other both mean the file '" + other + "': ";
    for (const auto& [one_use, other_use] : {std::pair(FileUse::kInput, FileUse::kOutput),
                                             std::pair(FileUse::kOutput, FileUse::kInput),
                                             std::pair(FileUse::kOutput, FileUse::kOutput)}) {
      const Status status = Check(one, one_use, other, other_use);
      EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << one << ' ' << other;
      EXPECT_THAT(status.message(), HasSubstr(text));
    }
    EXPECT_TRUE(Check(one, FileUse::kInput, other, FileUse::kInput).ok());
  }

  const std::string folder_ = TempFolder();
};

// A folder, a link to it, and ways to write a file in it.
std::vector<std::string> Spellings(const std::string& folder, const std::string& name) {
  const std::filesystem::path file = folder + name;
  return {folder + name,
          folder + "./" + name,
          folder + '/' + name,
          folder + "sub/../" + name,
          folder + "none/../" + name,
          folder + "link_to_folder/" + name,
          folder + "link_to_folder/sub/../" + name,
          folder + "link_to_sub/../" + name,
          folder + "link_to_" + name,
          folder + "link_to_link_to_" + name,
          std::filesystem::relative(file),
          std::filesystem::relative(folder).string() + "/sub/../link_to_" + name};
}

void MakeLinks(const std::string& folder, const std::string& name) {
  std::filesystem::create_directory(folder + "sub");
  std::filesystem::create_directory_symlink(".", folder + "link_to_folder");
  std::filesystem::create_directory_symlink(folder + "sub", folder + "link_to_sub");
  std::filesystem::create_symlink(name, folder + "link_to_" + name);
  std::filesystem::create_symlink("sub/../link_to_" + name, folder + "link_to_link_to_" + name);
}

TEST_F(FileFlagsTest, AFileIsTheSameHoweverItIsWritten) {
  MakeLinks(folder_, "file");
  for (const bool is_there : {false, true}) {
    if (is_there) WriteFile(Path("file"), "text");
    for (const std::string& one : Spellings(folder_, "file")) {
      for (const std::string& other : Spellings(folder_, "file")) ExpectRefused(one, other);
    }
  }
  std::filesystem::create_hard_link(Path("file"), Path("hard"));
  ExpectRefused(Path("file"), Path("hard"));
  ExpectRefused(Path("hard"), Path("link_to_link_to_file"));
}

TEST_F(FileFlagsTest, AFileInAFolderToBeMadeIsTheSameHoweverItIsWritten) {
  std::filesystem::create_directory_symlink(".", Path("here"));
  ExpectRefused(Path("new/deeper/a"), Path("here/new/./other/../deeper//a"));
  ExpectRefused(Path("new/"), Path("here/new"));
}

TEST_F(FileFlagsTest, OtherFilesAreFine) {
  for (const char* folder : {"sub", "new"}) std::filesystem::create_directory(Path(folder));
  WriteFile(Path("file"), "text");
  WriteFile(Path("sub/file"), "text");
  for (const char* other : {"sub/file", "File.new", "sub/new", "new/file", "new/new"}) {
    EXPECT_TRUE(Check(Path("file"), FileUse::kInput, Path(other), FileUse::kOutput).ok()) << other;
    EXPECT_TRUE(Check(Path("gone"), FileUse::kOutput, Path(other), FileUse::kOutput).ok()) << other;
  }
  EXPECT_TRUE(Check("", FileUse::kInput, "", FileUse::kOutput).ok());
}

TEST_F(FileFlagsTest, AFolderCountsWithTheFilesThatAreWrittenInIt) {
  const std::string folder = Path("out"), inside = Path("out/a.png"), beside = Path("out/b.png");
  const FileFlag output = {
      "dir", &folder, FileUse::kOutputFolder,
      [](const std::string& value) -> std::vector<std::string> { return {value + "/a.png"}; }};
  for (const bool is_there : {false, true}) {
    if (is_there) std::filesystem::create_directory(folder);
    for (const FileUse use : {FileUse::kInput, FileUse::kOutput}) {
      EXPECT_THAT(CheckFileFlags({{"log", &inside, use}, output}).message(),
                  HasSubstr("--log and --dir both mean the file '" + inside + "'"));
      EXPECT_EQ(CheckFileFlags({{"log", &beside, use}, output}).code(),
                is_there || use == FileUse::kInput ? StatusCode::kOk : StatusCode::kUnavailable);
    }
    EXPECT_FALSE(CheckFileFlags({{"log", &folder, FileUse::kInput}, output}).ok());
  }
}

TEST_F(FileFlagsTest, AListMustNotMeanAFileTwice) {
  const std::string path = Path("a");
  const FileFlag list = {"output", &path, FileUse::kOutput,
                         [](const std::string& value) -> std::vector<std::string> {
                           return {value, value + ".b", value};
                         }};
  EXPECT_EQ(CheckFileFlags({list}).message(), "--output means the file '" + path + "' twice");
}

TEST_F(FileFlagsTest, ADeviceMayBeNamedSeveralTimes) {
  EXPECT_TRUE(Check("/dev/null", FileUse::kOutput, "/dev/null", FileUse::kOutput).ok());
}

TEST_F(FileFlagsTest, AFolderInThePlaceOfAnOutputIsRefused) {
  const std::string path = Path("out");
  std::filesystem::create_directory(path);
  const Status status = CheckFileFlags({{"csv", &path, FileUse::kOutput}});
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_EQ(status.message(), "cannot write '" + path + "': Is a directory");
  EXPECT_TRUE(CheckFileFlags({{"log", &path, FileUse::kInput}}).ok());
}

TEST_F(FileFlagsTest, AnOutputWithoutAFolderIsRefused) {
  const std::string path = Path("none/a.csv");
  EXPECT_EQ(CheckFileFlags({{"csv", &path, FileUse::kOutput}}).message(),
            "cannot write '" + path + "': No such file or directory");
}

}  // namespace
}  // namespace plumbline
