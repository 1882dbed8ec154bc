// SPDX-License-Identifier: GPL-3.0-or-later
// PNG as decoded by libpng's own simplified reader, and files of other programs as read here.

#include <png.h>

#include "core/formats/support.hpp"
#include "scanmill/data/picture.hpp"
#include "support/program.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A picture whose pixels all differ.
Picture made_picture(u32 width, u32 height) {
    Picture picture{width, height, {}, "A cube, seen from +z"};
    Array<Colour> pixels;
    for (u32 y = 0; y < height; ++y)
        for (u32 x = 0; x < width; ++x) pixels.push_back({u8(x), u8(y), u8(x * 7 + y * 3)});
    picture.pixels = std::move(pixels);
    return picture;
}

std::string png_of(const Picture& picture) { return write_bytes("a.png", std::make_shared<const Picture>(picture)); }

std::shared_ptr<const Picture> read_picture(std::string_view bytes, Warnings* warnings = nullptr) {
    return read_bytes(bytes, "a.png", warnings ? warnings->reading() : ReadOptions{}).value.get<Picture>();
}

/// The samples of a PNG as libpng's simplified interface decodes them.
struct Decoded {
    u32 width = 0, height = 0;
    std::vector<u8> rgb;
};
Decoded decoded(const std::string& bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) << image.message;
    image.format = PNG_FORMAT_RGB;
    Decoded result{image.width, image.height, std::vector<u8>(PNG_IMAGE_SIZE(image))};
    EXPECT_TRUE(png_image_finish_read(&image, nullptr, result.rgb.data(), 0, nullptr)) << image.message;
    return result;
}

/// A PNG made by libpng's simplified interface from samples of this format (PNG_FORMAT_…).
std::string encoded(u32 width, u32 height, u32 format, const void* numbers, const void* colour_map = nullptr,
                    u32 colours = 0) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = format;
    image.colormap_entries = colours;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::string bytes(size, '\0');
    EXPECT_TRUE(png_image_write_to_memory(&image, bytes.data(), &size, 0, numbers, 0, colour_map)) << image.message;
    bytes.resize(size);
    return bytes;
}

std::vector<u8> samples_of(const Picture& picture) {
    std::vector<u8> numbers;
    for (const Colour& pixel : picture.pixels) numbers.insert(numbers.end(), pixel.begin(), pixel.end());
    return numbers;
}

u32 big_endian_at(std::string_view bytes, std::size_t at) {
    u32 number = 0;
    for (std::size_t i = 0; i < 4; ++i) number = number << 8 | static_cast<unsigned char>(bytes[at + i]);
    return number;
}

/// The types of the chunks, in order.
std::vector<std::string> chunks_of(std::string_view bytes) {
    std::vector<std::string> types;
    for (std::size_t at = 8; at + 12 <= bytes.size(); at += 12 + big_endian_at(bytes, at))
        types.emplace_back(bytes.substr(at + 4, 4));
    return types;
}

/// The bytes with another number in the header at `offset` within IHDR, and with a matching checksum.
std::string with_header(std::string bytes, std::size_t offset, std::string_view replacement) {
    constexpr std::size_t header = 16, size = 13;  // after the signature, the chunk's length and its type
    bytes.replace(header + offset, replacement.size(), replacement);
    u32 crc = 0xFFFFFFFF;
    for (std::size_t i = header - 4; i < header + size; ++i) {
        crc ^= static_cast<unsigned char>(bytes[i]);
        for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? 0xEDB88320 ^ crc >> 1 : crc >> 1;
    }
    return bytes.replace(header + size, 4, bytes_of(~crc, true));
}

TEST(Png, Pixels_AreThoseThatLibpngDecodes) {
    for (const auto& [width, height] : {std::pair(1u, 1u), {1u, 5u}, {7u, 1u}, {3u, 2u}, {17u, 13u}, {255u, 255u}}) {
        const Picture picture = made_picture(width, height);
        const Decoded seen = decoded(png_of(picture));
        EXPECT_EQ(seen.width, width);
        EXPECT_EQ(seen.height, height);
        EXPECT_EQ(seen.rgb, samples_of(picture)) << width << " x " << height;
    }
}

