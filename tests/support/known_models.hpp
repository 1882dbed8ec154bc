// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Well-known closed models in one piece, whose vertices are as good as a scan: those with points enough for their
/// genus.

#include <array>
#include <cctype>
#include <ostream>

#include "support/real_data.hpp"

namespace scanmill::test {

struct Model {
    const char* file;  ///< under build/data, or ../shared/data when it begins with a number
    long genus;        ///< genus of the model, which is closed and connected
};

inline void PrintTo(const Model& model, std::ostream* stream) { *stream << model.file; }

inline std::optional<std::filesystem::path> found(const Model& model) {
    return std::isdigit(model.file[0]) ? shared_data(model.file) : fetched_data(model.file);
}

/// An alpha-solid is enough.
inline constexpr std::array<Model, 14> dense_models{{{"meshes/bear.off", 0},
                                                     {"meshes/bear_bis.off", 0},
                                                     {"meshes/blobby.off", 0},
                                                     {"meshes/cube-meshed.off", 0},
                                                     {"meshes/ellipe0.003.off", 0},
                                                     {"meshes/larger_sphere.off", 0},
                                                     {"meshes/retinal.off", 0},
                                                     {"meshes/sphere966.off", 0},
                                                     {"6-formats/obj/ok/trimesh_ico4.obj", 0},
                                                     {"6-formats/ply/ok/trimesh_sphere.ply", 0},
                                                     {"meshes/eight.off", 2},
                                                     {"meshes/knot.off", 1},
                                                     {"meshes/knot1.off", 1},
                                                     {"6-formats/stl/ok/trimesh_torus.STL", 1}}};

/// Points lie in creases and grooves narrower than 2 alpha.
inline constexpr std::array<Model, 20> grooved_models{{{"meshes/armadillo.off", 0},
                                                       {"meshes/bull.off", 0},
                                                       {"meshes/bunny00.off", 0},
                                                       {"meshes/cactus.off", 0},
                                                       {"meshes/camel.off", 0},
                                                       {"meshes/cow.off", 0},
                                                       {"meshes/dino.off", 0},
                                                       {"meshes/diplodocus.off", 0},
                                                       {"meshes/fandisk.off", 0},
                                                       {"meshes/fandisk_large.off", 0},
                                                       {"meshes/hand.off", 0},
                                                       {"meshes/handle.off", 0},
                                                       {"meshes/homer.off", 0},
                                                       {"meshes/oblong.off", 0},
                                                       {"meshes/spool.off", 0},
                                                       {"meshes/triceratops.off", 0},
                                                       {"7-seed-like/femur_gfxmorph.stl", 0},
                                                       {"meshes/anchor_dense.off", 4},
                                                       {"meshes/refined_elephant.off", 3},
                                                       {"meshes/turbine.off", 11}}};

}  // namespace scanmill::test
