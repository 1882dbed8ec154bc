// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "test_step/test_step.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = TestStepParams;
    return Declare<P>("test-step", 1)
        .summary("Passes a cloud through, or misbehaves as it is told to; for tests only.")
        .source("Hand-made")
        .ties("Nothing is compared.")
        .not_finite("Passed through as they are.")
        .in<PointCloud>("points", "Any cloud; without one, the corners of the unit tetrahedron.", optional)
        .in<PointCloud>("more", "More clouds, which are only counted.", list, optional)
        .out<PointCloud>("points", "The cloud times the factor, with its columns and its frame.")
        .out<TriangleMesh>("mesh", "A right-angled tetrahedron at the frame's origin.")
        .choice("mode", &P::mode,
                {{"pass", P::Mode::pass, "Does what a filter does."},
                 {"fail", P::Mode::fail, "Throws an Error with a hint."},
                 {"throw", P::Mode::throw_standard, "Throws a std::runtime_error."},
                 {"out-of-memory", P::Mode::out_of_memory, "Throws a std::bad_alloc."},
                 {"empty", P::Mode::empty, "Gives an empty mesh."},
                 {"wait", P::Mode::wait, "Goes on until it is cancelled."},
                 {"warn", P::Mode::warn, "Warns once."},
                 {"doubt", P::Mode::doubt, "Doubts all outputs."},
                 {"doubt-mesh", P::Mode::doubt_mesh, "Doubts the output `mesh`."},
                 {"slow", P::Mode::slow, "Takes 30 ms."},
                 {"held", P::Mode::held, "Waits while there is a file that SCANMILL_TEST_HOLD names."},
                 {"crash", P::Mode::crash, "Raises SIGSEGV."},
                 {"kill", P::Mode::kill, "Takes 96 MiB and raises SIGKILL."},
                 {"abort", P::Mode::abort, "Aborts the process."},
                 {"throw-number", P::Mode::throw_number, "Throws an int."},
                 {"loop", P::Mode::loop, "Never returns, whoever asks."},
                 {"allocate", P::Mode::allocate, "Takes memory until there is none."},
                 {"write", P::Mode::write, "Writes to standard output and error."},
                 {"leak", P::Mode::leak, "Leaves files open."},
                 {"exit", P::Mode::exit, "Ends the process as if all were well."},
                 {"change-folder", P::Mode::change_folder, "Changes the process's working folder."},
                 {"undeclared-metric", P::Mode::undeclared_metric, "Reports a metric that it does not declare."},
                 {"babble", P::Mode::babble, "Warns 50,000 times."},
                 {"close-streams", P::Mode::close_streams, "Closes standard output and error."},
                 {"close-channel", P::Mode::close_channel, "Closes the channel to the runner, and never returns."}},
                "What becomes of the run.")
        .param("log", &P::log, "A file that every run appends a line to: mode, number of points.")
        .param("length", &P::length, "Legs of the tetrahedron.", above(0))
        .param("factor", &P::factor, "What positions are multiplied by.")
        .doubts({"it is asked to doubt"})
        .metric("points", Unit::count, "Points that came out.", headline)
        .metric("more", Unit::count, "Points that came in at the port `more`.")
        .metric("length", Unit::length, "The parameter `length` in the scan's unit.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            PointCloud corners;
            corners.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
            const PointCloud* given = inputs.find<PointCloud>("points");
            double more = 0;
            for (const auto& cloud : inputs.list<PointCloud>("more")) more += static_cast<double>(cloud->size());
            context.metric("more", more);
            TestStepResult result = test_step(given ? *given : corners, params, context);
            return Outputs().set("points", std::move(result.points)).set("mesh", std::move(result.mesh));
        });
}
