// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/input_frame.hpp"

#include <fmt/format.h>

namespace scanmill {

namespace {
const std::string placeholder = "{stem}";
}

void check_frame_template(const std::string& frame, Position position, Diagnostics& diagnostics) {
    for (std::size_t at = 0; (at = frame.find_first_of("{}", at)) != std::string::npos; at += placeholder.size())
        if (frame.compare(at, placeholder.size(), placeholder) != 0) {
            diagnostics.error(position, fmt::format("the frame '{}' has a brace that is not part of {}, the only "
                                                    "placeholder in a frame's name",
                                                    frame, placeholder));
            return;
        }
}

std::string frame_of_file(std::string frame, const std::filesystem::path& file) {
    const std::string stem = file.stem().string();
    for (std::size_t at = 0; (at = frame.find(placeholder, at)) != std::string::npos; at += stem.size())
        frame.replace(at, placeholder.size(), stem);
    return frame;
}

}  // namespace scanmill
