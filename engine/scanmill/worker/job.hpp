// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Jobs for workers and reports from workers. Both are also messages between the runner and a worker process.
///
/// A job contains everything that a worker needs, because workers have neither the plan nor the graph. Messages are in
/// CBOR. Numbers keep their bits, and file names need not be UTF-8.

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scanmill/cache/run_values.hpp"
#include "scanmill/cache/step_result.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/plugin/library.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill {

/// A value that a job needs. It is in RunValues, in the cache, or in the file to read.
struct JobInput {
    std::string port;                ///< input port of the step that takes the value
    std::size_t node = 0;            ///< index of the node that made the value
    std::string from;                ///< the node's output port; empty for leaves
    std::string content;             ///< name of the value in the cache; empty: not cached
    std::optional<LeafSource> leaf;  ///< the file, if the node is a leaf
};
constexpr auto fields(const JobInput*) {
    using R = JobInput;
    return std::tuple{field("port", &R::port), field("node", &R::node), field("from", &R::from),
                      field("content", &R::content), field("leaf", &R::leaf)};
}

struct JobCaching {
    bool is_used = false;  ///< false: the cache is neither read nor written
    std::string plan_key;
    std::string code;
    double inputs_cost = 0;  ///< seconds to compute again the inputs that the cache does not have
    std::vector<std::string> needed;  ///< output ports that other tasks need
    std::string workflow{};  ///< StepResult::workflow
};
constexpr auto fields(const JobCaching*) {
    using R = JobCaching;
    return std::tuple{field("is-used", &R::is_used), field("plan-key", &R::plan_key),
                      field("code", &R::code),       field("inputs-cost", &R::inputs_cost),
                      field("needed", &R::needed),   field("workflow", &R::workflow)};
}

struct ReadWork {
    LeafSource leaf;
    JobCaching caching;
};
constexpr auto fields(const ReadWork*) {
    using R = ReadWork;
    return std::tuple{field("leaf", &R::leaf), field("caching", &R::caching)};
}

struct StepWork {
    std::shared_ptr<const PlannedStep> step;
    std::string build;  ///< build of the filter's module
    std::vector<JobInput> inputs;
    std::vector<ParameterFile> parameter_files;
    JobCaching caching;
};
constexpr auto fields(const StepWork*) {
    using R = StepWork;
    return std::tuple{field("step", &R::step), field("build", &R::build), field("inputs", &R::inputs),
                      field("parameter-files", &R::parameter_files), field("caching", &R::caching)};
}

/// Checks whether a cached result meets the step's expectations. The filter does not run.
struct ExpectWork {
    std::shared_ptr<const PlannedStep> step;
    Metrics metrics;
    JobInput primary;
};
constexpr auto fields(const ExpectWork*) {
    using R = ExpectWork;
    return std::tuple{field("step", &R::step), field("metrics", &R::metrics), field("primary", &R::primary)};
}

struct WriteWork {
    std::filesystem::path file;
    std::string made_how;  ///< text for the file's description; see made_how()
    std::vector<std::string> added_columns;  ///< result of added_columns()
    bool must_be_closed = false;  ///< the step expects `closed: true`, so the mesh in the file must be closed too
    JobInput value;
    Metrics properties{};  ///< the value's properties; empty: not computed yet
};
constexpr auto fields(const WriteWork*) {
    using R = WriteWork;
    return std::tuple{field("file", &R::file),
                      field("made-how", &R::made_how),
                      field("added-columns", &R::added_columns),
                      field("must-be-closed", &R::must_be_closed),
                      field("value", &R::value),
                      field("properties", &R::properties)};
}

struct Job {
    std::size_t node = 0;  ///< index of the node whose values the job computes, checks or writes
    std::variant<ReadWork, StepWork, ExpectWork, WriteWork> work;
    std::string frame;  ///< frame to add to errors of the job; empty: none
    std::string scan;  ///< name of the scan, for errors
    unsigned threads = 1;
    std::uint64_t seed = 0;
    u64 memory_limit = 0;  ///< in bytes; 0: no limit
    double seconds_limit = 0;  ///< 0: no limit
    std::string limit_text;  ///< names the setting that gave seconds_limit, for the end of a sentence
};
constexpr auto fields(const Job*) {
    using R = Job;
    return std::tuple{field("node", &R::node),
                      field("work", &R::work),
                      field("frame", &R::frame),
                      field("scan", &R::scan),
                      field("threads", &R::threads),
                      field("seed", &R::seed),
                      field("memory-limit", &R::memory_limit),
                      field("seconds-limit", &R::seconds_limit),
                      field("limit-text", &R::limit_text)};
}

