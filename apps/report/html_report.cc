#include "plumbline/apps/report/html_report.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/report/html_text.h"
#include "plumbline/apps/report/report_assets.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxNarrowColumns = 5;  // what half the page has room for

std::string Element(const std::string& tag, const std::string& attributes,
                    const std::string& content) {
  return "<" + tag + (attributes.empty() ? "" : " " + attributes) + ">" + content + "</" + tag +
         ">";
}

std::string Attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + EscapeHtml(value) + "\"";
}

std::string Attribute(const std::string& name, double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.10g", value);
  return Attribute(name, text);
}

// A section with a heading. html: its content. A wide one takes both columns of the page.
std::string Card(const std::string& title, const std::string& html, const std::string& note,
                 bool is_wide = false) {
  return Element("section", is_wide ? "class=\"card wide\"" : "class=\"card\"",
                 Element("h2", "", EscapeHtml(title)) + html +
                     (note.empty() ? "" : Element("p", "class=\"note\"", EscapeHtml(note)))) +
         "\n";
}

Status CheckTable(const ReportTable& table) {
  for (const auto& row : table.rows) {
    if (row.size() == table.header.size()) continue;
    return Status::InvalidArgument("report: table '" + table.title + "' has " +
                                   std::to_string(table.header.size()) + " columns, but a row of " +
                                   std::to_string(row.size()));
  }
  return Status::Ok();
}

Status CheckReport(const HtmlReport& report) {
  for (const ReportTable& table : report.tables) PLUMBLINE_RETURN_IF_ERROR(CheckTable(table));
  for (const ReportHistogram& histogram : report.histograms) {
    if (histogram.lower_edges.size() != histogram.counts.size()) {
      return Status::InvalidArgument("report: histogram '" + histogram.title +
                                     "' needs one edge per count");
    }
  }
  for (const ReportStagePlot& plot : report.stage_plots) {
    for (const ReportStagePlot::Series& series : plot.series) {
      if (series.values.size() == plot.stages.size()) continue;
      return Status::InvalidArgument("report: series '" + series.label + "' of '" + plot.title +
                                     "' needs one value per stage");
    }
  }
  for (const ReportMap& map : report.maps) {
    const MapRaster& raster = map.area.raster;
    const bool has_place = std::isfinite(raster.left_m) && std::isfinite(raster.top_m) &&
                           std::isfinite(raster.pixel_m) && raster.pixel_m > 0.0 &&
                           raster.width > 0 && raster.height > 0;
    if (!has_place) {
      return Status::InvalidArgument("report: map '" + map.name + "' has no place in the world");
    }
  }
  return Status::Ok();
}

// A picture as the address of an <img>.
Status ReadPicture(const std::string& path, std::string* address) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return ReadError("open", path, errno);
  std::ostringstream content;
  content << file.rdbuf();
  // An empty file fails as well, but without an error of the system.
  if (!content && errno != 0) return ReadError("read", path, errno);
  const std::string bytes = content.str();
  if (bytes.compare(0, 8, "\x89PNG\r\n\x1a\n") != 0) {
    return Status::InvalidArgument("report: '" + path + "' is no PNG picture");
  }
  *address = "data:image/png;base64," + Base64(bytes);
  return Status::Ok();
}

Status MapsHtml(const std::vector<ReportMap>& maps, std::string* html) {
  for (const ReportMap& map : maps) {
    std::string address;
    PLUMBLINE_RETURN_IF_ERROR(ReadPicture(map.png_path, &address));
    const MapRaster& raster = map.area.raster;
    *html += "<img class=\"layer\" draggable=\"false\"" + Attribute("alt", "Map: " + map.name) +
             Attribute("data-name", map.name) + Attribute("data-left-m", raster.left_m) +
             Attribute("data-top-m", raster.top_m) + Attribute("data-pixel-m", raster.pixel_m) +
             Attribute("data-left-px", map.area.left_px) +
             Attribute("data-top-px", map.area.top_px) + Attribute("data-width-px", raster.width) +
             Attribute("data-height-px", raster.height) + " src=\"" + address + "\">\n";
  }
  return Status::Ok();
}

