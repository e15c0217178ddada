#ifndef PLUMBLINE_CORE_FLOAT_ENVIRONMENT_H_
#define PLUMBLINE_CORE_FLOAT_ENVIRONMENT_H_

#include <cfenv>

#if defined(__SSE__) || defined(_M_X64)
#include <xmmintrin.h>
#define PLUMBLINE_HAS_MXCSR
#endif

namespace plumbline {

/// While it lives, the calling thread computes as the C++ standard has it at the start of a
/// program: rounds to nearest, keeps subnormal numbers, traps nothing. Then the thread's
/// environment is what it was before, its exception flags included.
///
/// A host may have chosen otherwise for its own work (audio and graphics code flush subnormals to
/// zero), and threads inherit from those that start them: without this the same input would give
/// other bytes.
class DefaultFloatEnvironment {
 public:
  DefaultFloatEnvironment() {
    std::fegetenv(&host_);
    std::fesetenv(FE_DFL_ENV);
#ifdef PLUMBLINE_HAS_MXCSR
    // Not every C library takes flush-to-zero (bit 15) and denormals-are-zero (bit 6) for a part of
    // the environment that it resets.
    host_mxcsr_ = _mm_getcsr();
    _mm_setcsr(host_mxcsr_ & ~kFlushBits);
#endif
  }

  ~DefaultFloatEnvironment() {
#ifdef PLUMBLINE_HAS_MXCSR
    _mm_setcsr(host_mxcsr_);
#endif
    std::fesetenv(&host_);
  }

  DefaultFloatEnvironment(const DefaultFloatEnvironment&) = delete;
  DefaultFloatEnvironment& operator=(const DefaultFloatEnvironment&) = delete;

 private:
#ifdef PLUMBLINE_HAS_MXCSR
  static constexpr unsigned kFlushBits = 0x8040;
  unsigned host_mxcsr_ = 0;
#endif
  std::fenv_t host_;
};

}  // namespace plumbline

#undef PLUMBLINE_HAS_MXCSR

#endif  // PLUMBLINE_CORE_FLOAT_ENVIRONMENT_H_
