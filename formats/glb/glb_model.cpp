// SPDX-License-Identifier: GPL-3.0-or-later
#include "glb/glb_model.hpp"

#include <ostream>
#include <streambuf>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/column_names.hpp"

namespace scanmill::glb {

namespace {

/// What tinygltf writes to goes on at once.
class Passing : public std::streambuf {
public:
    explicit Passing(OutputBuffer& out) : out_(out) {}

private:
    std::streamsize xsputn(const char* bytes, std::streamsize count) override {
        out_.text({bytes, static_cast<std::size_t>(count)});
        return count;
    }
    int_type overflow(int_type byte) override {
        const char c = traits_type::to_char_type(byte);
        out_.text({&c, 1});
        return byte;
    }
    OutputBuffer& out_;
};

}  // namespace

GlbModel::GlbModel(const Frame& frame, std::string_view kind) {
    model_.asset.version = "2.0";
    model_.asset.generator = "Scanmill " SCANMILL_VERSION;
    model_.buffers.emplace_back();
    model_.meshes.emplace_back();
    model_.meshes[0].primitives.emplace_back();
    primitive().material = 0;
    model_.nodes.emplace_back();
    model_.nodes[0].name = frame.name.empty() ? std::string(kind) : valid_text(frame.name);
    model_.nodes[0].mesh = 0;
    model_.scenes.emplace_back();
    model_.scenes[0].nodes = {0};
    model_.defaultScene = 0;
    add_extras(frame);
    add_material();
}

unsigned char* GlbModel::add_accessor(std::size_t count, std::size_t stride, int type, int component_type, int target) {
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes().size();
    view.byteLength = count * stride;
    view.target = target;
    if (target == TINYGLTF_TARGET_ARRAY_BUFFER) view.byteStride = stride;
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size());
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = count;
    bytes().resize(view.byteOffset + view.byteLength);
    unsigned char* const place = bytes().data() + view.byteOffset;
    model_.bufferViews.push_back(std::move(view));
    model_.accessors.push_back(std::move(accessor));
    return place;
}

void GlbModel::write(OutputBuffer& out) const {
    Passing passing(out);
    std::ostream stream(&passing);
    stream.exceptions(std::ios::badbit);  // hands on what the sink throws: a full disk
    constexpr bool pretty = false, binary = true;
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, stream, pretty, binary) || !stream)
        throw Error("tinygltf could not write it").hint("write PLY");
}

void GlbModel::add_extras(const Frame& frame) {
    tinygltf::Value::Object extras;
    if (frame.unit != LengthUnit::unknown) extras["unit"] = tinygltf::Value(std::string(symbol(frame.unit)));
    if (!frame.name.empty()) extras["frame"] = tinygltf::Value(valid_text(frame.name));
    if (!extras.empty()) node().extras = tinygltf::Value(extras);
}

/// The default material is a metal, which is black without something to mirror.
void GlbModel::add_material() {
    model_.materials.emplace_back();
    material().name = "scan";
    material().pbrMetallicRoughness.metallicFactor = 0;
    material().doubleSided = true;
}

}  // namespace scanmill::glb
