// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

Recognition recognise(std::string_view head, u64) {
    const std::string_view text = without_byte_order_mark(head);
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const bool is_object = first != std::string_view::npos && text[first] == '{';
    return is_object && text.find("\"scanmill\"") != std::string_view::npos ? Recognition::plausible : Recognition::no;
}

LoadedFile read(const FileBytes& file, const ReadOptions& options) {
    const Json document = parse_document(without_byte_order_mark(file.bytes));
    std::vector<std::string> members;
    for (const Kind kind : all_kinds()) {
        if (!kind.has_json()) continue;
        members.push_back(fmt::format("'{}' ({})", kind.info().json_member, kind.name()));
        if (!document.is_object() || !document.contains(kind.info().json_member)) continue;
        Value value(kind, kind.info().from_json(
                              document, options.on_warning ? options.on_warning : [](std::string) {}));
        if (std::optional<Frame> frame = frame_of(value); frame && options.unit != LengthUnit::unknown) {
            frame->unit = chosen_unit(frame->unit, options);
            value = reframed(value, *frame);
        }
        return {std::move(value), "JSON", "text", {}};
    }
    throw Error("is JSON without a member that names its kind; expected one of {}", fmt::join(members, ", "))
        .hint("scans are read from point and mesh files, such as PLY");
}

void write(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    if (const std::optional<Frame> frame = frame_of(value))
        warn_lost_precision(*frame, positions_of(value).span(), false, "JSON", options);
    Json document;
    value.kind().info().to_json(value.object(), document);
    // A frame's name may be any bytes; invalid UTF-8 is replaced.
    out.text(document.dump(2, ' ', false, Json::error_handler_t::replace));
    out.text("\n");
}

}  // namespace

Format json_format() {
    Format json{"JSON", {"json"}, recognise, read, {}};
    for (const Kind kind : all_kinds())
        if (kind.has_json()) json.writers.emplace_back(kind, write);
    return json;
}

}  // namespace scanmill
