// SPDX-License-Identifier: GPL-3.0-or-later
// A module for this version and this compiler from the time before the ABI text named the headers. Whatever they were,
// its declaration must never be called.

#include <cstdlib>

#include "scanmill/plugin/plugin.hpp"

#undef SCANMILL_ABI_TEXT
#define SCANMILL_ABI_TEXT                                                                                         \
    "scanmill " SCANMILL_VERSION ", compiler abi " SCANMILL_TEXT(__GXX_ABI_VERSION) ", libstdc++ " SCANMILL_TEXT( \
        _GLIBCXX_RELEASE) " strings " SCANMILL_TEXT(_GLIBCXX_USE_CXX11_ABI) SCANMILL_ABI_DEBUG                    \
        ", c++ " SCANMILL_TEXT(__cplusplus) ", eigen " SCANMILL_TEXT(EIGEN_WORLD_VERSION) "." SCANMILL_TEXT(      \
            EIGEN_MAJOR_VERSION) " aligned to " SCANMILL_TEXT(EIGEN_MAX_STATIC_ALIGN_BYTES) SCANMILL_ABI_SANITIZER

SCANMILL_FILTER() { std::abort(); }
