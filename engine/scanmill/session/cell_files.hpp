// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the records of a cell say about its files: which is the scan, the truth, the result, and the map of deviations.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "scanmill/compare/comparison.hpp"
#include "scanmill/plugin/library.hpp"
#include "scanmill/session/previews.hpp"

namespace scanmill {

/// Finds the record of a compared cell.
class CellRecords {
public:
    /// Refers to `run`.
    explicit CellRecords(const RunDetails& run);
    /// nullptr: only the accepted run has the cell.
    const CellRecord* of(const CellComparison& cell) const;

private:
    using Names = std::tuple<std::string, std::string, std::string>;  // workflow, scan, variant
    std::map<Names, const CellRecord*> exact_;
    std::map<Names, std::vector<const CellRecord*>> by_name_;  // with the scan's file name
};

/// A file that a step read, or an output; empty: none.
struct CellFile {
    std::string path;
    LengthUnit unit = LengthUnit::unknown;  ///< as declared or written; unknown: that of the file itself
};

/// The step of a cell that inspects a part. It has metrics if it ran, even if the part does not meet what is expected.
struct InspectionStep {
    const StepRecord* step = nullptr;
    const InspectSpec* inspects = nullptr;
    const FilterSpec* filter = nullptr;

    explicit operator bool() const { return step != nullptr; }
    /// NaN without the metric.
    double number(const std::string& metric) const;
    /// The two numbers of the tolerance or of the range.
    std::array<double, 2> numbers(const std::vector<std::string>& metrics) const;
    FileDeviation deviation() const;
};

/// Reads the wiring of one cell. Refers to its arguments.
class CellFiles {
public:
    /// `base`: the working folder of the run, from which the paths of its scans count; empty: that of this process.
    CellFiles(const CellRecord& cell, const StepsByNode& steps, const FilterLibrary& library,
              const std::string& base = {})
        : cell_(cell),
          steps_(steps),
          library_(library),
          base_(base) {}

    /// The first file that the cell reads.
    CellFile scan() const;
    /// The file with which a measuring or inspecting step compares: a file that the cell reads, or an output. The first
    /// such step that has one counts.
    CellFile truth() const;
    /// The first output that is a mesh and was written, also below `failed/`.
    const OutputRecord* mesh() const;
    /// The step that inspects a part: of several, the first that failed, or else the first of which the workflow
    /// expects something, or else the first.
    InspectionStep inspection() const;
    /// The written output with the deviations that this step found, the best to look at; nullptr if none was written.
    const OutputRecord* deviation_map(const InspectionStep& inspection) const;
    /// The written pictures that steps drew directly from results of the step.
    std::vector<const OutputRecord*> pictures_of(const StepRecord& step) const;

private:
    const StepRecord* step(std::size_t node) const;
    CellFile file_of(const StepRecord& step, const std::string& port) const;

    const CellRecord& cell_;
    const StepsByNode& steps_;
    std::string from_base(const std::string& file) const;

    const FilterLibrary& library_;
    const std::filesystem::path base_;
};

/// Whether the output was written, also below `failed/`.
bool is_written(const OutputRecord& output);
/// Where the output is: below `failed/`, if its cell does not meet an expectation.
const std::string& path_of(const OutputRecord& output);

}  // namespace scanmill
