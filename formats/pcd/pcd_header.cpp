// SPDX-License-Identifier: GPL-3.0-or-later
#include "pcd/pcd_header.hpp"

#include <array>
#include <charconv>
#include <cstring>
#include <set>
#include <span>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill::pcd {

namespace {

using pcl::PCLPointField;

constexpr std::array<std::pair<ScalarType, PCLPointField::PointFieldTypes>, 10> types{{
    {ScalarType::int8, PCLPointField::INT8},
    {ScalarType::uint8, PCLPointField::UINT8},
    {ScalarType::int16, PCLPointField::INT16},
    {ScalarType::uint16, PCLPointField::UINT16},
    {ScalarType::int32, PCLPointField::INT32},
    {ScalarType::uint32, PCLPointField::UINT32},
    {ScalarType::int64, PCLPointField::INT64},
    {ScalarType::uint64, PCLPointField::UINT64},
    {ScalarType::float32, PCLPointField::FLOAT32},
    {ScalarType::float64, PCLPointField::FLOAT64},
}};

constexpr std::array<std::string_view, 3> encodings{"ascii", "binary", "binary_compressed"};
constexpr u64 most_row_bytes = 1u << 20;

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t at = 0; (at = line.find_first_not_of(" \t\r", at)) != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
    return words;
}

class HeaderParser {
public:
    explicit HeaderParser(std::string_view bytes) : bytes_(bytes) {}

    PcdHeader header() {
        while (next_line())
            if (read_line()) {
                finish();
                return std::move(header_);
            }
        throw Error("line {}: the header ends before its DATA line", line_)
            .hint("the file is truncated: fetch or export it again");
    }

private:
    bool next_line() {
        if (at_ >= bytes_.size()) return false;
        const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
        words_ = words_of(bytes_.substr(at_, end - at_));
        text_ = bytes_.substr(at_, end - at_);
        if (text_.ends_with('\r')) text_.remove_suffix(1);
        at_ = end + 1;
        ++line_;
        return true;
    }

    /// Reads a line; returns true for the DATA line.
    bool read_line() {
        if (words_.empty()) return false;
        const std::string_view key = words_.front();
        if (key.starts_with('#')) {
            if (!text_.starts_with("# .PCD")) header_.comments.emplace_back(text_.substr(text_.find('#') + 1));
        } else if (key == "FIELDS" || key == "COLUMNS") {
            fields_ = words_.size() - 1;
            require_fields();
            padded_ = std::ranges::find(words_, "_") != words_.end();
        } else if (key == "SIZE") {
            sizes_ = numbers();
        } else if (key == "COUNT") {
            counts_ = numbers();
        } else if (key == "WIDTH") {
            header_.width = number();
        } else if (key == "HEIGHT") {
            header_.height = number();
        } else if (key == "POINTS") {
            promised_ = number();
        } else if (key == "VIEWPOINT") {
            read_viewpoint();
        } else if (key == "DATA") {
            read_encoding();
            return true;
        } else if (key != "VERSION" && key != "TYPE") {
            throw Error("line {}: {} is not part of a PCD header", line_, quote(key));
        }
        return false;
    }

    void require_fields() const {
        constexpr std::size_t most_fields = 1000;
        if (fields_ > most_fields) throw Error("line {}: {} fields; at most {} are read", line_, fields_, most_fields);
        std::set<std::string_view> seen;
        for (const std::string_view name : std::span(words_).subspan(1))
            if (name != "_" && !seen.insert(name).second)
                throw Error("line {}: two fields are called {}", line_, quote(name));
    }

    /// Reads the position of the sensor and its rotation, a quaternion w x y z. Old files have no such line.
    void read_viewpoint() {
        constexpr std::array<double, 7> identity{0, 0, 0, 1, 0, 0, 0};
        if (words_.size() != identity.size() + 1)
            throw Error("line {}: VIEWPOINT has {}; expected {}", line_,
                        count_text(words_.size() - 1, "number", "numbers"), identity.size());
        for (std::size_t i = 0; i < identity.size(); ++i) {
            double number = 0;
            if (!parse_number(words_[i + 1], number))
                throw Error("line {}: {} is not a number for VIEWPOINT", line_, quote(words_[i + 1]));
            header_.has_viewpoint |= number != identity[i];
            if (i < 3) header_.sensor[static_cast<Eigen::Index>(i)] = number;
            header_.viewpoint.append(i > 0 ? " " : "").append(words_[i + 1]);
        }
    }

    void read_encoding() {
        const std::string_view word = words_.size() > 1 ? words_[1] : std::string_view();
        const auto found = std::ranges::find(encodings, word);
        if (found == encodings.end())
            throw Error("line {}: DATA is {}; expected ascii, binary or binary_compressed", line_, quote(word));
        header_.encoding = static_cast<PcdHeader::Encoding>(found - encodings.begin());
        header_.body = std::min(at_, bytes_.size());
        header_.lines = line_;
    }

