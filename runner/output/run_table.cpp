// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/run_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "output/step_names.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/compare/tables.hpp"
#include "scanmill/graph/output_files.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::runner {

namespace {

constexpr std::size_t most_columns = 100, most_rows = 50;

/// What a number says about the result of a cell, the most important first.
enum class Rank {
    property,     ///< of the mesh that the last geometric step wrote
    measurement,  ///< by a later step
    own,          ///< a metric of the last geometric step
    earlier,      ///< of another step or of the scan
};

/// A number in the row of a cell. The steps of a cell may have different units of lengths.
struct ShownNumber {
    std::string step;  ///< empty for a number of the scan
    Metric metric;
    LengthUnit lengths = LengthUnit::unknown;
    Rank rank = Rank::earlier;
};
using ShownNumbers = std::vector<ShownNumber>;

/// Replaces an earlier number of the same step and name.
void set(ShownNumbers& numbers, ShownNumber number) {
    const auto found = std::ranges::find_if(numbers, [&](const ShownNumber& one) {
        return one.step == number.step && one.metric.name == number.metric.name;
    });
    if (found == numbers.end())
        numbers.push_back(std::move(number));
    else
        *found = std::move(number);
}

/// The node of the last step whose first output is geometric; empty if the cell has no such step. A step that draws or
/// measures has another kind of output.
std::optional<std::size_t> result_node(const RunGraph& graph, const RunCell& cell) {
    for (auto node = cell.nodes.rbegin(); node != cell.nodes.rend(); ++node)
        if (const PlannedStep* step = graph.step(graph.nodes[*node]);
            step && is_geometric(step->spec.outputs.front().kind))
            return *node;
    return std::nullopt;
}

/// The numbers of a cell in the order of its steps.
ShownNumbers numbers_of(const RunGraph& graph, const RunReport& report, std::size_t index) {
    const RunCell& cell = graph.cells[index];
    const std::optional<std::size_t> result = result_node(graph, cell);
    ShownNumbers shown;
    Metrics read;
    bool is_after_result = false;
    for (const std::size_t node : cell.nodes) {
        const NodeReport& done = report.nodes[node];
        const PlannedStep* step = graph.step(graph.nodes[node]);
        if (!step) {
            if (!graph.nodes[node].is_scan) continue;
            for (const Metric& property : done.properties.values) {  // the counts of a list's scans are added up
                const Metric* before = read.find(property.name);
                read.set(property.name, property.value + (before ? before->value : 0), property.unit);
                set(shown, {"", *read.find(property.name), done.properties.unit, Rank::earlier});
            }
            continue;
        }
        const Rank rank = node == result ? Rank::own : is_after_result ? Rank::measurement : Rank::earlier;
        is_after_result = is_after_result || node == result;
        for (const MetricSpec& metric : step->spec.metrics)
            if (const Metric* found = done.metrics.find(metric.name); metric.headline && found)
                set(shown, {graph.label(graph.nodes[node]), *found, done.metrics.unit, rank});
    }
    const auto node_of = [&](const OutputReport& output) {
        const auto found = std::ranges::find(cell.outputs, output.file, &RunOutput::file);
        return found == cell.outputs.end() ? std::nullopt : std::optional(found->node);
    };
    // The mesh of the result, or else the first mesh.
    const OutputReport* mesh = nullptr;
    for (const OutputReport& output : report.cells[index].outputs)
        if (output.kind == kind_of<TriangleMesh>() && (output.outcome == Outcome::ok || !output.evidence.empty()) &&
            (!mesh || (node_of(output) == result && node_of(*mesh) != result)))
            mesh = &output;
    if (!mesh) return shown;
    const std::optional<std::size_t> made = node_of(*mesh);
    const std::string step = made && graph.step(graph.nodes[*made]) ? graph.label(graph.nodes[*made]) : "";
    for (const std::string_view name : {"triangles", "closed", "genus"})
        if (const Metric* property = mesh->properties.find(name))
            set(shown, {step, *property, mesh->properties.unit, made == result ? Rank::property : Rank::earlier});
    return shown;
}

/// A column of numbers. A unit that all values of the column share is written in its header, any other in the cells.
struct NumberColumn {
    std::string step, name, header;  ///< `step` is empty if the column has the numbers of different steps
    Rank rank = Rank::earlier;
    bool is_by_step = false, has_several_units = false;