TEST(Png, Chunks_AreHeaderColourSpaceTextsAndPixels) {
    const std::string bytes = png_of(made_picture(3, 2));
    EXPECT_THAT(chunks_of(bytes), ElementsAre("IHDR", "sRGB", "tEXt", "tEXt", "IDAT", "IEND"));
    EXPECT_THAT(bytes, AllOf(HasSubstr(std::string("Software\0scanmill", 17)),
                             HasSubstr(std::string("Description\0A cube, seen from +z", 32))));
}

TEST(Png, CaptionBeyondAscii_IsAnInternationalText) {
    Picture picture = made_picture(2, 2);
    picture.caption = "Würfel, Maße in µm";
    const std::string bytes = png_of(picture);
    EXPECT_THAT(chunks_of(bytes), testing::Contains("iTXt"));
    EXPECT_THAT(bytes, HasSubstr(picture.caption));
    EXPECT_EQ(read_picture(bytes)->caption, picture.caption);
}

TEST(Png, WithoutCaption_HasNoDescription) {
    Picture picture = made_picture(2, 2);
    picture.caption.clear();
    EXPECT_THAT(png_of(picture), Not(HasSubstr("Description")));
    EXPECT_EQ(read_picture(png_of(picture))->caption, "");
}

TEST(Png, Caption_KeepsItsLinesAndLosesOtherControlCharacters) {
    Picture picture = made_picture(2, 2);
    picture.caption = std::string("first\nsecond\tthird\0fourth\n", 26);
    EXPECT_EQ(read_picture(png_of(picture))->caption, "first\nsecond_third_fourth\n");
}

TEST(Png, EqualPictures_GiveEqualBytes) {
    EXPECT_EQ(png_of(made_picture(40, 30)), png_of(made_picture(40, 30)));
    Picture other = made_picture(40, 30);
    other.caption += ".";
    EXPECT_NE(png_of(other), png_of(made_picture(40, 30)));
}

TEST(Png, WrittenPicture_ReadsBackEqual) {
    const Picture picture = made_picture(31, 9);
    Warnings warnings;
    const LoadedFile loaded = read_bytes(png_of(picture), "a.png", warnings.reading());
    EXPECT_THAT(warnings.sentences, IsEmpty());
    EXPECT_EQ(loaded.format, "PNG");
    EXPECT_EQ(loaded.encoding, "8-bit RGB");
    EXPECT_THAT(loaded.comments, ElementsAre(picture.caption));
    const auto back = loaded.value.get<Picture>();
    EXPECT_EQ(back->width, 31u);
    EXPECT_EQ(back->height, 9u);
    EXPECT_TRUE(std::ranges::equal(back->pixels, picture.pixels));
    EXPECT_EQ(back->caption, picture.caption);
}

TEST(Png, Content_DecidesTheFormat) { EXPECT_EQ(read_bytes(png_of(made_picture(2, 2)), "a.ply").format, "PNG"); }

TEST(Png, EveryImageFormat_IsReadAsRgb) {
    const std::array<u8, 2> grey{10, 200};
    EXPECT_THAT(rows_of(read_picture(encoded(2, 1, PNG_FORMAT_GRAY, grey.data()))->pixels),
                ElementsAre(Colour{10, 10, 10}, Colour{200, 200, 200}));
    const std::array<u8, 6> rgb{1, 2, 3, 4, 5, 6};
    EXPECT_THAT(rows_of(read_picture(encoded(2, 1, PNG_FORMAT_RGB, rgb.data()))->pixels),
                ElementsAre(Colour{1, 2, 3}, Colour{4, 5, 6}));
}

TEST(Png, Alpha_IsLeftOutWithAWarningThatCountsPixels) {
    const std::array<u8, 12> rgba{1, 2, 3, 255, 4, 5, 6, 128, 7, 8, 9, 0};
    Warnings warnings;
    EXPECT_THAT(rows_of(read_picture(encoded(3, 1, PNG_FORMAT_RGBA, rgba.data()), &warnings)->pixels),
                ElementsAre(Colour{1, 2, 3}, Colour{4, 5, 6}, Colour{7, 8, 9}));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("2 pixels are not opaque")));
    const std::array<u8, 4> grey{9, 255, 8, 255};
    warnings.sentences.clear();
    EXPECT_THAT(rows_of(read_picture(encoded(2, 1, PNG_FORMAT_GA, grey.data()), &warnings)->pixels),
                ElementsAre(Colour{9, 9, 9}, Colour{8, 8, 8}));
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(PngRefusal, Palette_NamesAConverter) {
    const std::array<u8, 2> indices{0, 1};
    const std::array<u8, 6> colours{1, 2, 3, 4, 5, 6};
    const std::string bytes = encoded(2, 1, PNG_FORMAT_RGB_COLORMAP, indices.data(), colours.data(), 2);
    const Error error = error_of([&] { read_bytes(bytes, "a.png"); });
    EXPECT_THAT(error.sentence(), HasSubstr("palette"));
    EXPECT_THAT(error.hint(), HasSubstr("magick a.png"));
}

