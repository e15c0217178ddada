#include "plumbline/apps/io/compressed_frames.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

constexpr std::size_t kFrameBlockSize = std::size_t{1} << 17;
constexpr std::size_t kLargeSize = std::size_t{1} << 26;

// One call of a library: what it took and gave, and whether a frame has ended with it.
struct Step {
  std::size_t num_taken = 0;
  std::size_t num_given = 0;
  bool at_end = false;
  const char* fault = nullptr;
};

class Lz4Expander {
 public:
  Lz4Expander() {
    LZ4F_dctx* context = nullptr;
    if (!LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) {
      context_.reset(context);
    }
  }

  bool ok() const { return context_ != nullptr; }

  Step Expand(std::string_view in, std::vector<char>* out) {
    Step step{in.size(), out->size(), false, nullptr};
    const std::size_t hint = LZ4F_decompress(context_.get(), out->data(), &step.num_given,
                                             in.data(), &step.num_taken, nullptr);
    if (LZ4F_isError(hint)) step.fault = LZ4F_getErrorName(hint);
    step.at_end = hint == 0;
    return step;
  }

 private:
  struct Free {
    void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
  };
  std::unique_ptr<LZ4F_dctx, Free> context_;
};

class ZstdExpander {
 public:
  bool ok() const { return context_ != nullptr; }

  Step Expand(std::string_view in, std::vector<char>* out) {
    ZSTD_inBuffer input{in.data(), in.size(), 0};
    ZSTD_outBuffer output{out->data(), out->size(), 0};
    const std::size_t hint = ZSTD_decompressStream(context_.get(), &output, &input);
    return {input.pos, output.pos, hint == 0,
            ZSTD_isError(hint) != 0 ? ZSTD_getErrorName(hint) : nullptr};
  }

 private:
  struct Free {
    void operator()(ZSTD_DStream* context) const { ZSTD_freeDStream(context); }
  };
  std::unique_ptr<ZSTD_DStream, Free> context_{ZSTD_createDStream()};
};

// The widest window of zlib, in frames of gzip and no others.
constexpr int kGzipWindow = MAX_WBITS + 16;

// zlib does not write there.
Bytef* InputOf(std::string_view bytes) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
}

class GzipExpander {
 public:
  GzipExpander() {
    auto stream = std::make_unique<z_stream>();
    if (inflateInit2(stream.get(), kGzipWindow) == Z_OK) stream_.reset(stream.release());
  }

  bool ok() const { return stream_ != nullptr; }

  Step Expand(std::string_view in, std::vector<char>* out) {
    if (at_end_) inflateReset(stream_.get());
    constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;  // of the sizes of zlib
    const auto num_in = static_cast<uInt>(std::min(in.size(), kMostAtOnce));
    stream_->next_in = InputOf(in);
    stream_->avail_in = num_in;
    stream_->next_out = reinterpret_cast<Bytef*>(out->data());
    stream_->avail_out = static_cast<uInt>(out->size());
    const int code = inflate(stream_.get(), Z_NO_FLUSH);
    at_end_ = code == Z_STREAM_END;
    Step step{num_in - stream_->avail_in, out->size() - stream_->avail_out, at_end_, nullptr};
    // With Z_BUF_ERROR there was nothing to do.
    if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR) {
      step.fault = stream_->msg != nullptr ? stream_->msg : zError(code);
    }
    return step;
  }

 private:
  struct Free {
    void operator()(z_stream* stream) const {
      inflateEnd(stream);
      delete stream;
    }
  };
  std::unique_ptr<z_stream, Free> stream_;
  bool at_end_ = false;
};

class Bzip2Expander {
 public:
  Bzip2Expander() { Restart(); }

  bool ok() const { return stream_ != nullptr; }

