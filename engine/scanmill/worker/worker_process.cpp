// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "scanmill/base/error.hpp"
#include "scanmill/worker/worker_processes.hpp"

namespace scanmill {

namespace {

constexpr std::size_t log_lines = 50, longest_line = 1000;

[[noreturn]] void fail(int reason) {
    throw Error("no worker process can be started: {}", std::strerror(reason))
        .hint("run without worker processes; a filter that crashes then ends the whole program")
        .remedy(Remedy::run_without_workers);
}

/// The descriptors, signals and process group of a new process.
class SpawnPlan {
public:
    SpawnPlan(int channel, int log) {
        ::posix_spawn_file_actions_init(&files_);
        ::posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        ::posix_spawn_file_actions_adddup2(&files_, log, STDOUT_FILENO);
        ::posix_spawn_file_actions_adddup2(&files_, log, STDERR_FILENO);
        ::posix_spawn_file_actions_adddup2(&files_, channel, worker_channel);
        ::posix_spawnattr_init(&attributes_);
        ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
        ::posix_spawnattr_setpgroup(&attributes_, 0);
        sigset_t signals;
        ::sigemptyset(&signals);
        for (const int each : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) ::sigaddset(&signals, each);
        ::posix_spawnattr_setsigdefault(&attributes_, &signals);
    }
    ~SpawnPlan() {
        ::posix_spawn_file_actions_destroy(&files_);
        ::posix_spawnattr_destroy(&attributes_);
    }
    SpawnPlan(const SpawnPlan&) = delete;
    SpawnPlan& operator=(const SpawnPlan&) = delete;

    int start(const std::vector<std::string>& command) const {
        std::vector<char*> arguments;
        for (const std::string& each : command) arguments.push_back(const_cast<char*>(each.c_str()));
        arguments.push_back(nullptr);
        int process = -1;
        if (const int reason =
                ::posix_spawn(&process, arguments.front(), &files_, &attributes_, arguments.data(), environ))
            fail(reason);
        return process;
    }

private:
    posix_spawn_file_actions_t files_;
    posix_spawnattr_t attributes_;
};

/// Closes a descriptor at the end of a scope. Moves it above the numbers that SpawnPlan assigns.
class OwnDescriptor {
public:
    explicit OwnDescriptor(int descriptor) : descriptor_(descriptor) {
        if (descriptor_ < 0 || descriptor_ > worker_channel) return;
        const int higher = ::fcntl(descriptor_, F_DUPFD_CLOEXEC, worker_channel + 1);
        ::close(descriptor_);
        descriptor_ = higher;
    }
    ~OwnDescriptor() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    OwnDescriptor(const OwnDescriptor&) = delete;
    OwnDescriptor& operator=(const OwnDescriptor&) = delete;
    int get() const { return descriptor_; }
    int release() { return std::exchange(descriptor_, -1); }

private:
    int descriptor_;
};

}  // namespace

WorkerProcess::WorkerProcess(const std::vector<std::string>& command) {
    int sockets[2], pipes[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) fail(errno);
    OwnDescriptor channel(sockets[0]), worker_end(sockets[1]);
    if (channel.get() < 0 || worker_end.get() < 0) fail(EMFILE);
    if (::pipe2(pipes, O_CLOEXEC) != 0) fail(errno);
    OwnDescriptor log(pipes[0]), log_end(pipes[1]);
    if (log.get() < 0 || log_end.get() < 0) fail(EMFILE);
    ::fcntl(log.get(), F_SETFL, O_NONBLOCK);
    process_ = SpawnPlan(worker_end.get(), log_end.get()).start(command);
    descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, process_, 0));
    channel_ = channel.release();
    log_pipe_ = log.release();
    reader_ = MessageReader(channel_);
    if (descriptor_ < 0) {
        const int reason = errno;
        end(true);
        ::close(channel_);
        ::close(log_pipe_);
        fail(reason);
    }
}

WorkerProcess::~WorkerProcess() {
    end(true);
    for (const int each : {channel_, log_pipe_, descriptor_})
        if (each >= 0) ::close(each);
}

void WorkerProcess::read_log() {
    if (log_pipe_ < 0) return;
    std::array<char, 1 << 14> block;
    ssize_t length = 0;
    // The number of blocks is limited, so that a process that writes without pause does not block the runner.
    for (int blocks = 0; blocks < 64 && (length = ::read(log_pipe_, block.data(), block.size())) > 0; ++blocks) {
        for (const char c : std::string_view(block.data(), static_cast<std::size_t>(length))) {
            if (c != '\n') {
                if (line_.size() < longest_line) line_ += c;
                continue;
            }
            lines_.push_back(std::move(line_));
            line_.clear();
            if (lines_.size() > log_lines) lines_.pop_front();
        }
    }
    if (length == 0) {  // the process has closed standard output and error
        ::close(log_pipe_);
        log_pipe_ = -1;
    }
}

std::vector<std::string> WorkerProcess::log() const {
    std::vector<std::string> all(lines_.begin(), lines_.end());
    if (!line_.empty()) all.push_back(line_);
    if (all.size() > log_lines) all.erase(all.begin());
    return all;
}

void WorkerProcess::clear_log() {
    lines_.clear();
    line_.clear();
}

void WorkerProcess::signal(int number) const {
    if (!has_ended_) ::kill(process_, number);
}

ProcessEnd WorkerProcess::end(bool kills) {
    if (has_ended_) return end_;
    if (kills) ::kill(process_, SIGKILL);
    siginfo_t ended;
    while (::waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
    }
    ::kill(-process_, SIGKILL);  // kills the processes that it started; the group's number is not reused yet
    int status = 0;
    rusage used{};
    while (::wait4(process_, &status, 0, &used) < 0 && errno == EINTR) {
    }
    has_ended_ = true;
    if (WIFSIGNALED(status)) end_.signal = WTERMSIG(status);
    if (WIFEXITED(status)) end_.exit_code = WEXITSTATUS(status);
    end_.peak_memory = static_cast<u64>(used.ru_maxrss) * 1024;
    return end_;
}

}  // namespace scanmill
