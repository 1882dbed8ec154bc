// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/regular_file.hpp"

namespace scanmill {

namespace {

/// As a part of a sentence.
const char* name_of(std::filesystem::file_type type) {
    switch (type) {
        case std::filesystem::file_type::fifo: return "a pipe";
        case std::filesystem::file_type::socket: return "a socket";
        case std::filesystem::file_type::character:
        case std::filesystem::file_type::block: return "a device";
        default: return "something unknown";
    }
}

}  // namespace

std::optional<Error> why_no_file(const std::filesystem::path& path) {
    std::error_code trouble;
    const std::filesystem::file_status status = std::filesystem::status(path, trouble);
    switch (status.type()) {
        case std::filesystem::file_type::regular: return std::nullopt;
        case std::filesystem::file_type::not_found: return Error("'{}': there is no such file", path.string());
        case std::filesystem::file_type::none:
            return Error("'{}' cannot be looked at: {}", path.string(), trouble.message());
        case std::filesystem::file_type::directory:
            return Error("'{}' is a folder, not a file", path.string())
                .hint("name one file, or several by a pattern as DIR/*.ply");
        default:
            return Error("'{}' is {}, not a file: what it gives cannot be read a second time", path.string(),
                         name_of(status.type()))
                .hint("copy what it gives into a file first, and name that");
    }
}

}  // namespace scanmill
