// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A glTF scene of one node with one mesh of one primitive, and its numbers.

#include <tiny_gltf.h>

#include "scanmill/data/frame.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill::glb {

class GlbModel {
public:
    /// `kind` names the node when the frame has no name.
    GlbModel(const Frame& frame, std::string_view kind);

    tinygltf::Primitive& primitive() { return model_.meshes[0].primitives[0]; }
    tinygltf::Node& node() { return model_.nodes[0]; }
    tinygltf::Material& material() { return model_.materials[0]; }

    void reserve(std::size_t size) { bytes().reserve(size); }
    /// The place of `count` rows, `stride` bytes each, all zero; it moves with the next call unless room was reserved.
    /// The constants are tinygltf's.
    unsigned char* add_accessor(std::size_t count, std::size_t stride, int type, int component_type, int target);
    tinygltf::Accessor& last_accessor() { return model_.accessors.back(); }
    int last_index() const { return static_cast<int>(model_.accessors.size()) - 1; }

    /// Throws Error, also that of whoever stores the bytes.
    void write(OutputBuffer& out) const;

private:
    std::vector<unsigned char>& bytes() { return model_.buffers[0].data; }
    void add_extras(const Frame& frame);
    void add_material();

    tinygltf::Model model_;
};

}  // namespace scanmill::glb
