// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/column_names.hpp"

#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

namespace {

/// The length of the UTF-8 character that the text begins with; 0 when it begins with none (RFC 3629: the shortest
/// form only, no surrogates, nothing above U+10FFFF).
std::size_t character_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xbf) {
        return byte(i) >= low && byte(i) <= high;
    };
    const unsigned first = byte(0);
    if (first < 0x80) return first >= ' ' && first != 0x7f ? 1 : 0;
    if (first >= 0xc2 && first <= 0xdf) return follows(1) ? 2 : 0;
    if (first >= 0xe0 && first <= 0xef) {
        const bool is_second = follows(1, first == 0xe0 ? 0xa0 : 0x80, first == 0xed ? 0x9f : 0xbf);
        // U+FFFE and U+FFFF are no characters, and XML refuses them.
        const bool is_none = first == 0xef && byte(1) == 0xbf && byte(2) >= 0xbe;
        return is_second && follows(2) && !is_none ? 3 : 0;
    }
    if (first >= 0xf0 && first <= 0xf4) {
        const bool is_second = follows(1, first == 0xf0 ? 0x90 : 0x80, first == 0xf4 ? 0x8f : 0xbf);
        return is_second && follows(2) && follows(3) ? 4 : 0;
    }
    return 0;
}

}  // namespace

std::string valid_text(std::string_view text) {
    std::string valid;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        if (length == 0)
            valid += '_';
        else
            valid += text.substr(0, length);
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return valid;
}

WrittenNames::WrittenNames(std::string_view format, const WriteOptions& options, std::set<std::string> taken)
    : format_(format),
      options_(&options),
      taken_(std::move(taken)) {}

std::string WrittenNames::add(std::string_view column, std::string wanted, std::string_view expected) {
    while (!taken_.insert(wanted).second) wanted += "_2";
    if (wanted != expected)
        warn(options_->on_warning, "{} holds the column '{}' under the name '{}'", format_, column, wanted);
    return wanted;
}

}  // namespace scanmill
