// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/declared_filters.hpp"

#include "scanmill/plugin/module.hpp"

namespace scanmill::test {

namespace {

struct Nothing {};

enum class Rule { nearest, random };

struct ThinParams {
    Length size = Length::percent_of_diagonal(1);
    int count = 1;
    Rule rule = Rule::nearest;
    std::vector<double> axis{0, 0, 1};
};

struct SolidParams {
    std::optional<Length> alpha;
    Ratio coverage = Ratio::percent(100);
    Angle angle = Angle::degrees(40);
};

struct SimplifyParams {
    Length max_error;
    double target = 0;
};

const char* const help = "As its name says.";

template <class Params>
Declare<Params> declare(std::string name) {
    Declare<Params> declaration(std::move(name), 1);
    declaration.summary("Does what its name says.")
        .source("Hand-made for tests")
        .ties("There are none.")
        .not_finite(help);
    return declaration;
}

}  // namespace

DeclaredFilters::DeclaredFilters() {
    const auto spec = [](const FilterDeclaration& declaration) { return declaration.spec; };
    add(spec(
        declare<ThinParams>("thin")
            .in<PointCloud>("points", help)
            .out<PointCloud>("points", help)
            .param("size", &ThinParams::size, help, above(0))
            .param("count", &ThinParams::count, help, at_least(1), at_most(9))
            .choice("rule", &ThinParams::rule, {{"nearest", Rule::nearest, help}, {"random", Rule::random, help}}, help)
            .param("axis", &ThinParams::axis, help, size(3))
            .metric("kept", Unit::count, help)));
    add(spec(declare<Nothing>("tetrahedralise").in<PointCloud>("points", help).out<TetMesh>("tets", help)));
    add(spec(declare<SolidParams>("solid")
                 .in<TetMesh>("tets", help)
                 .out<TriangleMesh>("mesh", help)
                 .out<TetMesh>("tets", help)
                 .param("alpha", &SolidParams::alpha, help, above(0), word("auto"))
                 .param("coverage", &SolidParams::coverage, help, above(0), at_most(1))
                 .param("angle", &SolidParams::angle, help, at_least(0), at_most(180))
                 .metric("alpha", Unit::length, help)
                 .metric("volume", Unit::volume, help)
                 .metric("skin", Unit::area, help)
                 .metric("bending", Unit::angle, help)));
    add(spec(declare<SimplifyParams>("simplify")
                 .in<TriangleMesh>("mesh", help)
                 .out<TriangleMesh>("mesh", help)
                 .param("max-error", &SimplifyParams::max_error, help, above(0), required)
                 .param("target", &SimplifyParams::target, help)));
    add(spec(declare<Nothing>("register")
                 .in<PointCloud>("source", help)
                 .in<PointCloud>("target", help)
                 .out<Transforms>("transform", help)));
    add(spec(declare<Nothing>("combine").in<PointCloud>("points", help, list).out<PointCloud>("points", help)));
    add(spec(declare<Nothing>("pair")
                 .in<PointCloud>("points", help)
                 .out<PointCloud>("left", help)
                 .out<PointCloud>("right", help)));
    add(spec(declare<Nothing>("make").in<TriangleMesh>("mesh", help, optional).out<PointCloud>("points", help)));
}

FilterSpec drawing_filter(std::string name) {
    return FilterDeclaration(declare<Nothing>(std::move(name))
                                 .in<TriangleMesh, PointCloud, FeatureGraph>("scene", help)
                                 .in<Metrics>("scale", help, optional)
                                 .out<Picture>("picture", help)
                                 .draws("scene"))
        .spec;
}

void DeclaredFilters::add(const FilterSpec& spec) {
    folder_.write("scanmill-" + spec.name + ".json", to_json_text({abi_text(), spec}));
    folder_.write("scanmill-" + spec.name + ".so", "never loaded");
}

}  // namespace scanmill::test