Status PicturesHtml(const std::vector<ReportPicture>& pictures, std::string* html) {
  for (const ReportPicture& picture : pictures) {
    std::string address;
    PLUMBLINE_RETURN_IF_ERROR(ReadPicture(picture.png_path, &address));
    *html += "<figure class=\"card wide\"><figcaption>" + EscapeHtml(picture.title) +
             "</figcaption><img" + Attribute("alt", picture.title) + " src=\"" + address +
             "\"></figure>\n";
  }
  return Status::Ok();
}

std::string FiguresHtml(const std::vector<ReportFigure>& figures) {
  std::string html;
  for (const ReportFigure& figure : figures) {
    html += Element("div", "class=\"figure\"",
                    Element("dt", "", EscapeHtml(figure.label)) +
                        Element("dd", "class=\"value\"", EscapeHtml(figure.value)) +
                        Element("dd", "class=\"note\"", EscapeHtml(figure.note))) +
            "\n";
  }
  return html;
}

std::string ItemsHtml(const std::vector<std::string>& items) {
  std::string html;
  for (const std::string& item : items) html += Element("li", "", EscapeHtml(item)) + "\n";
  return html;
}

std::string TablesHtml(const std::vector<ReportTable>& tables) {
  std::string html;
  for (const ReportTable& table : tables) {
    std::string head, body;
    for (const std::string& cell : table.header) {
      head += Element("th", "scope=\"col\"", EscapeHtml(cell));
    }
    for (const auto& row : table.rows) {
      std::string cells;
      for (std::size_t i = 0; i < row.size(); ++i) {
        cells += i == 0 ? Element("th", "scope=\"row\"", EscapeHtml(row[i]))
                        : Element("td", "", EscapeHtml(row[i]));
      }
      body += Element("tr", "", cells) + "\n";
    }
    html += Card(
        table.title,
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\"" +
            Attribute("aria-label", table.title) + ">" +
            Element("table", "",
                    Element("thead", "", Element("tr", "", head)) + Element("tbody", "", body)) +
            "</div>",
        table.note, table.header.size() > kMaxNarrowColumns);
  }
  return html;
}

std::string TextsHtml(const std::vector<ReportText>& texts) {
  std::string html;
  for (const ReportText& text : texts) {
    html += Card(text.title,
                 "<div class=\"scroll\" tabindex=\"0\" role=\"region\"" +
                     Attribute("aria-label", text.title) + ">" +
                     Element("pre", "", EscapeHtml(text.text)) + "</div>",
                 "", true);
  }
  return html;
}

// A place that the script fills with chart number `index` of a kind.
std::string ChartCard(const std::string& kind, std::size_t index, const std::string& title,
                      const std::string& note) {
  return Card(title,
              "<div class=\"chart\"" + Attribute("data-" + kind, std::to_string(index)) + "></div>",
              note);
}

std::string ChartsHtml(const HtmlReport& report) {
  std::string html;
  for (std::size_t i = 0; i < report.stage_plots.size(); ++i) {
    html += ChartCard("stage-plot", i, report.stage_plots[i].title, report.stage_plots[i].note);
  }
  for (std::size_t i = 0; i < report.plots.size(); ++i) {
    html += ChartCard("plot", i, report.plots[i].title, report.plots[i].note);
  }
  for (std::size_t i = 0; i < report.histograms.size(); ++i) {
    html += ChartCard("histogram", i, report.histograms[i].title, report.histograms[i].note);
  }
  return html;
}

