// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What is asked of a plan: over which files it runs, how much of it, and where its results go.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/data/transform.hpp"
#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// A file, and what is known of it that it may not say itself.
struct ScanFile {
    ScanFile(std::filesystem::path file) : path(std::move(file)) {}

    std::filesystem::path path;
    LengthUnit unit = LengthUnit::unknown;  ///< unknown: what the request, the workflow or the file says
    std::string frame;  ///< empty: what the workflow or the file says
    std::optional<RigidTransform> pose;  ///< moves what was read; `to` names the frame that it leads to
};

struct RunRequest {
    std::vector<ScanFile> scans;  ///< feed the first input: one a run, or all of them one run's list
    std::map<std::string, std::vector<std::filesystem::path>> inputs;  ///< feed the other inputs
    std::vector<std::filesystem::path> protected_files;  ///< others that no output may replace
    std::filesystem::path output_folder;
    LengthUnit unit = LengthUnit::unknown;  ///< of every file; unknown: what the workflow or the file says
    std::uint64_t seed = 0;
    std::vector<std::string> only;  ///< variants; empty: all
    std::string until;  ///< last step to run, in the variants that have it; empty: all
    std::vector<std::string> save;  ///< steps (or step.port) to write in addition to the outputs
};

/// Throws Error for inputs that are not fed or not there, and for variants and steps that the plan does not have.
void require_fits(const RunRequest& request, const Plan& plan);

}  // namespace scanmill
