// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Runs long work beside Python: on a thread of its own, while the calling thread handles Python's signals and calls
/// Python's callbacks. The work must not touch Python objects.

#include <nanobind/nanobind.h>

#include <atomic>
#include <functional>

namespace scanmill::python {

/// The link between the work and the thread that waits for it.
struct Beside {
    std::atomic<bool> is_cancelled = false;
    std::atomic<double> progress = -1;  ///< the fraction that is done; negative: not known
};

/// Runs `work` and waits for its end, then throws what it threw. `on_progress` is a callable of one number, or None. If
/// a signal handler or the callback throws, cancels the work and throws that exception. Work that does not end soon is
/// left to itself then, so it must own everything that it uses.
void run_beside(std::function<void(Beside&)> work, nanobind::handle on_progress);

/// Cancels all work, also that of other threads, and waits until it has ended. To be called before the interpreter
/// ends.
void stop_all();

/// Throws Error in a process that was forked after its parent had used threads: those threads are missing here, so work
/// would wait for them for ever. To be called before any work that may use threads.
void require_own_threads();

}  // namespace scanmill::python
