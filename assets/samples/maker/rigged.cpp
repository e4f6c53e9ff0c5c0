// SPDX-License-Identifier: GPL-3.0-or-later
#include "rigged.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "encode_png.h"
#include "gltf.h"

namespace imomushi::samples {

namespace {

constexpr int kMargin = 3;  // texels around each chart, painted like its rim

/// A part in its charts: vertices on the rim of a chart are doubled.
struct Unrolled {
    std::vector<int> source;                        // vertex of the part's mesh
    std::vector<int> chart;                         // of each vertex
    std::vector<Eigen::Vector2d> flat;              // m, then texels
    std::vector<std::array<int, 3>> triangles;
    std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> boxes;  // of the charts, m: low, size
};

Unrolled unroll(const RiggedPart& part) {
    Unrolled u;
    std::map<std::pair<int, int>, int> made;
    u.boxes.assign(part.charts.size(), {Eigen::Vector2d::Constant(1e9), Eigen::Vector2d::Constant(-1e9)});
    for (const auto& t : part.mesh.triangles) {
        const Vec3 &a = part.mesh.points[t[0]], &b = part.mesh.points[t[1]], &c = part.mesh.points[t[2]], middle = (a + b + c) / 3, n = (b - a).cross(c - a).normalized();
        int chart = 0;
        while (chart + 1 < int(part.charts.size()) && !part.charts[chart].holds(middle, n)) ++chart;
        std::array<int, 3> flat{};
        for (int k = 0; k < 3; ++k) {
            const auto [it, fresh] = made.try_emplace({chart, t[k]}, int(u.source.size()));
            if (fresh) {
                u.source.push_back(t[k]);
                u.chart.push_back(chart);
                u.flat.push_back(part.charts[chart].unroll(part.mesh.points[t[k]]));
                auto& [low, high] = u.boxes[chart];
                low = low.cwiseMin(u.flat.back());
                high = high.cwiseMax(u.flat.back());
            }
            flat[k] = it->second;
        }
        u.triangles.push_back(flat);
    }
    for (auto& [low, high] : u.boxes) high = (high - low).cwiseMax(0.0);
    return u;
}

/// Puts all charts on shelves of one square with the largest scale at which they fit; turns `flat` into texels. Returns texels per metre.
double pack(std::vector<Unrolled>& parts, int size) {
    std::vector<std::pair<int, int>> order;
    for (int p = 0; p < int(parts.size()); ++p)
        for (int c = 0; c < int(parts[p].boxes.size()); ++c) order.push_back({p, c});
    const auto box = [&](std::pair<int, int> at) -> const Eigen::Vector2d& { return parts[at.first].boxes[at.second].second; };
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return box(a).y() > box(b).y(); });
    std::vector<Eigen::Vector2d> corner(order.size());
    const auto fits = [&](double scale) {
        double x = 0, y = 0, shelf = 0;
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Eigen::Vector2d b = scale * box(order[i]) + Eigen::Vector2d::Constant(2 * kMargin);
            if (x + b.x() > size) x = 0, y += shelf, shelf = 0;
            if (b.x() > size || y + b.y() > size) return false;
            corner[i] = {x + kMargin, y + kMargin};
            x += b.x();
            shelf = std::max(shelf, b.y());
        }
        return true;
    };
    double low = 1, high = 10.0 * size;
    for (int i = 0; i < 40; ++i) {
        const double middle = (low + high) / 2;
        (fits(middle) ? low : high) = middle;
    }
    if (!fits(low)) throw std::runtime_error("The charts do not fit into the texture.");
    for (std::size_t i = 0; i < order.size(); ++i) {
        Unrolled& part = parts[order[i].first];
        for (std::size_t v = 0; v < part.flat.size(); ++v)
            if (part.chart[v] == order[i].second) part.flat[v] = corner[i] + low * (part.flat[v] - part.boxes[order[i].second].first);
    }
    return low;
}

