// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/base64.hpp"

#include <nettle/base64.h>

#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::string_view white_space = " \t\n\v\f\r";

/// Explains why Nettle refuses the text.
JsonMismatch mismatch(std::string_view text) {
    const std::string accepted = std::string(alphabet).append("=").append(white_space);
    if (const std::size_t wrong = text.find_first_not_of(accepted); wrong != std::string_view::npos)
        return {{}, fmt::format("is not base64: character {} is {}", wrong, quote(text.substr(wrong, 1)))};
    return {{},
            fmt::format("is not base64: its {} characters are not whole groups of 4 with padding only at the end",
                        text.size())};
}

}  // namespace

std::string base64_of(std::span<const std::byte> bytes) {
    std::string text(BASE64_ENCODE_RAW_LENGTH(bytes.size()), '\0');
    base64_encode_raw(text.data(), bytes.size(), reinterpret_cast<const u8*>(bytes.data()));
    return text;
}

Array<std::byte> bytes_of_base64(std::string_view text) {
    Array<std::byte> bytes(BASE64_DECODE_LENGTH(text.size()));
    base64_decode_ctx state;
    base64_decode_init(&state);
    std::size_t size = bytes.size();
    if (base64_decode_update(&state, &size, reinterpret_cast<u8*>(bytes.data()), text.size(), text.data()) == 0 ||
        base64_decode_final(&state) == 0)
        throw mismatch(text);
    bytes.resize(size);
    return bytes;
}

void require_rows(std::size_t bytes, std::size_t row) {
    if (bytes % row != 0)
        throw JsonMismatch{{}, fmt::format("holds {} bytes, which are not whole rows of {}", bytes, row)};
}

}  // namespace scanmill