    const ShownNumber* number_in(const ShownNumbers& numbers) const {
        const auto found = std::ranges::find_if(numbers, [&](const ShownNumber& one) {
            return one.metric.name == name && (!is_by_step || one.step == step);
        });
        return found == numbers.end() ? nullptr : &*found;
    }
    std::string text(const ShownNumbers& numbers) const {
        const ShownNumber* number = number_in(numbers);
        if (!number) return "-";
        return has_several_units ? display(number->metric, number->lengths) : display(number->metric);
    }
    void find_unit(const std::vector<ShownNumbers>& cells) {
        std::set<std::string> units;
        bool is_declared = false;
        for (const ShownNumbers& numbers : cells)
            if (const ShownNumber* number = number_in(numbers)) {
                units.insert(length_unit_text(number->metric, number->lengths));
                is_declared = is_declared || number->lengths != LengthUnit::unknown;
            }
        has_several_units = units.size() > 1;
        if (units.size() == 1 && is_declared && !units.begin()->empty()) header += fmt::format(" ({})", *units.begin());
    }
};

/// Names that a cell has from several steps.
std::set<std::string> repeated_names(const std::vector<ShownNumbers>& cells) {
    std::set<std::string> repeated;
    for (const ShownNumbers& numbers : cells) {
        std::set<std::string> seen;
        for (const ShownNumber& number : numbers)
            if (!seen.insert(number.metric.name).second) repeated.insert(number.metric.name);
    }
    return repeated;
}

std::vector<NumberColumn> number_columns(const std::vector<ShownNumbers>& cells) {
    const std::set<std::string> repeated = repeated_names(cells);
    std::vector<NumberColumn> columns;
    for (const ShownNumbers& numbers : cells)
        for (const ShownNumber& number : numbers) {
            const std::string& name = number.metric.name;
            const bool is_by_step = repeated.contains(name);
            const bool is_known = std::ranges::any_of(columns, [&](const NumberColumn& column) {
                return column.name == name && (!is_by_step || column.step == number.step);
            });
            if (is_known) continue;
            const std::string header = is_by_step && !number.step.empty() ? number.step + "." + name : name;
            columns.push_back({number.step, name, header, number.rank, is_by_step});
        }
    for (NumberColumn& column : columns) column.find_unit(cells);
    return columns;
}

/// The file that could not be read, if the cell failed because of it. All cells of this scan that need the file fail
/// for the same reason.
std::optional<std::size_t> unreadable_file(const RunGraph& graph, const CellReport& report) {
    const bool is_file = report.failed_node && !graph.nodes[*report.failed_node].step;
    return is_file ? report.failed_node : std::nullopt;
}

/// A row, with its first cell and the number of cells that share it.
struct Row {
    std::size_t cell, cells;
};

/// Cells of one scan that failed because of one file share a row.
std::vector<Row> rows_of(const RunGraph& graph, const RunReport& report) {
    std::vector<Row> rows;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> row_of;  // row by file and scan
    for (std::size_t cell = 0; cell < graph.cells.size(); ++cell) {
        if (const std::optional<std::size_t> file = unreadable_file(graph, report.cells[cell])) {
            const auto [row, is_new] = row_of.emplace(std::pair(*file, graph.cells[cell].scan), rows.size());
            if (!is_new) {
                ++rows[row->second].cells;
                continue;
            }
        }
        rows.push_back({cell, 1});
    }
    return rows;
}

/// The worst `most_rows` rows, in their order.
std::vector<Row> worst_of(std::vector<Row> rows, const RunReport& report) {
    if (rows.size() <= most_rows) return rows;
    std::vector<Row> worst;
    for (const Outcome outcome : {Outcome::failed, Outcome::skipped, Outcome::doubtful, Outcome::ok})
        for (const Row& row : rows)
            if (report.cells[row.cell].outcome == outcome && worst.size() < most_rows) worst.push_back(row);
    std::ranges::sort(worst, {}, &Row::cell);
    return worst;
}

std::string files_text(const CellReport& report, TableExtent extent) {
    std::vector<std::string> files;
    for (const OutputReport& output : report.outputs)
        if (output.outcome == Outcome::ok) files.push_back(shown_path(output.file));
    if (files.empty()) return "-";
    if (extent == TableExtent::everything) return fmt::format("{}", fmt::join(files, ", "));
    return files.size() == 1 ? files.front() : fmt::format("{} +{}", files.front(), files.size() - 1);
}

/// How many cells are doubtful or failed, and what became of the files.
std::string summary_text(const RunGraph& graph, const RunReport& report, std::size_t rows) {
    std::size_t doubtful = 0, failed = 0;
    std::set<std::size_t> unreadable;                               // nodes that read a file
    std::set<std::filesystem::path> evidence, moved_to, not_moved;  // variants may share a file
    for (const CellReport& done : report.cells) {
        doubtful += done.outcome == Outcome::doubtful;
        failed += done.outcome == Outcome::failed;
        if (const std::optional<std::size_t> file = unreadable_file(graph, done)) unreadable.insert(*file);
        for (const OutputReport& output : done.outputs) {
            if (!output.evidence.empty()) evidence.insert(output.evidence);
            if (!output.moved_to.empty()) moved_to.insert(output.moved_to);
            if (!output.not_moved.empty()) not_moved.insert(output.file);
        }
    }
    std::string text;
    if (doubtful > 0)
        text += fmt::format("{} of {} doubtful; the reasons are on stderr\n", doubtful, graph.cells.size());
    const std::string broken = rows < graph.cells.size() ? fmt::format(" ({} could not be read)",
                                                                       count_text(unreadable.size(), "file", "files"))
                                                         : "";
    if (failed > 0)
        text += fmt::format("{} of {} failed{}; the reasons are on stderr\n", failed, graph.cells.size(), broken);
    if (!evidence.empty())
        text +=
            fmt::format("{} written to '{}'\n", count_text(evidence.size(), "failed result was", "failed results were"),
                        shown_path(failed_folder(graph.output_folder)));
    if (!moved_to.empty())
        text += fmt::format("{} moved to *.previous, because the cells failed now\n",
                            count_text(moved_to.size(), "file of an earlier run was", "files of an earlier run were"));
    if (!not_moved.empty())
        text += fmt::format("{} could not be moved, although the cells failed now; see stderr\n",
                            count_text(not_moved.size(), "file of an earlier run", "files of an earlier run"));
    return text;
}

}  // namespace

