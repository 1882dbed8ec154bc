// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Worker processes. A filter that crashes its process affects neither this process nor other workers.
///
/// A process starts with its first job and is reused. It is replaced when it has ended or its state is uncertain. A
/// process that exceeds the time limit or memory limit of its job is killed. Memory is limited in two ways: allocations
/// beyond the limit fail (RLIMIT_DATA), and the runner checks the resident size several times a second.

#include <deque>
#include <memory>
#include <optional>

#include "scanmill/base/error.hpp"
#include "scanmill/worker/resources.hpp"
#include "scanmill/worker/workers.hpp"

namespace scanmill {

/// The file descriptor, in a worker process, of the socket to the runner (the channel).
inline constexpr int worker_channel = 3;

/// The main function of a worker process. Does jobs until the runner closes the channel or ends. Returns the exit code.
int serve_as_worker();

struct ProcessEnd {
    int signal = 0;  ///< signal that ended the process; 0: the process exited
    int exit_code = 0;
    u64 peak_memory = 0;
};

class WorkerProcess {
public:
    /// Starts `command` in a new process group, with a socket to this process at worker_channel. Standard output and
    /// standard error of the process become its log. Throws Error if it cannot be started.
    explicit WorkerProcess(const std::vector<std::string>& command);
    /// Kills the process and the processes that it started.
    ~WorkerProcess();
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    /// Sends a message to the process. Returns false if the process has ended.
    bool send(std::string_view message) { return send_message(channel_, message); }
    MessageReader& reader() { return reader_; }
    /// Reads new output of the process into the log.
    void read_log();
    /// The last lines of output, at most 50.
    std::vector<std::string> log() const;
    void clear_log();

    void signal(int number) const;
    /// Waits until the process ends. With `kills`, kills it first.
    ProcessEnd end(bool kills);
    ResidentMemory memory() const { return resident_memory(process_); }

    int channel() const { return channel_; }
    int log_pipe() const { return log_pipe_; }
    /// A process file descriptor, which becomes readable when the process ends.
    int descriptor() const { return descriptor_; }

private:
    int process_ = -1, channel_ = -1, log_pipe_ = -1, descriptor_ = -1;
    bool has_ended_ = false;
    ProcessEnd end_;
    MessageReader reader_{-1};
    std::deque<std::string> lines_;
    std::string line_;  // the last line of output while it is incomplete
};

struct WorkerProcessSettings {
    std::vector<std::string> command;  ///< absolute path and arguments of a program that calls serve_as_worker()
    std::size_t count = 1;
    std::string cache_folder;  ///< empty: no cache
    int keep_policy = 0;  ///< KeepRule::Policy
    /// Receives warnings about the cache. Equal warnings of several workers are reported once.
    std::function<void(std::string)> on_note;
};

class WorkerProcesses : public Workers {
public:
    using Clock = std::chrono::steady_clock;

    explicit WorkerProcesses(WorkerProcessSettings settings);

    std::size_t size() const override { return slots_.size(); }
    bool has_room(u64 memory_limit) const override;
    bool start(std::size_t worker, Job job) override;
    RunValues& values() override { return values_; }
    void wait(const WorkerListener& listener, std::chrono::milliseconds patience) override;
    void cancel() override;
    /// Starts the process of worker 0 before its first job.
    void start_early() { ensure(0); }
    /// Kills all processes without waiting until they have ended; the destructor waits. Pre: no more jobs.
    void dismiss();
    /// Changes the number of workers. Pre: no job was started.
    void resize(std::size_t count);

private:
    struct Slot {
        std::unique_ptr<WorkerProcess> process;
        std::optional<Job> job;
        Clock::time_point begun, checked;  ///< when the job began, and when its memory was last checked
        bool is_ready = false;  ///< the process has started
        std::optional<Clock::time_point> channel_closed;  ///< when the process closed the channel
        bool cannot_start = false;
        u64 peak_memory = 0;
        std::string loading;  ///< file of the module that the process is loading; empty: none
    };

    void ensure(std::size_t worker);
    void check(std::size_t worker, const WorkerListener& listener);
    void take_messages(std::size_t worker, const WorkerListener& listener);
    void enforce_limits(std::size_t worker, const WorkerListener& listener);
    Clock::duration until_next_check(std::chrono::milliseconds patience) const;

    void take_report(std::size_t worker, const WorkerListener& listener, JobReport report);
    void end_of_process(std::size_t worker, const WorkerListener& listener);
    void kill(std::size_t worker, const WorkerListener& listener, Cause cause, Error error, int number);
    void report_start_failure(std::size_t worker, const WorkerListener& listener);
    u64 peak_of(const Slot& slot, const ProcessEnd& end) const;
    void report_end(std::size_t worker, const WorkerListener& listener, JobReport report, bool ends_process);

    WorkerProcessSettings settings_;
    WorkerStart start_;
    ScratchFolder scratch_;  // contains one folder per worker, and one for values
    RunValues values_;
    std::vector<Slot> slots_;
    std::vector<std::string> notes_;
    std::optional<Clock::time_point> cancelled_;
    std::optional<Error> start_failure_;
};

}  // namespace scanmill
