// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/detail/content.hpp"

#include <iconv.h>
#include <zlib.h>

#include <algorithm>
#include <limits>
#include <new>
#include <span>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/io/memory.hpp"

namespace scanmill {

namespace {

constexpr std::string_view gzip_magic = "\x1f\x8b";
constexpr std::string_view little_mark = "\xff\xfe", big_mark = "\xfe\xff";

/// Decodes the members of a gzip file one after the other, with zlib.
class Inflater {
public:
    explicit Inflater(std::string_view input) : input_(input) {
        constexpr int largest_window = 15, only_gzip = 16;
        if (::inflateInit2(&stream_, largest_window + only_gzip) != Z_OK) throw std::bad_alloc();
    }
    ~Inflater() { ::inflateEnd(&stream_); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    /// Writes up to room.size() bytes of content into `room`. Returns their number, which is less than room.size() only
    /// at the end. Throws Error for invalid or truncated data.
    std::size_t read(std::span<char> room) {
        std::size_t filled = 0;
        while (filled < room.size() && !is_at_end_) filled += step(room.subspan(filled));
        return filled;
    }
    /// The bytes after the last member. Pre: all content has been read.
    std::string_view rest() const { return input_; }

private:
    std::size_t step(std::span<char> room) {
        constexpr std::size_t most = std::numeric_limits<uInt>::max();
        const auto input = static_cast<uInt>(std::min(input_.size(), most));
        const auto output = static_cast<uInt>(std::min(room.size(), most));
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(input_.data()));  // zlib does not write there
        stream_.avail_in = input;
        stream_.next_out = reinterpret_cast<Bytef*>(room.data());
        stream_.avail_out = output;
        const int result = ::inflate(&stream_, Z_NO_FLUSH);
        input_.remove_prefix(input - stream_.avail_in);
        const std::size_t filled = output - stream_.avail_out;
        content_ += filled;
        if (result == Z_MEM_ERROR) throw std::bad_alloc();
        if (result == Z_STREAM_END)
            next_member();
        else if (result == Z_BUF_ERROR || (result == Z_OK && input_.empty() && stream_.avail_out > 0))
            throw Error("its gzip data end after {} of content, before the end of the content",
                        count_text(content_, "byte", "bytes"))
                .hint("the file is truncated: fetch or compress it again");
        else if (result != Z_OK)
            throw Error("its gzip data are damaged after {} of content ({})", count_text(content_, "byte", "bytes"),
                        stream_.msg ? stream_.msg : "no reason given")
                .hint("fetch or compress the file again");
        return filled;
    }

    /// Bytes after a member are ignored if they do not begin another member, as gunzip does.
    void next_member() {
        is_at_end_ = !input_.starts_with(gzip_magic);
        if (!is_at_end_) ::inflateReset(&stream_);
    }

    z_stream stream_{};
    std::string_view input_;
    std::uint64_t content_ = 0;
    bool is_at_end_ = false;
};

}  // namespace

Wrapping wrapping_of(std::string_view bytes) {
    if (bytes.starts_with(gzip_magic)) return Wrapping::gzip;
    const bool has_mark = bytes.starts_with(little_mark) || bytes.starts_with(big_mark);
    const bool is_utf16 = has_mark && !bytes.substr(2).starts_with(std::string_view("\0\0", 2));  // else UTF-32
    return is_utf16 ? Wrapping::utf16 : Wrapping::none;
}

Array<char> decompressed(std::string_view gzip, std::uint64_t most, const OnWarning& on_warning) {
    constexpr std::size_t usual_ratio = 4;
    Inflater inflater(gzip);
    Array<char> content(std::min<std::uint64_t>(most, usual_ratio * gzip.size() + 1));
    std::size_t filled = 0;
    for (;;) {
        filled += inflater.read(std::span(content).subspan(filled));
        if (filled < content.size()) break;
        char further = 0;
        if (content.size() == most && inflater.read({&further, 1}) == 0) break;
        if (content.size() == most)
            throw Error("its {} of gzip data contain more than {}, half of the memory that is available",
                        byte_size_text(gzip.size()), byte_size_text(most))
                .hint(
                    "decompress it with gunzip -k; binary PLY and texts of three columns are then read piece by "
                    "piece where the workflow allows it");
        content.resize(std::min<std::uint64_t>(most, 2 * content.size()));
    }
    content.resize(filled);
    if (content.empty()) throw Error("is empty: its gzip data hold 0 bytes");
    if (const std::string_view rest = inflater.rest(); rest.find_first_not_of('\0') != rest.npos)
        warn(on_warning, "{} after the end of the gzip data {} ignored; they are not gzip data",
             count_text(rest.size(), "byte", "bytes"), by_count(rest.size(), "was", "were"));
    return content;
}

Array<char> utf8_of(std::string_view utf16) {
    if (utf16.size() % 2 != 0)
        throw Error("is text in UTF-16 and has an odd number of bytes, {}", utf16.size())
            .hint("the file is truncated: fetch it again, or save it as UTF-8 in a text editor");
    const iconv_t converter = ::iconv_open("UTF-8", utf16.starts_with(big_mark) ? "UTF-16BE" : "UTF-16LE");
    if (converter == reinterpret_cast<iconv_t>(-1))
        throw Error("is text in UTF-16, which the C library of this system does not convert")
            .hint("save the file as UTF-8 in a text editor");
    constexpr std::size_t most_growth = 2;  // bytes of UTF-8 per byte of UTF-16, rounded up
    Array<char> text(most_growth * utf16.size());
    char *in = const_cast<char*>(utf16.data()) + little_mark.size(),
         *out = text.data();  // iconv does not write to `in`
    std::size_t in_left = utf16.size() - little_mark.size(), out_left = text.size();
    while (::iconv(converter, &in, &in_left, &out, &out_left) == std::size_t(-1)) {
        // The next two bytes are an unpaired surrogate.
        in += 2;
        in_left -= 2;
        *out++ = '?';
        --out_left;
    }
    ::iconv_close(converter);
    text.resize(text.size() - out_left);
    return text;
}

std::optional<Array<char>> unwrapped(std::string_view bytes, const OnWarning& on_warning) {
    std::optional<Array<char>> content;
    if (wrapping_of(bytes) == Wrapping::gzip) {
        content = decompressed(bytes, available_memory() / 2, on_warning);
        bytes = {content->data(), content->size()};
        if (wrapping_of(bytes) == Wrapping::gzip)
            throw Error("is compressed twice with gzip").hint("decompress it with gunzip -k");
    }
    if (wrapping_of(bytes) == Wrapping::utf16) content = utf8_of(bytes);
    return content;
}

}  // namespace scanmill
