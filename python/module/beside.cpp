// SPDX-License-Identifier: GPL-3.0-or-later
#include "beside.hpp"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "scanmill/base/error.hpp"

namespace scanmill::python {

namespace nb = nanobind;

namespace {

/// How often signals and progress are looked at.
constexpr std::chrono::milliseconds patience(20);
/// How long cancelled work may take to end before it is left to itself.
constexpr std::chrono::milliseconds patience_after_cancel(120);

std::atomic<pid_t> process_with_threads = 0;

/// The state that the work and its caller share.
struct Shared : Beside {
    std::function<void(Beside&)> work;
    std::mutex mutex;
    std::condition_variable ended;
    bool has_ended = false;
    std::exception_ptr failure;
};

/// The threads of all work, also of work that was left to itself.
struct Threads {
    std::mutex mutex;
    std::map<const Shared*, std::pair<std::shared_ptr<Shared>, std::thread>> running;
    std::atomic<bool> is_interpreter_ending = false;

    void start(const std::shared_ptr<Shared>& shared);
    /// Waits until the work's thread has ended, unless another caller does.
    void finish(const Shared* shared);
};

/// Never destroyed, because threads may outlive everything else.
Threads& threads() {
    static auto* all = new Threads;
    return *all;
}

void perform(const std::shared_ptr<Shared>& shared) {
    try {
        shared->work(*shared);
    } catch (...) {
        shared->failure = std::current_exception();
    }
    shared->work = nullptr;
    const std::scoped_lock lock(shared->mutex);
    shared->has_ended = true;
    shared->ended.notify_all();
}

void Threads::start(const std::shared_ptr<Shared>& shared) {
    const std::scoped_lock lock(mutex);
    running.emplace(shared.get(), std::pair(shared, std::thread(perform, shared)));
}

void Threads::finish(const Shared* shared) {
    std::thread thread;
    {
        const std::scoped_lock lock(mutex);
        const auto found = running.find(shared);
        if (found == running.end()) return;
        thread = std::move(found->second.second);
        running.erase(found);
    }
    thread.join();
}

}  // namespace

void require_own_threads() {
    pid_t none = 0;
    if (process_with_threads.compare_exchange_strong(none, getpid()) || none == getpid()) return;
    throw Error(
        "this process was forked after its parent had used Scanmill, and the threads of the parent are missing here")
        .hint("start processes with multiprocessing.get_context('spawn'), or fork before the first use");
}

/// Stops the calling thread for ever if the interpreter is ending. Python would end a thread that asks for the
/// interpreter's lock then, in the middle of C++ code, which ends the process.
static void stay_out_of_ending_interpreter() {
    while (threads().is_interpreter_ending) pause();
}

void stop_all() {
    threads().is_interpreter_ending = true;
    const nb::gil_scoped_release released;
    while (true) {
        const Shared* first = nullptr;
        {
            const std::scoped_lock lock(threads().mutex);
            for (const auto& [shared, work] : threads().running) work.first->is_cancelled = true;
            if (!threads().running.empty()) first = threads().running.begin()->first;
        }
        if (!first) return;
        threads().finish(first);
    }
}

void run_beside(std::function<void(Beside&)> work, nb::handle on_progress) {
    const auto shared = std::make_shared<Shared>();
    shared->work = std::move(work);
    threads().start(shared);
    std::optional<nb::python_error> interrupt;
    {
        const nb::gil_scoped_release released;
        double shown = -1;
        while (true) {
            std::unique_lock lock(shared->mutex);
            const bool is_over = shared->ended.wait_for(lock, interrupt ? patience_after_cancel : patience,
                                                        [&] { return shared->has_ended; });
            lock.unlock();
            stay_out_of_ending_interpreter();
            if (is_over) threads().finish(shared.get());
            if (is_over || interrupt) break;
            const nb::gil_scoped_acquire locked;
            try {
                if (PyErr_CheckSignals() != 0) throw nb::python_error();
                const double progress = shared->progress;
                if (!on_progress.is_none() && progress != shown && progress >= 0) on_progress(shown = progress);
            } catch (nb::python_error& error) {
                interrupt.emplace(std::move(error));
                shared->is_cancelled = true;
            }
        }
    }
    if (interrupt) throw nb::python_error(std::move(*interrupt));
    if (shared->failure) std::rethrow_exception(shared->failure);
    if (!on_progress.is_none()) on_progress(1.0);
}

}  // namespace scanmill::python
