// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `picture`: an image with a caption.

#include <array>
#include <string>

#include "scanmill/data/array.hpp"
#include "scanmill/record/fields.hpp"

namespace scanmill {

/// Red, green, blue of the sRGB colour space.
using Colour = std::array<u8, 3>;

struct Picture {
    u32 width = 0, height = 0;
    /// #pixels = width · height, row by row from the top left.
    Buffer<Colour> pixels;
    /// The text below the picture; UTF-8.
    std::string caption;
};
constexpr auto fields(const Picture*) {
    return std::tuple{field("width", &Picture::width), field("height", &Picture::height),
                      field("pixels", &Picture::pixels), field("caption", &Picture::caption)};
}

}  // namespace scanmill
