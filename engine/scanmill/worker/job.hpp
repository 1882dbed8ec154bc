// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// One piece of work and everything that doing it needs: whoever does it, in this process or in another, knows no plan
/// and no graph.

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "scanmill/cache/step_result.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill {

/// A value that is needed: the doer still holds it from an earlier job, or the cache has it under `content`.
struct JobInput {
    std::string port;  ///< of the step that takes it
    std::size_t node = 0;  ///< whose value it is
    std::string from;  ///< the node's output port; empty for leaves
    std::string content;  ///< empty: the cache does not have it
    std::optional<LeafSource> leaf;  ///< it can be read again
};

/// How the result is known in the cache.
struct JobMemory {
    bool is_used = false;  ///< the cache may be asked, and told
    std::string plan_key;
    std::string code;
    bool keep_always = false;  ///< several wait for the values: they are kept whatever they cost
    double inputs_cost = 0;  ///< seconds to make those inputs again that were not kept
    std::vector<std::string> needed;  ///< output ports that somebody waits for
};

struct ReadWork {
    LeafSource leaf;
    JobMemory memory;
};

struct StepWork {
    std::shared_ptr<const PlannedStep> step;
    std::string build;  ///< of the module
    std::vector<JobInput> inputs;
    std::vector<ParameterFile> parameter_files;
    JobMemory memory;
};

/// Only asks whether a result that is known already is what the step expects.
struct ExpectWork {
    std::shared_ptr<const PlannedStep> step;
    Metrics metrics;
    JobInput primary;
};

struct WriteWork {
    std::filesystem::path file;
    std::string made_how;  ///< for the file's description
    JobInput value;
};

struct Job {
    std::size_t node = 0;  ///< whose values it makes, asks about or writes
    std::variant<ReadWork, StepWork, ExpectWork, WriteWork> work;
    /// Of its errors, innermost first. None of a reading whose file is the scan.
    std::vector<std::string> frames;
    unsigned threads = 1;
    std::uint64_t seed = 0;
    u64 memory_limit = 0;  ///< bytes; 0: none
    double seconds_limit = 0;  ///< 0: none
    std::string limit_text;  ///< whose limit of time that is, as a part of a sentence
};

struct JobReport {
    Outcome outcome = Outcome::skipped;  ///< skipped: cancelled, or an input was lost
    std::vector<JobInput> lost;  ///< inputs that neither memory nor cache has any longer
    NodeReport node;  ///< failure and effort also of a write
    StepResult result;  ///< what the cache knows of it now; empty without a cache
    std::vector<std::string> kept;  ///< ports whose values the cache has
    OutputReport output;
    bool was_read_whole = false;  ///< a scan that was to be streamed
    std::string worn;  ///< why whoever did this should do nothing else; empty: it may
};

/// Filter, parameters and the content of the inputs: what decides the result, whatever else changes. With parameters
/// as the filter gets them it is the run key; as they are authored, it is equal for steps that will have one run key.
std::string work_key(const PlannedStep& step, const std::string& code, const ParameterSet& parameters,
                     const std::vector<JobInput>& inputs);

/// The error with the job's frames, as a failure of this cause. Where a reader did not say it itself, also with the
/// file that was being read.
Failure failure_of(const Job& job, Cause cause, Error error, int number = 0);

}  // namespace scanmill
