// SPDX-License-Identifier: GPL-3.0-or-later
#include "glb.h"

#define TINYGLTF_IMPLEMENTATION
#include "gltf.h"

#include <cstring>
#include <stdexcept>

namespace imomushi::samples {

void writeGlb(const RenderMesh& mesh, const std::string& name, const std::filesystem::path& path) {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "imomushi samples";
    model.buffers.emplace_back();
    auto& data = model.buffers[0].data;
    const auto view = [&](const void* bytes, std::size_t size, int target) {
        while (data.size() % 4) data.push_back(0);
        tinygltf::BufferView v;
        v.buffer = 0;
        v.byteOffset = data.size();
        v.byteLength = size;
        v.target = target;
        data.insert(data.end(), static_cast<const unsigned char*>(bytes), static_cast<const unsigned char*>(bytes) + size);
        model.bufferViews.push_back(v);
        return int(model.bufferViews.size()) - 1;
    };
    const auto accessor = [&](int bufferView, int componentType, int type, std::size_t count) {
        tinygltf::Accessor a;
        a.bufferView = bufferView;
        a.componentType = componentType;
        a.type = type;
        a.count = count;
        model.accessors.push_back(a);
        return int(model.accessors.size()) - 1;
    };
    const std::size_t n = mesh.positions.size();
    tinygltf::Primitive primitive;
    const int positions = accessor(view(mesh.positions.data(), 12 * n, TINYGLTF_TARGET_ARRAY_BUFFER), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, n);
    for (int k = 0; k < 3; ++k) {
        float low = mesh.positions[0][k], high = low;
        for (const auto& p : mesh.positions) low = std::min(low, p[k]), high = std::max(high, p[k]);
        model.accessors[positions].minValues.push_back(low);
        model.accessors[positions].maxValues.push_back(high);
    }
    primitive.attributes["POSITION"] = positions;
    primitive.attributes["NORMAL"] =
        accessor(view(mesh.normals.data(), 12 * n, TINYGLTF_TARGET_ARRAY_BUFFER), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, n);
    primitive.attributes["TEXCOORD_0"] =
        accessor(view(mesh.texCoords.data(), 8 * n, TINYGLTF_TARGET_ARRAY_BUFFER), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, n);
    std::vector<unsigned short> indices;
    for (const auto& t : mesh.triangles)
        for (int v : t) indices.push_back(static_cast<unsigned short>(v));
    primitive.indices = accessor(view(indices.data(), 2 * indices.size(), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER),
                                 TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_SCALAR, indices.size());
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = 0;

    tinygltf::Image image;
    image.name = name;
    image.mimeType = "image/png";
    image.bufferView = view(mesh.png.data(), mesh.png.size(), 0);
    model.images.push_back(image);
    tinygltf::Texture texture;
    texture.source = 0;
    model.textures.push_back(texture);
    tinygltf::Material material;
    material.name = name;
    material.pbrMetallicRoughness.baseColorTexture.index = 0;
    material.pbrMetallicRoughness.metallicFactor = 0.0;
    material.pbrMetallicRoughness.roughnessFactor = 0.45;
    model.materials.push_back(material);

    tinygltf::Mesh body;
    body.name = name;
    body.primitives.push_back(primitive);
    model.meshes.push_back(body);
    tinygltf::Node node;
    node.name = name;
    node.mesh = 0;
    model.nodes.push_back(node);
    tinygltf::Scene scene;
    scene.nodes.push_back(0);
    model.scenes.push_back(scene);
    model.defaultScene = 0;
    while (data.size() % 4) data.push_back(0);
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToFile(&model, path.string(), true, true, false, true))
        throw std::runtime_error("Cannot write " + path.string());
}

}  // namespace imomushi::samples