  Step Expand(std::string_view in, std::vector<char>* out) {
    if (at_end_) Restart();
    if (!ok()) return {0, 0, false, "no memory to decompress with"};
    constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;  // of the sizes of libbz2
    const auto num_in = static_cast<unsigned>(std::min(in.size(), kMostAtOnce));
    stream_->next_in = const_cast<char*>(in.data());  // which libbz2 does not write
    stream_->avail_in = num_in;
    stream_->next_out = out->data();
    stream_->avail_out = static_cast<unsigned>(out->size());
    const int code = BZ2_bzDecompress(stream_.get());
    at_end_ = code == BZ_STREAM_END;
    Step step{num_in - stream_->avail_in, out->size() - stream_->avail_out, at_end_, nullptr};
    if (code != BZ_OK && code != BZ_STREAM_END) {
      step.fault = code == BZ_MEM_ERROR ? "no memory to decompress with" : "no valid bzip2 data";
    }
    return step;
  }

 private:
  struct Free {
    void operator()(bz_stream* stream) const {
      BZ2_bzDecompressEnd(stream);
      delete stream;
    }
  };

  // libbz2 cannot begin a second stream with the state of the first.
  void Restart() {
    auto stream = std::make_unique<bz_stream>();
    *stream = {};
    stream_.reset();
    if (BZ2_bzDecompressInit(stream.get(), 0, 0) == BZ_OK) stream_.reset(stream.release());
    at_end_ = false;
  }

  std::unique_ptr<bz_stream, Free> stream_;
  bool at_end_ = false;
};

template <typename Expander>
Status ExpandWith(Expander expander, const std::function<std::string_view()>& next_block,
                  std::size_t max_size, std::string* expanded) {
  if (!expander.ok()) return Status::Unavailable("no memory to decompress with");
  expanded->clear();
  std::vector<char> out(kFrameBlockSize);
  bool at_end = true;
  for (std::string_view block = next_block(); !block.empty(); block = next_block()) {
    // After the last byte of a block, there may be more to come out of what went in.
    for (bool out_is_full = false; !block.empty() || (out_is_full && !at_end);) {
      const Step step = expander.Expand(block, &out);
      if (step.fault != nullptr) {
        return Status::DataLoss(std::string("the compressed data are damaged: ") + step.fault);
      }
      if (step.num_given > max_size - expanded->size()) {
        return Status::InvalidArgument("the compressed data expand to more than " +
                                       std::to_string(max_size) + " bytes");
      }
      // Growing by doubling would take twice the memory; what is reserved is not used before.
      if (expanded->size() > kLargeSize) expanded->reserve(max_size);
      expanded->append(out.data(), step.num_given);
      block.remove_prefix(step.num_taken);
      at_end = step.at_end;
      out_is_full = step.num_given == out.size();
    }
  }
  return at_end ? Status::Ok() : Status::DataLoss("the compressed data are cut off");
}

}  // namespace

bool StartsWithZstdFrame(std::string_view bytes) {
  constexpr std::string_view kMagic = "\x28\xb5\x2f\xfd";
  return bytes.substr(0, kMagic.size()) == kMagic;
}

Status ExpandFrames(FrameFormat format, const std::function<std::string_view()>& next_block,
                    std::size_t max_size, std::string* expanded) {
  switch (format) {
    case FrameFormat::kLz4:
      return ExpandWith(Lz4Expander(), next_block, max_size, expanded);
    case FrameFormat::kZstd:
      return ExpandWith(ZstdExpander(), next_block, max_size, expanded);
    case FrameFormat::kBzip2:
      return ExpandWith(Bzip2Expander(), next_block, max_size, expanded);
    case FrameFormat::kGzip:
      break;
  }
  return ExpandWith(GzipExpander(), next_block, max_size, expanded);
}

Status ExpandFrames(FrameFormat format, std::string_view frames, std::size_t max_size,
                    std::string* expanded) {
  return ExpandFrames(
      format, [&frames] { return std::exchange(frames, {}); }, max_size, expanded);
}

std::string GzipFrame(std::string_view bytes) {
  z_stream stream{};
  constexpr int kMemoryLevel = 8;  // zlib's default
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzipWindow, kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  std::string frame(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = InputOf(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(frame.data());
  stream.avail_out = static_cast<uInt>(frame.size());
  deflate(&stream, Z_FINISH);
  frame.resize(stream.total_out);
  deflateEnd(&stream);
  return frame;
}

}  // namespace plumbline
