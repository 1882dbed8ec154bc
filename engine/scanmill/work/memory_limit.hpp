// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The most memory that this process may ask for, for as long as the object lives: beyond it allocating fails.

#include "scanmill/data/array.hpp"

namespace scanmill {

/// Counts what belongs to no file; the stacks of `threads`, hardly used, come on top. 0: no limit. Under
/// AddressSanitizer, which takes more than anybody would allow, nothing is limited.
class MemoryLimit {
public:
    MemoryLimit(u64 bytes, unsigned threads);
    ~MemoryLimit();
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;

private:
    bool is_set_ = false;
    u64 before_ = 0;
};

}  // namespace scanmill
