// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What runner and worker say to each other, as bytes: CBOR.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "scanmill/filter/error.hpp"

namespace scanmill {

std::string bytes_of(const nlohmann::json& json);

/// Throws Error of a message that is no CBOR, or that nests deeper than any message of ours: it would exhaust the
/// stack.
nlohmann::json json_of(std::string_view message);

/// Runs `read` over the message; whatever is not as it should be becomes an Error.
template <class Read>
auto read_message(std::string_view message, Read&& read) {
    try {
        return read(json_of(message));
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw Error("a message between runner and worker cannot be understood: {}", error.what());
    }
}

}  // namespace scanmill
