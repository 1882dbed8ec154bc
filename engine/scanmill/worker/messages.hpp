// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What runner and worker say to each other, as bytes: CBOR.

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "scanmill/base/error.hpp"
#include "scanmill/plan/plan.hpp"
#include "scanmill/plugin/library.hpp"
#include "scanmill/worker/job.hpp"

namespace scanmill {

std::string bytes_of(const nlohmann::json& json);

/// Runs `read` over the message; whatever is not as it should be becomes an Error.
template <class Read>
auto read_message(std::string_view message, Read&& read) {
    try {
        return read(nlohmann::json::from_cbor(message));
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw Error("a message between runner and worker cannot be understood: {}", error.what());
    }
}

// Messages over a socket between two processes: four bytes of length, then the bytes.

/// Sends the whole message; false when nobody is there to receive it.
bool send_message(int socket, std::string_view message);

/// What arrives, cut into messages.
class MessageReader {
public:
    explicit MessageReader(int socket) : socket_(socket) {}

    enum class Arrival { something, nothing, end };
    /// Takes what has arrived; with `waits`, until something has. `end`: nobody will send any longer.
    Arrival receive(bool waits);
    /// The next whole message. Throws Error for a length that no message has.
    std::optional<std::string> next();

private:
    int socket_;
    std::string bytes_;
    std::size_t taken_ = 0;
};

// A planned step as runner and worker tell it to each other.

/// A row for every parameter that has a value: its name, the written items, whether they are a list.
nlohmann::json rows_of(const ParameterSet& parameters);
/// In the order of the declaration.
ParameterSet parameters_from(const nlohmann::json& rows, const FilterSpec& spec);

nlohmann::json to_json(const PlannedStep& step);
/// Throws Error when the library's filter is no longer of that version.
std::shared_ptr<const PlannedStep> step_from(const nlohmann::json& json, const FilterLibrary& library);

// Jobs and their reports as bytes (CBOR), for workers in other processes. Every number and every byte of a name
// arrives as it was.

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
