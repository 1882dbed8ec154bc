// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/format.hpp"

#include <algorithm>
#include <cctype>

namespace scanmill {

std::string plain_extension(std::string_view extension) {
    if (extension.starts_with('.')) extension.remove_prefix(1);
    std::string plain(extension);
    for (char& c : plain) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return plain;
}

bool Format::has_extension(std::string_view extension) const {
    return std::ranges::find(extensions, plain_extension(extension)) != extensions.end();
}

Format::Write Format::writer(Kind kind) const {
    for (const auto& [written, write] : writers)
        if (written == kind) return write;
    return {};
}

}  // namespace scanmill
