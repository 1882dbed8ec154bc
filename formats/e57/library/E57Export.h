// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// libE57Format marks what it exports with E57_DLL. It is linked statically, so nothing is exported.
#define E57_DLL
