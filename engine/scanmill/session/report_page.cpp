// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/compare/tables.hpp"
#include "scanmill/kinds/base64.hpp"
#include "scanmill/workflow/ready.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view data_mark = "<script type=\"application/json\" id=\"data\">null</script>";
constexpr std::size_t few_cells = 80, few_bytes = 15'000'000, many_bytes = 40'000'000;
constexpr std::size_t most_rules = 60, most_changes = 500, most_log_lines = 50, histogram_bins = 40;

std::string content_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

template <class T>
std::string base64_of_numbers(const std::vector<T>& numbers) {
    static_assert(std::endian::native == std::endian::little);
    return base64_of(std::as_bytes(std::span(numbers)));
}

PageRun page_run(const RunFacts& run) {
    return {run.id, run.started, run.version, run.machine, run.threads, run.jobs, run.seconds};
}

std::string unit_of(const CellValue& value) {
    const std::string lengths = length_unit_text(value.metric, value.lengths);
    return lengths.empty() && value.metric.unit != Unit::count && value.metric.unit != Unit::number
               ? std::string(name_of(value.metric.unit))
               : lengths;
}

/// A cell as its workflow, scan and variant identify it in all runs of a batch.
using CellNames = std::tuple<std::string, std::string, std::string>;
CellNames key_of(const CellComparison& cell) { return {cell.workflow, cell.scan, cell.variant}; }

/// Makes the data of one page.
class PageMaker {
public:
    PageMaker(const fs::path& folder, RunDetails run, Comparison comparison, const FilterLibrary& library)
        : folder_(folder),
          run_(std::move(run)),
          comparison_(std::move(comparison)),
          library_(library) {
        page_.batch = comparison_.batch;
        page_.verdict = comparison_.verdict;
        page_.folder = folder.string();
        for (const Verdict verdict : all_verdicts)
            if (comparison_.count(verdict) > 0) page_.counts.emplace(name_of(verdict), comparison_.count(verdict));
        page_.run = page_run(comparison_.run);
        if (comparison_.accepted) page_.accepted = page_run(*comparison_.accepted);
        if (const auto& acceptance = comparison_.acceptance)
            page_.acceptance = KnownDoubts{acceptance->who, acceptance->why, acceptance->at};
        for (auto& [name, text] : facts_of(comparison_)) page_.facts.push_back({name, text});
        page_.default_metric = default_metric(comparison_);
        for (const std::vector<std::string>& row : rule_table(comparison_, most_rules).rows)
            page_.rules.push_back({row[0], row[1], row[2], static_cast<std::size_t>(std::stoull(row[3])), row[4],
                                   row[5], static_cast<std::size_t>(std::stoull(row[6]))});
    }

    void add_cells() {
        const StepsByNode steps = steps_by_node(run_);
        std::map<CellNames, const CellRecord*> records;
        for (const CellRecord& cell : run_.cells) {
            records[{cell.workflow, cell.scan, cell.variant}] = &cell;
            by_name_[{cell.workflow, fs::path(cell.scan).filename().string(), cell.variant}].push_back(&cell);
        }
        for (const CellComparison& compared : comparison_.cells) {
            PageCell cell = page_cell(compared, page_.cells.size());
            if (const CellRecord* record = record_of(compared, records)) {
                record_of_cell_[cell.id] = record;
                add_record(cell, *record, steps);
            }
            page_.cells.push_back(std::move(cell));
        }
    }

    void add_changes() {
        for (const RankedChange& change : what_changed(comparison_)) {
            if (page_.changes.size() == most_changes) {
                page_.notes.push_back(fmt::format("the list of changes ends after {}", most_changes));
                break;
            }
            const auto cell = static_cast<std::size_t>(change.cell - comparison_.cells.data());
            PageChange listed;
            const std::vector<std::string> texts = change_texts(change);
            listed = {cell,     texts[0],
                      texts[1], texts[2],
                      texts[3], std::isfinite(change.share()) ? std::optional(change.share()) : std::nullopt,
                      texts[4], change.effect()};
            page_.changes.push_back(std::move(listed));
        }
    }