Json ChartsJson(const HtmlReport& report) {
  Json plots = Json::array(), stage_plots = Json::array(), histograms = Json::array();
  for (const ReportStagePlot& plot : report.stage_plots) {
    Json curves = Json::array();
    for (const ReportStagePlot::Series& series : plot.series) {
      curves.push_back({{"label", series.label}, {"values", series.values}});
    }
    stage_plots.push_back({{"title", plot.title},
                           {"valueLabel", plot.value_label},
                           {"stages", plot.stages},
                           {"curves", curves}});
  }
  for (const ReportPlot& plot : report.plots) {
    Json curves = Json::array();
    for (const ReportCurve& curve : plot.curves) {
      Json points = Json::array();
      for (const ReportCurvePoint& point : curve.points) {
        points.push_back({point.time_s, point.iteration, point.value});
      }
      curves.push_back({{"label", curve.label}, {"points", points}});
    }
    plots.push_back({{"title", plot.title}, {"valueLabel", plot.value_label}, {"curves", curves}});
  }
  for (const ReportHistogram& histogram : report.histograms) {
    histograms.push_back({{"title", histogram.title},
                          {"xLabel", histogram.x_label},
                          {"lowerEdges", histogram.lower_edges},
                          {"counts", histogram.counts}});
  }
  return {{"plots", plots}, {"stagePlots", stage_plots}, {"histograms", histograms}};
}

std::string DurationsHtml(const std::vector<ReportDuration>& durations) {
  double longest_s = 0.0;
  for (const ReportDuration& duration : durations) {
    if (std::isfinite(duration.time_s)) longest_s = std::max(longest_s, duration.time_s);
  }
  std::string html;
  for (const ReportDuration& duration : durations) {
    const bool is_known = std::isfinite(duration.time_s);
    const double share = is_known && longest_s > 0.0 ? duration.time_s / longest_s : 0.0;
    char seconds[40] = "-", style[40];
    if (is_known) std::snprintf(seconds, sizeof(seconds), "%.2f s", duration.time_s);
    std::snprintf(style, sizeof(style), "style=\"width:%.1f%%\"", 100.0 * share);
    html += Element("dt", "", EscapeHtml(duration.phase)) +
            Element("dd", "",
                    Element("span", "class=\"track\"",
                            Element("span", std::string("class=\"bar\" ") + style, "")) +
                        Element("span", "class=\"seconds\"", seconds)) +
            "\n";
  }
  return html;
}

std::string OptionsHtml(const std::vector<ReportOption>& options) {
  std::string html;
  for (const ReportOption& option : options) {
    const bool is_default = option.value == option.default_value;
    const std::string preset =
        is_default ? "" : Element("small", "", "default: " + EscapeHtml(option.default_value));
    html += Element("tr", is_default ? "" : "class=\"changed\"",
                    Element("th", "scope=\"row\"", EscapeHtml(option.name)) +
                        Element("td", "", Element("code", "", EscapeHtml(option.value)) + preset) +
                        Element("td", "", EscapeHtml(option.description))) +
            "\n";
  }
  return html;
}

}  // namespace

Status WriteHtmlReport(const std::string& path, const HtmlReport& report) {
  PLUMBLINE_RETURN_IF_ERROR(CheckReport(report));
  std::map<std::string, std::string> values;
  PLUMBLINE_RETURN_IF_ERROR(MapsHtml(report.maps, &values["maps"]));
  PLUMBLINE_RETURN_IF_ERROR(PicturesHtml(report.pictures, &values["pictures"]));
  values["title"] = EscapeHtml(report.title);
  values["subtitle"] = EscapeHtml(report.subtitle);
  values["alarms"] = ItemsHtml(report.alarms);
  values["warnings"] = ItemsHtml(report.warnings);
  values["all_clear"] = report.alarms.empty() ? EscapeHtml(report.all_clear) : "";
  values["figures"] = FiguresHtml(report.figures);
  values["tables"] = TablesHtml(report.tables) + TextsHtml(report.texts);
  values["charts"] = ChartsHtml(report);
  values["data"] = ScriptJson(ChartsJson(report));
  values["durations"] = DurationsHtml(report.durations);
  values["options"] = OptionsHtml(report.options);
  values["option_count"] = std::to_string(report.options.size());
  values["css"] = kReportCss;
  values["js"] = std::string(kMapViewerJs) + kReportJs;
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  ExpandTemplate(kReportHtml, values, &file.stream());
  return file.Commit();
}

}  // namespace plumbline