TEST(PngRefusal, SixteenBits_NamesAConverter) {
    const std::array<std::uint16_t, 2> grey{0, 65535};
    const std::string bytes = encoded(2, 1, PNG_FORMAT_LINEAR_Y, grey.data());
    const Error error = error_of([&] { read_bytes(bytes, "a.png"); });
    EXPECT_THAT(error.sentence(), HasSubstr("16 bits per sample"));
    EXPECT_THAT(error.hint(), HasSubstr("magick a.png"));
}

TEST(PngRefusal, AnyTruncation_IsAnError) {
    const std::string bytes = png_of(made_picture(9, 9));
    const std::size_t end = bytes.size() - 12;  // the last chunk holds nothing
    for (std::size_t size = 8; size < end; ++size) {
        const Error error = error_of([&] { read_bytes(bytes.substr(0, size), "a.png"); });
        EXPECT_THAT(error.sentence(), HasSubstr("truncated")) << size;
        EXPECT_NE(error.hint(), "") << size;
    }
}

TEST(PngRefusal, DamagedPixels_AreAnError) {
    std::string bytes = png_of(made_picture(9, 9));
    bytes[bytes.find("IDAT") + 8] ^= 0x55;
    EXPECT_THAT(refusal_of(bytes, "a.png"), HasSubstr("not a sound PNG"));
}

TEST(PngRefusal, HugeSizeInTheHeader_IsRefusedBeforeMemoryIsAllocated) {
    const std::string bytes = png_of(made_picture(9, 9));
    const std::string most = bytes_of(u32(1000000), true);  // a terabyte of pixels would be needed
    const std::string huge = with_header(with_header(bytes, 0, most), 4, most);
    EXPECT_THAT(refusal_of(huge, "a.png"), HasSubstr("declares 1000000 x 1000000 pixels"));
    const std::string beyond = with_header(bytes, 0, bytes_of(u32(1) << 30, true));
    EXPECT_THAT(refusal_of(beyond, "a.png"), HasSubstr("not a sound PNG"));
}

TEST(PngRefusal, OtherKinds_AreNotWritten) {
    const Error error = error_of([] { write_bytes("a.png", std::make_shared<const TriangleMesh>(cube(1))); });
    EXPECT_THAT(error.sentence(), HasSubstr("mesh cannot be written with the extension '.png'"));
    const Error picture = error_of([] { write_bytes("a.ply", std::make_shared<const Picture>(made_picture(1, 1))); });
    EXPECT_EQ(picture.hint(), "extensions for it: png");
    EXPECT_EQ(writable_extensions(kind_of<Picture>()), "png");
}

TEST(PngRefusal, PictureWithoutItsPixels_IsNotWritten) {
    Picture picture = made_picture(3, 2);
    picture.height = 3;
    EXPECT_THAT(sentence_of([&] { png_of(picture); }), HasSubstr("has 6 pixels; expected 3 x 3 = 9"));
    EXPECT_THAT(sentence_of([] { png_of(Picture{}); }), HasSubstr("empty: 0 x 0"));
}

TEST(PngCommand, Info_ShowsTheSizeAndConvertNamesTheFormat) {
    const TemporaryFolder folder;
    write_file(folder / "a.png", std::make_shared<const Picture>(made_picture(31, 9)));
    const ProgramResult info = scanmill_program({"info", "a.png"}, {.folder = folder.path()});
    EXPECT_EQ(info.exit_code, 0) << info.err;
    EXPECT_THAT(info.out, AllOf(HasSubstr("picture"), HasSubstr("31"), HasSubstr("9"), HasSubstr("8-bit RGB"),
                                HasSubstr("A cube, seen from +z")));
    const ProgramResult convert = scanmill_program({"convert", "a.png", "a.ply"}, {.folder = folder.path()});
    EXPECT_EQ(convert.exit_code, 1);
    EXPECT_THAT(convert.err, HasSubstr("picture cannot be written with the extension '.ply'"));
}

}  // namespace
}  // namespace scanmill::test
