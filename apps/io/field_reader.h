#ifndef PLUMBLINE_APPS_IO_FIELD_READER_H_
#define PLUMBLINE_APPS_IO_FIELD_READER_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace plumbline {

/// The start of a word from a file as a message may show it: on one line, and without codes that a
/// terminal would obey; up to `max_shown` bytes of it.
std::string Printable(std::string_view word, std::size_t max_shown = 40);
/// Text with names of files as a terminal or a page may show it: what is not UTF-8, and the codes
/// that a terminal would obey, as \xNN, except for the characters to keep.
std::string Legible(std::string_view text, std::string_view keep = "");
/// A Printable word in quotation marks.
std::string Quote(std::string_view word);

/// Takes a line of a text format apart into fields separated by blanks. The first failure sticks:
/// later reads return zero or nothing, so that a record is read in one go and checked once.
class FieldReader {
 public:
  /// Keeps a view: the line must outlive the reader.
  explicit FieldReader(std::string_view line) : rest_(line) {}

  std::string_view Word(const char* field);
  /// Any number; "nan" and "inf" are numbers, and so is one too large for a double (infinity).
  double Number(const char* field);
  double FiniteNumber(const char* field);
  double PositiveNumber(const char* field);  ///< finite and > 0
  // Within core/input_limits.h:
  double Coordinate(const char* field);  ///< at most 1e7 m either way
  double Yaw(const char* field);         ///< at most 1e6 rad either way
  double Time(const char* field);        ///< at most 1e12 s either way
  int Count(const char* field);          ///< an integer >= 0
  /// `count` fields, each as Number takes it.
  std::vector<double> Numbers(const char* field, int count);
  /// Fails if anything is left.
  void ExpectEnd();

  /// Marks `field` as unusable unless an earlier failure is on record.
  void Fail(std::string field, const std::string& problem);

  bool ok() const { return error_.empty(); }
  /// The field that failed.
  const std::string& field() const { return field_; }
  /// E.g. "field 'odom_x': 'abc' is not a number"; empty while all is well.
  const std::string& error() const { return error_; }

 private:
  std::string_view NextWord();
  double NumberWithin(double limit, const char* requirement, const char* field);
  double NumberThat(bool (*accept)(double), const char* requirement, const char* field);

  std::string_view rest_;
  std::string field_;
  std::string error_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_FIELD_READER_H_
