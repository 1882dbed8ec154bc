// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "png/libpng.hpp"
#include "png/png.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill::png {

namespace {

/// The largest ratio of decompressed to compressed size in deflate: 258 bytes in 2 bits.
constexpr u64 largest_ratio = 1032;

class Reader {
public:
    explicit Reader(const FileBytes& file)
        : file_(file),
          png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &error_, LibpngError::record, LibpngError::ignore)),
          info_(png_ ? png_create_info_struct(png_) : nullptr) {
        if (!info_) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw std::bad_alloc();
        }
        png_set_read_fn(png_, this, take);
    }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }

    LoadedFile read(const ReadOptions& options) {
        read_header();
        const std::size_t channels = png_get_channels(png_, info_);
        Picture picture;
        picture.width = png_get_image_width(png_, info_);
        picture.height = png_get_image_height(png_, info_);
        const std::size_t pixels = std::size_t(picture.width) * picture.height;
        Array<u8> samples = read_samples(picture.height, picture.width * channels);
        Array<Colour> colours(pixels);
        std::size_t translucent = 0;
        for (std::size_t i = 0; i < pixels; ++i) {
            const u8* from = samples.data() + i * channels;
            colours[i] = channels >= 3 ? Colour{from[0], from[1], from[2]} : Colour{from[0], from[0], from[0]};
            translucent += channels % 2 == 0 && from[channels - 1] != 255 ? 1 : 0;
        }
        if (png_get_valid(png_, info_, PNG_INFO_tRNS))
            warn(options.on_warning, "alpha was left out: one colour is transparent");
        if (translucent > 0)
            warn(options.on_warning, "alpha was left out: {} not opaque",
                 count_text(translucent, "pixel is", "pixels are"));
        picture.pixels = std::move(colours);
        picture.caption = caption();
        const std::string encoding =
            fmt::format("8-bit {}{}", channels >= 3 ? "RGB" : "grey", channels % 2 == 0 ? " with alpha" : "");
        std::vector<std::string> comments;
        if (!picture.caption.empty()) comments.push_back(picture.caption);
        return {std::make_shared<const Picture>(std::move(picture)), "PNG", encoding, std::move(comments)};
    }

private:
    static void take(png_structp png, png_bytep to, std::size_t size) {
        auto& self = *static_cast<Reader*>(png_get_io_ptr(png));
        if (size > self.file_.bytes.size() - self.next_) {
            self.is_truncated_ = true;
            png_error(png, "the file ends too early");
        }
        std::memcpy(to, self.file_.bytes.data() + self.next_, size);
        self.next_ += size;
    }

    [[noreturn]] void refuse() const {
        if (is_truncated_)
            throw Error("is truncated: its {} end within the image", byte_size_text(file_.bytes.size()))
                .hint(truncated_hint);
        throw Error("is not a sound PNG file: {}", error_.message.data()).hint(truncated_hint);
    }

    void read_header() {
        if (!succeeds(png_, [&] { png_read_info(png_, info_); })) refuse();
        const int depth = png_get_bit_depth(png_, info_), type = png_get_color_type(png_, info_);
        if (type == PNG_COLOR_TYPE_PALETTE || depth != 8)
            throw Error("has {}{} bits per sample; 8-bit grey and RGB are read",
                        type == PNG_COLOR_TYPE_PALETTE ? "a palette with " : "", depth)
                .hint(fmt::format("convert it with a free program: magick {} -depth 8 png24:out.png",
                                  shell_word(file_.path)));
        const u64 width = png_get_image_width(png_, info_), height = png_get_image_height(png_, info_);
        const u64 size = height * (1 + width * png_get_channels(png_, info_));
        if (size / largest_ratio > file_.bytes.size())
            throw Error("declares {} x {} pixels, which {} cannot hold", width, height,
                        byte_size_text(file_.bytes.size()))
                .hint(truncated_hint);
    }

    Array<u8> read_samples(std::size_t height, std::size_t row_size) {
        Array<u8> samples(height * row_size);
        std::vector<png_bytep> rows(height);
        for (std::size_t row = 0; row < height; ++row) rows[row] = samples.data() + row * row_size;
        const bool done = succeeds(png_, [&] {
            png_set_interlace_handling(png_);
            png_read_update_info(png_, info_);
            png_read_image(png_, rows.data());
            png_read_end(png_, info_);
        });
        if (!done) refuse();
        return samples;
    }

    /// The text `Description`. A tEXt chunk has Latin-1, which equals UTF-8 for ASCII; other bytes become '_'.
    std::string caption() const {
        png_textp texts = nullptr;
        const int count = png_get_text(png_, info_, &texts, nullptr);
        for (const png_text& text : std::span(texts, static_cast<std::size_t>(count)))
            if (std::string_view(text.key) == caption_key) return caption_text(text.text ? text.text : "");
        return "";
    }

    LibpngError error_;
    const FileBytes& file_;
    std::size_t next_ = 0;
    bool is_truncated_ = false;
    png_structp png_;
    png_infop info_;
};

}  // namespace

LoadedFile read_png(const FileBytes& file, const ReadOptions& options) { return Reader(file).read(options); }

}  // namespace scanmill::png
