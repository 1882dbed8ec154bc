// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/memory_limit.hpp"

#include <sys/resource.h>

#include <algorithm>

namespace scanmill {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

MemoryLimit::MemoryLimit(u64, unsigned) {}
MemoryLimit::~MemoryLimit() = default;

#else

MemoryLimit::MemoryLimit(u64 bytes, unsigned threads) {
    rlimit limit{};
    if (bytes == 0) return;
    constexpr u64 largest_stack = u64(64) << 20;
    if (::getrlimit(RLIMIT_STACK, &limit) == 0) bytes += threads * std::min<u64>(limit.rlim_cur, largest_stack);
    if (::getrlimit(RLIMIT_DATA, &limit) != 0 || bytes >= limit.rlim_cur) return;
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
