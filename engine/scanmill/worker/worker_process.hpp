// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// One worker process, from its start to its end.

#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/worker/messages.hpp"
#include "scanmill/worker/resources.hpp"

namespace scanmill {

/// How a process ended.
struct ProcessEnd {
    int signal = 0;  ///< 0: it ended by itself
    int exit_code = 0;
    u64 peak_memory = 0;
};

class WorkerProcess {
public:
    /// Starts `command`, in a process group of its own, with its end of a channel at worker_channel and its standard
    /// output and error as the log. Throws Error when it cannot be started.
    explicit WorkerProcess(const std::vector<std::string>& command);
    /// Ends it by force, with the processes that it started.
    ~WorkerProcess();
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    /// False when it is gone.
    bool send(std::string_view message) { return send_message(channel_, message); }
    MessageReader& reader() { return reader_; }
    /// Takes what it wrote meanwhile into log().
    void read_log();
    /// The last lines, at most 50.
    std::vector<std::string> log() const;
    void clear_log();

    void signal(int number) const;
    /// Waits for its end, after having forced it with `kills`.
    ProcessEnd end(bool kills);
    ResidentMemory memory() const { return resident_memory(process_); }

    int channel() const { return channel_; }
    int log_pipe() const { return log_pipe_; }
    /// Readable once the process has ended.
    int descriptor() const { return descriptor_; }

private:
    int process_ = -1, channel_ = -1, log_pipe_ = -1, descriptor_ = -1;
    bool has_ended_ = false;
    ProcessEnd end_;
    MessageReader reader_{-1};
    std::deque<std::string> lines_;
    std::string line_;  // that has no end yet
};

}  // namespace scanmill
