// SPDX-License-Identifier: GPL-3.0-or-later
#include "threemf/plain_zip.hpp"

#include <cstring>
#include <limits>
#include <optional>
#include <vector>

#include "scanmill/data/array.hpp"

namespace scanmill::threemf {

namespace {

constexpr u32 local_mark = 0x04034b50, central_mark = 0x02014b50, zip64_end_mark = 0x06064b50,
              locator_mark = 0x07064b50, end_mark = 0x06054b50;
constexpr std::size_t local_size = 30, central_size = 46, locator_size = 20, end_size = 22;
constexpr std::uint16_t deflated = 8, zip64_tag = 1;

struct Entry {
    std::string_view name;
    std::string_view content;  ///< compressed
    u32 checksum;
    u64 size;  ///< not compressed
};

/// Reads numbers and texts in sequence; they are zero and empty beyond the end of the archive.
class Cursor {
public:
    Cursor(std::string_view archive, std::size_t at) : archive_(archive), at_(at), is_good_(at <= archive.size()) {}

    template <class T>
    T number() {
        const std::string_view bytes = text(sizeof(T));
        T value = 0;
        if (is_good_) std::memcpy(&value, bytes.data(), sizeof(T));
        if constexpr (std::endian::native == std::endian::big) value = byte_swapped(value);
        return value;
    }
    std::string_view text(std::size_t size) {
        is_good_ = is_good_ && size <= archive_.size() - at_;
        if (!is_good_) return {};
        at_ += size;
        return archive_.substr(at_ - size, size);
    }

    bool is_good() const { return is_good_; }

private:
    std::string_view archive_;
    std::size_t at_;
    bool is_good_;
};

/// The content after the local header at `offset`, `size` bytes.
std::optional<std::string_view> content_at(std::string_view archive, u64 offset, u64 size) {
    Cursor header(archive, offset);
    if (header.number<u32>() != local_mark) return std::nullopt;
    header.text(local_size - 8);
    const auto name = header.number<std::uint16_t>(), extra = header.number<std::uint16_t>();
    header.text(std::size_t(name) + extra);
    const std::string_view content = header.text(size);
    return header.is_good() ? std::optional(content) : std::nullopt;
}

/// The next entry of the directory, with all sizes in its ZIP64 field.
std::optional<Entry> entry_at(std::string_view archive, Cursor& directory) {
    Entry entry{};
    if (directory.number<u32>() != central_mark) return std::nullopt;
    directory.text(4);  // versions
    const auto flags = directory.number<std::uint16_t>(), method = directory.number<std::uint16_t>();
    directory.text(4);  // time
    entry.checksum = directory.number<u32>();
    directory.text(8);  // sizes
    const auto name = directory.number<std::uint16_t>(), extra = directory.number<std::uint16_t>(),
               comment = directory.number<std::uint16_t>();
    directory.text(12);  // disk, attributes, offset
    entry.name = directory.text(name);
    const auto tag = directory.number<std::uint16_t>(), length = directory.number<std::uint16_t>();
    entry.size = directory.number<u64>();
    const u64 compressed = directory.number<u64>(), offset = directory.number<u64>();
    constexpr std::uint16_t field = 3 * sizeof(u64);
    if (!directory.is_good() || flags != 0 || method != deflated || comment != 0 || tag != zip64_tag ||
        length != field || extra != field + 4)
        return std::nullopt;
    const std::optional<std::string_view> content = content_at(archive, offset, compressed);
    if (!content) return std::nullopt;
    entry.content = *content;
    return entry;
}

std::optional<std::vector<Entry>> entries_of(std::string_view archive) {
    constexpr u64 most = std::numeric_limits<u32>::max();
    if (archive.size() < locator_size + end_size || archive.size() >= most) return std::nullopt;
    Cursor locator(archive, archive.size() - end_size - locator_size);
    if (locator.number<u32>() != locator_mark) return std::nullopt;
    locator.text(4);  // disk
    Cursor end(archive, locator.number<u64>());
    if (end.number<u32>() != zip64_end_mark) return std::nullopt;
    end.text(28);  // size of this, versions, disks, count on this disk
    const u64 count = end.number<u64>();
    end.text(8);  // size of the directory
    Cursor directory(archive, end.number<u64>());
    std::vector<Entry> entries;
    while (entries.size() < count) {
        const std::optional<Entry> entry = entry_at(archive, directory);
        if (!entry || entry->size >= most) return std::nullopt;
        entries.push_back(*entry);
    }
    return entries;
}

/// The fields that the local header and the directory have in common.
void put_common(const Entry& entry, OutputBuffer& out) {
    constexpr std::uint16_t version = 20, no_flags = 0, midnight = 0, new_year_1980 = 1 << 5 | 1, no_extra = 0;
    out.binary(version);
    out.binary(no_flags);
    out.binary(deflated);
    out.binary(midnight);
    out.binary(new_year_1980);
    out.binary(entry.checksum);
    out.binary(static_cast<u32>(entry.content.size()));
    out.binary(static_cast<u32>(entry.size));
    out.binary(static_cast<std::uint16_t>(entry.name.size()));
    out.binary(no_extra);
}

}  // namespace

void write_plain_zip(std::string_view archive, OutputBuffer& out) {
    const std::optional<std::vector<Entry>> entries = entries_of(archive);
    if (!entries) return out.text(archive);
    u32 offset = 0;
    std::vector<u32> offsets;
    for (const Entry& entry : *entries) {
        offsets.push_back(offset);
        out.binary(local_mark);
        put_common(entry, out);
        out.text(entry.name);
        out.text(entry.content);
        offset += static_cast<u32>(local_size + entry.name.size() + entry.content.size());
    }
    u32 directory_size = 0;
    for (std::size_t i = 0; i < entries->size(); ++i) {
        const Entry& entry = (*entries)[i];
        constexpr std::uint16_t version = 20, none = 0;
        out.binary(central_mark);
        out.binary(version);
        put_common(entry, out);
        for (int field = 0; field < 3; ++field) out.binary(none);  // comment, disk, internal attributes
        out.binary(u32(0));                                        // external attributes
        out.binary(offsets[i]);
        out.text(entry.name);
        directory_size += static_cast<u32>(central_size + entry.name.size());
    }
    const auto count = static_cast<std::uint16_t>(entries->size());
    out.binary(end_mark);
    out.binary(u32(0));  // disks
    out.binary(count);
    out.binary(count);
    out.binary(directory_size);
    out.binary(offset);
    out.binary(std::uint16_t(0));  // comment
}

}  // namespace scanmill::threemf
