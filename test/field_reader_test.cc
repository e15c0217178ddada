#include "plumbline/apps/io/field_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace plumbline {
namespace {

using testing::ElementsAre;

TEST(FieldReaderTest, TakesALineApart) {
  FieldReader fields("  POSE\t-1.5 2e3  2 0.25 .5 ");
  EXPECT_EQ(fields.Word("keyword"), "POSE");
  EXPECT_EQ(fields.Number("x"), -1.5);
  EXPECT_EQ(fields.FiniteNumber("y"), 2000.0);
  const int count = fields.Count("n");
  EXPECT_THAT(fields.Numbers("range", count), ElementsAre(0.25, 0.5));
  fields.ExpectEnd();
  EXPECT_TRUE(fields.ok());
}

TEST(FieldReaderTest, NumbersNeedNotBeFinite) {
  FieldReader fields("nan inf -inf 1e999 1e-999");
  EXPECT_TRUE(std::isnan(fields.Number("a")));
  EXPECT_EQ(fields.Number("b"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(fields.Number("c"), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(fields.Number("d"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(fields.Number("e"), 0.0);
  EXPECT_TRUE(fields.ok());
}

TEST(FieldReaderTest, TheFirstFailureSticks) {
  FieldReader fields("1 abc 3");
  EXPECT_EQ(fields.Number("x"), 1.0);
  EXPECT_EQ(fields.Number("y"), 0.0);
  EXPECT_EQ(fields.Number("z"), 0.0);
  EXPECT_EQ(fields.field(), "y");
  EXPECT_EQ(fields.error(), "field 'y': 'abc' is not a number");
}

TEST(FieldReaderTest, NamesEachKindOfFailure) {
  const auto error = [](const char* line, void (*read)(FieldReader*)) {
    FieldReader fields(line);
    read(&fields);
    return fields.error();
  };
  EXPECT_EQ(error("", [](FieldReader* f) { f->Number("x"); }),
            "field 'x': is missing, the line ends before it");
  EXPECT_EQ(error(" ", [](FieldReader* f) { f->Word("host"); }),
            "field 'host': is missing, the line ends before it");
  EXPECT_EQ(error("1.5x", [](FieldReader* f) { f->Number("x"); }),
            "field 'x': '1.5x' is not a number");
  EXPECT_EQ(error("nan", [](FieldReader* f) { f->FiniteNumber("x"); }),
            "field 'x': 'nan' is not a finite number");
  EXPECT_EQ(error("abc", [](FieldReader* f) { f->FiniteNumber("x"); }),
            "field 'x': 'abc' is not a number");
  EXPECT_EQ(error("0", [](FieldReader* f) { f->PositiveNumber("x"); }),
            "field 'x': '0' is not a positive number");
  EXPECT_EQ(error("-3", [](FieldReader* f) { f->Count("n"); }), "field 'n': '-3' is not a count");
  EXPECT_EQ(error("2.5", [](FieldReader* f) { f->Count("n"); }), "field 'n': '2.5' is not a count");
  EXPECT_EQ(error("1 2 x", [](FieldReader* f) { f->Numbers("range", 3); }),
            "field 'range[2]': 'x' is not a number");
  EXPECT_EQ(error("1 2", [](FieldReader* f) { f->Numbers("range", 2000000000); }),
            "field 'range[2]': is missing, the line ends before it");
  EXPECT_EQ(error(" extra", [](FieldReader* f) { f->ExpectEnd(); }),
            "field 'end of line': 'extra' is one field too many");
}

}  // namespace
}  // namespace plumbline
