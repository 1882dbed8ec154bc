// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A filter for tests of what runs filters: small, and able to misbehave in every way that a filter can.

#include <filesystem>
#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct TestStepParams {
    enum class Mode {
        pass,
        fail,
        throw_standard,
        out_of_memory,
        empty,
        wait,
        warn,
        doubt,
        doubt_mesh,
        slow,
        held,
        crash,
        kill,
        abort,
        throw_number,
        loop,
        allocate,
        write,
        leak,
        exit,
        change_folder,
        undeclared_metric,
        babble,
        close_streams,
        close_channel
    };
    Mode mode = Mode::pass;
    std::optional<std::filesystem::path> log;
    Length length = Length::percent_of_diagonal(1);
    double factor = 1;
};

struct TestStepResult {
    PointCloud points;
    TriangleMesh mesh;
};

/// The cloud with every position (relative to its frame's origin) times `factor`, columns and frame kept; and a right-
/// angled tetrahedron with legs of `length` along the axes, outwards oriented, its corner at the frame's origin.
///
/// First of all one line, "<mode> <number of points>", is appended to `log`, when one is given. Then, by mode:
/// fail throws Error with a hint, throw_standard a std::runtime_error, out_of_memory a std::bad_alloc; empty gives a
/// mesh without vertices; wait returns only by throwing Cancelled; warn warns once; doubt doubts all outputs,
/// doubt_mesh the mesh; slow takes 30 ms; held
/// waits while there is a file that the environment variable SCANMILL_TEST_HOLD names; undeclared_metric reports
/// `stray`. What follows takes the process along or leaves something behind in it: crash raises SIGSEGV, kill SIGKILL,
/// abort and exit end the process, throw_number throws an int, loop never returns, allocate takes memory until there is
/// none, write says 100 lines on standard output and one on standard error, leak leaves three files open, change_folder
/// leaves the process in the root folder, babble warns 50,000 times, close_streams closes standard output and error,
/// close_channel the descriptor to the runner, and loops. Metrics: `points`, the number of points that came out;
/// `length`.
TestStepResult test_step(const PointCloud& cloud, const TestStepParams& params, Context& context);

}  // namespace scanmill
