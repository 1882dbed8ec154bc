// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a filter can leave behind in its process that the next one would feel.

#include <string>

#include "scanmill/data/array.hpp"

namespace scanmill {

class ProcessState {
public:
    /// As it is now.
    static ProcessState now();

    /// What differs since `before`, as a part of a sentence: "3 more files are open"; empty: nothing.
    std::string changes_since(const ProcessState& before) const;

private:
    std::string folder_, locale_, environment_;
    unsigned file_mask_ = 0;
    int rounding_ = 0;
    std::size_t open_files_ = 0;
};

/// Bytes of this process that belong to no file.
u64 anonymous_memory();

}  // namespace scanmill
