// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The pixels of a picture while it is drawn, with lines, dots and text.

#include <string>
#include <string_view>

#include "render/camera.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/data/picture.hpp"

namespace scanmill {

/// A colour with a share of coverage from 0 to 1 is laid over earlier colours.
class Canvas {
public:
    /// White. Pre: both sides are at least 1.
    Canvas(u32 width, u32 height);

    u32 width() const { return width_; }
    u32 height() const { return height_; }
    /// Ignores places outside the canvas.
    void lay(std::int64_t x, std::int64_t y, const Colour& colour, double share);
    void lay(std::int64_t x, std::int64_t y, const std::array<double, 3>& colour, double share);
    void fill(const Rectangle& part, const Colour& colour);
    Buffer<Colour> pixels() const;

private:
    u32 width_, height_;
    Array<std::array<float, 3>> colours_;
};

enum class TextAnchor { left, centre, right };

/// Draws text in DejaVu Sans. The outlines are not fitted to the pixels, so texts look alike at every size.
class Font {
public:
    Font();
    ~Font();
    Font(const Font&) = delete;
    Font& operator=(const Font&) = delete;

    /// Width of the text in pixels. `text` is UTF-8; `size` is the height of a line in pixels.
    double width(std::string_view text, double size);
    /// Draws the text with its baseline at y. With a halo, the text is surrounded by white.
    void draw(Canvas& canvas, std::string_view text, double x, double y, double size, const Colour& colour,
              TextAnchor anchor = TextAnchor::left, bool halo = false);

private:
    struct Library;
    std::unique_ptr<Library> library_;
};

}  // namespace scanmill
