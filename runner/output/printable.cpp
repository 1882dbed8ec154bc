// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/printable.hpp"

#include <algorithm>

namespace scanmill::runner {

namespace {

bool is_control(unsigned char c) { return c < ' ' || c == 0x7f; }

}  // namespace

std::string printable(std::string text) {
    std::ranges::replace_if(
        text, [](char c) { return is_control(static_cast<unsigned char>(c)) && c != '\n'; }, '?');
    return text;
}

std::string printable_line(std::string text) {
    std::ranges::replace_if(
        text, [](char c) { return is_control(static_cast<unsigned char>(c)); }, '?');
    return text;
}

}  // namespace scanmill::runner
