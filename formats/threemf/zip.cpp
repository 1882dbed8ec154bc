// SPDX-License-Identifier: GPL-3.0-or-later
#include "threemf/zip.hpp"

#include <zlib.h>

#include <limits>
#include <new>

#include "scanmill/base/error.hpp"
#include "scanmill/data/array.hpp"

namespace scanmill::threemf {

namespace {

/// Compresses a text that arrives in parts.
class Deflater {
public:
    Deflater() {
        constexpr int bare_data = -15, usual_memory = 8;
        if (::deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, bare_data, usual_memory, Z_DEFAULT_STRATEGY) !=
            Z_OK)
            throw std::bad_alloc();
    }
    ~Deflater() { ::deflateEnd(&stream_); }
    Deflater(const Deflater&) = delete;
    Deflater& operator=(const Deflater&) = delete;

    void add(std::string_view piece, int flush = Z_NO_FLUSH) {
        checksum = ::crc32_z(checksum, reinterpret_cast<const Bytef*>(piece.data()), piece.size());
        size += piece.size();
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(piece.data()));  // zlib does not write there
        stream_.avail_in = static_cast<uInt>(piece.size());
        do {
            char room[1 << 14];
            stream_.next_out = reinterpret_cast<Bytef*>(room);
            stream_.avail_out = sizeof room;
            ::deflate(&stream_, flush);
            compressed.append(room, sizeof room - stream_.avail_out);
        } while (stream_.avail_out == 0);
    }

    std::string compressed;
    uLong checksum = 0;
    std::size_t size = 0;

private:
    z_stream stream_{};
};

constexpr std::uint16_t zero = 0, version = 20;

/// Appends the output of `write` to `bytes`.
template <class Write>
void append(std::string& bytes, Write&& write) {
    OutputBuffer out([&](std::string_view piece) { bytes += piece; });
    write(out);
    out.flush();
}

}  // namespace

void ZipWriter::add(std::string_view name, const std::function<void(OutputBuffer&)>& write) {
    Deflater part;
    OutputBuffer text([&](std::string_view piece) { part.add(piece); });
    write(text);
    text.flush();
    part.add("", Z_FINISH);  // not {}, because zlib restarts the checksum at a null pointer
    constexpr std::size_t headers = 1 << 10;
    if (std::max(part.size, size_ + part.compressed.size() + headers) > std::numeric_limits<u32>::max())
        throw Error("a model of {} bytes is too large; 3MF files are ZIP archives of less than 4 GiB", part.size)
            .hint("write PLY or VTP, or fewer triangles");

    // The local header and the directory have these fields in common.
    std::string fields;
    append(fields, [&](OutputBuffer& out) {
        constexpr std::uint16_t deflated = 8, new_year_1980 = 1 << 5 | 1;
        for (const std::uint16_t field : {version, zero, deflated, zero, new_year_1980}) out.binary(field);
        out.binary(static_cast<u32>(part.checksum));
        out.binary(static_cast<u32>(part.compressed.size()));
        out.binary(static_cast<u32>(part.size));
        out.binary(static_cast<std::uint16_t>(name.size()));
        out.binary(zero);  // no extra field
    });
    append(directory_, [&](OutputBuffer& out) {
        out.text("PK\1\2");
        out.binary(version);
        out.text(fields);
        for (int field = 0; field < 5; ++field) out.binary(zero);  // comment, disk, attributes
        out.binary(static_cast<u32>(size_));
        out.text(name);
    });
    for (const std::string_view piece :
         {std::string_view("PK\3\4"), std::string_view(fields), name, std::string_view(part.compressed)}) {
        out_.text(piece);
        size_ += piece.size();
    }
    ++parts_;
}

void ZipWriter::finish() {
    out_.text(directory_);
    out_.text("PK\5\6");
    for (const std::size_t field : {std::size_t(0), std::size_t(0), parts_, parts_})  // disks, parts
        out_.binary(static_cast<std::uint16_t>(field));
    out_.binary(static_cast<u32>(directory_.size()));
    out_.binary(static_cast<u32>(size_));
    out_.binary(zero);  // no comment
}

}  // namespace scanmill::threemf
