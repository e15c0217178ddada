#ifndef PLUMBLINE_APPS_REPORT_HTML_REPORT_H_
#define PLUMBLINE_APPS_REPORT_HTML_REPORT_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A figure that stands at the top, as "wall thickness", "23.2 mm", "odometry: 50.2 mm".
struct ReportFigure {
  std::string label, value, note;
};

/// A map for the viewer, which lays all of them over each other by their place in the world.
struct ReportMap {
  std::string name;
  std::string png_path;  ///< as WriteMapPicture has written it
  MapArea area;          ///< as it has told
};

struct ReportTable {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< as wide as the header
  std::string note;                            ///< below the table; may be empty
};

/// Lines set in columns of a fixed width, as a program prints them.
struct ReportText {
  std::string title;
  std::string text;
};

struct ReportPicture {
  std::string title;
  std::string png_path;
};

struct ReportDuration {
  std::string phase;
  double time_s = 0.0;
};

struct ReportCurvePoint {
  double time_s = 0.0;
  double iteration = 0.0;
  double value = 0.0;
};

struct ReportCurve {
  std::string label;
  std::vector<ReportCurvePoint> points;  ///< joined in their order
};

/// Curves over time or iterations, as the reader likes. An axis that spans more than two decades
/// is logarithmic; points that are not finite have no place on it.
struct ReportPlot {
  std::string title;
  std::string value_label;
  std::vector<ReportCurve> curves;
  std::string note;
};

/// Values that each of several stages has, on a logarithmic axis: what is not positive has no place
/// on it.
struct ReportStagePlot {
  struct Series {
    std::string label;
    std::vector<double> values;  ///< one per stage
  };
  std::string title;
  std::string value_label;  ///< with unit
  std::vector<std::string> stages;
  std::vector<Series> series;
  std::string note;
};

struct ReportHistogram {
  std::string title;
  std::string x_label;              ///< with unit
  std::vector<double> lower_edges;  ///< of the bins, rising; the last bin has no upper end
  std::vector<std::size_t> counts;  ///< one per edge
  std::string note;
};

struct ReportOption {
  std::string name, value, default_value, description;
};

/// What a report shows. All texts are plain and may hold anything; what is empty is left out.
struct HtmlReport {
  std::string title;
  std::string subtitle;
  std::vector<std::string> alarms;    ///< where and why the result may be wrong
  std::string all_clear;              ///< shown where there is no alarm
  std::vector<std::string> warnings;  ///< about the input and the results
  std::vector<ReportFigure> figures;
  /// In the order in which they came about: the viewer compares the first with the last, until the
  /// reader chooses others.
  std::vector<ReportMap> maps;
  std::vector<ReportTable> tables;
  std::vector<ReportText> texts;
  std::vector<ReportPlot> plots;
  std::vector<ReportStagePlot> stage_plots;
  std::vector<ReportHistogram> histograms;
  std::vector<ReportDuration> durations;
  std::vector<ReportPicture> pictures;
  std::vector<ReportOption> options;
};

/// Writes a report as one HTML file that holds all it shows, pictures included: it needs neither a
/// server nor a network, and forbids itself to use one. The same report gives the same bytes.
///
/// InvalidArgument on a table row that is not as wide as its header, on histograms without an edge
/// per count, on a series without a value per stage, on a map without a pixel size, and on a
/// picture that is no PNG or cannot be read; NotFound if there is no such picture, Unavailable if
/// the report cannot be written.
Status WriteHtmlReport(const std::string& path, const HtmlReport& report);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_HTML_REPORT_H_
