// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Jobs for workers, their reports, and both as messages between the runner and a worker process.
///
/// A job contains everything that a worker needs; workers have neither the plan nor the graph. Messages are CBOR;
/// numbers keep their bits and file names need not be UTF-8.

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

/// A value that a job needs: in RunValues, in the cache, or in the file to read.
struct JobInput {
    std::string port;                ///< of the step that takes it
    std::size_t node = 0;            ///< the node that the value belongs to
    std::string from;                ///< the node's output port; empty for leaves
    std::string content;             ///< its name in the cache; empty: not cached
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
    double inputs_cost = 0;  ///< seconds to compute those inputs again that the cache does not have
    std::vector<std::string> needed;  ///< output ports that other tasks need
};
constexpr auto fields(const JobCaching*) {
    using R = JobCaching;
    return std::tuple{field("is-used", &R::is_used), field("plan-key", &R::plan_key), field("code", &R::code),
                      field("inputs-cost", &R::inputs_cost), field("needed", &R::needed)};
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
    std::string build;  ///< of the module
    std::vector<JobInput> inputs;
    std::vector<ParameterFile> parameter_files;
    JobCaching caching;
};
constexpr auto fields(const StepWork*) {
    using R = StepWork;
    return std::tuple{field("step", &R::step), field("build", &R::build), field("inputs", &R::inputs),
                      field("parameter-files", &R::parameter_files), field("caching", &R::caching)};
}

/// Only checks whether a cached result meets the step's expectations.
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
    std::string made_how;  ///< for the file's description
    std::vector<std::string> added_columns;  ///< those of added_columns()
    bool must_be_closed = false;             ///< the step's expectation `closed: true` holds for the file too
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
    std::size_t node = 0;  ///< whose values it computes, checks or writes
    std::variant<ReadWork, StepWork, ExpectWork, WriteWork> work;
    std::string frame;  ///< added to its errors; empty: none
    std::string scan;
    unsigned threads = 1;
    std::uint64_t seed = 0;
    u64 memory_limit = 0;      ///< bytes; 0: none
    double seconds_limit = 0;  ///< 0: none
    std::string limit_text;    ///< the setting behind seconds_limit, as a part of a sentence
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
    std::vector<ValueSlot> lost;         ///< inputs that were removed from the cache
    NodeReport node;                     ///< its failure and effort are also those of a write
    StepResult result;                   ///< as stored in the cache; empty without a cache
    std::vector<std::string> kept;       ///< ports whose values the cache has
    OutputReport output;
    bool was_read_whole = false;  ///< a scan that was planned as a stream
    std::string wear;  ///< why the process should be replaced; empty: it need not be
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

/// Hash of all that decides the result: filter, parameters, content of the inputs. With resolved parameters it is the
/// run key; with authored ones, equal keys mean equal run keys.
std::string work_key(const PlannedStep& step, const std::string& code, const ParameterSet& parameters,
                     const std::vector<JobInput>& inputs);

/// The error with the job's frame and scan. Adds the file that was being read unless a reader threw the error.
Failure failure_of(const Job& job, Cause cause, Error error, int number = 0);

// Messages. Functions that read one throw Error for bytes that are not such a message.

/// The first message to a worker.
struct WorkerStart {
    std::string cache_folder;  ///< empty: none
    int keep_policy = 0;
    int parent = 0;  ///< process ID; the worker ends with it
    std::string core_build;
    std::string values;   ///< the folder of RunValues
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

/// All further messages to a worker.
std::string to_message(const Job& job);
/// The message contains filters by name; `library` has their declarations.
Job job_from(std::string_view message, const FilterLibrary& library);

/// A message from a worker; one of these.
struct WorkerMessage {
    bool is_ready = false;  ///< once, when the process has started
    std::optional<std::string> loading = {};  ///< the module that is being loaded; empty: it is loaded
    std::optional<double> progress = {};
    std::optional<std::string> warning = {};  ///< warning about the job
    std::optional<std::string> note = {};     ///< note by the worker's cache
    std::optional<JobReport> report = {};
};
constexpr auto fields(const WorkerMessage*) {
    using R = WorkerMessage;
    return std::tuple{field("is-ready", &R::is_ready), field("loading", &R::loading), field("progress", &R::progress),
                      field("warning", &R::warning),   field("note", &R::note),       field("report", &R::report)};
}
std::string to_message(const WorkerMessage& message);
WorkerMessage worker_message_from(std::string_view message);

/// Sends a message over a socket: four bytes of length, then the bytes. False when the other process has ended.
bool send_message(int socket, std::string_view message);

/// Splits the bytes that arrive on a socket into messages.
class MessageReader {
public:
    explicit MessageReader(int socket) : socket_(socket) {}

    enum class Arrival { something, nothing, end };
    /// Reads what has arrived; with `waits`, blocks until something arrives. `end`: the other side closed the socket.
    Arrival receive(bool waits);
    /// The next complete message. Throws Error for an impossible length.
    std::optional<std::string> next();

private:
    int socket_;
    std::string bytes_;
    std::size_t taken_ = 0;
};

}  // namespace scanmill
