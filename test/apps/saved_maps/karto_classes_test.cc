#include "plumbline/apps/saved_maps/karto_classes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "plumbline/apps/saved_maps/boost_archive.h"
#include "plumbline/test/apps/saved_maps/boost_writer.h"

namespace plumbline {
namespace {

using Kind = ArchiveSchema::Value::Kind;

TEST(KartoClassesTest, AllNamesAreThereOnce) {
  const ArchiveSchema& schema = KartoClasses();
  std::set<std::string> names;
  for (int type = 0; type < schema.num_classes(); ++type) {
    const ArchiveClass& of = schema.Class(type);
    EXPECT_TRUE(names.insert(of.name).second) << of.name;
    ASSERT_EQ(schema.Values(type).size(), of.members.size());
    for (std::size_t i = 0; i < of.members.size(); ++i) {
      const ArchiveSchema::Value& value = schema.Values(type)[i];
      EXPECT_EQ(value.size > 0, value.kind == Kind::kNumber)
          << of.name << '.' << of.members[i].name;
      EXPECT_GE(value.type, 0) << of.name << '.' << of.members[i].name;
      for (const int factor : value.times) EXPECT_GE(factor, 0) << of.name;
    }
  }
  EXPECT_GT(names.size(), 60u);
}

TEST(KartoClassesTest, BasesAreThoseOfKarto) {
  const ArchiveSchema& schema = KartoClasses();
  const auto is_a = [&](const char* name, const char* base) {
    return schema.IsA(schema.Find(name), schema.Find(base));
  };
  EXPECT_TRUE(is_a("karto::LocalizedRangeScan", "karto::Object"));
  EXPECT_TRUE(is_a("karto::LaserRangeFinder", "karto::Object"));
  EXPECT_TRUE(is_a("karto::ParameterEnum", "karto::AbstractParameter"));
  EXPECT_TRUE(is_a("karto::MapperGraph", "karto::Graph"));
  EXPECT_TRUE(is_a("karto::CorrelationGrid", "karto::Grid<kt_int8u>"));
  EXPECT_FALSE(is_a("karto::Object", "karto::LocalizedRangeScan"));
  EXPECT_FALSE(is_a("karto::LinkInfo", "karto::Object"));
}

// Vertices in the edges of vertices, each of which says that all bytes left are its edges.
TEST(KartoClassesTest, CollectionsInCollectionsDoNotShareTheirBytes) {
  constexpr int kDepth = 200, kBytesPerLevel = 26;
  BoostWriter writer(18);
  writer.TrackedObject("E");
  for (int i = 0; i < kDepth; ++i) {
    writer.Pointer("V");
    writer.Register("LRS");
    writer.Null();
    writer.Collection("ve", std::max(1, (kDepth - i - 2) * kBytesPerLevel));
    writer.Pointer("E");
  }
  BoostArchive archive;
  const Status status = archive.Read(writer.bytes(), KartoClasses(), "karto::Edge");
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_THAT(status.message(), testing::HasSubstr("more elements than the file has bytes left"));
}

}  // namespace
}  // namespace plumbline
