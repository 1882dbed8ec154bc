// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/machine.hpp"

#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <tbb/version.h>

#include <Eigen/Core>
#include <fstream>
#include <thread>

#include "scanmill/base/text.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill::runner {

namespace {

std::string processor() {
    std::ifstream facts("/proc/cpuinfo");
    for (std::string line; std::getline(facts, line);)
        if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(": ") + 2));
    return "unknown processor";
}

}  // namespace

std::string machine_text() {
    utsname system{};
    ::uname(&system);
    const u64 memory = static_cast<u64>(::sysconf(_SC_PHYS_PAGES)) * static_cast<u64>(::sysconf(_SC_PAGESIZE));
    return fmt::format("{}, {}, {}, {} {} {}", processor(),
                       counted(std::thread::hardware_concurrency(), "core", "cores"), byte_size_text(memory),
                       system.sysname, system.release, system.machine);
}

std::string libraries_text() {
    const std::string eigen = fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
    return fmt::format("Eigen {}, oneTBB {}, glibc {}, GCC {}", eigen, TBB_VERSION_STRING, ::gnu_get_libc_version(),
                       __VERSION__);
}

}  // namespace scanmill::runner