/// The texture: every texel of a triangle is the paint of the surface point under it; texels around are filled from their neighbours.
std::vector<unsigned char> bake(const RiggedCharacter& c, const std::vector<Unrolled>& parts, double scale) {
    const int size = c.textureSize;
    std::vector<Vec3> colour(static_cast<std::size_t>(size) * size, Vec3::Constant(-1));
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (const auto& t : parts[p].triangles) {
            const Eigen::Vector2d &a = parts[p].flat[t[0]], &b = parts[p].flat[t[1]], &d = parts[p].flat[t[2]];
            const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); };
            const double area = cross(b - a, d - a);
            if (std::abs(area) < 1e-9) continue;
            const Eigen::Vector2d low = a.cwiseMin(b).cwiseMin(d), high = a.cwiseMax(b).cwiseMax(d);
            for (int y = std::max(int(low.y()) - 1, 0); y <= std::min(int(high.y()) + 1, size - 1); ++y)
                for (int x = std::max(int(low.x()) - 1, 0); x <= std::min(int(high.x()) + 1, size - 1); ++x) {
                    const Eigen::Vector2d q(x + 0.5, y + 0.5);
                    const double wb = cross(q - a, d - a) / area, wd = cross(b - a, q - a) / area, wa = 1 - wb - wd;
                    if (std::min({wa, wb, wd}) < -1e-6) continue;
                    const auto& points = c.parts[p].mesh.points;
                    const Vec3 at = wa * points[parts[p].source[t[0]]] + wb * points[parts[p].source[t[1]]] + wd * points[parts[p].source[t[2]]];
                    const Vec3 n = normal(c.parts[p].shape, at);
                    double open = 0;  // how far the surroundings stay outside along the normal
                    for (double step : {0.03, 0.07, 0.14}) open += std::clamp(c.shape(at + step * n) / step, 0.0, 1.0) / 3;
                    colour[static_cast<std::size_t>(y) * size + x] = c.parts[p].paint(at, n, 1 / scale) * (1 - c.shade * (1 - open));
                }
        }
    for (int round = 0; round < kMargin; ++round) {
        const auto before = colour;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                if (before[static_cast<std::size_t>(y) * size + x].x() >= 0) continue;
                Vec3 sum = Vec3::Zero();
                int count = 0;
                for (int v = std::max(y - 1, 0); v <= std::min(y + 1, size - 1); ++v)
                    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, size - 1); ++u)
                        if (const Vec3& near = before[static_cast<std::size_t>(v) * size + u]; near.x() >= 0) sum += near, ++count;
                if (count > 0) colour[static_cast<std::size_t>(y) * size + x] = sum / count;
            }
    }
    std::vector<unsigned char> pixels(3 * colour.size(), 0);
    for (std::size_t i = 0; i < colour.size(); ++i)
        for (int k = 0; k < 3; ++k) pixels[3 * i + k] = static_cast<unsigned char>(std::lround(255 * std::clamp(colour[i][k], 0.0, 1.0)));
    return encodePng(pixels, size, size);
}

/// A glTF model with its one buffer.
struct Writer {
    tinygltf::Model model;

    template <class T>
    int accessor(const std::vector<T>& values, int component, int type, std::size_t count, int target) {
        auto& data = model.buffers[0].data;
        while (data.size() % 4) data.push_back(0);
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = data.size();
        view.byteLength = values.size() * sizeof(T);
        view.target = target;
        const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
        data.insert(data.end(), bytes, bytes + view.byteLength);
        model.bufferViews.push_back(view);
        tinygltf::Accessor a;
        a.bufferView = int(model.bufferViews.size()) - 1;
        a.componentType = component;
        a.type = type;
        a.count = count;
        model.accessors.push_back(a);
        return int(model.accessors.size()) - 1;
    }
    int floats(const std::vector<float>& values, int type, int width, int target, bool bounds = false) {
        const int at = accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, type, values.size() / width, target);
        for (int k = 0; bounds && k < width; ++k) {
            float low = values[k], high = low;
            for (std::size_t i = k; i < values.size(); i += width) low = std::min(low, values[i]), high = std::max(high, values[i]);
            model.accessors[at].minValues.push_back(low);
            model.accessors[at].maxValues.push_back(high);
        }
        return at;
    }
};

