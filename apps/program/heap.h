#ifndef PLUMBLINE_APPS_PROGRAM_HEAP_H_
#define PLUMBLINE_APPS_PROGRAM_HEAP_H_

namespace plumbline {

/// Keeps what is freed for what comes next, for all threads alike. Arrays with an entry per return
/// come and go all the time. Were each thread to keep those that it has freed to itself, a run
/// would take a fifth more memory; were they given back to the system, a tenth more time. To be
/// called while there is one thread.
void KeepOneHeap();

/// From now on gives arrays of 8 MB and more back as soon as they are freed, where several
/// processes share the memory of a machine. With arrays of a megabyte as well, long runs take a
/// twentieth less memory, and runs of seconds a tenth more time.
void GiveLargeArraysBack();

/// Gives the system what is freed so far: between stages of which one leaves much that the next
/// does not need.
void GiveFreedMemoryBack();

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_HEAP_H_