struct JobReport {
    Outcome outcome = Outcome::skipped;  ///< skipped: cancelled, or an input was lost
    std::vector<ValueSlot> lost;  ///< inputs that were removed from the cache
    NodeReport node;  ///< for WriteWork, holds the failure and effort of the write
    StepResult result;  ///< as stored in the cache; empty without a cache
    std::vector<std::string> kept;  ///< output ports whose values the cache has
    OutputReport output;  ///< only for WriteWork
    bool was_read_whole = false;  ///< the scan was planned as a stream but had to be loaded whole
    std::string wear;  ///< why the worker process should be replaced; empty: no reason
};
constexpr auto fields(const JobReport*) {
    using R = JobReport;
    return std::tuple{field("outcome", &R::outcome),
                      field("lost", &R::lost),
                      field("node", &R::node),
                      field("result", &R::result),
                      field("kept", &R::kept),
                      field("output", &R::output),
                      field("was-read-whole", &R::was_read_whole),
                      field("wear", &R::wear)};
}

/// A hash of everything that decides the result of a step: filter, parameters and content of the inputs. With resolved
/// parameters, the hash is the run key. With authored parameters, equal hashes mean equal run keys.
std::string work_key(const PlannedStep& step, const std::string& code, const ParameterSet& parameters,
                     const std::vector<JobInput>& inputs);

/// The failure of a job: `error` with the job's frame and scan. Adds the name of the file that was being read, unless
/// the reader threw the error and named the file.
Failure failure_of(const Job& job, Cause cause, Error error, int number = 0);

// Messages. A function that reads a message throws Error for bytes that are not a message of its type.

/// The first message to a worker.
struct WorkerStart {
    std::string cache_folder;  ///< empty: no cache
    int keep_policy = 0;  ///< KeepRule::Policy
    int parent = 0;  ///< process ID of the runner; the worker ends when the runner ends
    std::string core_build;  ///< hash of the runner's core library
    std::string values;  ///< the folder of RunValues
    std::string scratch;  ///< a folder that only this worker uses
};
constexpr auto fields(const WorkerStart*) {
    using R = WorkerStart;
    return std::tuple{
        field("cache-folder", &R::cache_folder), field("keep-policy", &R::keep_policy), field("parent", &R::parent),
        field("core-build", &R::core_build),     field("values", &R::values),           field("scratch", &R::scratch)};
}
std::string to_message(const WorkerStart& start);
WorkerStart start_from(std::string_view message);

// All further messages to a worker are jobs.
std::string to_message(const Job& job);
/// Reads a job. A message names the filter of a step; its declaration comes from `library`.
Job job_from(std::string_view message, const FilterLibrary& library);

/// A message from a worker. Exactly one member is set.
struct WorkerMessage {
    bool is_ready = false;  ///< sent once, when the process has started
    std::optional<std::string> loading = {};  ///< file of the module that is being loaded; empty text: loading is over
    std::optional<double> progress = {};
    std::optional<std::string> warning = {};  ///< warning about the job
    std::optional<std::string> note = {};  ///< warning of the worker's cache
    std::optional<JobReport> report = {};
};
constexpr auto fields(const WorkerMessage*) {
    using R = WorkerMessage;
    return std::tuple{field("is-ready", &R::is_ready), field("loading", &R::loading), field("progress", &R::progress),
                      field("warning", &R::warning),   field("note", &R::note),       field("report", &R::report)};
}
std::string to_message(const WorkerMessage& message);
WorkerMessage worker_message_from(std::string_view message);

/// Sends a message over a socket: four bytes of length, then the bytes. Returns false if the other process has ended.
bool send_message(int socket, std::string_view message);

/// Splits the bytes that arrive on a socket into messages.
class MessageReader {
public:
    explicit MessageReader(int socket) : socket_(socket) {}

    enum class Arrival { something, nothing, end };
    /// Reads the bytes that have arrived. With `waits`, blocks until bytes arrive. Returns `end` if the other side
    /// closed the socket.
    Arrival receive(bool waits);
    /// The next complete message; empty if none has arrived. Throws Error for an impossible length.
    std::optional<std::string> next();

private:
    int socket_;
    std::string bytes_;
    std::size_t taken_ = 0;
};

}  // namespace scanmill
