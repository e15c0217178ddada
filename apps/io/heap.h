#ifndef PLUMBLINE_APPS_IO_HEAP_H_
#define PLUMBLINE_APPS_IO_HEAP_H_

#include <cstddef>

namespace plumbline {

/// Keeps what is freed for what comes next, for all threads alike. Arrays with an entry per return
/// come and go all the time. Were each thread to keep those that it has freed to itself, a run
/// would take a fifth more memory; were they given back to the system, a tenth more time. The first
/// gigabyte has large pages where the system has some, until it is given back: runs of seconds take
/// 1 to 10 % less time, two processes 6 to 19 %. To be called while there is one thread.
void KeepOneHeap();

/// Returns of a run, in all its processes, from which on memory is worth time. To take memory anew
/// from the system, after it was given back, takes runs of seconds a tenth to a quarter more time,
/// and they have some hundred megabytes.
constexpr std::size_t kManyReturns = 16000000;

/// From now on gives arrays of 8 MB and more back as soon as they are freed: where memory is
/// limited, or several processes with many returns share that of a machine. With arrays of a
/// megabyte as well, long runs take a twentieth less memory.
void GiveLargeArraysBack();

/// Gives the system what is freed so far: between stages of which one leaves much that the next
/// does not need. num_returns: of the run; fewer than many keep it, unless GiveLargeArraysBack was
/// called.
void GiveFreedMemoryBack(std::size_t num_returns = kManyReturns);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_HEAP_H_
