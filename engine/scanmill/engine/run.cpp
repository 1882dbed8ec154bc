// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/run.hpp"

#include "scanmill/engine/scheduler.hpp"

namespace scanmill {

RunReport run(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              RunObserver& observer) {
    return Scheduler(library, graph, workers, settings, observer).run();
}

}  // namespace scanmill
