// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What reader and writer share: errors of libpng, and the form of captions. libpng reports an error by longjmp, which
/// must not pass over objects with a destructor.

#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>
#include <string>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/writing.hpp"

namespace scanmill::png {

/// The message of libpng's last error; contains no object with a destructor.
struct LibpngError {
    std::array<char, 200> message{};

    /// A png_error_ptr; its error pointer is a LibpngError.
    static void record(png_structp png, png_const_charp message) {
        auto& error = *static_cast<LibpngError*>(png_get_error_ptr(png));
        std::snprintf(error.message.data(), error.message.size(), "%s", message);
        png_longjmp(png, 1);
    }
    /// A png_error_ptr for libpng's warnings, which concern chunks that are not read.
    static void ignore(png_structp, png_const_charp) {}
};

/// Calls `action` and returns whether it ended without an error of libpng. Pre: the objects that `action` makes have no
/// destructor.
template <class Action>
bool succeeds(png_structp png, const Action& action) {
    if (setjmp(png_jmpbuf(png))) return false;
    action();
    return true;
}

/// The key of the text chunk that holds the caption.
constexpr const char* caption_key = "Description";

/// A caption as valid_text(), with its line breaks, which PNG allows.
inline std::string caption_text(std::string_view caption) {
    std::string text;
    for (std::size_t begin = 0, end; begin <= caption.size(); begin = end + 1) {
        end = std::min(caption.find('\n', begin), caption.size());
        if (begin > 0) text += '\n';
        text += valid_text(caption.substr(begin, end - begin));
    }
    return text;
}

}  // namespace scanmill::png
