// SPDX-License-Identifier: GPL-3.0-or-later
#include "beside.hpp"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "scanmill/base/error.hpp"

namespace scanmill::python {

namespace nb = nanobind;

namespace {

/// How often signals and progress are looked at.
constexpr std::chrono::milliseconds patience(20);

std::atomic<pid_t> process_with_threads = 0;

}  // namespace

void require_own_threads() {
    pid_t none = 0;
    if (process_with_threads.compare_exchange_strong(none, getpid()) || none == getpid()) return;
    throw Error("this process was forked after its parent had used Scanmill, and the threads of the parent are missing here")
        .hint("start processes with multiprocessing.get_context('spawn'), or fork before the first use");
}

void run_beside(const std::function<void(Beside&)>& work, nb::handle on_progress) {
    Beside beside;
    std::mutex mutex;
    std::condition_variable ended;
    bool has_ended = false;
    std::exception_ptr failure;
    std::thread thread([&] {
        try {
            work(beside);
        } catch (...) {
            failure = std::current_exception();
        }
        const std::scoped_lock lock(mutex);
        has_ended = true;
        ended.notify_one();
    });
    std::optional<nb::python_error> interrupt;
    {
        const nb::gil_scoped_release released;
        double shown = -1;
        while (true) {
            std::unique_lock lock(mutex);
            if (ended.wait_for(lock, patience, [&] { return has_ended; })) break;
            lock.unlock();
            if (interrupt) continue;
            const nb::gil_scoped_acquire locked;
            try {
                if (PyErr_CheckSignals() != 0) throw nb::python_error();
                const double progress = beside.progress;
                if (!on_progress.is_none() && progress != shown && progress >= 0) on_progress(shown = progress);
            } catch (nb::python_error& error) {
                interrupt.emplace(std::move(error));
                beside.is_cancelled = true;
            }
        }
        thread.join();
    }
    if (interrupt) throw nb::python_error(std::move(*interrupt));
    if (failure) std::rethrow_exception(failure);
    if (!on_progress.is_none()) on_progress(1.0);
}

}  // namespace scanmill::python