    void add_metrics() {
        std::map<std::string, std::size_t> known;
        for (const CellComparison& cell : comparison_.cells)
            for (const CellValue& value : cell.values)
                if (known.emplace(value.metric.name, page_.metrics.size()).second)
                    page_.metrics.push_back({value.metric.name, unit_of(value), better_of(value.metric.name)});
        page_.metrics.push_back({"seconds", "s", "smaller"});
        page_.metrics.push_back({"cpu-seconds", "s", "smaller"});
        page_.metrics.push_back({"memory", "bytes", "smaller"});
    }

    /// The values of the gated metrics, of the default metric and the seconds in the last runs of the batch.
    void add_trends(const RunRecords& records) {
        std::vector<RunSummary> nights;
        for (const RunSummary& run : records.runs())
            if (run.outcome && run.workflow == comparison_.batch && run.id <= comparison_.run.id) nights.push_back(run);
        if (nights.size() > most_nights) nights.erase(nights.begin(), nights.end() - most_nights);
        std::set<std::string> metrics{page_.default_metric, "seconds"};
        for (const GateRule& rule : comparison_.gate.rules)
            if (rule.metric != "outputs") metrics.insert(rule.metric);
        std::set<std::int64_t> accepted;
        for (const Acceptance& acceptance : records.acceptances())
            if (!acceptance.revoked_at) accepted.insert(acceptance.run);
        std::map<std::pair<CellNames, std::string>, std::vector<std::optional<double>>> values;
        for (std::size_t night = 0; night < nights.size(); ++night) {
            const RunSummary& run = nights[night];
            page_.runs.push_back({run.id, run.started, accepted.contains(run.id), *run.outcome});
            for (const CellComparison& cell : compare(records.run(run.id), nullptr).cells)
                for (const std::string& metric : metrics)
                    if (const auto value = number_of(cell, metric); value && std::isfinite(value->metric.value)) {
                        auto& trend = values[{key_of(cell), metric}];
                        trend.resize(nights.size());
                        trend[night] = value->metric.value;
                    }
        }
        for (const PageCell& cell : page_.cells)
            for (const std::string& metric : metrics)
                if (const auto found = values.find({{cell.workflow, cell.scan, cell.variant}, metric});
                    found != values.end())
                    page_.trends.push_back({cell.id, metric, found->second});
    }

    void add_previews(FilterLibrary& library, const PreviewSettings& settings, const RunDetails* accepted,
                      const std::function<void(std::string)>& warn) {
        find_wishes(accepted);
        const std::vector<Preview> previews = make_previews(folder_, wishes_, library, settings, warn);
        std::set<std::string> reasons;
        for (std::size_t wish = 0; wish < wishes_.size(); ++wish) {
            if (!previews[wish].reason.empty() && wish_is_of_tonight_[wish]) reasons.insert(previews[wish].reason);
            for (const auto& [cell, role] : uses_[wish]) take(page_.cells[cell], role, previews[wish]);
        }
        for (const std::string& reason : reasons) page_.notes.push_back("a preview is missing: " + reason);
    }

