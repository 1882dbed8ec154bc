// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/error_output.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/io/memory.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::string from, to;
    LengthUnit unit = LengthUnit::unknown, to_unit = LengthUnit::unknown;
    bool drop_invalid = false;
};

template <class T>
Value warn_dropped(Cleaned<T> cleaned) {
    if (cleaned.points > 0)
        print_warning(count_text(cleaned.points, "point", "points") +
                      " with a NaN, infinite or too distant coordinate " + (cleaned.points == 1 ? "was" : "were") +
                      " left out" +
                      (cleaned.triangles > 0 ? ", and " + count_text(cleaned.triangles, "triangle", "triangles") +
                                                   " on " + (cleaned.points == 1 ? "it" : "them")
                                             : ""));
    return std::make_shared<const T>(std::move(cleaned.result));
}

Value without_invalid(const Value& value) {
    if (const auto* mesh = value.find<TriangleMesh>()) return warn_dropped(without_invalid_points(*mesh));
    if (const auto* cloud = value.find<PointCloud>()) return warn_dropped(without_invalid_points(*cloud));
    throw Error("--drop-invalid needs points or a mesh; the input contains {}", name_of(value.kind()));
}

/// Converts the file, or the view of a file, that `from` names.
void convert_one(const Options& options, const std::filesystem::path& from, const std::filesystem::path& to) {
    ReadOptions read;
    WriteOptions write;
    read.on_warning = write.on_warning = warning_printer();
    read.unit = options.unit;
    if (std::error_code absent; std::filesystem::equivalent(file_view(from).file, to, absent))
        throw Error("'{}' is the input; the output must not replace it", to.string());
    require_memory_to_read(from, available_memory());
    Value value = read_file(from, read).value;
    if (options.drop_invalid) value = without_invalid(value);
    if (options.to_unit != LengthUnit::unknown) {
        const std::optional<Frame> frame = frame_of(value);
        if (!frame)
            throw Error("--to-unit converts values with positions; the input contains {}", name_of(value.kind()));
        if (frame->unit == LengthUnit::unknown)
            throw Error("--to-unit {}: the unit of the input is not known", symbol(options.to_unit))
                .hint("give it with --unit");
        value = in_unit(value, options.to_unit);
    }
    write_file(to, value, write);
}

int convert(const Options& options) {
    try {
        const std::filesystem::path to = options.to;
        const u32 views = file_view(options.from).view > 0 ? 1 : count_views(options.from);
        for (u32 view = 1; view <= views && views > 1; ++view) {
            const std::filesystem::path file =
                to.parent_path() / fmt::format("{}-{}{}", to.stem().string(), view, to.extension().string());
            convert_one(options, view_name(options.from, view), file);
            print_stderr("wrote '{}'\n", printable_line(file.string()));
        }
        if (views == 1) convert_one(options, options.from, to);
    } catch (const Error& error) {
        print(error, false);
        return some_failed;
    }
    return done;
}

}  // namespace

void add_convert(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<Options>(
        app, chosen, "convert", "Writes a scan or mesh in the format of the output's extension", convert);
    command.add_option("FROM", options.from, "The file to read; FILE#2 is the second view of a file with several")
        ->required();
    command
        .add_option("TO", options.to,
                    "The file to write; for a FROM with several views, TO-1, TO-2, … before the extension")
        ->required();
    add_unit_option(command, "--unit", options.unit, "The input's unit of length");
    add_unit_option(command, "--to-unit", options.to_unit, "Convert the coordinates to this unit");
    command.add_flag("--drop-invalid", options.drop_invalid,
                     "Leave out points with a NaN or infinite coordinate, and their faces. Also leave out points of a "
                     "point file that are too distant for the supported range");
}

}  // namespace scanmill::runner
