#include "plumbline/apps/saved_maps/boost_archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "plumbline/apps/saved_maps/karto_classes.h"
#include "plumbline/test/apps/saved_maps/boost_writer.h"
#include "plumbline/test/apps/saved_maps/posegraph_writer.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A list, and what may be in it.
const ArchiveSchema& Nodes() {
  static const ArchiveSchema schema({
      {"Base", {{"int32", "number"}}, ArchiveClass::Form::kMembers, /*is_abstract=*/true},
      {"Node", {{"Base", "base"}, {"Node*", "next"}}},
      {"Array",
       {{"Base", "base"},
        {"uint32", "rows"},
        {"uint32", "columns"},
        {"double", "values", {"rows", "columns"}}}},
      {"vector<Base*>", {{"Base*", "element"}}, ArchiveClass::Form::kCollection},
      {"List", {{"vector<Base*>", "nodes"}, {"string", "name"}}},
  });
  return schema;
}

class BoostArchiveTest : public testing::Test {
 protected:
  // A list of this many elements, which follow.
  static BoostWriter List(std::size_t size, std::uint16_t version = 18) {
    BoostWriter writer(version);
    writer.TrackedObject("List");
    writer.Collection("vector", size);
    return writer;
  }
  static void Base(std::uint32_t number, BoostWriter* writer) {
    writer->Object("Base");
    writer->Int(number);
  }
  Status Read(const std::string& bytes) { return archive_.Read(bytes, Nodes(), "List"); }
  void ExpectDamaged(const std::string& bytes, const std::string& problem) {
    const Status status = Read(bytes);
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(), HasSubstr(problem));
  }
  ArchiveObject Element(std::size_t i) const { return archive_.root().Object("nodes")[i]; }

  BoostArchive archive_;
};

TEST_F(BoostArchiveTest, ReadsObjectsBehindPointersOnce) {
  BoostWriter writer = List(3);
  const std::uint32_t first = writer.PointerToDerived("Node");
  Base(7, &writer);
  writer.Null();
  writer.PointerToDerived("Node");
  Base(-8, &writer);
  writer.Again("Node", first);
  writer.Again("Node", first);
  writer.Text("three");
  ASSERT_TRUE(Read(writer.bytes()).ok());
  EXPECT_EQ(archive_.root().String("name"), "three");
  ASSERT_EQ(archive_.root().Object("nodes").size(), 3u);
  EXPECT_EQ(Element(0).Object("base").Number("number"), 7.0);
  EXPECT_TRUE(Element(0).Object("next").is_null());
  EXPECT_EQ(Element(1).Object("base").Number("number"), -8.0);
  EXPECT_TRUE(Element(1).Object("next") == Element(0));
  EXPECT_TRUE(Element(2) == Element(0));
}

TEST_F(BoostArchiveTest, ReadsClassesByTheirNames) {
  BoostWriter writer = List(2);
  writer.PointerToDerived("Array");
  Base(0, &writer);
  writer.Int(2);
  writer.Int(1);
  writer.Double(0.5);
  writer.Double(-2.0);
  writer.Null();
  writer.Text("");
  ASSERT_TRUE(Read(writer.bytes()).ok());
  EXPECT_TRUE(Element(0).IsA("Array"));
  EXPECT_TRUE(Element(0).IsA("Base"));
  EXPECT_FALSE(Element(0).IsA("Node"));
  EXPECT_THAT(Element(0).Numbers("values"), ElementsAre(0.5, -2.0));
  EXPECT_TRUE(Element(1).is_null());
  EXPECT_FALSE(Element(1).IsA("Base"));
}

TEST_F(BoostArchiveTest, PlacesAreThoseOfTheBytes) {
  BoostWriter writer = List(1);
  writer.PointerToDerived("Node");
  Base(0x01020304, &writer);
  writer.Null();
  writer.Text("");
  ASSERT_TRUE(Read(writer.bytes()).ok());
  EXPECT_EQ(Element(0).Object("base").Place("number"),
            archive_.bytes().find(std::string("\4\3\2\1")));
}

