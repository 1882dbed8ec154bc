// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/canvas.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <cmath>

#include "scanmill/base/error.hpp"

// The font is part of the program, so that texts look alike on every machine.
asm(".section .rodata\n"
    ".balign 16\n"
    "scanmill_render_font:\n"
    ".incbin \"" SCANMILL_FONT
    "\"\n"
    "scanmill_render_font_end:\n"
    ".previous\n");
extern "C" {
extern const unsigned char font_begin[] asm("scanmill_render_font");
extern const unsigned char font_end[] asm("scanmill_render_font_end");
}

namespace scanmill {

Canvas::Canvas(u32 width, u32 height) : width_(width), height_(height) {
    colours_.assign(std::size_t(width) * height, {255, 255, 255});
}

void Canvas::lay(std::int64_t x, std::int64_t y, const std::array<double, 3>& colour, double share) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_ || !(share > 0)) return;
    auto& pixel = colours_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)];
    for (std::size_t i = 0; i < 3; ++i) pixel[i] = static_cast<float>(pixel[i] + share * (colour[i] - pixel[i]));
}

void Canvas::lay(std::int64_t x, std::int64_t y, const Colour& colour, double share) {
    lay(x, y, std::array<double, 3>{double(colour[0]), double(colour[1]), double(colour[2])}, share);
}

void Canvas::fill(const Rectangle& part, const Colour& colour) {
    for (u32 y = part.y; y < part.y + part.height; ++y)
        for (u32 x = part.x; x < part.x + part.width; ++x) lay(x, y, colour, 1);
}

Buffer<Colour> Canvas::pixels() const {
    Array<Colour> pixels(colours_.size());
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            pixels[i][c] = static_cast<u8>(std::floor(std::min(255.0f, std::max(0.0f, colours_[i][c])) + 0.5f));
    return pixels;
}

struct Font::Library {
    FT_Library library = nullptr;
    FT_Face face = nullptr;

    ~Library() {
        if (face) FT_Done_Face(face);
        if (library) FT_Done_FreeType(library);
    }

    /// Calls action(glyph, x) for every character; x is the start of the glyph in pixels. Returns the text's width.
    template <class Action>
    double for_each_glyph(std::string_view text, double size, const Action& action) {
        constexpr double fraction = 64;  // FreeType counts sixty-fourths of a pixel
        FT_Set_Char_Size(face, 0, static_cast<FT_F26Dot6>(std::lround(size * fraction)), 72, 72);
        double x = 0;
        for (std::size_t i = 0; i < text.size();) {
            const auto lead = static_cast<unsigned char>(text[i++]);
            FT_ULong code = lead < 0x80 ? lead : lead < 0xE0 ? lead & 0x1Fu : lead < 0xF0 ? lead & 0x0Fu : lead & 0x07u;
            while (i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80)
                code = code << 6 | (static_cast<unsigned char>(text[i++]) & 0x3Fu);
            if (FT_Load_Char(face, code, FT_LOAD_NO_HINTING | FT_LOAD_RENDER) != 0) continue;
            action(*face->glyph, x);
            x += static_cast<double>(face->glyph->advance.x) / fraction;
        }
        return x;
    }
};

Font::Font() : library_(std::make_unique<Library>()) {
    if (FT_Init_FreeType(&library_->library) != 0 ||
        FT_New_Memory_Face(library_->library, font_begin, static_cast<FT_Long>(font_end - font_begin), 0,
                           &library_->face) != 0)
        throw Error("FreeType cannot read the built-in font").hint("this is a fault of the program; please report it");
}

Font::~Font() = default;

double Font::width(std::string_view text, double size) {
    return library_->for_each_glyph(text, size, [](const FT_GlyphSlotRec&, double) {});
}

void Font::draw(Canvas& canvas, std::string_view text, double x, double y, double size, const Colour& colour,
                TextAnchor anchor, bool halo) {
    if (anchor != TextAnchor::left) x -= width(text, size) * (anchor == TextAnchor::centre ? 0.5 : 1);
    const auto draw_at = [&](std::int64_t dx, std::int64_t dy, const Colour& ink) {
        library_->for_each_glyph(text, size, [&](const FT_GlyphSlotRec& glyph, double at) {
            const std::int64_t left = std::llround(x + at) + glyph.bitmap_left + dx,
                               top = std::llround(y) - glyph.bitmap_top + dy;
            for (unsigned row = 0; row < glyph.bitmap.rows; ++row)
                for (unsigned column = 0; column < glyph.bitmap.width; ++column)
                    canvas.lay(left + column, top + row, ink,
                               glyph.bitmap.buffer[row * static_cast<unsigned>(glyph.bitmap.pitch) + column] / 255.0);
        });
    };
    if (halo)
        for (const int dx : {-2, -1, 0, 1, 2})
            for (const int dy : {-2, -1, 0, 1, 2}) draw_at(dx, dy, {255, 255, 255});
    draw_at(0, 0, colour);
}

}  // namespace scanmill
