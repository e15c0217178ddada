#include "plumbline/apps/io/field_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "plumbline/core/input_limits.h"

namespace plumbline {
namespace {

constexpr char kMissing[] = "is missing, the line ends before it";

bool ParseNumber(std::string_view word, double* value) {
  const char* end = word.data() + word.size();
  const std::from_chars_result result = std::from_chars(word.data(), end, *value);
  if (result.ec == std::errc::invalid_argument || result.ptr != end) return false;
  if (result.ec == std::errc::result_out_of_range) {
    const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
    *value = tiny ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return true;
}

}  // namespace

std::string Printable(std::string_view word, std::size_t max_shown) {
  constexpr char kHexDigits[] = "0123456789abcdef";
  std::string shown;
  for (const char c : word.substr(0, max_shown)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= ' ' && byte <= '~') {
      shown += c;
    } else {
      shown += {'\\', 'x', kHexDigits[byte / 16], kHexDigits[byte % 16]};
    }
  }
  return shown + (word.size() > max_shown ? "..." : "");
}

std::string Quote(std::string_view word) { return "'" + Printable(word) + "'"; }

std::string_view FieldReader::NextWord() {
  std::size_t begin = 0;
  while (begin < rest_.size() && (rest_[begin] == ' ' || rest_[begin] == '\t')) ++begin;
  std::size_t end = begin;
  while (end < rest_.size() && rest_[end] != ' ' && rest_[end] != '\t') ++end;
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return word;
}

std::string_view FieldReader::Word(const char* field) {
  if (!ok()) return {};
  const std::string_view word = NextWord();
  if (word.empty()) Fail(field, kMissing);
  return word;
}

double FieldReader::NumberThat(bool (*accept)(double), const char* requirement, const char* field) {
  const std::string_view word = Word(field);
  double value = 0.0;
  if (ok() && !ParseNumber(word, &value)) Fail(field, Quote(word) + " is not a number");
  if (ok() && !accept(value)) Fail(field, Quote(word) + " is not " + requirement);
  return ok() ? value : 0.0;
}

double FieldReader::Number(const char* field) {
  return NumberThat([](double) { return true; }, "a number", field);
}

double FieldReader::FiniteNumber(const char* field) {
  return NumberThat([](double value) { return std::isfinite(value); }, "a finite number", field);
}

double FieldReader::PositiveNumber(const char* field) {
  return NumberThat([](double value) { return std::isfinite(value) && value > 0.0; },
                    "a positive number", field);
}

double FieldReader::NumberWithin(double limit, const char* requirement, const char* field) {
  FieldReader quoted = *this;
  const double value = FiniteNumber(field);
  if (std::abs(value) > limit) Fail(field, Quote(quoted.NextWord()) + " is not " + requirement);
  return ok() ? value : 0.0;
}

double FieldReader::Coordinate(const char* field) {
  return NumberWithin(kMaxCoordinateM, "within 1e7 m of the origin", field);
}

double FieldReader::Yaw(const char* field) {
  return NumberWithin(kMaxYawRad, "an angle within 1e6 rad", field);
}

double FieldReader::Time(const char* field) {
  return NumberWithin(kMaxTimeS, "a time within 1e12 s", field);
}

int FieldReader::Count(const char* field) {
  const std::string_view word = Word(field);
  if (!ok()) return 0;
  int value = 0;
  const char* end = word.data() + word.size();
  const std::from_chars_result result = std::from_chars(word.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || value < 0) {
    Fail(field, Quote(word) + " is not a count");
    return 0;
  }
  return value;
}

std::vector<double> FieldReader::Numbers(const char* field, int count) {
  std::vector<double> values;
  if (!ok()) return values;
  // A count that is garbage must not allocate more than the line can hold.
  values.reserve(std::min<std::size_t>(count, rest_.size() / 2));
  for (int i = 0; i < count; ++i) {
    const std::string_view word = NextWord();
    double value = 0.0;
    if (!ParseNumber(word, &value)) {
      Fail(std::string(field) + "[" + std::to_string(i) + "]",
           word.empty() ? kMissing : Quote(word) + " is not a number");
      return {};
    }
    values.push_back(value);
  }
  return values;
}

void FieldReader::ExpectEnd() {
  const std::string_view word = NextWord();
  if (!word.empty()) Fail("end of line", Quote(word) + " is one field too many");
}

void FieldReader::Fail(std::string field, const std::string& problem) {
  if (!ok()) return;
  field_ = std::move(field);
  error_ = "field '" + field_ + "': " + problem;
}

}  // namespace plumbline
