#include "plumbline/apps/report/html_report.h"

#include <cairo/cairo.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "plumbline/apps/report/html_text.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr char kHostile[] = "</title><script>alert('a' & \"b\")</script>";

class HtmlReportTest : public testing::Test {
 protected:
  HtmlReportTest() {
    cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 4, 3);
    EXPECT_EQ(cairo_surface_write_to_png(surface, png_.c_str()), CAIRO_STATUS_SUCCESS);
    cairo_surface_destroy(surface);
    WriteFile(no_png_, "GIF89a");
  }

  ReportMap Map(const std::string& name) const {
    ReportMap map{name, png_, MapArea()};
    map.area.raster = {0.05, -1.5, 2.25, 3, 2};
    map.area.left_px = 1;
    return map;
  }
  HtmlReport FullReport(const std::string& text) const {
    HtmlReport report;
    report.title = report.subtitle = report.all_clear = text;
    report.alarms = {text};
    report.figures = {{text, text, text}};
    report.maps = {Map(text)};
    report.tables = {{text, {text, text}, {{text, text}}, text}};
    report.texts = {{text, text}};
    report.plots = {{text, text, {{text, {{0.5, 1.0, 7.0}}}}, text}};
    report.stage_plots = {{text, text, {text, text}, {{text, {7.0, 0.5}}}, text}};
    report.histograms = {{text, text, {0.0, 0.5}, {3, 4}, text}};
    report.durations = {{text, 1.5}};
    report.pictures = {{text, png_}};
    report.options = {{text, text, text + "!", text}};
    return report;
  }
  std::string Write(const HtmlReport& report) const {
    const Status status = WriteHtmlReport(path_, report);
    EXPECT_TRUE(status.ok()) << status.message();
    return ReadFile(path_);
  }
  // What the page's script reads.
  static nlohmann::json DataOf(const std::string& html) {
    const std::string begin = "id=\"report-data\">";
    const std::size_t at = html.find(begin) + begin.size();
    return nlohmann::json::parse(html.substr(at, html.find("</script>", at) - at));
  }
  void ExpectRefused(const HtmlReport& report, StatusCode code, const std::string& message) const {
    const Status status = WriteHtmlReport(path_, report);
    EXPECT_EQ(status.code(), code);
    EXPECT_THAT(status.message(), HasSubstr(message));
    EXPECT_EQ(NumFilesIn(folder_), 2);  // the pictures
  }

  const std::string folder_ = TempFolder();
  const std::string png_ = folder_ + "a.png", no_png_ = folder_ + "b.png";
  const std::string path_ = folder_ + "report.html";
};

TEST_F(HtmlReportTest, TextsCannotBecomeMarkup) {
  const std::string html = Write(FullReport(kHostile));
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html, HasSubstr("<h1>" + EscapeHtml(kHostile) + "</h1>"));
  EXPECT_THAT(html, HasSubstr("data-name=\"" + EscapeHtml(kHostile) + "\""));
  EXPECT_EQ(DataOf(html)["plots"][0]["curves"][0]["label"], kHostile);
  EXPECT_EQ(DataOf(html)["histograms"][0]["xLabel"], kHostile);
  EXPECT_EQ(DataOf(html)["stagePlots"][0]["stages"][1], kHostile);
  EXPECT_EQ(DataOf(html)["stagePlots"][0]["curves"][0]["values"], nlohmann::json({7.0, 0.5}));
}

TEST_F(HtmlReportTest, HoldsItsPicturesAndAsksForNothing) {
  const std::string html = Write(FullReport("a"));
  const std::string address = "src=\"data:image/png;base64," + Base64(ReadFile(png_)) + "\"";
  const std::size_t first = html.find(address);
  ASSERT_NE(first, html.npos);
  EXPECT_NE(html.find(address, first + 1), html.npos);  // the map and the picture
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  const std::regex foreign(
      "(src|href|action)\\s*=\\s*[\"']?(?![\"']|data:)|@import|url\\(|fetch\\(");
  std::smatch match;
  EXPECT_FALSE(std::regex_search(html, match, foreign)) << match.str();
  EXPECT_THAT(html, Not(HasSubstr("https:")));
}

TEST_F(HtmlReportTest, PrintedLinesKeepTheirColumns) {
  HtmlReport report;
  report.texts = {{"Table", "a    1\nb  < 22\n"}};
  EXPECT_THAT(Write(report), HasSubstr("<pre>a    1\nb  &lt; 22\n</pre>"));
}

TEST_F(HtmlReportTest, MapsKnowTheirPlace) {
  EXPECT_THAT(Write(FullReport("a")),
              HasSubstr("data-left-m=\"-1.5\" data-top-m=\"2.25\" data-pixel-m=\"0.05\" "
                        "data-left-px=\"1\" data-top-px=\"0\" data-width-px=\"3\" "
                        "data-height-px=\"2\""));
}

