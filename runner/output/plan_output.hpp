// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A plan for eyes, for Graphviz and for other programs.

#include <string>

#include "scanmill/plan/plan.hpp"

namespace scanmill::runner {

std::string plan_text(const Plan& plan);
std::string plan_dot(const Plan& plan);
std::string plan_json(const Plan& plan);

}  // namespace scanmill::runner
