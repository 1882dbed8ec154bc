// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <string>

#include "png/libpng.hpp"
#include "png/png.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill::png {

namespace {

constexpr u32 largest_side = PNG_UINT_31_MAX;

/// libpng's structures for one file. The bytes are gathered in memory, because a full disk throws, and exceptions must
/// not pass through libpng.
class Writer {
public:
    Writer()
        : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, &error_, LibpngError::record, LibpngError::ignore)),
          info_(png_ ? png_create_info_struct(png_) : nullptr) {
        if (!info_) {
            png_destroy_write_struct(&png_, nullptr);
            throw std::bad_alloc();
        }
        png_set_write_fn(png_, &bytes_, append, [](png_structp) {});
    }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    ~Writer() { png_destroy_write_struct(&png_, &info_); }

    const std::string& write(const Picture& picture, std::string& caption) {
        std::string software_key = "Software", software = "scanmill", description = caption_key;
        std::array<png_text, 2> texts{};
        texts[0].compression = PNG_TEXT_COMPRESSION_NONE;
        texts[0].key = software_key.data();
        texts[0].text = software.data();
        const bool is_ascii = std::ranges::all_of(caption, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
        texts[1].compression = is_ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
        texts[1].key = description.data();
        texts[1].text = caption.data();
        const int text_count = caption.empty() ? 1 : 2;
        const bool done = succeeds(png_, [&] {
            png_set_user_limits(png_, largest_side, largest_side);
            png_set_IHDR(png_, info_, picture.width, picture.height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                         PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
            png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
            png_set_text(png_, info_, texts.data(), text_count);
            png_write_info(png_, info_);
            for (std::size_t row = 0; row < picture.height; ++row)
                png_write_row(png_, picture.pixels.data()[row * picture.width].data());
            png_write_end(png_, nullptr);
        });
        if (!done) throw Error("PNG cannot hold the picture: {}", error_.message.data());
        return bytes_;
    }

private:
    static void append(png_structp png, png_bytep data, std::size_t size) {
        bool is_full = false;
        try {
            static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
        } catch (const std::bad_alloc&) {
            is_full = true;
        }
        if (is_full) png_error(png, "out of memory");
    }

    LibpngError error_;
    std::string bytes_;
    png_structp png_;
    png_infop info_;
};

}  // namespace

void write_png(const Value& value, OutputBuffer& out, const WriteOptions&) {
    const Picture& picture = *value.get<Picture>();
    value.kind().info().require_usable(&picture);
    if (picture.width > largest_side || picture.height > largest_side)
        throw Error("PNG holds at most {} pixels in a row or column; the picture has {} x {}", largest_side,
                    picture.width, picture.height)
            .hint("draw a smaller picture");
    std::string caption = caption_text(picture.caption);
    Writer writer;
    out.text(writer.write(picture, caption));
}

}  // namespace scanmill::png
