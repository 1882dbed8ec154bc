// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The JSON form of long arrays: one text per array, base64 (RFC 4648, section 4) of the little-endian bytes of its
/// rows. It needs a third more characters than the array has bytes, and keeps every bit of a number.

#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "scanmill/data/array.hpp"
#include "scanmill/record/json.hpp"

namespace scanmill {

/// The base64 text of the bytes, padded, in one line.
std::string base64_of(std::span<const std::byte> bytes);

/// The bytes of a base64 text. White space between characters is ignored. Throws JsonMismatch for another character,
/// wrong padding, and unused bits that are not 0.
Array<std::byte> bytes_of_base64(std::string_view text);

/// Throws JsonMismatch if the bytes are not whole rows of `row` bytes.
void require_rows(std::size_t bytes, std::size_t row);

/// An array whose JSON form is base64. `Row` is a number, an enumeration, or an array of numbers without gaps.
template <class Row>
struct Base64 {
    Array<Row> rows;
};

template <class Row>
struct JsonForm<Base64<Row>> {
    static_assert(std::endian::native == std::endian::little, "the bytes of the rows are written as they are");

    static Json write(const Base64<Row>& value) { return base64_of(std::as_bytes(std::span(value.rows))); }
    static void read(const Json& json, Base64<Row>& value) {
        if (!json.is_string()) throw JsonMismatch{{}, "is not a base64 text"};
        const Array<std::byte> bytes = bytes_of_base64(json.get_ref<const std::string&>());
        require_rows(bytes.size(), sizeof(Row));
        value.rows.resize(bytes.size() / sizeof(Row));
        if (!bytes.empty()) std::memcpy(static_cast<void*>(value.rows.data()), bytes.data(), bytes.size());
    }
    static Json schema() {
        Json schema = schema::type("string");
        schema["contentEncoding"] = "base64";
        return schema;
    }
};

}  // namespace scanmill
