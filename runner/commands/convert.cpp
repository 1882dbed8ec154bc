// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands/commands.hpp"
#include "commands/load.hpp"
#include "output/error_output.hpp"
#include "output/printable.hpp"
#include "output/stderr_text.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::string from, to, unit, to_unit;
    bool drop_invalid = false;
};

template <class T>
Value warn_dropped(Cleaned<T> cleaned, const std::function<void(std::string)>& warn) {
    if (cleaned.points > 0)
        warn(count_text(cleaned.points, "point", "points") + " with a NaN or an infinity " +
             (cleaned.points == 1 ? "was" : "were") + " left out" +
             (cleaned.triangles > 0 ? ", and " + count_text(cleaned.triangles, "triangle", "triangles") + " on " +
                                          (cleaned.points == 1 ? "it" : "them")
                                    : ""));
    return std::make_shared<const T>(std::move(cleaned.result));
}

Value without_invalid(const Value& value, const std::function<void(std::string)>& warn) {
    if (const auto* mesh = value.find<TriangleMesh>()) return warn_dropped(without_invalid_points(*mesh), warn);
    return warn_dropped(without_invalid_points(*value.get<PointCloud>()), warn);
}

int convert(const Options& options) {
    const auto warn = [](const std::string& text) { tell("warning: {}\n", printable(text)); };
    const LengthUnit unit = parse_unit(options.to_unit);
    ReadOptions read;
    read.on_warning = warn;
    read.unit = parse_unit(options.unit);
    try {
        if (std::error_code absent; std::filesystem::equivalent(options.from, options.to, absent))
            throw Error("'{}' is the input; the output must not replace it", options.to);
        Value value = read_file(options.from, read).value;
        if (options.drop_invalid) value = without_invalid(value, warn);
        if (unit != LengthUnit::unknown) {
            if (frame_of(value)->unit == LengthUnit::unknown)
                throw Error("--to-unit {}: the unit of the input is not known", symbol(unit))
                    .hint("say it with --unit");
            value = in_unit(value, unit);
        }
        WriteOptions write;
        write.on_warning = warn;
        write_file(options.to, value, write);
    } catch (const Error& error) {
        print(error, false);
        return some_failed;
    }
    return done;
}

}  // namespace

void add_convert(CLI::App& app, Action& chosen) {
    CLI::App* command =
        app.add_subcommand("convert", "Writes a scan or mesh in another format; the extension says which");
    auto options = std::make_shared<Options>();
    command->add_option("FROM", options->from, "The file to read")->required();
    command->add_option("TO", options->to, "The file to write")->required();
    command->add_option("--unit", options->unit, "The input's unit of length: um, mm, cm, m, in, ft");
    command->add_option("--to-unit", options->to_unit, "Convert the coordinates to this unit");
    command->add_flag("--drop-invalid", options->drop_invalid,
                      "Leave out points with a NaN or infinite coordinate, and faces on them");
    command->callback([&chosen, options] { chosen = [options] { return convert(*options); }; });
}

}  // namespace scanmill::runner
