// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/inspection_sheet.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/session/cell_files.hpp"
#include "scanmill/session/inspections.hpp"
#include "scanmill/session/page_template.hpp"
#include "scanmill/worker/file_description.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bytes = 40'000'000, most_pictures = 2, most_drawn = 200;

std::string cell_name(const CellComparison& cell) { return fmt::format("{} [{}]", cell.scan, cell.variant); }

/// Whether `parts` names the cell. `path`: the scan as the run got it, from its working folder `base`.
bool is_named(const CellComparison& cell, const std::string& path, const fs::path& base, const std::string& parts) {
    if (parts == "." || cell.scan == parts || cell_name(cell) == parts) return true;
    fs::path wished = fs::path(parts).lexically_normal();
    if (!wished.has_filename()) wished = wished.parent_path();  // a folder with a slash at its end
    const auto is_below = [&](const fs::path& scan) {
        return scan == wished || scan.string().starts_with(wished.string() + "/");
    };
    return is_below(fs::path(cell.scan).lexically_normal()) || is_below(fs::path(path).lexically_normal()) ||
           is_below((base / path).lexically_normal());
}

/// Makes the data of sheets.
class SheetMaker {
public:
    SheetMaker(const fs::path& folder, RunDetails run, const Comparison& comparison, const FilterLibrary& library)
        : folder_(folder),
          run_(std::move(run)),
          comparison_(comparison),
          library_(library),
          steps_(steps_by_node(run_)),
          records_(run_) {
        document_.batch = comparison.batch;
        document_.folder = folder.string();
        document_.run = page_run(comparison.run);
    }

    /// Adds the sheets of the named parts.
    void add_sheets(const std::string& parts) {
        // A scan that cannot be read has no steps, but its workflow and variant inspect other parts. If no cell of the
        // run was inspected, every cell that failed or is missing may be a part.
        std::set<std::pair<std::string, std::string>> inspecting;
        for (const CellRecord& cell : run_.cells)
            if (CellFiles(cell, steps_, library_).inspection()) inspecting.emplace(cell.workflow, cell.variant);
        std::set<std::string> inspected;
        bool is_cell = false;
        for (const CellComparison& cell : comparison_.cells) {
            const CellRecord* record = records_.of(cell);
            const bool is_part = inspecting.contains({cell.workflow, cell.variant}) ||
                                 (inspecting.empty() && (!record || record->outcome >= Outcome::failed));
            const bool is_wished = is_named(cell, record ? record->scan : cell.scan, run_.start.working_folder, parts);
            if (is_part) inspected.insert(cell.scan);
            is_cell = is_cell || is_wished;
            if (is_part && is_wished) add_sheet(cell, record);
        }
        if (!document_.sheets.empty()) return;
        const std::vector<std::string> names(inspected.begin(), inspected.end());
        const std::string hint = names.empty() ? "the workflow needs a step that compares the part with its nominal"
                                               : "inspected are " + enumerated(names);
        throw is_cell
            ? Error("run {} does not inspect '{}'", comparison_.run.id, parts).hint(hint)
            : Error("run {} has no scan '{}'{}", comparison_.run.id, parts, did_you_mean(parts, names)).hint(hint);
    }

    void add_pictures(FilterLibrary& library, const PreviewSettings& settings,
                      const std::function<void(std::string)>& warn) {
        std::vector<PreviewWish> wishes;
        std::vector<std::pair<std::size_t, std::string>> sheets;  // sheet and caption of each wish
        for (std::size_t sheet = 0; sheet < document_.sheets.size(); ++sheet) {
            if (!document_.sheets[sheet].inspection) continue;
            const CellFiles files = files_of(*record_of_sheet_[sheet]);
            const InspectionStep inspection = files.inspection();
            std::size_t own = 0;
            for (const OutputRecord* picture : files.pictures_of(*inspection.step))
                if (own < most_pictures && (bytes_ > most_bytes || sha256_of(path_of(*picture)) == picture->sha256)) {
                    add_picture(document_.sheets[sheet], picture->sha256, path_of(*picture), stem_of(*picture));
                    ++own;
                }
            const OutputRecord* map = files.deviation_map(inspection);
            if (own > 0 || !map) continue;
            if (wishes.size() == most_drawn) {
                ++left_out_;
                continue;
            }
            wishes.push_back(wish_for(files, *map, inspection));
            sheets.emplace_back(sheet, stem_of(*map));
        }
        const std::vector<Preview> previews = make_previews(folder_, wishes, library, settings, warn);
        for (std::size_t wish = 0; wish < previews.size(); ++wish) {
            Sheet& sheet = document_.sheets[sheets[wish].first];
            if (previews[wish].deviation.empty())
                document_.notes.push_back(
                    fmt::format("a picture of {} is missing: {}", sheet.scan, previews[wish].reason));
            else
                add_picture(sheet, previews[wish].key, previews[wish].deviation, sheets[wish].second);
        }
        if (left_out_ > 0)
            document_.notes.push_back(
                fmt::format("{} left out, because a file of sheets has pictures of at most {} MB; name fewer parts",
                            count_text(left_out_, "picture is", "pictures are"), most_bytes / 1'000'000));
    }

