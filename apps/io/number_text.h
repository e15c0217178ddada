#ifndef PLUMBLINE_APPS_IO_NUMBER_TEXT_H_
#define PLUMBLINE_APPS_IO_NUMBER_TEXT_H_

#include <cstddef>
#include <string>

namespace plumbline {

/// "1,739,359".
std::string WithThousands(std::size_t number);

/// A number with a fixed count of digits after the point; a dash if it is not finite.
std::string FixedText(double value, int digits);

/// A number of any size in five significant digits; a dash if it is not finite.
std::string ShortText(double value);

/// A number for files, finite or not: the fewest digits that give the same double when read.
std::string ExactText(double value);

/// The shortest decimal number that stands for this float and no other: 3.45 and not
/// 3.4500000476837158.
double ShortestDecimal(float value);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_NUMBER_TEXT_H_