    /// Leaves out views in 3D, and then pictures, until the data are small enough.
    PageDocument finished() {
        const std::size_t limit = page_.cells.size() <= few_cells ? few_bytes : many_bytes;
        std::size_t bytes = text_of(json_of(page_)).size();
        const auto leave_out = [&](auto& all, const auto& size_of, const std::string& one, const std::string& many) {
            std::vector<std::pair<std::size_t, std::string>> by_size;
            for (const auto& [key, item] : all) by_size.emplace_back(size_of(item), key);
            std::ranges::sort(by_size, std::greater<>());
            std::size_t count = 0;
            for (const auto& [size, key] : by_size) {
                if (bytes <= limit) break;
                all.erase(key);
                bytes -= std::min(bytes, size);
                ++count;
            }
            if (count > 0)
                page_.notes.push_back(fmt::format("{} left out, because the page would be larger than {} MB",
                                                  count_text(count, one, many), limit / 1'000'000));
        };
        leave_out(
            page_.meshes,
            [](const PageMesh& mesh) {
                return mesh.positions.size() + mesh.triangles.size() + mesh.deviation.value_or("").size();
            },
            "view in 3D is", "views in 3D are");
        leave_out(
            page_.images, [](const std::string& image) { return image.size(); }, "picture is", "pictures are");
        for (PageCell& cell : page_.cells) {
            if (cell.mesh && !page_.meshes.contains(*cell.mesh)) cell.mesh.reset();
            std::erase_if(cell.pictures, [&](const auto& picture) { return !page_.images.contains(picture.second); });
        }
        return std::move(page_);
    }

private:
    /// The record of the compared cell, whose scan may be written as a path from another folder.
    const CellRecord* record_of(const CellComparison& cell,
                                const std::map<CellNames, const CellRecord*>& records) const {
        if (const auto found = records.find(key_of(cell)); found != records.end()) return found->second;
        const auto found = by_name_.find({cell.workflow, fs::path(cell.scan).filename().string(), cell.variant});
        if (found == by_name_.end()) return nullptr;
        for (const CellRecord* record : found->second)
            if (fs::path(record->scan).lexically_normal().string().ends_with("/" + cell.scan)) return record;
        return nullptr;
    }

    PageCell page_cell(const CellComparison& compared, std::size_t id) const {
        PageCell cell;
        cell.id = id;
        cell.workflow = compared.workflow;
        cell.scan = compared.scan;
        cell.variant = compared.variant;
        cell.verdict = compared.verdict;
        cell.outcome = compared.outcome;
        cell.seconds = compared.seconds;
        cell.reasons = compared.reasons;
        cell.causes = compared.causes;
        cell.doubts = compared.doubts;
        cell.known = compared.known;
        cell.command = compared.command;
        std::map<std::pair<std::string, std::string>, const MetricChange*> changes;
        for (const MetricChange& change : compared.metrics) changes[{change.source, change.metric}] = &change;
        const bool is_compared = comparison_.accepted && compared.verdict != Verdict::is_new;
        for (const CellValue& value : compared.values) {
            PageValue shown{value.source, value.metric.name, {}, display(value.metric, value.lengths), {}};
            if (std::isfinite(value.metric.value)) shown.value = value.metric.value;
            if (const auto change = changes.find({value.source, value.metric.name}); change != changes.end()) {
                if (const auto& before = change->second->accepted)
                    shown.accepted = display(Metric{"", *before, change->second->unit}, change->second->lengths);
            } else if (is_compared) {
                shown.accepted = shown.text;
            }
            cell.values.push_back(std::move(shown));
        }
        return cell;
    }

    void add_record(PageCell& cell, const CellRecord& record, const StepsByNode& steps) const {
        cell.error = record.failure.error;
        for (const std::size_t node : record.nodes) {
            const auto found = steps.find(node);
            if (found == steps.end()) continue;
            const StepRecord& step = *found->second;
            PageStep shown{step.label,
                           step.filter,
                           step.filter_version,
                           step.effort.seconds,
                           step.effort.cpu_seconds,
                           step.effort.peak_memory,
                           std::string(name_of(step.origin)),
                           std::string(name_of(step.outcome)),
                           {}};
            for (const auto& [name, value] : step.resolved.empty() ? step.authored : step.resolved)
                shown.parameters.push_back({name, value});
            if (step.filter.empty()) shown.parameters.push_back({"file", step.file});
            cell.steps.push_back(std::move(shown));
            for (const std::string& warning : step.warnings) cell.warnings.push_back(step.label + ": " + warning);
            if (step.outcome != Outcome::failed) continue;
            const std::size_t lines = step.effort.log.size();
            for (std::size_t line = lines - std::min(lines, most_log_lines); line < lines; ++line)
                cell.log += step.effort.log[line] + "\n";
        }
        for (const OutputRecord& output : record.outputs) {
            cell.outputs.push_back(
                {output.evidence.empty() ? output.file : output.evidence, output.bytes, output.sha256});
            for (const std::string& warning : output.warnings) cell.warnings.push_back(warning);
        }
    }

