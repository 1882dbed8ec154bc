// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/graph/graph.hpp"

namespace scanmill {

std::vector<std::pair<std::string, std::string>> declared_of(const LeafSource& leaf) {
    std::vector<std::pair<std::string, std::string>> texts;
    if (leaf.unit != LengthUnit::unknown) texts.emplace_back("unit", symbol(leaf.unit));
    if (!leaf.frame.empty()) texts.emplace_back("frame", leaf.frame);
    if (leaf.pose) {
        std::string rows;
        for (int row = 0; row < 3; ++row)
            rows += fmt::format("{}[{}, {}, {}, {}]", row > 0 ? ", " : "", leaf.pose->rotation(row, 0),
                                leaf.pose->rotation(row, 1), leaf.pose->rotation(row, 2), leaf.pose->translation[row]);
        texts.emplace_back("pose", "[" + rows + ", [0, 0, 0, 1]]");
    }
    return texts;
}

const std::string& RunGraph::label(const RunNode& node) const {
    static const std::string read = "read";
    const PlannedStep* planned = step(node);
    return planned ? planned->label : read;
}

}  // namespace scanmill
