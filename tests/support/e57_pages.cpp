// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/e57_pages.hpp"

#include <cstdint>

namespace scanmill::test {

namespace {

constexpr std::size_t page_size = 1024, page_content = 1020;

/// CRC-32C.
std::uint32_t checksum(std::string_view bytes) {
    std::uint32_t crc = 0xffffffffu;
    for (const char byte : bytes) {
        crc ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0x82f63b78u : 0);
    }
    return ~crc;
}

}  // namespace

std::string e57_content(std::string_view file) {
    std::string content;
    for (std::size_t page = 0; page < file.size(); page += page_size) content += file.substr(page, page_content);
    return content;
}

std::string e57_sealed(std::string_view content) {
    std::string file;
    for (std::size_t page = 0; page < content.size(); page += page_content) {
        std::string part(content.substr(page, page_content));
        part.resize(page_content);
        const std::uint32_t sum = checksum(part);
        file += part;
        for (int byte = 3; byte >= 0; --byte) file += static_cast<char>(sum >> 8 * byte);
    }
    return file;
}

}  // namespace scanmill::test
