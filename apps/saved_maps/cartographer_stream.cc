#include "plumbline/apps/saved_maps/cartographer_stream.h"

#include <algorithm>
#include <utility>

#include "plumbline/apps/io/compressed_frames.h"
#include "plumbline/apps/io/little_endian.h"

namespace plumbline {
namespace {

// See the class.
constexpr std::uint64_t kMaxMessageBytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kMaxExpansion = 200;
constexpr std::uint64_t kAlwaysExpanded = std::uint64_t{1} << 26;

}  // namespace

CartographerStream::CartographerStream(std::string path, std::string_view content,
                                       const MemoryLimit* memory)
    : path_(std::move(path)),
      file_(content),
      memory_(memory),
      num_left_(std::max<std::uint64_t>(kAlwaysExpanded, kMaxExpansion * content.size())) {
  if (file_.Bytes(kCartographerMagic.size()) != kCartographerMagic) {
    status_ = Error("it does not begin as such files do");
  }
}

bool CartographerStream::Next() {
  message_.clear();
  if (!status_.ok() || file_.rest().empty()) return false;
  ++number_;
  const std::size_t num_bytes_left = file_.rest().size();
  const auto size = file_.Number<std::uint64_t>();
  const std::string_view compressed = file_.Bytes(size);
  if (!file_.ok()) {
    status_ = num_bytes_left < sizeof(size)
                  ? Error("the file ends within its length")
                  : Error("its length is said to be " + std::to_string(size) +
                          " bytes, but the file has " +
                          std::to_string(num_bytes_left - sizeof(size)) + " left");
    return false;
  }
  const std::uint64_t max_bytes = std::min(kMaxMessageBytes, num_left_);
  const std::uint64_t memory_left = memory_ != nullptr ? memory_->Left() : max_bytes;
  const Status expanded =
      ExpandFrames(FrameFormat::kGzip, compressed, std::min(max_bytes, memory_left), &message_);
  if (!expanded.ok()) {
    const bool lacks_memory =
        memory_left < max_bytes && expanded.code() == StatusCode::kInvalidArgument;
    status_ = lacks_memory
                  ? Status::InvalidArgument(path_ + ": message " + std::to_string(number_) + ": " +
                                            memory_->Fault())
                  : Error(expanded.message());
    return false;
  }
  num_left_ -= message_.size();
  return true;
}

std::string CartographerStream::Place() const {
  return path_ + ": cannot be read as a state of Cartographer: " +
         (number_ == 0 ? "" : "message " + std::to_string(number_) + ": ");
}

Status CartographerStream::Error(const std::string& problem) const {
  return Status::DataLoss(Place() + problem);
}

Status CartographerStream::Unsupported(const std::string& problem) const {
  return Status::InvalidArgument(Place() + problem);
}

std::string CartographerMessage(std::string_view message) {
  const std::string gzip = GzipFrame(message);
  std::string bytes(sizeof(std::uint64_t), '\0');
  StoreLittleEndian(std::uint64_t{gzip.size()}, reinterpret_cast<unsigned char*>(bytes.data()));
  return bytes + gzip;
}

}  // namespace plumbline
