// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "transfer/transfer.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = TransferParams;
    return Declare<P>("transfer", 1)
        .summary("Carries columns, above all colours, from one cloud or mesh to the points or vertices of another.")
        .source("Callieri et al. 2008 for the weights; Comaniciu, Meer 2002 for the mode of the colours; IEC 61966-2-1")
        .ties(
            "Among equally near points, corners and triangles, the one with the lowest row counts; among colours with "
            "equal weight, the nearer one.")
        .not_finite(
            "Coordinates: refused, with their number and the first of them. Values: left out of means; a row without "
            "others keeps that of the nearest point.")
        .in<PointCloud, TriangleMesh>(
            "from",
            "Points or a surface with the columns, in the frame and unit of `to`. The columns `normal` and `approach` "
            "of points are used: what faces the other way does not count.")
        .in<TriangleMesh, PointCloud>(
            "to", "The mesh whose vertices, or the points that get the columns. The column `filled` is used.")
        .out_like("result", "to",
                  "`to` with the columns and with the column `transferred`: 1 for rows with values, 0 for rows with "
                  "neutral ones (middle grey for colours, else 0). Columns of the same names are replaced. If `from` "
                  "has no colours and `columns` is `colour`, `to` as it is.")
        .adds({"transferred"})
        .param("columns", &P::columns,
               "Names of the columns, of points, vertices or faces; `colour` is the columns `colour` and `colour16`, "
               "if there are any.",
               word("colour"))
        .choice("method", &P::method,
                {{"nearest", P::Method::nearest,
                  "The values of the nearest point; with a mesh, of the nearest corner of the nearest triangle."},
                 {"blend", P::Method::blend,
                  "The weighted mean of near points, for colours of those similar to most, so that edges stay sharp; "
                  "with a mesh, the value at its nearest point. Integers other than colours are as with `nearest`."}},
                "How values are found.")
        .param("max-distance", &P::max_distance,
               "Rows of `to` that are farther from `from` get no values. `auto` is 1.5 times the median distance of a "
               "point "
               "to its 12th neighbour, about 3 spacings of an even scan; of a mesh, 3 times the median edge.",
               above(0), word("auto"))
        .param("filled", &P::filled, "Whether rows that the column `filled` marks get values, too.")
        .metric("transferred", Unit::count, "Rows of `to` with values of `from`; 0 if no column is carried.")
        .metric("unknown", Unit::count,
                "Rows without values, because nothing that faces the same way is within max-distance.")
        .metric("filled", Unit::count, "Rows without values, because the column `filled` marks them.")
        .metric("max-distance", Unit::length, "The largest distance that was used; 0 if no column is carried.")
        .doubts({"more than 5 % of the rows near `from` face away from it", "the column `filled` marks every row"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            Outputs outputs;
            const auto carry = [&](const auto& from, const auto& to) {
                outputs.set("result", transfer(from, to, params, context).result);
            };
            const auto carry_from = [&](const auto& from) {
                if (const auto* mesh = inputs.find<TriangleMesh>("to")) return carry(from, *mesh);
                carry(from, inputs.get<PointCloud>("to"));
            };
            if (const auto* points = inputs.find<PointCloud>("from"))
                carry_from(*points);
            else
                carry_from(inputs.get<TriangleMesh>("from"));
            return outputs;
        });
}
