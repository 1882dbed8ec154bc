// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/inspection_sheet.hpp"

#include <fmt/format.h>

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

constexpr std::size_t most_bytes = 40'000'000, most_pictures = 2;

std::string cell_name(const CellComparison& cell) { return fmt::format("{} [{}]", cell.scan, cell.variant); }

bool is_named(const CellComparison& cell, std::string parts) {
    if (parts == "." || cell.scan == parts || cell_name(cell) == parts) return true;
    while (parts.ends_with('/')) parts.pop_back();
    return !parts.empty() && cell.scan.starts_with(parts + "/");
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
        // A scan that cannot be read has no steps, but its workflow and variant inspect other parts.
        std::set<std::pair<std::string, std::string>> inspecting;
        for (const CellRecord& cell : run_.cells)
            if (CellFiles(cell, steps_, library_).inspection()) inspecting.emplace(cell.workflow, cell.variant);
        std::vector<std::string> inspected;
        bool is_cell = false;
        for (const CellComparison& cell : comparison_.cells) {
            const CellRecord* record = records_.of(cell);
            const bool is_part = record && inspecting.contains({cell.workflow, cell.variant});
            if (is_part) inspected.push_back(cell.scan);
            is_cell = is_cell || is_named(cell, parts);
            if (is_part && is_named(cell, parts)) add_sheet(cell, *record);
        }
        if (!document_.sheets.empty()) return;
        inspected.erase(std::unique(inspected.begin(), inspected.end()), inspected.end());
        const std::string hint = inspected.empty()
                                     ? "the workflow needs a step that compares the part with its nominal"
                                     : "inspected are " + enumerated(inspected);
        throw is_cell ? Error("run {} does not inspect '{}'", comparison_.run.id, parts).hint(hint)
                      : Error("run {} has no scan '{}'{}", comparison_.run.id, parts, did_you_mean(parts, inspected))
                            .hint(hint);
    }

    void add_pictures(FilterLibrary& library, const PreviewSettings& settings,
                      const std::function<void(std::string)>& warn) {
        std::vector<PreviewWish> wishes;
        std::vector<std::size_t> sheet_of_wish;
        for (std::size_t sheet = 0; sheet < document_.sheets.size(); ++sheet) {
            const CellFiles files(*record_of_sheet_[sheet], steps_, library_);
            const InspectionStep inspection = files.inspection();
            if (!inspection) continue;
            for (const OutputRecord* picture : files.pictures_of(*inspection.step))
                if (document_.sheets[sheet].pictures.size() < most_pictures && sha256_of(path_of(*picture)) == picture->sha256)
                    add_picture(document_.sheets[sheet], picture->sha256, path_of(*picture));
            const OutputRecord* map = files.deviation_map(inspection);
            if (!document_.sheets[sheet].pictures.empty() || !map || !document_.sheets[sheet].inspection) continue;
            wishes.push_back(wish_for(files, *map, inspection));
            sheet_of_wish.push_back(sheet);
        }
        const std::vector<Preview> previews = make_previews(folder_, wishes, library, settings, warn);
        for (std::size_t wish = 0; wish < previews.size(); ++wish) {
            Sheet& sheet = document_.sheets[sheet_of_wish[wish]];
            add_picture(sheet, previews[wish].key, previews[wish].deviation);
            if (!previews[wish].reason.empty())
                document_.notes.push_back(fmt::format("a picture of {} is missing: {}", sheet.scan, previews[wish].reason));
        }
        leave_out_pictures();
    }

    SheetDocument finished() { return std::move(document_); }

private:
    void add_sheet(const CellComparison& cell, const CellRecord& record) {
        const CellFiles files(record, steps_, library_);
        Sheet sheet;
        sheet.workflow = cell.workflow;
        sheet.scan = cell.scan;
        sheet.variant = cell.variant;
        sheet.verdict = cell.verdict;
        sheet.outcome = cell.outcome;
        sheet.reasons = cell.reasons;
        sheet.doubts = cell.doubts;
        sheet.known = cell.known;
        sheet.error = record.failure.error;
        sheet.inspection = page_inspection(files.inspection());
        std::string filters;
        for (const std::size_t node : record.nodes) {
            const auto found = steps_.find(node);
            if (found == steps_.end()) continue;
            const StepRecord& step = *found->second;
            for (const std::string& warning : step.warnings) sheet.warnings.push_back(step.label + ": " + warning);
            if (!step.filter.empty())
                filters += fmt::format("{}{} {}", filters.empty() ? "" : ", ", step.filter, step.filter_version);
        }
        sheet.facts = {{"scan", record.scan},
                       {"nominal", files.truth().path},
                       {"workflow", cell.workflow},
                       {"filters and versions", filters},
                       {"program", "Scanmill " + comparison_.run.version},
                       {"run", fmt::format("{}, {}", comparison_.run.id, comparison_.run.started)},
                       {"machine", comparison_.run.machine}};
        const auto place = record.outcome == Outcome::failed ? failed_++ : document_.sheets.size();
        document_.sheets.insert(document_.sheets.begin() + static_cast<std::ptrdiff_t>(place), std::move(sheet));
        record_of_sheet_.insert(record_of_sheet_.begin() + static_cast<std::ptrdiff_t>(place), &record);
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

    void add_picture(Sheet& sheet, const std::string& key, const fs::path& file) {
        std::string address = image_address(file);
        if (address.empty()) return;
        document_.images.emplace(key, std::move(address));
        sheet.pictures.push_back({key, file.stem().string()});
    }

    void leave_out_pictures() {
        std::size_t bytes = 0, left_out = 0;
        for (Sheet& sheet : document_.sheets)
            std::erase_if(sheet.pictures, [&](const SheetPicture& picture) {
                bytes += document_.images.at(picture.image).size();
                left_out += bytes > most_bytes;
                return bytes > most_bytes;
            });
        std::erase_if(document_.images, [&](const auto& image) {
            return std::ranges::none_of(document_.sheets, [&](const Sheet& sheet) {
                return std::ranges::find(sheet.pictures, image.first, &SheetPicture::image) != sheet.pictures.end();
            });
        });
        if (left_out > 0)
            document_.notes.push_back(fmt::format("{} left out, because all would have more than {} MB; name fewer parts",
                                                  count_text(left_out, "picture is", "pictures are"),
                                                  most_bytes / 1'000'000));
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
