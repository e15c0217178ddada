#include "plumbline/apps/program/resident_memory.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

namespace plumbline {

ResidentMemory::ResidentMemory()
    : file_(open("/proc/self/statm", O_RDONLY | O_CLOEXEC)),
      page_bytes_(static_cast<double>(sysconf(_SC_PAGESIZE))) {}

ResidentMemory::~ResidentMemory() {
  if (file_ >= 0) close(file_);
}

Resident ResidentMemory::Read() const {
  std::array<char, 128> text{};
  if (file_ < 0 || pread(file_, text.data(), text.size() - 1, 0) <= 0) return {};
  char* end = text.data();
  std::strtoull(end, &end, 10);  // of its addresses
  const auto resident = static_cast<double>(std::strtoull(end, &end, 10));
  const auto in_files = static_cast<double>(std::strtoull(end, &end, 10));
  return {page_bytes_ * resident, page_bytes_ * (resident - in_files)};
}

}  // namespace plumbline
