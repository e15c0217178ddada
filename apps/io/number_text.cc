#include "plumbline/apps/io/number_text.h"

#include <charconv>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace plumbline {

std::string WithThousands(std::size_t number) {
  std::string text = std::to_string(number);
  for (int i = static_cast<int>(text.size()) - 3; i > 0; i -= 3) text.insert(i, ",");
  return text;
}

std::string FixedText(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string ShortText(double value) {
  if (!std::isfinite(value)) return "-";
  std::ostringstream text;
  text << std::setprecision(5) << value;
  return text.str();
}

std::string ExactText(double value) {
  char text[32];  // Holds the 24 characters of -1.2345678901234567e-308.
  return std::string(text, std::to_chars(text, text + sizeof(text), value).ptr);
}

double ShortestDecimal(float value) {
  char text[32];
  const char* end = std::to_chars(text, text + sizeof(text), value).ptr;
  double decimal = 0.0;
  std::from_chars(text, end, decimal);
  return decimal;
}

}  // namespace plumbline
