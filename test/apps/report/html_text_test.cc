#include "plumbline/apps/report/html_text.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

namespace plumbline {
namespace {

std::string Expand(const std::string& text, const std::map<std::string, std::string>& values) {
  std::ostringstream out;
  ExpandTemplate(text, values, &out);
  return out.str();
}

TEST(HtmlTextTest, EscapesAllThatHtmlCouldMisread) {
  EXPECT_EQ(EscapeHtml("<a href=\"x\">'&'</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
  EXPECT_EQ(EscapeHtml("&amp; \xc3\xa4"), "&amp;amp; \xc3\xa4");
  EXPECT_EQ(EscapeHtml(""), "");
}

TEST(HtmlTextTest, APageHoldsNothingButUtf8) {
  EXPECT_EQ(EscapeHtml("a\x1b[31m\xff\n\tb"), "a\\x1b[31m\\xff\n\tb");
}

TEST(HtmlTextTest, Base64IsThatOfTheStandard) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64(std::string("\xff\xfe\x00\xfb", 4)), "//4A+w==");
}

TEST(HtmlTextTest, JsonCannotEndItsScript) {
  const std::string text = ScriptJson({{"name", "</script><!--"}});
  EXPECT_EQ(text, "{\"name\":\"\\u003c/script>\\u003c!--\"}");
  EXPECT_EQ(nlohmann::json::parse(text)["name"], "</script><!--");
}

TEST(HtmlTextTest, WhatJsonCannotSayIsReplaced) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(ScriptJson({1.5, std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity}),
            "[1.5,null,null,null]");
  EXPECT_EQ(ScriptJson({"a\xff"}), "[\"a\xef\xbf\xbd\"]");
}

TEST(HtmlTextTest, TemplatesTakeValuesAsTheyAre) {
  EXPECT_EQ(Expand("<{{a}}|{{b}}|{{c}}>", {{"a", "1"}, {"b", "{{a}}"}}), "<1|{{a}}|>");
  EXPECT_EQ(Expand("no names {{ open", {}), "no names {{ open");
}

TEST(HtmlTextTest, BlocksWithoutAValueAreLeftOut) {
  const std::string text = "[{{#a}}a={{a}}{{#b}},b={{b}}{{/b}}{{/a}}]";
  EXPECT_EQ(Expand(text, {{"a", "1"}, {"b", "2"}}), "[a=1,b=2]");
  EXPECT_EQ(Expand(text, {{"a", "1"}, {"b", ""}}), "[a=1]");
  EXPECT_EQ(Expand(text, {{"b", "2"}}), "[]");
}

}  // namespace
}  // namespace plumbline
