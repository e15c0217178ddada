#include "plumbline/apps/benchmark/published_figures.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

TEST(PublishedFiguresTest, BelongToTheContentOfAFileWhateverItsName) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "PLUMBLINE_DATASETS is not set";
  const std::string folder = TempFolder();
  for (const char* name : {"fr079", "intel"}) {
    std::filesystem::copy_file(DatasetsFolder() + "/" + name + ".relations", folder + "copy",
                               std::filesystem::copy_options::overwrite_existing);
    std::vector<PublishedFigure> figures;
    ASSERT_TRUE(FindPublishedFigures(folder + "copy", &figures).ok());
    ASSERT_EQ(figures.size(), 5u);
    for (const PublishedFigure& figure : figures) {
      EXPECT_FALSE(figure.source.empty());
      EXPECT_GT(figure.translation_m.mean, 0.0);
    }
    // One more relation is another benchmark.
    WriteFile(folder + "copy", ReadFile(folder + "copy") + "0 1 0 0 0 0 0 0\n");
    ASSERT_TRUE(FindPublishedFigures(folder + "copy", &figures).ok());
    EXPECT_TRUE(figures.empty());
  }
}

TEST(PublishedFiguresTest, UnknownRelationsHaveNoneAndAMissingFileIsNotFound) {
  const std::string folder = TempFolder();
  WriteFile(folder + "fr079.relations", "0 1 0 0 0 0 0 0\n");
  std::vector<PublishedFigure> figures(1);
  ASSERT_TRUE(FindPublishedFigures(folder + "fr079.relations", &figures).ok());
  EXPECT_TRUE(figures.empty());
  EXPECT_EQ(FindPublishedFigures(folder + "none", &figures).code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace plumbline