// A call for each would take the stack.
TEST_F(BoostArchiveTest, AChainOfPointersMayBeAnyLength) {
  constexpr std::uint32_t kLength = 300000;
  BoostWriter writer = List(1);
  writer.PointerToDerived("Node");
  Base(0, &writer);
  for (std::uint32_t i = 1; i < kLength; ++i) {
    writer.Pointer("Node");
    Base(i, &writer);
  }
  writer.Null();
  writer.Text("");
  ASSERT_TRUE(Read(writer.bytes()).ok());
  std::uint32_t length = 0;
  for (ArchiveObject node = Element(0); !node.is_null(); node = node.Object("next")) ++length;
  EXPECT_EQ(length, kLength);
}

TEST_F(BoostArchiveTest, TakesTheVersionsThatAreKnown) {
  for (const int version : {15, 17, 18, 19, 20, 21}) {
    BoostWriter writer = List(0, static_cast<std::uint16_t>(version));
    writer.Text("");
    EXPECT_TRUE(Read(writer.bytes()).ok()) << version;
  }
  for (const int version : {0, 14, 22, 0xffff}) {
    BoostWriter writer = List(0, static_cast<std::uint16_t>(version));
    writer.Text("");
    const Status status = Read(writer.bytes());
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("an archive of version " + std::to_string(version)));
  }
}

TEST_F(BoostArchiveTest, OtherFilesAndMachinesAreNamed) {
  for (const std::string text : {"", "22 serialization::archive 18 0 0", "VERTEX_SE2 0 0 0 0\n"}) {
    const Status status = Read(text);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("it does not begin as binary archives"));
  }
  BoostWriter writer = List(0);
  writer.Text("");
  std::string big_endian = writer.bytes();
  std::swap(big_endian[36], big_endian[39]);  // the int behind the sizes
  EXPECT_THAT(Read(big_endian).message(), HasSubstr("an archive of a machine with other sizes"));
  EXPECT_TRUE(BoostArchive::IsArchive(writer.bytes()));
  EXPECT_TRUE(BoostArchive::IsArchive("22 serialization::archive 18 0 0"));
  EXPECT_FALSE(BoostArchive::IsArchive("# this is no serialization::archive"));
}

TEST_F(BoostArchiveTest, LyingLengthsAreDamage) {
  for (const std::uint64_t length :
       {std::uint64_t{100}, std::uint64_t{1} << 40, std::numeric_limits<std::uint64_t>::max()}) {
    ExpectDamaged(List(length).bytes(), "List.nodes: more elements than the file has bytes");
    BoostWriter text = List(0);
    text.Number(length);
    ExpectDamaged(text.bytes(), "List.name: it takes " + std::to_string(length) + " bytes");
    BoostWriter name = List(1);
    name.Number<std::uint16_t>(2);  // the next class
    name.Number(length);
    ExpectDamaged(name.bytes(), length == 100 ? "it takes 100 bytes" : "takes too many bytes");
  }
  for (const std::uint32_t size : {0x10000u, 0xffffffffu}) {
    BoostWriter writer = List(1);
    writer.PointerToDerived("Array");
    Base(0, &writer);
    writer.Int(size);
    writer.Int(size);
    ExpectDamaged(writer.bytes(), "Array.values: more values than the file has bytes");
  }
}

TEST_F(BoostArchiveTest, WrongClassesAndObjectsAreDamage) {
  BoostWriter unknown = List(1);
  unknown.PointerToDerived("Other");
  ExpectDamaged(unknown.bytes(), "an object of class 'Other', which is not known");
  BoostWriter no_base = List(1);
  no_base.PointerToDerived("List");
  ExpectDamaged(no_base.bytes(), "a pointer to an object of List, which is no Base");
  BoostWriter far = List(1);
  far.Number<std::uint16_t>(77);
  ExpectDamaged(far.bytes(), "class 77 is not known");
  BoostWriter later = List(2);
  later.PointerToDerived("Node");
  Base(0, &later);
  later.Null();
  later.Again("Node", 9);
  ExpectDamaged(later.bytes(), "object 9 is not known");
  BoostWriter other = List(3);
  other.PointerToDerived("Node");
  Base(0, &other);
  other.Null();
  other.Again("Node", 0);
  ExpectDamaged(other.bytes(), "object 0 is of class List, not Node");
}

