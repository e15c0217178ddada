#ifndef PLUMBLINE_APPS_REPORT_REPORT_ASSETS_H_
#define PLUMBLINE_APPS_REPORT_REPORT_ASSETS_H_

namespace plumbline {

// The files of this folder, which cmake/EmbedText.cmake turns into text of the library.
extern const char* const kReportHtml;   ///< report.html.in
extern const char* const kReportCss;    ///< report.css
extern const char* const kReportJs;     ///< report.js: options and charts
extern const char* const kMapViewerJs;  ///< map_viewer.js

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_REPORT_ASSETS_H_
