// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Batch files in a folder of their own, with the filters that exist only as declarations.

#include <gmock/gmock.h>

#include "scanmill/batch/batch.hpp"
#include "support/declared_filters.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

class Batches : public testing::Test {
protected:
    Batches() {
        for (const char* scan : {"a.ply", "b.ply"}) folder_.write(std::string("scans/") + scan, "x");
        folder_.write("w.yaml",
                      "scanmill: 1\ninputs: {scan: points}\nparameters: {n: 1, s: 1 u}\nsteps: [{thin: {count: "
                      "$n, size: $s}}]\n");
    }

    /// Parses it, remembering the batch; findings begin with "b:".
    std::vector<std::string> findings(const std::string& text) {
        Diagnostics diagnostics(file());
        batch_ = parse_batch(text, diagnostics);
        return texts(diagnostics);
    }
    /// The same of lines that follow a sound beginning; the first is line 5.
    std::vector<std::string> rest(const std::string& lines) { return findings(head + lines); }
    /// The same for the text after `scans: `, in line 3.
    std::vector<std::string> scans(const std::string& list) {
        return findings("scanmill: 1\nbatch: b\nscans: " + list + "\nworkflows: w.yaml\n");
    }
    /// Checks the batch with its workflows.
    std::vector<std::string> check(const std::string& text) {
        checked_ = check_batch(text, file(), library_);
        std::vector<std::string> all;
        for (const Diagnostics& diagnostics : checked_.diagnostics)
            for (std::string& finding : texts(diagnostics)) all.push_back(std::move(finding));
        return all;
    }
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const BatchScan& scan : batch_.scans)
            names.push_back(scan.file.lexically_relative(folder_.path()).string());
        return names;
    }
    std::string file() const { return (folder_ / "b.yaml").string(); }

    static inline const std::string head = "scanmill: 1\nbatch: b\nscans: [scans/*.ply]\nworkflows: w.yaml\n";

    TemporaryFolder folder_;
    DeclaredFilters filters_;
    FilterLibrary library_ = filters_.library();
    Batch batch_;
    CheckedBatch checked_;

private:
    std::vector<std::string> texts(const Diagnostics& diagnostics) const {
        std::vector<std::string> all;
        for (const Diagnostic& diagnostic : diagnostics.sorted())
            all.push_back(text(diagnostic, std::filesystem::path(diagnostics.file()).stem().string()));
        return all;
    }
};

}  // namespace scanmill::test
