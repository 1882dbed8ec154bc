// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The errors of a workflow whose filters exist only as declarations.

#include <gmock/gmock.h>

#include "scanmill/plan/plan.hpp"
#include "support/declared_filters.hpp"

namespace scanmill::test {

class WorkflowFindings : public testing::Test {
protected:
    std::vector<std::string> findings(const std::string& workflow, const Settings& settings = {}) {
        Diagnostics diagnostics("w");
        plan_ = make_plan(parse_workflow(workflow, diagnostics), library_, settings, diagnostics);
        std::vector<std::string> texts;
        for (const Diagnostic& diagnostic : diagnostics.sorted()) texts.push_back(text(diagnostic, "w"));
        return texts;
    }
    /// A workflow of the given steps (each line as in the file, from line 4 on).
    std::vector<std::string> steps(const std::string& lines) {
        return findings("scanmill: 1\ninputs: {scan: points}\nsteps:\n" + lines);
    }

    DeclaredFilters filters_;
    FilterLibrary library_ = filters_.library();
    Plan plan_;
};

}  // namespace scanmill::test
