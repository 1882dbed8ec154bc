// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "fuzz/targets.hpp"
#include "scanmill/batch/batch.hpp"
#include "support/declared_filters.hpp"

namespace scanmill::test {

namespace {

struct Place {
    Place() {
        folder.write("a.ply", "x");
        folder.write("b.ply", "x");
        folder.write("p.json",
                     "{\"scanmill\": 1, \"poses\": [{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0]}]}");
        folder.write("w.yaml",
                     "scanmill: 1\ninputs: {scan: points}\nparameters: {n: 1, s: 1 u}\n"
                     "steps: [{thin: {count: $n, size: $s}}]\n");
    }

    TemporaryFolder folder;
    FilterLibrary library = DeclaredFilters().library();
};

/// What may be relied upon when a batch has passed the check.
void require_sound(const CheckedBatch& checked) {
    const Batch& batch = checked.batch;
    require_law(!batch.name.empty() && !batch.scans.empty() && !batch.workflows.empty(), "a batch without its parts");
    for (std::size_t workflow = 0; workflow < batch.workflows.size(); ++workflow) {
        std::size_t scans = 0;
        for (const BatchPart& part : checked.parts)
            if (part.workflow == workflow) scans += part.scans.size();
        require_law(scans == batch.scans.size(), "a scan that a workflow passes over, or takes twice");
    }
    for (const BatchPart& part : checked.parts) {
        require_law(!part.plan->variants.empty(), "a plan without variants");
        require_law(std::ranges::is_sorted(part.scans) && part.scans.back() < batch.scans.size(), "scans out of order");
    }
    for (const BatchScan& scan : batch.scans) {
        if (!scan.is_object()) require_law(std::filesystem::is_regular_file(scan.file), "a scan that is not there");
        for (const std::filesystem::path& view : scan.views)
            require_law(std::filesystem::is_regular_file(view), "a view that is not there");
        if (!scan.pose) continue;
        const Eigen::Matrix3d& rotation = scan.pose->rotation;
        require_law((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-11, "no rotation");
        require_law(scan.pose->translation.allFinite(), "a translation that is no vector");
    }
}

}  // namespace

bool check_batch_text(std::string_view bytes) {
    // A path that begins with a slash, or whose two dots follow one, would make the target read this machine's files.
    if (bytes.find_first_of("/\\") != std::string_view::npos) return false;
    static const Place place;
    const CheckedBatch checked = check_batch(std::string(bytes), (place.folder / "batch.yaml").string(), place.library);
    for (const Diagnostics& diagnostics : checked.diagnostics)
        for (const Diagnostic& diagnostic : diagnostics.sorted()) {
            require_law(!diagnostic.message.empty(), "a finding without words");
            require_law(diagnostic.position.line >= 0 && diagnostic.position.column >= 0, "a finding at no place");
        }
    if (checked.has_errors()) return false;
    require_law(is_batch(std::string(bytes)), "a batch that is not known as one");
    require_sound(checked);
    return true;
}

}  // namespace scanmill::test
