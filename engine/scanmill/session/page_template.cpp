// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/page_template.hpp"

#include <fstream>
#include <iterator>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/base64.hpp"
#include "scanmill/workflow/ready.hpp"

namespace scanmill {

namespace fs = std::filesystem;

static constexpr std::string_view data_mark = "<script type=\"application/json\" id=\"data\">null</script>";

static std::string content_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The file of the template; empty if the program was built without it.
static fs::path template_file(const std::string& name) {
    std::error_code ignored;
    for (fs::path& file : shared_places("report/" + name))
        if (fs::exists(file, ignored)) return std::move(file);
    return {};
}

bool has_page_template(const std::string& name) { return !template_file(name).empty(); }

std::string page_template(const std::string& name) {
    if (const fs::path file = template_file(name); !file.empty()) return content_of(file);
    throw Error("this program was built without the report page")
        .hint("build it where Node and npm are installed; reports as text, markdown, JUnit and JSON need no page");
}

bool is_page(std::string_view text) {
    return text.find(data_mark.substr(0, data_mark.find("null"))) != std::string_view::npos;
}

std::string page_with(std::string page, const Json& data) {
    const std::size_t at = page.find(data_mark);
    if (at == std::string::npos)
        throw Error("the report page of this program has no place for data").hint("build the program again");
    Json json{{"scanmill", 1}};
    json.update(data);
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    // An HTML parser ends the element at "</", and "<!--" changes how it reads the rest.
    std::string escaped;
    escaped.reserve(text.size());
    for (const char c : text) c == '<' ? escaped += "\\u003c" : escaped += c;
    return page.replace(at + data_mark.find("null"), 4, escaped);
}

std::string image_address(const fs::path& file) {
    const std::string content = file.empty() ? "" : content_of(file);
    return content.empty() ? "" : "data:image/png;base64," + base64_of(std::as_bytes(std::span(content)));
}

}  // namespace scanmill
