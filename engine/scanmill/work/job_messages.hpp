// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Jobs and their reports as bytes (CBOR), for workers in other processes. Every number and every byte of a name
/// arrives as it was.

#include <string>
#include <string_view>

#include "scanmill/filter/library.hpp"
#include "scanmill/work/job.hpp"

namespace scanmill {

/// What a worker must know before its first job.
struct WorkerStart {
    std::string cache_folder;  ///< empty: none
    int keep_policy = 0;
    int parent = 0;  ///< process; the worker ends with it
    std::string core_build;
    std::string scratch;  ///< a folder of its own
};
std::string to_message(const WorkerStart& start);
/// Throws Error, as all that read.
WorkerStart start_from(std::string_view message);

/// `forgotten`: nodes whose values are to be dropped before.
std::string to_message(const Job& job, const std::vector<std::size_t>& forgotten);
/// Only that.
std::string to_message(const std::vector<std::size_t>& forgotten);
struct ReceivedJob {
    std::optional<Job> job;
    std::vector<std::size_t> forgotten;
};
/// Filters are known by name: `library` has their declarations.
ReceivedJob job_from(std::string_view message, const FilterLibrary& library);

/// What a worker says: exactly one of them.
struct WorkerMessage {
    bool is_ready = false;  ///< once, when the process has started
    std::optional<double> progress = {};
    std::optional<std::string> warning = {};  ///< about what is being done
    std::optional<std::string> note = {};  ///< about the worker's surroundings, its cache
    std::optional<JobReport> report = {};
};
std::string to_message(const WorkerMessage& message);
/// `step`: of the job that is being done, nullptr when it has none.
WorkerMessage worker_message_from(std::string_view message, const PlannedStep* step);

}  // namespace scanmill