TEST_F(BoostArchiveTest, VersionsOfClassesAreNamed) {
  BoostWriter writer(18);
  writer.Bool(true);
  writer.Int(3);
  ExpectDamaged(writer.bytes(), "version 3 of List; only version 0 is known");
}

TEST_F(BoostArchiveTest, NothingMayFollow) {
  BoostWriter writer = List(0);
  writer.Text("");
  ExpectDamaged(writer.bytes() + "more", "4 bytes more than there should be");
}

// Of maps of slam_toolbox, which have something of everything.
class SavedMapBytesTest : public testing::Test {
 protected:
  struct File {
    std::string bytes;
    const char* root;
  };
  static std::vector<File> Files() {
    return {{PosegraphBytes(SmallKartoMap()), "karto::Mapper"},
            {DataBytes(SmallKartoMap()), "karto::Dataset"}};
  }
  static Status Read(const std::string& bytes, const char* root) {
    BoostArchive archive;
    return archive.Read(bytes, KartoClasses(), root);
  }
};

TEST_F(SavedMapBytesTest, EveryCutIsFound) {
  for (const File& file : Files()) {
    ASSERT_TRUE(Read(file.bytes, file.root).ok());
    for (std::size_t size = 0; size < file.bytes.size(); ++size) {
      const Status status = Read(file.bytes.substr(0, size), file.root);
      ASSERT_FALSE(status.ok()) << size;
      ASSERT_FALSE(status.message().empty());
    }
  }
}

TEST_F(SavedMapBytesTest, FlippedBytesAreReadOrNamed) {
  for (const File& file : Files()) {
    std::size_t num_found = 0;
    for (std::size_t i = 0; i < file.bytes.size(); ++i) {
      for (const int change : {0x01, 0x80, 0xff}) {
        std::string flipped = file.bytes;
        flipped[i] = static_cast<char>(flipped[i] ^ change);
        const Status status = Read(flipped, file.root);
        EXPECT_EQ(status.ok(), status.message().empty()) << i;
        num_found += status.ok() ? 0 : 1;
      }
    }
    EXPECT_GT(num_found, file.bytes.size());  // the others are in names and numbers
  }
}

// At every place, whether or not there is a length.
TEST_F(SavedMapBytesTest, HugeNumbersAnywhereTakeNoMemory) {
  for (const File& file : Files()) {
    for (std::size_t i = 0; i + 8 <= file.bytes.size(); ++i) {
      for (const char* number : {"\xff\xff\xff\xff\xff\xff\xff\xff", "\0\0\0\0\0\1\0\0"}) {
        std::string huge = file.bytes;
        huge.replace(i, 8, number, 8);
        const Status status = Read(huge, file.root);
        EXPECT_EQ(status.ok(), status.message().empty()) << i;
      }
    }
  }
}

TEST_F(SavedMapBytesTest, VariantsOfSlamToolboxAreRead) {
  KartoMap newer = SmallKartoMap(), ros1 = newer, unused = newer;
  newer.has_newer_parameters = true;
  ros1.double_parameter = "karto::Parameter<kt_double >";
  unused.has_scan_matcher = false;
  for (KartoMap map : {newer, ros1, unused}) {
    for (const int version : {15, 17, 18, 19}) {
      map.archive_version = static_cast<std::uint16_t>(version);
      EXPECT_EQ(Read(PosegraphBytes(map), "karto::Mapper").message(), "");
      EXPECT_EQ(Read(DataBytes(map), "karto::Dataset").message(), "");
    }
  }
}

}  // namespace
}  // namespace plumbline
