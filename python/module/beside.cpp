// SPDX-License-Identifier: GPL-3.0-or-later
#include "beside.hpp"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

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

/// Threads with work that was left to itself.
std::vector<std::thread>& leftovers() {
    static auto* threads = new std::vector<std::thread>;
    return *threads;
}
std::mutex leftovers_mutex;

void perform(const std::shared_ptr<Shared>& shared) {
    try {
        shared->work(*shared);
    } catch (...) {
        shared->failure = std::current_exception();
    }
    shared->work = nullptr;
    const std::scoped_lock lock(shared->mutex);
    shared->has_ended = true;
    shared->ended.notify_one();
}

}  // namespace

void require_own_threads() {
    pid_t none = 0;
    if (process_with_threads.compare_exchange_strong(none, getpid()) || none == getpid()) return;
    throw Error(
        "this process was forked after its parent had used Scanmill, and the threads of the parent are missing here")
        .hint("start processes with multiprocessing.get_context('spawn'), or fork before the first use");
}

void wait_for_leftovers() {
    const nb::gil_scoped_release released;
    const std::scoped_lock lock(leftovers_mutex);
    for (std::thread& thread : leftovers()) thread.join();
    leftovers().clear();
}

void run_beside(std::function<void(Beside&)> work, nb::handle on_progress) {
    const auto shared = std::make_shared<Shared>();
    shared->work = std::move(work);
    std::thread thread(perform, shared);
    std::optional<nb::python_error> interrupt;
    bool is_over = false;
    {
        const nb::gil_scoped_release released;
        double shown = -1;
        while (true) {
            std::unique_lock lock(shared->mutex);
            is_over = shared->ended.wait_for(lock, interrupt ? patience_after_cancel : patience,
                                             [&] { return shared->has_ended; });
            lock.unlock();
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
        if (is_over) {
            thread.join();
        } else {
            const std::scoped_lock lock(leftovers_mutex);
            leftovers().push_back(std::move(thread));
        }
    }
    if (interrupt) throw nb::python_error(std::move(*interrupt));
    if (shared->failure) std::rethrow_exception(shared->failure);
    if (!on_progress.is_none()) on_progress(1.0);
}

}  // namespace scanmill::python