    std::vector<std::string> change_texts(const RankedChange& change) const {
        Comparison one;  // change_table() writes the texts of one change
        one.cells = {*change.cell};
        CellComparison& cell = one.cells.front();
        cell.metrics.clear();
        cell.outputs.clear();
        cell.costs.clear();
        if (change.metric) cell.metrics = {*change.metric};
        if (change.output) cell.outputs = {*change.output};
        if (change.cost) cell.costs = {*change.cost};
        const ReportTable table = change_table(one, 1);
        const std::vector<std::string>& row = table.rows.at(0);
        return {row.begin() + 2, row.begin() + 7};
    }

    /// Whether smaller or larger values of the metric are better, by the first filter that declares it.
    std::optional<std::string> better_of(const std::string& metric) const {
        for (const std::string& name : library_.names())
            if (const MetricSpec* spec = library_.find(name)->metric(metric); spec && spec->better != Better::neither)
                return spec->better == Better::smaller ? "smaller" : "larger";
        return std::nullopt;
    }

    /// A file that a step of the cell reads, and whether one of its steps measures.
    struct Files {
        std::string scan, truth;
        LengthUnit unit = LengthUnit::unknown, truth_unit = LengthUnit::unknown;
    };
    /// The unit that was declared for the file; unknown: that of the file itself.
    static LengthUnit declared_unit(const StepRecord& read) {
        const auto unit = std::ranges::find(read.authored, "unit", &std::pair<std::string, std::string>::first);
        return unit == read.authored.end() ? LengthUnit::unknown
                                           : length_unit(unit->second).value_or(LengthUnit::unknown);
    }
    Files files_of(const CellRecord& record, const StepsByNode& steps) const {
        Files files;
        std::vector<std::string> read;
        LengthUnit unit = LengthUnit::unknown;  // declared for the last file that was read
        for (const std::size_t node : record.nodes) {
            const auto found = steps.find(node);
            if (found == steps.end()) continue;
            const StepRecord& step = *found->second;
            if (step.filter.empty()) {
                read.push_back(step.file);
                unit = declared_unit(step);
                if (read.size() == 1) files.unit = unit;
                continue;
            }
            const FilterSpec* spec = library_.find(step.filter);
            if (!spec || !spec->measures || read.size() < 2 || !files.truth.empty()) continue;
            files.truth = read.back();
            files.truth_unit = unit;
        }
        if (!read.empty()) files.scan = read.front();
        return files;
    }

    enum class Role { truth, scan, result, accepted };

    std::size_t wish(PreviewWish wish, bool is_of_tonight) {
        const std::string key =
            fmt::format("{}\n{}\n{}\n{}", wish.file.string(), wish.sha256, wish.truth_file, wish.camera_file);
        const auto [found, is_new] = wish_of_key_.emplace(key, wishes_.size());
        if (is_new) {
            wishes_.push_back(std::move(wish));
            wish_is_of_tonight_.push_back(is_of_tonight);
            uses_.emplace_back();
        }
        return found->second;
    }

    static const OutputRecord* mesh_of(const CellRecord& record) {
        for (const OutputRecord& output : record.outputs)
            if (output.kind == kind_name<TriangleMesh>() && (output.outcome == Outcome::ok || !output.evidence.empty()))
                return &output;
        return nullptr;
    }
    template <class T>
    static std::string kind_name() {
        return std::string(name_of(kind_of<T>()));
    }