void put(std::vector<float>& values, const Vec3& v) {
    for (int k = 0; k < 3; ++k) values.push_back(float(v[k]));
}

/// Joints and weights of one vertex: the four largest, summing to 1.
void putWeights(std::vector<double> w, std::vector<unsigned char>& joints, std::vector<float>& weights) {
    std::vector<int> order(w.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return w[a] > w[b]; });
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += w[order[k]] < 0.01 * w[order[0]] ? w[order[k]] = 0.0 : w[order[k]];
    for (int k = 0; k < 4; ++k) {
        const auto weight = float(w[order[k]] / sum);
        joints.push_back(weight > 0 ? static_cast<unsigned char>(order[k]) : 0);
        weights.push_back(weight);
    }
}

tinygltf::Mesh meshOf(Writer& out, const RiggedPart& part, const Unrolled& u, int size, int material) {
    std::vector<float> positions, normals, texCoords, weights, morph;
    std::vector<unsigned char> joints;
    std::vector<unsigned short> indices;
    for (std::size_t v = 0; v < u.source.size(); ++v) {
        const Vec3& p = part.mesh.points[u.source[v]];
        put(positions, p);
        put(normals, normal(part.shape, p));
        for (int k = 0; k < 2; ++k) texCoords.push_back(float(u.flat[v][k] / size));
        putWeights(part.weights(p), joints, weights);
        if (!part.morph.empty()) put(morph, part.morphBy(p));
    }
    for (const auto& t : u.triangles)
        for (int v : t) indices.push_back(static_cast<unsigned short>(v));
    constexpr int kVertices = TINYGLTF_TARGET_ARRAY_BUFFER;
    tinygltf::Primitive primitive;
    primitive.attributes["POSITION"] = out.floats(positions, TINYGLTF_TYPE_VEC3, 3, kVertices, true);
    primitive.attributes["NORMAL"] = out.floats(normals, TINYGLTF_TYPE_VEC3, 3, kVertices);
    primitive.attributes["TEXCOORD_0"] = out.floats(texCoords, TINYGLTF_TYPE_VEC2, 2, kVertices);
    primitive.attributes["JOINTS_0"] = out.accessor(joints, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_TYPE_VEC4, u.source.size(), kVertices);
    primitive.attributes["WEIGHTS_0"] = out.floats(weights, TINYGLTF_TYPE_VEC4, 4, kVertices);
    primitive.indices = out.accessor(indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_SCALAR, indices.size(), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = material;
    tinygltf::Mesh mesh;
    mesh.name = part.name;
    if (!part.morph.empty()) {
        primitive.targets.push_back({{"POSITION", out.floats(morph, TINYGLTF_TYPE_VEC3, 3, kVertices, true)}});
        mesh.weights = {0.0};
        mesh.extras = tinygltf::Value(tinygltf::Value::Object{{"targetNames", tinygltf::Value(tinygltf::Value::Array{tinygltf::Value(part.morph)})}});
    }
    mesh.primitives.push_back(primitive);
    return mesh;
}

void addMaterials(Writer& out, const RiggedCharacter& c, std::vector<int>& ofPart) {
    std::map<std::string, int> made;
    for (const RiggedPart& part : c.parts) {
        const auto [it, fresh] = made.try_emplace(part.material, int(made.size()));
        ofPart.push_back(it->second);
        if (!fresh) continue;
        tinygltf::Material material;
        material.name = part.material;
        material.pbrMetallicRoughness.baseColorTexture.index = 0;
        material.pbrMetallicRoughness.metallicFactor = 0.0;
        material.pbrMetallicRoughness.roughnessFactor = part.roughness;
        out.model.materials.push_back(material);
    }
}

/// Nodes of the joints come first, in their order.
void addSkeleton(Writer& out, const RiggedCharacter& c) {
    std::vector<float> inverse;
    tinygltf::Skin skin;
    skin.name = c.name;
    for (std::size_t j = 0; j < c.joints.size(); ++j) {
        const RigJoint& joint = c.joints[j];
        const Vec3 from = joint.parent < 0 ? joint.place : Vec3(joint.place - c.joints[joint.parent].place);
        tinygltf::Node node;
        node.name = joint.name;
        node.translation = {from.x(), from.y(), from.z()};
        out.model.nodes.push_back(node);
        if (joint.parent >= 0) out.model.nodes[joint.parent].children.push_back(int(j));
        skin.joints.push_back(int(j));
        for (float v : {1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f}) inverse.push_back(v);
        put(inverse, -joint.place);
        inverse.push_back(1.f);
    }
    skin.inverseBindMatrices = out.floats(inverse, TINYGLTF_TYPE_MAT4, 16, 0);
    skin.skeleton = 0;
    out.model.skins.push_back(skin);
}

void addClips(Writer& out, const RiggedCharacter& c) {
    for (const RigClip& clip : c.clips) {
        tinygltf::Animation animation;
        animation.name = clip.name;
        for (const RigTurn& turn : clip.turns) {
            std::vector<float> turns;
            for (double angle : turn.angles) {
                const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, turn.axis));
                for (double v : {q.x(), q.y(), q.z(), q.w()}) turns.push_back(float(v));
            }
            tinygltf::AnimationSampler sampler;
            sampler.input = out.floats(turn.times, TINYGLTF_TYPE_SCALAR, 1, 0, true);
            sampler.output = out.floats(turns, TINYGLTF_TYPE_VEC4, 4, 0);
            sampler.interpolation = "LINEAR";
            tinygltf::AnimationChannel channel;
            channel.sampler = int(animation.samplers.size());
            channel.target_node = turn.joint;
            channel.target_path = "rotation";
            animation.samplers.push_back(sampler);
            animation.channels.push_back(channel);
        }
        out.model.animations.push_back(animation);
    }
}

}  // namespace

