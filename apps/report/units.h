#ifndef PLUMBLINE_APPS_REPORT_UNITS_H_
#define PLUMBLINE_APPS_REPORT_UNITS_H_

namespace plumbline {

// From the units of the library to those that people read.
inline constexpr double kMmPerM = 1e3, kPercent = 1e2, kBytesPerMb = 1e6;

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_UNITS_H_
