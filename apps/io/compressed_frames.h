#ifndef PLUMBLINE_APPS_IO_COMPRESSED_FRAMES_H_
#define PLUMBLINE_APPS_IO_COMPRESSED_FRAMES_H_

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "plumbline/core/status.h"

namespace plumbline {

enum class FrameFormat { kLz4, kZstd, kGzip, kBzip2 };

/// Whether the bytes begin as a frame of zstd does.
bool StartsWithZstdFrame(std::string_view bytes);

/// Expands the frames of LZ4, zstd, gzip or bzip2 that the blocks hold together, into *expanded,
/// whose memory is used again. `next_block` gives one block after the other, and an empty one at
/// the end. With a reason but no path, DataLoss if they are damaged or cut off, InvalidArgument if
/// they expand to more than `max_size` bytes. Memory grows with the expanded bytes, not with
/// the size that a frame states.
Status ExpandFrames(FrameFormat format, const std::function<std::string_view()>& next_block,
                    std::size_t max_size, std::string* expanded);

/// The same of frames that are in memory.
Status ExpandFrames(FrameFormat format, std::string_view frames, std::size_t max_size,
                    std::string* expanded);

/// The bytes as a frame of gzip, at most 1 GiB of them. The same bytes give the same frame.
std::string GzipFrame(std::string_view bytes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_COMPRESSED_FRAMES_H_