    u64 number(std::size_t word = 1) const {
        u64 value = 0;
        if (word < words_.size()) {
            const std::string_view text = words_[word];
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            if (error == std::errc() && end == text.data() + text.size()) return value;
        }
        throw Error("line {}: {} needs a whole number; found {}", line_, words_.front(),
                    word < words_.size() ? quote(words_[word]) : "nothing");
    }
    std::vector<u64> numbers() const {
        std::vector<u64> values;
        for (std::size_t word = 1; word < words_.size(); ++word) values.push_back(number(word));
        return values;
    }

    void finish() {
        if (counts_.empty()) counts_.assign(fields_, 1);
        if (fields_ == 0 || sizes_.size() != fields_ || counts_.size() != fields_)
            throw Error("its header names {} and gives {} and {}", count_text(fields_, "field", "fields"),
                        count_text(sizes_.size(), "size", "sizes"), count_text(counts_.size(), "count", "counts"));
        for (std::size_t field = 0; field < fields_; ++field) {
            if (sizes_[field] != 1 && sizes_[field] != 2 && sizes_[field] != 4 && sizes_[field] != 8)
                throw Error("its header gives field {} the size {}; expected 1, 2, 4 or 8", field, sizes_[field]);
            if (counts_[field] > most_row_bytes || header_.row_bytes > most_row_bytes)
                throw Error("its header promises points of more than {} bytes each", most_row_bytes);
            header_.row_bytes += sizes_[field] * counts_[field];
            header_.row_numbers += counts_[field];
        }
        // Old files have POINTS instead of WIDTH and HEIGHT.
        if (header_.width == 0 && promised_) header_.width = *promised_;
        require_countable(header_.width, "points");
        require_countable(header_.height, "points");
        header_.points = header_.width * header_.height;
        require_countable(header_.points, "points");
        if (promised_ && *promised_ != header_.points)
            throw Error("its header promises {}, but WIDTH × HEIGHT is {} × {}",
                        count_text(*promised_, "point", "points"), header_.width, header_.height);
        if (padded_ && header_.encoding == PcdHeader::Encoding::compressed)
            throw Error("its compressed points have padding (the field _), which PCL does not read correctly")
                .hint("save it as binary or ascii");
        if (header_.points == 0 || header_.row_bytes == 0) throw Error("holds no points");
        require_room();
    }

    void require_room() {
        const u64 left = bytes_.size() - header_.body;
        const u64 promised = header_.points * header_.row_bytes;
        const auto require = [&](bool fits) {
            if (!fits)
                throw Error("its header promises {} of {}; {} it", count_text(header_.points, "point", "points"),
                            count_text(header_.row_bytes, "byte", "bytes"),
                            count_text(left, "byte follows", "bytes follow"))
                    .hint("the file is truncated or its header is wrong: fetch or export it again");
        };
        switch (header_.encoding) {
            case PcdHeader::Encoding::ascii: require((left + 1) / 2 >= header_.points * header_.row_numbers); break;
            case PcdHeader::Encoding::binary:
                require(left >= promised);
                header_.bytes_behind = without_padding(left - promised);
                break;
            case PcdHeader::Encoding::compressed: {
                constexpr u64 best_ratio = 264;  // LZF expands three bytes to at most 264
                std::array<std::uint32_t, 2> sizes{};
                require(left >= sizeof sizes);
                std::memcpy(sizes.data(), bytes_.data() + header_.body, sizeof sizes);
                require(left - sizeof sizes >= sizes[0]);
                header_.bytes_behind = without_padding(left - sizeof sizes - sizes[0]);
                if (sizes[1] != promised || promised > best_ratio * sizes[0])
                    throw Error("its header promises {} of {}; the compressed block declares {} in {} compressed bytes",
                                count_text(header_.points, "point", "points"),
                                count_text(header_.row_bytes, "byte", "bytes"), count_text(sizes[1], "byte", "bytes"),
                                sizes[0])
                        .hint("the file is damaged: fetch or export it again");
            }
        }
    }

    /// The number of bytes after the points, without zeros: PCL's own writer fills the last page of the file with
    /// zeros.
    u64 without_padding(u64 behind) const {
        const bool is_padding = bytes_.substr(bytes_.size() - behind).find_first_not_of('\0') == std::string_view::npos;
        return is_padding ? 0 : behind;
    }

    std::string_view bytes_, text_;
    std::vector<std::string_view> words_;
    std::size_t at_ = 0, line_ = 0;
    PcdHeader header_;
    std::size_t fields_ = 0;
    bool padded_ = false;
    std::vector<u64> sizes_, counts_;
    std::optional<u64> promised_;
};

}  // namespace

PcdHeader checked_header(std::string_view bytes) { return HeaderParser(bytes).header(); }

std::string_view name_of(PcdHeader::Encoding encoding) { return encodings[static_cast<std::size_t>(encoding)]; }

std::optional<ScalarType> scalar_type(std::uint8_t datatype) {
    for (const auto& [ours, theirs] : types)
        if (theirs == datatype) return ours;
    return std::nullopt;
}

std::uint8_t datatype(ScalarType type) {
    return std::ranges::find(types, type, &std::pair<ScalarType, PCLPointField::PointFieldTypes>::first)->second;
}

}  // namespace scanmill::pcd
