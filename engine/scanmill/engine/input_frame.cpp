// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/input_frame.hpp"

#include <fmt/format.h>

namespace scanmill {

namespace {
const std::string placeholder = "{stem}";
}

void check_stem_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics) {
    for (std::size_t at = 0; (at = text.find_first_of("{}", at)) != std::string::npos; at += placeholder.size())
        if (text.compare(at, placeholder.size(), placeholder) != 0) {
            diagnostics.error(position, fmt::format("{} '{}' has a brace that is not part of {}, the only placeholder "
                                                    "that it may hold",
                                                    what, text, placeholder));
            return;
        }
}

void check_frame_template(const std::string& frame, Position position, Diagnostics& diagnostics) {
    check_stem_template(frame, "the frame", position, diagnostics);
}

std::string with_stem(std::string text, const std::filesystem::path& file) {
    const std::string stem = file.stem().string();
    for (std::size_t at = 0; (at = text.find(placeholder, at)) != std::string::npos; at += stem.size())
        text.replace(at, placeholder.size(), stem);
    return text;
}

std::string frame_of_file(std::string frame, const std::filesystem::path& file) {
    return with_stem(std::move(frame), file);
}

}  // namespace scanmill
