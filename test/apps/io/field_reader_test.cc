#include "plumbline/apps/io/field_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

namespace plumbline {
namespace {

using testing::ElementsAre;

TEST(FieldReaderTest, LegibleTextIsUtf8WithoutControls) {
  const std::string kept = "gr\xc3\xb6\xc3\x9f \xe2\x82\xac \xf0\x9f\x98\x80 ~";
  EXPECT_EQ(Legible(kept), kept);
  EXPECT_EQ(Legible("\x1b[2J\r\n\x7f"), "\\x1b[2J\\x0d\\x0a\\x7f");
  EXPECT_EQ(Legible("a\nb", "\n"), "a\nb");
  // Not UTF-8: a lone byte, a cut character, forms that are too long, a surrogate, beyond Unicode.
  EXPECT_EQ(Legible("\xff"), "\\xff");
  EXPECT_EQ(Legible("\xe2\x82"), "\\xe2\\x82");
  EXPECT_EQ(Legible("\xc0\xaf"), "\\xc0\\xaf");
  EXPECT_EQ(Legible("\xe0\x80\xaf"), "\\xe0\\x80\\xaf");
  EXPECT_EQ(Legible("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(Legible("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
  EXPECT_EQ(Legible("\xc2\x9b"), "\\xc2\\x9b");  // a terminal takes it for the start of a code
}

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

TEST(FieldReaderTest, RefusesNumbersBeyondTheLimits) {
  FieldReader good("1e7 -1e7 1e6 -1e12");
  EXPECT_EQ(good.Coordinate("x"), 1e7);
  EXPECT_EQ(good.Coordinate("y"), -1e7);
  EXPECT_EQ(good.Yaw("yaw"), 1e6);
  EXPECT_EQ(good.Time("t"), -1e12);
  EXPECT_TRUE(good.ok());
  const auto error = [](const char* line, double (FieldReader::*read)(const char*)) {
    FieldReader fields(line);
    EXPECT_EQ((fields.*read)("a"), 0.0);
    return fields.error();
  };
  EXPECT_EQ(error("-1.01e7", &FieldReader::Coordinate),
            "field 'a': '-1.01e7' is not within 1e7 m of the origin");
  EXPECT_EQ(error("1e999", &FieldReader::Coordinate), "field 'a': '1e999' is not a finite number");
  EXPECT_EQ(error("2e6", &FieldReader::Yaw), "field 'a': '2e6' is not an angle within 1e6 rad");
  EXPECT_EQ(error("2e12", &FieldReader::Time), "field 'a': '2e12' is not a time within 1e12 s");
  EXPECT_EQ(error("nan", &FieldReader::Time), "field 'a': 'nan' is not a finite number");
}

TEST(FieldReaderTest, QuotesOnOneShortLineWithoutTerminalCodes) {
  EXPECT_EQ(Quote("plain"), "'plain'");
  EXPECT_EQ(Quote(std::string_view("\x1b[2J\r\0\xff", 7)), "'\\x1b[2J\\x0d\\x00\\xff'");
  EXPECT_EQ(Printable(std::string(50, 'x')), std::string(40, 'x') + "...");
}

}  // namespace
}  // namespace plumbline