TEST_F(HtmlReportTest, WhatIsNotFiniteHasNoNumber) {
  HtmlReport report = FullReport("a");
  report.plots[0].curves[0].points = {{kNan, 1.0, 2.0}, {0.5, 2.0, -1.0 / 0.0}};
  report.durations = {{"known", 2.0}, {"unknown", kNan}, {"endless", 1.0 / 0.0}};
  const std::string html = Write(report);
  const nlohmann::json points = DataOf(html)["plots"][0]["curves"][0]["points"];
  EXPECT_EQ(points, nlohmann::json::parse("[[null, 1.0, 2.0], [0.5, 2.0, null]]"));
  EXPECT_THAT(html, HasSubstr("<span class=\"seconds\">2.00 s</span>"));
  EXPECT_THAT(html, HasSubstr("<span class=\"seconds\">-</span>"));
  EXPECT_THAT(html, Not(HasSubstr("width:nan")));
  EXPECT_THAT(html, Not(HasSubstr("inf s")));
}

TEST_F(HtmlReportTest, EmptySectionsAreLeftOut) {
  HtmlReport report;
  report.title = "empty";
  const std::string empty = Write(report);
  const std::string full = Write(FullReport("a"));
  for (const char* mark :
       {"id=\"map-viewer\"", "<dl class=\"figures\">", "<table", "<figure", "<div class=\"chart\"",
        "id=\"options\"", "class=\"durations\"", "role=\"alert\"", "class=\"subtitle\""}) {
    EXPECT_THAT(full, HasSubstr(mark));
    EXPECT_THAT(empty, Not(HasSubstr(mark)));
  }
  EXPECT_THAT(empty, HasSubstr("<h1>empty</h1>"));
  EXPECT_THAT(empty, Not(HasSubstr("{{")));
  EXPECT_EQ(DataOf(empty)["plots"].size(), 0u);
}

TEST_F(HtmlReportTest, AnAlarmTakesThePlaceOfTheAllClear) {
  HtmlReport report;
  report.all_clear = "all is well";
  EXPECT_THAT(Write(report), HasSubstr("all is well"));
  report.alarms = {"all is lost"};
  const std::string html = Write(report);
  EXPECT_THAT(html, HasSubstr("<li>all is lost</li>"));
  EXPECT_THAT(html, Not(HasSubstr("all is well")));
}

TEST_F(HtmlReportTest, OptionsThatWereChangedStandOut) {
  HtmlReport report;
  report.options = {{"a", "1", "1", "kept"}};
  EXPECT_THAT(Write(report), Not(HasSubstr("<tr class=\"changed\">")));
  report.options.push_back({"b", "2", "3", "set"});
  EXPECT_THAT(Write(report), HasSubstr("<small>default: 3</small>"));
}

TEST_F(HtmlReportTest, TheSameReportGivesTheSameBytes) {
  const std::string first = Write(FullReport("a"));
  EXPECT_EQ(Write(FullReport("a")), first);
  EXPECT_EQ(NumFilesIn(folder_), 3);
}

TEST_F(HtmlReportTest, BadInputIsRefusedAndLeavesNoFile) {
  HtmlReport report = FullReport("a");
  report.tables[0].rows.push_back({"only one"});
  ExpectRefused(report, StatusCode::kInvalidArgument, "table 'a' has 2 columns, but a row of 1");
  report = FullReport("a");
  report.histograms[0].counts.pop_back();
  ExpectRefused(report, StatusCode::kInvalidArgument, "histogram 'a'");
  report = FullReport("a");
  report.stage_plots[0].stages.pop_back();
  ExpectRefused(report, StatusCode::kInvalidArgument,
                "series 'a' of 'a' needs one value per stage");
  report = FullReport("a");
  report.maps[0].area.raster.pixel_m = 0.0;
  ExpectRefused(report, StatusCode::kInvalidArgument, "map 'a' has no place");
  report.maps[0].area.raster = {0.05, kNan, 0.0, 3, 2};
  ExpectRefused(report, StatusCode::kInvalidArgument, "map 'a' has no place");
  report = FullReport("a");
  report.maps[0].png_path = folder_ + "none.png";
  ExpectRefused(report, StatusCode::kNotFound, "none.png");
  report = FullReport("a");
  report.pictures[0].png_path = folder_;
  ExpectRefused(report, StatusCode::kInvalidArgument, "Is a directory");
  report.pictures[0].png_path = no_png_;
  ExpectRefused(report, StatusCode::kInvalidArgument, "is no PNG");
  EXPECT_EQ(WriteHtmlReport(folder_ + "none/report.html", FullReport("a")).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
