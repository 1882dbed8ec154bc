// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/workflow_file.hpp"

#include <fstream>

#include "scanmill/filter/error.hpp"

namespace scanmill {

std::string read_workflow_file(const std::filesystem::path& file) {
    constexpr std::size_t largest = 16u << 20;
    std::error_code trouble;
    if (std::filesystem::is_directory(file, trouble))
        throw Error("'{}' is a folder; expected a workflow file", file.string());
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error("'{}' cannot be opened; expected a workflow file", file.string());
    std::string text, block(1u << 16, '\0');
    while (stream.read(block.data(), static_cast<std::streamsize>(block.size())), stream.gcount() > 0) {
        text.append(block, 0, static_cast<std::size_t>(stream.gcount()));
        if (text.size() > largest)
            throw Error("'{}' has more than {} bytes, the most that a workflow may have", file.string(), largest);
    }
    return text;
}

}  // namespace scanmill
