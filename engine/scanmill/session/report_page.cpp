// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/compare/tables.hpp"
#include "scanmill/kinds/base64.hpp"
#include "scanmill/session/cell_files.hpp"
#include "scanmill/session/inspections.hpp"
#include "scanmill/session/page_template.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t few_cells = 80, few_bytes = 15'000'000, many_bytes = 40'000'000;
constexpr std::size_t most_rules = 60, most_changes = 500, most_log_lines = 50, histogram_bins = 40;

template <class T>
std::string base64_of_numbers(const std::vector<T>& numbers) {
    static_assert(std::endian::native == std::endian::little);
    return base64_of(std::as_bytes(std::span(numbers)));
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

/// The indices of the `most` cells with the worst verdicts, of equal ones the first, in the order of the cells.
std::vector<std::size_t> most_important(const std::vector<CellComparison>& cells, std::size_t most) {
    std::vector<std::size_t> chosen(cells.size());
    std::iota(chosen.begin(), chosen.end(), 0u);
    std::ranges::stable_sort(chosen, {}, [&](std::size_t cell) { return cells[cell].verdict; });
    chosen.resize(std::min(most, chosen.size()));
    std::ranges::sort(chosen);
    return chosen;
}

/// Makes the data of one page.
class PageMaker {
public:
    PageMaker(const fs::path& folder, RunDetails run, Comparison comparison, const FilterLibrary& library)
        : folder_(folder),
          run_(std::move(run)),
          comparison_(std::move(comparison)),
          library_(library),
          steps_(steps_by_node(run_)) {
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

    /// Removes the cells for which the page has no room, after the facts about all cells were added.
    void limit_cells(std::size_t most) {
        const std::size_t all = comparison_.cells.size();
        if (all <= most) return;
        std::vector<CellComparison> kept;
        for (const std::size_t cell : most_important(comparison_.cells, most))
            kept.push_back(std::move(comparison_.cells[cell]));
        comparison_.cells = std::move(kept);
        page_.notes.push_back(
            fmt::format("the page shows {} of {} cells, those with the worst verdicts; counts and rules "
                        "are those of all cells, changes those of the shown ones",
                        most, all));
    }

    void add_cells() {
        const CellRecords records(run_);
        for (const CellComparison& compared : comparison_.cells) {
            PageCell cell = page_cell(compared, page_.cells.size());
            if (const CellRecord* record = records.of(compared)) {
                record_of_cell_[cell.id] = record;
                add_record(cell, *record);
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
        std::set<CellNames> shown;
        for (const CellComparison& cell : comparison_.cells) shown.insert(key_of(cell));
        std::map<std::pair<CellNames, std::string>, std::vector<std::optional<double>>> values;
        for (std::size_t night = 0; night < nights.size(); ++night) {
            const RunSummary& run = nights[night];
            page_.runs.push_back({run.id, run.started, accepted.contains(run.id), *run.outcome});
            for (const CellComparison& cell : compare(records.run(run.id), nullptr).cells) {
                if (!shown.contains(key_of(cell))) continue;
                for (const std::string& metric : metrics)
                    if (const auto value = number_of(cell, metric); value && std::isfinite(value->metric.value)) {
                        auto& trend = values[{key_of(cell), metric}];
                        trend.resize(nights.size());
                        trend[night] = value->metric.value;
                    }
            }
        }
        for (const PageCell& cell : page_.cells)
            for (const std::string& metric : metrics)
                if (const auto found = values.find({{cell.workflow, cell.scan, cell.variant}, metric});
                    found != values.end())
                    page_.trends.push_back({cell.id, metric, found->second});
    }

    void add_previews(FilterLibrary& library, const PreviewSettings& settings, const RunDetails* accepted,
                      const std::function<void(std::string)>& warn, std::size_t most) {
        find_wishes(accepted, most_important(comparison_.cells, most));
        if (comparison_.cells.size() > most)
            page_.notes.push_back(fmt::format("{} of {} cells have pictures, those with the worst verdicts", most,
                                              comparison_.cells.size()));
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

    void add_record(PageCell& cell, const CellRecord& record) const {
        cell.error = record.failure.error;
        cell.inspection = page_inspection(CellFiles(record, steps_, library_).inspection());
        if (cell.inspection) {
            cell.histogram = cell.inspection->histogram;
            cell.deviation_unit = cell.inspection->unit;
        }
        for (const std::size_t node : record.nodes) {
            const auto found = steps_.find(node);
            if (found == steps_.end()) continue;
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
            cell.outputs.push_back({path_of(output), output.bytes, output.sha256});
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

    enum class Role { truth, scan, result, accepted };

    std::size_t wish(PreviewWish wish, bool is_of_tonight) {
        const std::string key = fmt::format("{}\n{}\n{}\n{}\n{}\n{}", wish.file.string(), wish.sha256, wish.truth_file,
                                            wish.camera_file, symbol(wish.unit), wish.kind ? name_of(*wish.kind) : "");
        const auto [found, is_new] = wish_of_key_.emplace(key, wishes_.size());
        if (is_new) {
            wishes_.push_back(std::move(wish));
            wish_is_of_tonight_.push_back(is_of_tonight);
            uses_.emplace_back();
        }
        return found->second;
    }

    /// The wish for the output with the deviations of an inspected part, or else for the result.
    std::optional<PreviewWish> wish_for(const CellRecord& record, const StepsByNode& steps,
                                        const std::string& base) const {
        const CellFiles files(record, steps, library_, base);
        const CellFile truth = files.truth();
        const InspectionStep inspection = files.inspection();
        const OutputRecord* map =
            inspection && !inspection.step->metrics.values.empty() ? files.deviation_map(inspection) : nullptr;
        const OutputRecord* output = map ? map : files.mesh();
        if (!output) return std::nullopt;
        PreviewWish wish;
        wish.file = path_of(*output);
        wish.sha256 = output->sha256;
        wish.truth_file = truth.path;
        const CellFile camera = truth.path.empty() ? files.scan() : truth;
        wish.camera_file = camera.path;
        wish.unit = output->properties.unit;
        wish.truth_unit = truth.unit;
        wish.camera_unit = camera.unit;
        wish.kind = kind_named(output->kind);
        if (map) wish.deviation = inspection.deviation();
        return wish;
    }

    /// The wish for a file that the cell reads.
    static PreviewWish wish_for(const CellFile& file, const CellFile& camera) {
        PreviewWish wish;
        wish.file = file.path;
        wish.camera_file = camera.path;
        wish.unit = file.unit;
        wish.camera_unit = camera.unit;
        wish.kind.reset();
        return wish;
    }

    void find_wishes(const RunDetails* accepted, const std::vector<std::size_t>& pictured) {
        std::map<CellNames, const CellRecord*> before;
        StepsByNode steps_before;
        if (accepted) {
            steps_before = steps_by_node(*accepted);
            for (const CellRecord& cell : accepted->cells) before[{cell.workflow, cell.scan, cell.variant}] = &cell;
        }
        for (const std::size_t id : pictured) {
            const auto recorded = record_of_cell_.find(id);
            if (recorded == record_of_cell_.end()) continue;
            const CellRecord* record = recorded->second;
            const CellFiles files(*record, steps_, library_, run_.start.working_folder);
            const CellFile scan = files.scan(), truth = files.truth();
            if (std::optional<PreviewWish> result = wish_for(*record, steps_, run_.start.working_folder))
                uses_[wish(*std::move(result), true)].emplace_back(id, Role::result);
            if (const auto found = before.find({record->workflow, record->scan, record->variant});
                found != before.end())
                if (std::optional<PreviewWish> result =
                        wish_for(*found->second, steps_before, accepted->start.working_folder))
                    uses_[wish(*std::move(result), false)].emplace_back(id, Role::accepted);
            if (!scan.path.empty())
                uses_[wish(wish_for(scan, truth.path.empty() ? scan : truth), true)].emplace_back(id, Role::scan);
            if (!truth.path.empty()) uses_[wish(wish_for(truth, truth), true)].emplace_back(id, Role::truth);
        }
    }

    /// The key of the image, which is added to the page. Empty if there is no such file.
    std::string image(const fs::path& file) {
        if (file.empty()) return {};
        const std::string key = file.stem().string();
        if (!page_.images.contains(key)) {
            std::string address = image_address(file);
            if (address.empty()) return {};
            page_.images.emplace(key, std::move(address));
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
        if (has_deviation && !cell.histogram)
            cell.histogram = histogram(mesh, preview.scale > 0 ? preview.scale : mesh.range);
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
    const StepsByNode steps_;
    PageDocument page_;
    std::map<std::size_t, const CellRecord*> record_of_cell_;
    std::vector<PreviewWish> wishes_;
    std::vector<bool> wish_is_of_tonight_;
    std::vector<std::vector<std::pair<std::size_t, Role>>> uses_;  // cells and roles by wish
    std::map<std::string, std::size_t> wish_of_key_;
};

}  // namespace

PageDocument page_document(const RecordedRun& which, const std::optional<RecordedRun>& against,
                           const CommandFor& command, FilterLibrary& library, const PreviewSettings& settings,
                           const std::function<void(std::string)>& warn, const PageLimits& limits) {
    Comparison comparison = compare_recorded(which, against, command);
    const RunRecords records = RunRecords::read(which.folder / records_file);
    RunDetails run = records.run(comparison.run.id);
    std::optional<RunDetails> accepted;
    if (comparison.accepted && comparison.accepted_folder.empty()) accepted = records.run(comparison.accepted->id);
    PageMaker maker(which.folder, std::move(run), std::move(comparison), library);
    maker.limit_cells(limits.cells);
    maker.add_cells();
    maker.add_changes();
    maker.add_metrics();
    maker.add_trends(records);
    maker.add_previews(library, settings, accepted ? &*accepted : nullptr, warn, limits.pictured);
    return maker.finished();
}

}  // namespace scanmill
