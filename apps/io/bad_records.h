#ifndef PLUMBLINE_APPS_IO_BAD_RECORDS_H_
#define PLUMBLINE_APPS_IO_BAD_RECORDS_H_

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "plumbline/core/options_check.h"

namespace plumbline {

/// Number of unreadable records that a recording may have: the larger of two limits.
struct BadRecordLimits {
  /// Share of the records. A gap of 1 % costs a map little; more points to a wrong format.
  double max_share = 0.01;
  /// Number of records, so that a short log survives a torn end or a burst of noise.
  int max_records = 10;

  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_OPTION_WITHIN(max_share, 0.0, 1.0);
    PLUMBLINE_CHECK_OPTION(max_records, >=, 0);
    return true;
  }

  std::size_t Of(std::size_t num_records) const {
    return static_cast<std::size_t>(
        std::max<double>(max_records, max_share * static_cast<double>(num_records)));
  }
};

/// Records that are skipped, counted by kind of fault.
class BadRecords {
 public:
  /// example: names the record and its fault; the first 10 are kept.
  void Add(const std::string& kind, const std::string& example) {
    constexpr std::size_t kMaxExamples = 10;
    ++num_;
    ++counts_[kind];
    if (examples_.size() < kMaxExamples) examples_.push_back(example);
  }

  std::size_t num() const { return num_; }
  const std::vector<std::string>& examples() const { return examples_; }

  /// "3 of 500 KIND are skipped: field 'ranges' is empty (2), ...; the first one: EXAMPLE".
  std::string Text(std::size_t num_records, const std::string& records) const {
    std::string kinds;
    for (const auto& [kind, count] : counts_) {
      kinds += (kinds.empty() ? "" : ", ") + kind + " (" + std::to_string(count) + ")";
    }
    return std::to_string(num_) + " of " + std::to_string(num_records) + " " + records +
           " cannot be used: " + kinds + "; the first one: " + examples_.front();
  }

 private:
  std::size_t num_ = 0;
  std::map<std::string, std::size_t> counts_;
  std::vector<std::string> examples_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_BAD_RECORDS_H_