std::string shown_path(const std::filesystem::path& file) {
    const std::string relative = std::filesystem::proximate(file).string();
    return relative.starts_with("..") ? file.string() : relative;
}

std::string run_table(const RunGraph& graph, const RunReport& report, TableExtent extent,
                      std::optional<std::size_t> width) {
    const bool is_whole = extent == TableExtent::everything;
    const std::vector<Row> all = rows_of(graph, report);
    const std::vector<Row> rows = is_whole ? all : worst_of(all, report);
    std::vector<ShownNumbers> numbers;  // by row
    for (const Row& row : rows) {
        numbers.push_back(numbers_of(graph, report, row.cell));
        if (is_whole) continue;
        std::erase_if(numbers.back(), [](const ShownNumber& number) { return number.rank == Rank::earlier; });
        std::ranges::stable_sort(numbers.back(), {}, &ShownNumber::rank);
    }
    std::vector<NumberColumn> columns = number_columns(numbers);
    if (!is_whole) std::ranges::stable_sort(columns, {}, &NumberColumn::rank);

    const bool several_workflows = has_several_workflows(graph), several_variants = has_several_variants(graph);
    std::vector<std::string> headers{"scan"};
    if (several_workflows) headers.emplace_back("workflow");
    if (several_variants) headers.emplace_back("variant");
    headers.emplace_back("outcome");
    for (const NumberColumn& column : columns) headers.push_back(column.header);
    headers.insert(headers.end(), {"seconds", "files"});
    Table table(headers);
    if (!is_whole) {
        for (const char* name : {"scan", "files"}) table.may_cut(name);
        if (several_variants) {  // the names of files repeat those of the variants
            table.may_cut("variant", 44);
            table.may_leave_out("files");
        }
        for (auto column = columns.rbegin(); column != columns.rend(); ++column) table.may_leave_out(column->header);
        table.may_leave_out("seconds");
        if (!several_variants) table.may_leave_out("files");
    }
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const auto [cell, cells] = rows[row];
        const CellReport& done = report.cells[cell];
        std::vector<std::string> texts{
            std::filesystem::path(graph.scan_names[graph.cells[cell].scan]).filename().string()};
        if (several_workflows) texts.push_back(cells > 1 ? "-" : graph.workflow(graph.cells[cell]));
        if (several_variants) texts.push_back(cells > 1 ? "-" : graph.variant(graph.cells[cell]).name);
        texts.emplace_back(name_of(done.outcome));
        for (const NumberColumn& column : columns) texts.push_back(column.text(numbers[row]));
        texts.push_back(fmt::format("{:.2f}", done.seconds));
        texts.push_back(files_text(done, extent));
        table.add(std::move(texts));
    }
    if (is_whole) return table.text() + summary_text(graph, report, all.size());
    const FittedTable fitted = table.fitted(std::min(width.value_or(most_columns), most_columns));
    std::string text = fitted.text;
    if (rows.size() < all.size())
        text +=
            fmt::format("and {}; --wide prints all\n", count_text(all.size() - rows.size(), "more cell", "more cells"));
    if (fitted.left_out > 0)
        text += fmt::format("{} left out; --wide prints all\n", count_text(fitted.left_out, "column", "columns"));
    return text + summary_text(graph, report, all.size());
}

}  // namespace scanmill::runner
