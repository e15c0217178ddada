#ifndef PLUMBLINE_TEST_APPS_BAGS_BAG_FILE_TESTING_H_
#define PLUMBLINE_TEST_APPS_BAGS_BAG_FILE_TESTING_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "plumbline/apps/bags/bag_reader.h"

namespace plumbline {

/// A base of fixtures that read one bag.
class BagFile {
 protected:
  explicit BagFile(std::string path) : path_(std::move(path)) {}

  RosRecording Read(const BagReadOptions& options = BagReadOptions()) const {
    RosRecording recording;
    const Status status = ReadBag(path_, options, &recording);
    EXPECT_TRUE(status.ok()) << status.message();
    return recording;
  }
  /// Expects an error that names the file and changes nothing.
  Status Fails(const BagReadOptions& options = BagReadOptions()) const {
    RosRecording recording;
    recording.path = "as before";
    const Status status = ReadBag(path_, options, &recording);
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(recording.path, "as before");
    EXPECT_THAT(status.message(), testing::HasSubstr(path_));
    return status;
  }

  const std::string path_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_BAGS_BAG_FILE_TESTING_H_
