#ifndef PLUMBLINE_TEST_CORE_HOST_FLOAT_ENVIRONMENT_H_
#define PLUMBLINE_TEST_CORE_HOST_FLOAT_ENVIRONMENT_H_

#include <cfenv>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace plumbline {

/// What a host may have set for its own arithmetic.
enum class HostFloatMode { kRoundUp, kRoundTowardZero, kFlushSubnormals };
constexpr HostFloatMode kHostFloatModes[] = {
    HostFloatMode::kRoundUp, HostFloatMode::kRoundTowardZero, HostFloatMode::kFlushSubnormals};

/// Sets it for the calling thread, and back on the way out.
class HostFloatEnvironment {
 public:
#if defined(__SSE__)
  static constexpr bool kCanFlush = true;
#else
  static constexpr bool kCanFlush = false;
#endif

  explicit HostFloatEnvironment(HostFloatMode mode) {
    std::fegetenv(&before_);
    if (mode == HostFloatMode::kRoundUp) std::fesetround(FE_UPWARD);
    if (mode == HostFloatMode::kRoundTowardZero) std::fesetround(FE_TOWARDZERO);
#if defined(__SSE__)
    mxcsr_before_ = _mm_getcsr();
    constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
    if (mode == HostFloatMode::kFlushSubnormals) {
      _mm_setcsr(mxcsr_before_ | kFlushToZero | kDenormalsAreZero);
    }
#endif
  }
  ~HostFloatEnvironment() {
#if defined(__SSE__)
    _mm_setcsr(mxcsr_before_);
#endif
    std::fesetenv(&before_);
  }
  HostFloatEnvironment(const HostFloatEnvironment&) = delete;
  HostFloatEnvironment& operator=(const HostFloatEnvironment&) = delete;

 private:
  std::fenv_t before_;
#if defined(__SSE__)
  unsigned mxcsr_before_ = 0;
#endif
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_CORE_HOST_FLOAT_ENVIRONMENT_H_