void writeRiggedGlb(const RiggedCharacter& c, const std::filesystem::path& path) {
    std::vector<Unrolled> unrolled;
    for (const RiggedPart& part : c.parts) unrolled.push_back(unroll(part));
    const double scale = pack(unrolled, c.textureSize);

    Writer out;
    out.model.asset.version = "2.0";
    out.model.asset.generator = "imomushi samples";
    out.model.buffers.emplace_back();
    std::vector<int> material;
    addMaterials(out, c, material);
    addSkeleton(out, c);
    tinygltf::Scene scene;
    scene.nodes.push_back(0);
    for (std::size_t p = 0; p < c.parts.size(); ++p) {
        out.model.meshes.push_back(meshOf(out, c.parts[p], unrolled[p], c.textureSize, material[p]));
        tinygltf::Node node;
        node.name = c.parts[p].name;
        node.mesh = int(p);
        node.skin = 0;
        scene.nodes.push_back(int(out.model.nodes.size()));
        out.model.nodes.push_back(node);
    }
    addClips(out, c);
    const std::vector<unsigned char> png = bake(c, unrolled, scale);
    auto& data = out.model.buffers[0].data;
    while (data.size() % 4) data.push_back(0);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = png.size();
    data.insert(data.end(), png.begin(), png.end());
    while (data.size() % 4) data.push_back(0);
    out.model.bufferViews.push_back(view);
    tinygltf::Image image;
    image.name = c.name;
    image.mimeType = "image/png";
    image.bufferView = int(out.model.bufferViews.size()) - 1;
    out.model.images.push_back(image);
    tinygltf::Texture texture;
    texture.source = 0;
    out.model.textures.push_back(texture);
    out.model.scenes.push_back(scene);
    out.model.defaultScene = 0;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToFile(&out.model, path.string(), true, true, false, true)) throw std::runtime_error("Cannot write " + path.string());
}

}  // namespace imomushi::samples
