// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Our files as read by assimp: every mesh of the scene, transformed by its nodes.

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>

#include "core/formats/support.hpp"

namespace scanmill::test {

struct SeenByAssimp {
    std::string error;  ///< empty when it could read the file
    std::size_t meshes = 0, vertices = 0, faces = 0;
    unsigned primitive_types = 0;  ///< aiPrimitiveType
    BoundingBox box;
    std::vector<Vec3> positions, normals;
    std::vector<std::array<double, 4>> colours;
};

inline void add_seen(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, SeenByAssimp& seen) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
        ++seen.meshes;
        seen.vertices += mesh.mNumVertices;
        seen.faces += mesh.mNumFaces;
        seen.primitive_types |= mesh.mPrimitiveTypes;
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D p = transform * mesh.mVertices[v];
            seen.positions.emplace_back(p.x, p.y, p.z);
            seen.box.low = seen.box.low.cwiseMin(seen.positions.back());
            seen.box.high = seen.box.high.cwiseMax(seen.positions.back());
            if (mesh.HasNormals())
                seen.normals.emplace_back(mesh.mNormals[v].x, mesh.mNormals[v].y, mesh.mNormals[v].z);
            if (mesh.HasVertexColors(0)) {
                const aiColor4D& c = mesh.mColors[0][v];
                seen.colours.push_back({c.r, c.g, c.b, c.a});
            }
        }
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) add_seen(scene, *node.mChildren[i], transform, seen);
}

template <class T>
SeenByAssimp through_assimp(const T& object, const char* name, Warnings* warnings = nullptr) {
    const TemporaryFolder folder;
    write_file(folder / name, std::make_shared<const T>(object), warnings ? warnings->writing() : WriteOptions{});
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile((folder / name).string(), 0);
    SeenByAssimp seen;
    if (scene && scene->mRootNode)
        add_seen(*scene, *scene->mRootNode, aiMatrix4x4(), seen);
    else
        seen.error = std::string("not read: ") + importer.GetErrorString();
    return seen;
}

}  // namespace scanmill::test
