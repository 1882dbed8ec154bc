// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/memory_limit.hpp"

#include <sys/resource.h>

namespace scanmill {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

MemoryLimit::MemoryLimit(u64) {}
MemoryLimit::~MemoryLimit() = default;

#else

MemoryLimit::MemoryLimit(u64 bytes) {
    rlimit limit{};
    if (bytes == 0 || ::getrlimit(RLIMIT_DATA, &limit) != 0 || bytes >= limit.rlim_cur) return;
    before_ = limit.rlim_cur;
    limit.rlim_cur = bytes;
    is_set_ = ::setrlimit(RLIMIT_DATA, &limit) == 0;
}

MemoryLimit::~MemoryLimit() {
    if (!is_set_) return;
    rlimit limit{};
    ::getrlimit(RLIMIT_DATA, &limit);
    limit.rlim_cur = before_;
    ::setrlimit(RLIMIT_DATA, &limit);
}

#endif

}  // namespace scanmill
