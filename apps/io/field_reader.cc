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

std::string EscapedByte(char c) {
  constexpr char kHexDigits[] = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  return {'\\', 'x', kHexDigits[byte / 16], kHexDigits[byte % 16]};
}

// Of the character of UTF-8 that a text begins with [bytes]; 0 if there is none, or a control
// character, U+0080 to U+009F included.
std::size_t LengthOfCharacter(std::string_view text) {
  const auto byte = [&](std::size_t i) -> int {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
  };
  const int lead = byte(0);
  if (lead < 0x80) return lead >= ' ' && lead <= '~' ? 1 : 0;
  if (lead < 0xc2 || lead > 0xf4) return 0;
  const std::size_t length = lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
  // The second byte tells forms that are too long, surrogates, and what is beyond Unicode.
  const int first = lead == 0xc2 || lead == 0xe0 ? 0xa0 : lead == 0xf0 ? 0x90 : 0x80;
  const int last = lead == 0xed ? 0x9f : lead == 0xf4 ? 0x8f : 0xbf;
  if (byte(1) < first || byte(1) > last) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if (byte(i) < 0x80 || byte(i) > 0xbf) return 0;
  }
  return length;
}

}  // namespace

std::string Printable(std::string_view word, std::size_t max_shown) {
  std::string shown;
  for (const char c : word.substr(0, max_shown)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= ' ' && byte <= '~') {
      shown += c;
    } else {
      shown += EscapedByte(c);
    }
  }
  return shown + (word.size() > max_shown ? "..." : "");
}

std::string Legible(std::string_view text, std::string_view keep) {
  std::string shown;
  while (!text.empty()) {
    std::size_t length = LengthOfCharacter(text);
    if (length > 0 || keep.find(text.front()) != keep.npos) {
      length = std::max<std::size_t>(length, 1);
      shown += text.substr(0, length);
    } else {
      length = 1;
      shown += EscapedByte(text.front());
    }
    text.remove_prefix(length);
  }
  return shown;
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