    void find_wishes(const RunDetails* accepted) {
        const StepsByNode steps = steps_by_node(run_);
        std::map<CellNames, const CellRecord*> before;
        if (accepted)
            for (const CellRecord& cell : accepted->cells) before[{cell.workflow, cell.scan, cell.variant}] = &cell;
        for (const auto& [id, record] : record_of_cell_) {
            const Files files = files_of(*record, steps);
            const std::string camera = files.truth.empty() ? files.scan : files.truth;
            const auto result_of = [&](const OutputRecord& output) {
                return PreviewWish{output.evidence.empty() ? output.file : output.evidence,
                                   output.sha256,
                                   files.truth,
                                   camera,
                                   output.properties.unit,
                                   files.truth_unit,
                                   kind_of<TriangleMesh>()};
            };
            if (const OutputRecord* output = mesh_of(*record))
                uses_[wish(result_of(*output), true)].emplace_back(id, Role::result);
            if (const auto found = before.find({record->workflow, record->scan, record->variant});
                found != before.end())
                if (const OutputRecord* output = mesh_of(*found->second))
                    uses_[wish(result_of(*output), false)].emplace_back(id, Role::accepted);
            if (!files.scan.empty())
                uses_[wish({files.scan, "", "", camera, files.unit, files.truth_unit, std::nullopt}, true)]
                    .emplace_back(id, Role::scan);
            if (!files.truth.empty())
                uses_[wish({files.truth, "", "", files.truth, files.truth_unit, files.truth_unit, std::nullopt}, true)]
                    .emplace_back(id, Role::truth);
        }
    }

    /// The key of the image, which is added to the page. Empty if there is no such file.
    std::string image(const fs::path& file) {
        if (file.empty()) return {};
        const std::string key = file.stem().string();
        if (!page_.images.contains(key)) {
            const std::string content = content_of(file);
            if (content.empty()) return {};
            page_.images.emplace(key, "data:image/png;base64," + base64_of(std::as_bytes(std::span(content))));
        }
        return key;
    }

    void take(PageCell& cell, Role role, const Preview& preview) {
        const auto set = [&](const char* name, const fs::path& file) {
            if (std::string key = image(file); !key.empty()) cell.pictures[name] = std::move(key);
        };
        switch (role) {
            case Role::truth: return set("truth", preview.picture);
            case Role::scan: return set("scan", preview.picture);
            case Role::accepted: return set("accepted", preview.picture);
            case Role::result: break;
        }
        set("result", preview.picture);
        set("deviation", preview.deviation);
        if (preview.mesh.empty()) return;
        try {
            add_mesh(cell, preview);
        } catch (const Error& error) {
            page_.notes.push_back("a view in 3D is missing: " + error.sentence());
        }
    }

    void add_mesh(PageCell& cell, const Preview& preview) {
        const QuantisedMesh mesh = quantised(preview.mesh);
        const bool has_deviation = !mesh.deviation.empty();
        cell.mesh = preview.key;
        cell.deviation_unit = symbol(mesh.unit);
        if (has_deviation) cell.histogram = histogram(mesh, preview.scale > 0 ? preview.scale : mesh.range);
        if (page_.meshes.contains(preview.key)) return;
        PageMesh& shown = page_.meshes[preview.key];
        for (int axis = 0; axis < 3; ++axis) {
            shown.low[static_cast<std::size_t>(axis)] = mesh.low[axis];
            shown.high[static_cast<std::size_t>(axis)] = mesh.high[axis];
        }
        shown.vertices = mesh.positions.size() / 3;
        shown.positions = base64_of_numbers(mesh.positions);
        if (shown.vertices <= 65535)
            shown.triangles =
                base64_of_numbers(std::vector<std::uint16_t>(mesh.triangles.begin(), mesh.triangles.end()));
        else
            shown.triangles = base64_of_numbers(mesh.triangles);
        if (!has_deviation) return;
        shown.deviation = base64_of_numbers(mesh.deviation);
        shown.deviation_low = -mesh.range;
        shown.deviation_high = mesh.range;
    }

