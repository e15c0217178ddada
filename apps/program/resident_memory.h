#ifndef PLUMBLINE_APPS_PROGRAM_RESIDENT_MEMORY_H_
#define PLUMBLINE_APPS_PROGRAM_RESIDENT_MEMORY_H_

namespace plumbline {

/// What this process holds in memory [bytes].
struct Resident {
  double total = 0.0;
  double unshared = 0.0;  ///< of that, what is in no file
};

/// Asks the system for it, again and again. Takes no memory for that.
class ResidentMemory {
 public:
  ResidentMemory();
  ~ResidentMemory();
  ResidentMemory(const ResidentMemory&) = delete;
  ResidentMemory& operator=(const ResidentMemory&) = delete;

  /// 0 where the system does not say.
  Resident Read() const;

 private:
  int file_;           // a descriptor; negative if there is none
  double page_bytes_;  // of a page
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PROGRAM_RESIDENT_MEMORY_H_
