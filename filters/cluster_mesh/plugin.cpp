// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "cluster_mesh/cluster_mesh.hpp"

using namespace scanmill;
