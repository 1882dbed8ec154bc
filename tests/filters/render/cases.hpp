// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Scenes and pictures for the tests of render.

#include <algorithm>
#include <cmath>

#include "render/render.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {

inline Picture picture_of(const Drawable& scene, const RenderParams& params = {}, unsigned threads = 2,
                          const Drawable& over = {}, const Drawable& truth = {}) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return render({scene, over, truth}, params, context);
}

/// 200 x 200 pixels, seen from above.
inline RenderParams from_above(CameraView view = CameraView::top) {
    RenderParams params;
    params.size = {200, 200};
    params.camera = {view};
    params.up = UpAxis::z;
    params.legend = false;
    return params;
}

inline Colour pixel(const Picture& picture, u32 x, u32 y) { return picture.pixels[std::size_t(y) * picture.width + x]; }
inline double brightness(const Colour& colour) { return (colour[0] + colour[1] + colour[2]) / 3.0; }
inline bool is_white(const Colour& colour) { return colour == Colour{255, 255, 255}; }

/// The largest difference of a channel.
inline int difference(const Colour& one, const Colour& other) {
    int largest = 0;
    for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, std::abs(int(one[i]) - int(other[i])));
    return largest;
}

/// Whether a colour is this one, laid over white with a share of at least 0.3.
inline bool is_tinted(const Colour& colour, const Colour& ink) {
    double share = 0;
    for (std::size_t i = 0; i < 3; ++i)
        if (ink[i] < 255) share = std::max(share, (255.0 - colour[i]) / (255 - ink[i]));
    if (share < 0.3 || share > 1.1) return false;
    for (std::size_t i = 0; i < 3; ++i)
        if (std::abs(255 - share * (255 - ink[i]) - colour[i]) > 25) return false;
    return true;
}

/// A square around the origin, facing up.
inline TriangleMesh centred_square(double side, double height = 0) {
    return shifted(rectangle(side, side), {-side / 2, -side / 2, height});
}

template <class Wanted>
std::size_t count_pixels(const Picture& picture, Wanted&& wanted) {
    return static_cast<std::size_t>(std::ranges::count_if(picture.pixels, wanted));
}

inline bool operator==(const Picture& one, const Picture& other) {
    return one.width == other.width && one.height == other.height && one.caption == other.caption &&
           std::ranges::equal(one.pixels, other.pixels);
}

/// The square [0, 1]² at z = 0, facing up, with a vertex column.
inline TriangleMesh square_with(const std::string& name, const Array<double>& values, int length_exponent = 0) {
    TriangleMesh mesh;
    mesh.positions = Array<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.triangles = Array<Triangle>{{0, 1, 2}, {0, 2, 3}};
    mesh.vertex_columns.add(Column(name, 1, Buffer<double>(values)).with_length_exponent(length_exponent));
    return mesh;
}

}  // namespace scanmill::test
