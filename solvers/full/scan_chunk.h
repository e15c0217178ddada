#ifndef PLUMBLINE_SOLVERS_FULL_SCAN_CHUNK_H_
#define PLUMBLINE_SOLVERS_FULL_SCAN_CHUNK_H_

#include <cstddef>

namespace plumbline {

/// Scans whose terms one thread evaluates at a time. Sums are formed chunk by chunk, so that this
/// number, unlike that of the threads, has a part in their last digits.
inline constexpr std::size_t kScansPerChunk = 16;

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_SCAN_CHUNK_H_
