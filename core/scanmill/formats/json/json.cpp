// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/json/json.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/io/output_buffer.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

Recognition recognise_json(std::string_view head, u64) {
    const std::string_view text = without_byte_order_mark(head);
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const bool is_object = first != std::string_view::npos && text[first] == '{';
    return is_object && text.find("\"scanmill\"") != std::string_view::npos ? Recognition::plausible : Recognition::no;
}

LoadedFile read_json(const FileBytes& file, const ReadOptions& options) {
    const Json document = parse_document(without_byte_order_mark(file.bytes));
    for (const Kind kind : all_kinds()) {
        if (!kind.has_json() || !document.is_object() || !document.contains(kind.info().json_member)) continue;
        Value value(kind, kind.info().from_json(
                              document, options.on_warning ? options.on_warning : [](std::string) {}));
        if (std::optional<Frame> frame = frame_of(value); frame && options.unit != LengthUnit::unknown) {
            if (frame->unit != LengthUnit::unknown && frame->unit != options.unit)
                warn(options.on_warning, "the file declares 'unit {}'; it was read in {}, as requested",
                     symbol(frame->unit), symbol(options.unit));
            frame->unit = options.unit;
            value = reframed(value, *frame);
        }
        return {std::move(value), "JSON", "text", {}};
    }
    std::string members;
    for (const Kind kind : all_kinds())
        if (kind.has_json())
            members += fmt::format("{}'{}' ({})", members.empty() ? "" : ", ", kind.info().json_member, kind.name());
    throw Error("is JSON without a member that names its kind; expected one of {}", members)
        .hint("scans are read from point and mesh files, such as PLY");
}

void write_json(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    if (const std::optional<Frame> frame = frame_of(value))
        warn_lost_precision(*frame, positions_of(value).span(), false, "JSON", options);
    Json document;
    value.kind().info().to_json(value.object(), document);
    // A frame's name may be any bytes; those that are not UTF-8 are replaced.
    out.text(document.dump(2, ' ', false, Json::error_handler_t::replace));
    out.text("\n");
}

}  // namespace scanmill
