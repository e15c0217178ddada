#include "plumbline/apps/bags/compressed_frames.h"

#include <lz4frame.h>
#include <zstd.h>

#include <memory>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

constexpr std::size_t kBlockSize = std::size_t{1} << 17;
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

template <typename Expander>
Status ExpandWith(Expander expander, const std::function<std::string_view()>& next_block,
                  std::size_t max_size, std::string* expanded) {
  if (!expander.ok()) return Status::Unavailable("no memory to decompress with");
  expanded->clear();
  std::vector<char> out(kBlockSize);
  bool at_end = true;
  for (std::string_view block = next_block(); !block.empty(); block = next_block()) {
    // After the last byte of a block, there may be more to come out of what went in.
    for (bool out_is_full = false; !block.empty() || (out_is_full && !at_end);) {
      const Step step = expander.Expand(block, &out);
      if (step.fault != nullptr) {
        return Status::DataLoss(std::string("the compressed data are damaged: ") + step.fault);
      }
      if (step.num_given > max_size - expanded->size()) {
        return Status::DataLoss("the compressed data expand to more than " +
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
  return format == FrameFormat::kLz4 ? ExpandWith(Lz4Expander(), next_block, max_size, expanded)
                                     : ExpandWith(ZstdExpander(), next_block, max_size, expanded);
}

Status ExpandFrames(FrameFormat format, std::string_view frames, std::size_t max_size,
                    std::string* expanded) {
  return ExpandFrames(
      format, [&frames] { return std::exchange(frames, {}); }, max_size, expanded);
}

}  // namespace plumbline
