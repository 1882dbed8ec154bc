// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/job.hpp"

#include "scanmill/base/hash.hpp"
#include "scanmill/plan/step_parameters.hpp"

namespace scanmill {

std::string work_key(const PlannedStep& step, const std::string& code, const ParameterSet& parameters,
                     const std::vector<JobInput>& inputs) {
    KeyBuilder key;
    key.field("code", code);  // it knows the files that parameters name
    for (const auto& [name, value] : parameters.values)
        if (!names_files(step.spec, name)) key.field("parameter " + name, canonical_text(value));
    for (const JobInput& input : inputs) key.field("port " + input.port, input.content);
    return key.key();
}

Failure failure_of(const Job& job, Cause cause, Error error, int number) {
    // A reader that refuses a file begins with its name; what ends the reading from outside does not know it.
    if (const auto* reading = std::get_if<ReadWork>(&job.work); reading && cause != Cause::refused) {
        const std::string file = reading->leaf.file.string();
        error.add_frame(fmt::format("while reading '{}'", file));
        if (job.frames.empty()) error.add_frame(fmt::format("on scan '{}'", file));
    }
    for (const std::string& frame : job.frames) error.add_frame(frame);
    return {cause, number, error.what()};
}

}  // namespace scanmill
