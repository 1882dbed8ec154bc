// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/job.hpp"

namespace scanmill {

Failure failure_of(const Job& job, Cause cause, Error error, int number) {
    for (const std::string& frame : job.frames) error.add_frame(frame);
    return {cause, number, error.what()};
}

}  // namespace scanmill