    /// Shares of the vertices by their deviation, from -scale to scale. The first and the last bin also count what is
    /// outside.
    static PageHistogram histogram(const QuantisedMesh& mesh, double scale) {
        PageHistogram found{-scale, scale, std::vector<double>(histogram_bins, 0.0), {}};
        const auto known = static_cast<double>(mesh.deviation.size()) -
                           static_cast<double>(std::ranges::count(mesh.deviation, QuantisedMesh::no_deviation));
        for (const std::uint16_t value : mesh.deviation) {
            if (value == QuantisedMesh::no_deviation) continue;
            const double deviation = mesh.range * (2.0 * value / (QuantisedMesh::no_deviation - 1) - 1);
            const double place = scale > 0 ? (deviation / scale + 1) / 2 * histogram_bins : histogram_bins / 2.0;
            const double bin = std::clamp(std::floor(place), 0.0, histogram_bins - 1.0);
            found.shares[static_cast<std::size_t>(bin)] += 1 / known;
        }
        return found;
    }

    fs::path folder_;
    RunDetails run_;
    Comparison comparison_;
    const FilterLibrary& library_;
    PageDocument page_;
    std::map<std::size_t, const CellRecord*> record_of_cell_;
    std::map<CellNames, std::vector<const CellRecord*>> by_name_;  // with the scan's file name
    std::vector<PreviewWish> wishes_;
    std::vector<bool> wish_is_of_tonight_;
    std::vector<std::vector<std::pair<std::size_t, Role>>> uses_;  // cells and roles by wish
    std::map<std::string, std::size_t> wish_of_key_;
};

}  // namespace

std::string page_template() {
    std::error_code ignored;
    for (const fs::path& file : shared_places("report/page.html"))
        if (fs::exists(file, ignored)) return content_of(file);
    throw Error("this program was built without the report page")
        .hint("build it where Node and npm are installed; reports as text, markdown, JUnit and JSON need no page");
}

PageDocument page_document(const RecordedRun& which, const std::optional<RecordedRun>& against,
                           const CommandFor& command, FilterLibrary& library, const PreviewSettings& settings,
                           const std::function<void(std::string)>& warn) {
    Comparison comparison = compare_recorded(which, against, command);
    const RunRecords records = RunRecords::read(which.folder / records_file);
    RunDetails run = records.run(comparison.run.id);
    std::optional<RunDetails> accepted;
    if (comparison.accepted && comparison.accepted_folder.empty()) accepted = records.run(comparison.accepted->id);
    PageMaker maker(which.folder, std::move(run), std::move(comparison), library);
    maker.add_cells();
    maker.add_changes();
    maker.add_metrics();
    maker.add_trends(records);
    maker.add_previews(library, settings, accepted ? &*accepted : nullptr, warn);
    return maker.finished();
}

bool is_report_page(std::string_view text) {
    return text.find(data_mark.substr(0, data_mark.find("null"))) != std::string_view::npos;
}

std::string page_with(std::string page, const PageDocument& document) {
    const std::size_t at = page.find(data_mark);
    if (at == std::string::npos)
        throw Error("the report page of this program has no place for data").hint("build the program again");
    Json json{{"scanmill", 1}};
    json.update(json_of(document));
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    // An HTML parser ends the element at "</", and "<!--" changes how it reads the rest.
    std::string escaped;
    escaped.reserve(text.size());
    for (const char c : text) c == '<' ? escaped += "\\u003c" : escaped += c;
    const std::size_t place = at + data_mark.find("null");
    return page.replace(place, 4, escaped);
}

}  // namespace scanmill
