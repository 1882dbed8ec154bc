// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The templates of pages, and how data are put into them.

#include <filesystem>
#include <string>
#include <string_view>

#include "scanmill/record/json.hpp"

namespace scanmill {

/// Whether the program was built with this template.
bool has_page_template(const std::string& name);

/// The template with this file name. Throws Error if the program was built without it.
std::string page_template(const std::string& name);

/// Whether the text is a page that was made of a template.
bool is_page(std::string_view text);

/// The page with these data, which are the JSON of a described struct. Pre: `page` is a page_template().
std::string page_with(std::string page, const Json& data);

/// The picture as an address that has its bytes; empty if the file cannot be read.
std::string image_address(const std::filesystem::path& file);

}  // namespace scanmill
