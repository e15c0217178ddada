#ifndef PLUMBLINE_APPS_REPORT_FORMAT_H_
#define PLUMBLINE_APPS_REPORT_FORMAT_H_

#include <cstdio>
#include <string>

namespace plumbline {

/// As std::snprintf gives it, up to 255 characters.
template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_FORMAT_H_
