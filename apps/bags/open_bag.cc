#include "plumbline/apps/bags/open_bag.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "plumbline/apps/bags/bag_metadata.h"
#include "plumbline/apps/bags/mcap_bag.h"
#include "plumbline/apps/bags/ros1_bag.h"
#include "plumbline/apps/bags/sqlite_bag.h"
#include "plumbline/apps/io/compressed_frames.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"

namespace plumbline {
namespace {

constexpr std::size_t kMaxExpandedBytes = std::size_t{1} << 30;

enum class Format { kUnknown, kFolder, kMetadata, kRos1, kSqlite, kMcap, kZstd };

bool StartsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

constexpr std::size_t kStartBytes = 1024;

// By the first bytes of a file.
Format FormatOf(std::string_view start) {
  if (StartsWith(start, kRos1Magic)) return Format::kRos1;
  if (StartsWith(start, kSqliteMagic)) return Format::kSqlite;
  // Of any version.
  if (StartsWith(start, kMcapMagic.substr(0, 5))) return Format::kMcap;
  if (StartsWithZstdFrame(start)) return Format::kZstd;
  // Behind comments, if there are any.
  if (start.find(kBagMetadataKey) != start.npos) return Format::kMetadata;
  return Format::kUnknown;
}

Format FormatOfFile(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return Format::kFolder;
  // A pipe would be read for ever.
  if (!std::filesystem::is_regular_file(path, ignored)) return Format::kUnknown;
  std::string start(kStartBytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return FormatOf(start);
}

// What there is in a folder, for people.
std::string FilesIn(const std::string& folder) {
  constexpr std::size_t kMaxShown = 10;
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxShown); ++i) {
    text += (i == 0 ? "" : ", ") + Printable(names[i]);
  }
  return (names.empty() ? "nothing" : text) + (names.size() > kMaxShown ? ", ..." : "");
}

// The description of the bag in a folder.
Status FindMetadata(const std::string& folder, std::string* path) {
  *path = (std::filesystem::path(folder) / kBagMetadataName).string();
  std::error_code ignored;
  if (std::filesystem::exists(*path, ignored)) return Status::Ok();
  return Status::InvalidArgument(folder + ": a folder, but no bag of ROS 2: there is no " +
                                 std::string(kBagMetadataName) + " in it (ros2 bag reindex makes " +
                                 "one), but " + FilesIn(folder));
}

// What a file that is compressed as a whole holds.
Status ExpandFile(const std::string& path, std::size_t max_bytes, std::string* expanded) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return ReadError("open", path, errno);
  std::string block(std::size_t{1} << 18, '\0');
  const auto next_block = [&]() -> std::string_view {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    return std::string_view(block).substr(0, static_cast<std::size_t>(file.gcount()));
  };
  const Status status = ExpandFrames(FrameFormat::kZstd, next_block, max_bytes, expanded);
  if (status.ok()) return Status::Ok();
  return Status::DataLoss(path + ": " + status.message() +
                          " (zstd -d makes a file of any size that can be read in its place)");
}

Status OpenFile(const std::string& path, std::size_t max_bytes,
                std::unique_ptr<BagContainer>* bag) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  std::optional<std::string> expanded;
  Format format = FormatOfFile(path);
  if (format == Format::kZstd) {
    PLUMBLINE_RETURN_IF_ERROR(ExpandFile(path, max_bytes, &expanded.emplace()));
    format = FormatOf(std::string_view(*expanded).substr(0, kStartBytes));
  }
  switch (format) {
    case Format::kRos1:
      *bag = MakeRos1Bag(path, std::move(expanded));
      return Status::Ok();
    case Format::kSqlite:
      *bag = MakeSqliteBag(path, std::move(expanded));
      return Status::Ok();
    case Format::kMcap:
      *bag = MakeMcapBag(path, std::move(expanded));
      return Status::Ok();
    default:
      break;
  }
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return ReadError("open", path, ENOENT);
  constexpr char kFormats[] = "neither a bag of ROS 1, nor a database of SQLite, nor an MCAP file";
  return Status::InvalidArgument(
      path + (expanded ? ": what zstd has compressed there is " + std::string(kFormats) +
                             "; zstd -d makes a file of it that may be read"
                       : std::string(": ") + kFormats));
}

// The files of a recording, one after the other.
class SplitBag : public BagContainer {
 public:
  SplitBag(std::vector<std::string> files, std::size_t max_bytes)
      : files_(std::move(files)), max_bytes_(max_bytes) {}

  Status ReadMessages(const IsWanted& is_wanted, const TakeMessage& take) override {
    for (const std::string& file : files_) {
      // One at a time: what is compressed takes memory.
      std::unique_ptr<BagContainer> bag;
      PLUMBLINE_RETURN_IF_ERROR(OpenFile(file, max_bytes_, &bag));
      PLUMBLINE_RETURN_IF_ERROR(bag->ReadMessages(is_wanted, take));
    }
    return Status::Ok();
  }

 private:
  const std::vector<std::string> files_;
  const std::size_t max_bytes_;
};

}  // namespace

bool IsBag(const std::string& path) { return FormatOfFile(path) != Format::kUnknown; }

Status OpenBag(const std::string& path, std::unique_ptr<BagContainer>* bag, double max_bytes) {
  const Format format = FormatOfFile(path);
  std::size_t max_expanded = kMaxExpandedBytes;
  if (max_bytes > 0.0 && max_bytes < static_cast<double>(max_expanded)) {
    max_expanded = static_cast<std::size_t>(max_bytes);
  }
  if (format != Format::kFolder && format != Format::kMetadata) {
    return OpenFile(path, max_expanded, bag);
  }
  std::vector<std::string> files;
  PLUMBLINE_RETURN_IF_ERROR(FilesOfLog(path, &files));
  files.erase(files.begin());
  *bag = std::make_unique<SplitBag>(std::move(files), max_expanded);
  return Status::Ok();
}

Status FilesOfLog(const std::string& path, std::vector<std::string>* files) {
  const Format format = FormatOfFile(path);
  std::vector<std::string> result;
  std::string first = path;
  if (format == Format::kFolder) PLUMBLINE_RETURN_IF_ERROR(FindMetadata(path, &first));
  if (format == Format::kFolder || format == Format::kMetadata) {
    PLUMBLINE_RETURN_IF_ERROR(ReadBagMetadata(first, &result));
  }
  result.insert(result.begin(), first);
  *files = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
