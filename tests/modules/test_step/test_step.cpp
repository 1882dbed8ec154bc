// SPDX-License-Identifier: GPL-3.0-or-later
#include "test_step/test_step.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

using Mode = TestStepParams::Mode;

std::string_view name_of(Mode mode) {
    switch (mode) {
        case Mode::pass: return "pass";
        case Mode::fail: return "fail";
        case Mode::throw_standard: return "throw";
        case Mode::out_of_memory: return "out-of-memory";
        case Mode::empty: return "empty";
        case Mode::wait: return "wait";
        case Mode::warn: return "warn";
        case Mode::doubt: return "doubt";
        case Mode::doubt_mesh: return "doubt-mesh";
        case Mode::slow: return "slow";
        case Mode::held: return "held";
        case Mode::crash: return "crash";
        case Mode::kill: return "kill";
        case Mode::abort: return "abort";
        case Mode::throw_number: return "throw-number";
        case Mode::loop: return "loop";
        case Mode::allocate: return "allocate";
        case Mode::write: return "write";
        case Mode::leak: return "leak";
        case Mode::exit: return "exit";
        case Mode::change_folder: return "change-folder";
        case Mode::undeclared_metric: return "undeclared-metric";
        case Mode::babble: return "babble";
        case Mode::close_streams: return "close-streams";
        case Mode::close_channel: return "close-channel";
    }
    return "";
}

/// One write of one line, so that processes that share a log do not mix their lines.
void append_to_log(const std::filesystem::path& log, Mode mode, std::size_t points) {
    std::ofstream stream(log, std::ios::binary | std::ios::app);
    stream << fmt::format("{} {}\n", name_of(mode), points) << std::flush;
    if (!stream) throw Error("the log '{}' cannot be written", log.string());
}

[[noreturn]] void take_all_memory() {
    std::vector<std::unique_ptr<char[]>> taken;
    constexpr std::size_t block = std::size_t(16) << 20;
    for (;;) {
        taken.push_back(std::make_unique<char[]>(block));  // set to zero: every page is touched
        static_cast<void>(taken.back().release());         // and never given back
    }
}

void misbehave(Mode mode, std::size_t points, Context& context) {
    switch (mode) {
        case Mode::fail:
            throw Error("was asked to fail; the cloud has {} points", points).hint("mode: pass lets it through");
        case Mode::throw_standard: throw std::runtime_error("was asked to throw");
        case Mode::out_of_memory: throw std::bad_alloc();
        case Mode::wait:
            for (;;) {
                context.check_cancelled();
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        case Mode::warn: context.warn("was asked to warn"); break;
        case Mode::doubt: context.doubt("was asked to doubt"); break;
        case Mode::doubt_mesh: context.doubt("was asked to doubt the mesh", "mesh"); break;
        case Mode::slow: std::this_thread::sleep_for(std::chrono::milliseconds(30)); break;
        case Mode::held:
            while (const char* file = std::getenv("SCANMILL_TEST_HOLD")) {
                if (std::error_code ignored; !std::filesystem::exists(file, ignored)) break;
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            }
            break;
        case Mode::crash:
            std::puts("about to crash");
            std::raise(SIGSEGV);  // as a wild pointer would; a sanitizer must not see one
            break;
        case Mode::kill: {
            const std::vector<char> held(std::size_t(96) << 20, 1);
            std::this_thread::sleep_for(std::chrono::milliseconds(300));  // so that its memory is measured
            std::raise(SIGKILL);
            break;
        }
        case Mode::abort: std::abort();
        case Mode::throw_number: throw 42;
        case Mode::close_channel: ::close(3); [[fallthrough]];
        case Mode::loop:
            for (volatile std::uint64_t turns = 0;;) turns = turns + 1;
        case Mode::allocate: take_all_memory(); break;
        case Mode::write:
            for (int line = 1; line <= 100; ++line) std::printf("line %d\n", line);
            std::fputs("and on standard error\n", stderr);
            break;
        case Mode::leak:
            for (int file = 0; file < 3; ++file)
                if (::open("/dev/null", O_RDONLY) < 0) throw Error("no file could be opened");
            break;
        case Mode::exit: std::exit(0);
        case Mode::undeclared_metric: context.metric("stray", 1); break;
        case Mode::babble:
            for (int i = 0; i < 50'000; ++i) context.warn(fmt::format("warning {}", i));
            break;
        case Mode::close_streams:
            ::close(STDOUT_FILENO);
            ::close(STDERR_FILENO);
            break;
        case Mode::change_folder:
            if (::chdir("/") != 0) throw Error("the folder could not be changed");
            break;
        case Mode::pass:
        case Mode::empty: break;
    }
}

TriangleMesh right_angled_tetrahedron(const Frame& frame, double leg) {
    TriangleMesh mesh;
    mesh.frame = frame;
    mesh.positions = {Vec3(0, 0, 0), Vec3(leg, 0, 0), Vec3(0, leg, 0), Vec3(0, 0, leg)};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
}

}  // namespace

TestStepResult test_step(const PointCloud& cloud, const TestStepParams& params, Context& context) {
    if (params.log) append_to_log(*params.log, params.mode, cloud.size());
    misbehave(params.mode, cloud.size(), context);

    TestStepResult result{cloud, {}};
    Array<Vec3> scaled(cloud.positions.begin(), cloud.positions.end());
    for (Vec3& p : scaled) p *= params.factor;
    result.points.positions = std::move(scaled);
    result.mesh.frame = cloud.frame;
    if (params.mode != Mode::empty) result.mesh = right_angled_tetrahedron(cloud.frame, params.length.value());

    context.metric("points", static_cast<double>(cloud.size()));
    context.metric("length", params.length.value(), Unit::length);
    context.progress(1);
    return result;
}

}  // namespace scanmill