    SheetDocument finished() { return std::move(document_); }

private:
    CellFiles files_of(const CellRecord& record) const { return {record, steps_, library_, run_.start.working_folder}; }
    static std::string stem_of(const OutputRecord& output) { return fs::path(output.file).stem().string(); }

    /// `record`: nullptr if the cell is missing in this run.
    void add_sheet(const CellComparison& cell, const CellRecord* record) {
        Sheet sheet;
        sheet.workflow = cell.workflow;
        sheet.scan = cell.scan;
        sheet.variant = cell.variant;
        sheet.verdict = cell.verdict;
        sheet.outcome = cell.outcome;
        sheet.reasons = cell.reasons;
        sheet.doubts = cell.doubts;
        sheet.known = cell.known;
        if (record) add_record(sheet, *record);
        const auto place =
            sheet.inspection && sheet.outcome != name_of(Outcome::failed) ? document_.sheets.size() : failed_++;
        document_.sheets.insert(document_.sheets.begin() + static_cast<std::ptrdiff_t>(place), std::move(sheet));
        record_of_sheet_.insert(record_of_sheet_.begin() + static_cast<std::ptrdiff_t>(place), record);
    }

    void add_record(Sheet& sheet, const CellRecord& record) const {
        const CellFiles files(record, steps_, library_);
        sheet.error = record.failure.error;
        sheet.inspection = page_inspection(files.inspection());
        std::vector<std::string> filters;
        for (const std::size_t node : record.nodes) {
            const auto found = steps_.find(node);
            if (found == steps_.end()) continue;
            const StepRecord& step = *found->second;
            for (const std::string& warning : step.warnings) sheet.warnings.push_back(step.label + ": " + warning);
            if (step.filter.empty()) continue;
            std::string name = fmt::format("{} {}", step.filter, step.filter_version);
            if (std::ranges::find(filters, name) == filters.end()) filters.push_back(std::move(name));
        }
        sheet.facts = {{"scan", record.scan},
                       {"nominal", files.truth().path},
                       {"workflow", record.workflow},
                       {"filters and versions", fmt::format("{}", fmt::join(filters, ", "))},
                       {"program", "Scanmill " + comparison_.run.version},
                       {"run", fmt::format("{}, {}", comparison_.run.id, comparison_.run.started)},
                       {"machine", comparison_.run.machine}};
    }

    static PreviewWish wish_for(const CellFiles& files, const OutputRecord& map, const InspectionStep& inspection) {
        const CellFile nominal = files.truth();
        PreviewWish wish;
        wish.file = path_of(map);
        wish.sha256 = map.sha256;
        wish.camera_file = nominal.path;
        wish.unit = map.properties.unit;
        wish.camera_unit = nominal.unit;
        wish.kind = kind_named(map.kind);
        wish.deviation = inspection.deviation();
        wish.is_for_paper = true;
        return wish;
    }

    /// Adds the picture, or leaves it out if the pictures have become too large.
    void add_picture(Sheet& sheet, const std::string& key, const fs::path& file, const std::string& caption) {
        if (!document_.images.contains(key)) {
            std::string address = bytes_ > most_bytes ? std::string() : image_address(file);
            bytes_ += address.size();
            if (address.empty() || bytes_ > most_bytes) {
                ++left_out_;
                return;
            }
            document_.images.emplace(key, std::move(address));
        }
        sheet.pictures.push_back({key, caption});
    }

    const fs::path folder_;
    const RunDetails run_;
    const Comparison& comparison_;
    const FilterLibrary& library_;
    const StepsByNode steps_;
    const CellRecords records_;
    SheetDocument document_;
    std::vector<const CellRecord*> record_of_sheet_;
    std::size_t failed_ = 0;  // sheets at the front
    std::size_t bytes_ = 0, left_out_ = 0;  // of pictures
};

}  // namespace

SheetDocument sheet_document(const RecordedRun& which, const std::string& parts, FilterLibrary& library,
                             const PreviewSettings& settings, const std::function<void(std::string)>& warn) {
    const Comparison comparison = compare_recorded(which, std::nullopt, {});
    const RunRecords records = RunRecords::read(which.folder / records_file);
    SheetMaker maker(which.folder, records.run(comparison.run.id), comparison, library);
    maker.add_sheets(parts);
    maker.add_pictures(library, settings, warn);
    return maker.finished();
}

}  // namespace scanmill
