// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/gltf_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/export/driver.h"
#include "core/export/gltf_file.h"
#include "core/export/key_reduction.h"

namespace imomushi {

namespace {

using Json = GltfFile::Json;
using Target = GltfFile::Target;

Json vector(const Vec3& v) { return Json::array({static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())}); }

class SceneWriter {
public:
    SceneWriter(const GltfContent& content, ExportReport& report, const Progress& progress)
        : content_(content), scene_(content.scene), options_(content.options), report_(report), progress_(progress) {}

    Result<std::string> write() {
        file_.root["asset"] = {{"version", "2.0"}, {"generator", "Imomushi"}};
        if (options_.quantised) {
            file_.root["extensionsUsed"] = {"KHR_mesh_quantization"};
            file_.root["extensionsRequired"] = {"KHR_mesh_quantization"};
        }
        file_.root["scene"] = 0;
        const std::size_t count = content_.surfaces.size();
        const bool skinned = options_.layout != ExportLayout::Baked;
        chooseUnits();
        if (skinned) addSkeleton();
        Json roots = Json::array(), children = Json::array();
        if (skinned) roots.push_back(root_);
        for (std::size_t e = 0; e < count; ++e) {
            if (progress_.cancelled()) return fail(kCancelled, "The export was cancelled.");
            progress_.report("write", 0.7 * static_cast<double>(e) / static_cast<double>(count));
            const int node = addElement(e);
            elementNodes_.push_back(node);
            (skinned ? roots : children).push_back(node);
        }
        if (!skinned) {
            Json node{{"name", scene_.name}};
            if (!children.empty()) node["children"] = std::move(children);
            roots.push_back(file_.add("nodes", std::move(node)));
        }
        for (std::size_t c = 0; c < content_.motion.clips.size(); ++c) addClip(c);
        Json scene{{"name", scene_.name}, {"nodes", std::move(roots)}};
        scene["extras"] = {{"unit", "m"}, {"fps", options_.fps > 0.0 ? options_.fps : framesPerSecond(content_.motion)}};
        file_.add("scenes", std::move(scene));
        std::string bytes = file_.glb();
        if (bytes.empty()) return fail("too-large", "The file would be larger than glTF allows (4 GiB): choose fewer targets, or export elements by themselves.");
        return bytes;
    }

private:
    [[nodiscard]] bool rigid() const { return options_.layout != ExportLayout::Skinned; }

    /// What positions in the file are multiplied by and shifted from: by the node (baked), by its joint alone (rigged), by all joints alike (skinned).
    struct Unit {
        Vec3 middle = Vec3::Zero();  // m
        float size = 1.0f;           // m
        bool whole = false;          // whole numbers, of -1 ... 1
    };
    [[nodiscard]] Points positionsOf(std::size_t e) const {
        const Vec3 from = rigid() ? Vec3(units_[e].middle - content_.morphs[e].middle) : units_[e].middle;
        return (rigid() ? content_.morphs[e].rest : content_.skin.bind[e]).rowwise() - from.transpose();
    }
    void chooseUnits() {
        units_.resize(content_.surfaces.size());
        for (std::size_t e = 0; rigid() && e < units_.size(); ++e)
            if (options_.quantised || options_.layout == ExportLayout::Baked) units_[e].middle = content_.morphs[e].middle;
        if (!options_.quantised) return;
        Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (std::size_t e = 0; !rigid() && e < units_.size(); ++e)
            for (const std::int32_t v : content_.surfaces[e].body) {
                const Vec3 p = content_.skin.bind[e].row(v).transpose();
                low = low.cwiseMin(p);
                high = high.cwiseMax(p);
            }
        for (std::size_t e = 0; e < units_.size(); ++e) {
            Unit& unit = units_[e];
            if (content_.surfaces[e].body.empty()) continue;
            double most = 0.5 * (high - low).maxCoeff();
            if (rigid()) {
                most = 0.0;
                for (const std::int32_t v : content_.surfaces[e].body) most = std::max(most, content_.morphs[e].rest.row(v).cwiseAbs().maxCoeff());
            } else {
                unit.middle = 0.5 * (low + high);
            }
            // A little more than the farthest: it must not round beyond the range.
            unit.size = static_cast<float>(most * (1.0 + 1e-6));
            unit.whole = unit.size > 0.0f;
            if (!unit.whole) unit.size = 1.0f;
        }
    }

    void addSkeleton() {
        std::vector<float> inverse;
        Json joints = Json::array();
        const auto addJoint = [&](const std::string& name, const Vec3& origin, const Unit& unit) {
            joints.push_back(file_.add("nodes", {{"name", name}, {"translation", vector(origin)}}));
            jointNodes_.push_back(joints.back());
            for (int i = 0; i < 16; ++i)
                inverse.push_back(i == 15 ? 1.0f : i % 5 == 0 ? unit.size : i >= 12 ? static_cast<float>(unit.middle[i - 12] - origin[i - 12]) : 0.0f);
        };
        if (rigid()) {
            for (std::size_t e = 0; e < content_.morphs.size(); ++e) addJoint(scene_.elements[e] + " frame", content_.morphs[e].middle, units_[e]);
        } else {
            const auto drawn = std::find_if(units_.begin(), units_.end(), [](const Unit& unit) { return unit.whole; });
            for (const auto& joint : content_.skin.joints) addJoint(joint.name + " frame", joint.origin, drawn == units_.end() ? Unit{} : *drawn);
        }
        Json root{{"name", scene_.name}, {"children", joints}};
        if (options_.layout == ExportLayout::Rigged) root["extras"] = {{"imomushi", driverData(content_)}};
        root_ = file_.add("nodes", std::move(root));
        file_.add("skins", {{"name", scene_.name}, {"joints", joints}, {"skeleton", root_}, {"inverseBindMatrices", file_.accessor(inverse, 16, Target::None, false)}});
    }

    int addMaterial(std::size_t e, int material) {
        const ElementMesh& mesh = *scene_.character.elements[e].mesh;
        Material m;
        if (material >= 0 && material < static_cast<int>(mesh.renderMesh.materials.size())) {
            m = mesh.renderMesh.materials[static_cast<std::size_t>(material)];
        } else {
            m.name = scene_.elements[e];
            m.baseColor << scene_.colors[e], 1.0f;
            if (content_.surfaces[e].colors.rows() > 0) m.baseColor.setOnes();
        }
        Json color = Json::array();
        for (int i = 0; i < 4; ++i) color.push_back(std::clamp(m.baseColor[i], 0.0f, 1.0f));
        Json surface{{"baseColorFactor", std::move(color)}, {"metallicFactor", std::clamp(m.metallic, 0.0f, 1.0f)}, {"roughnessFactor", std::clamp(m.roughness, 0.0f, 1.0f)}};
        if (m.baseColorTexture >= 0 && content_.surfaces[e].texCoords.rows() > 0)
            if (const int texture = addTexture(mesh.renderMesh.textures[static_cast<std::size_t>(m.baseColorTexture)]); texture >= 0) surface["baseColorTexture"] = {{"index", texture}};
        Json out{{"name", m.name}, {"pbrMetallicRoughness", std::move(surface)}};
        if (m.baseColor[3] < 1.0f) out["alphaMode"] = "BLEND";
        // Elements that were imported together share their materials.
        const std::string key = out.dump(-1, ' ', false, Json::error_handler_t::replace);
        const auto known = materials_.find(key);
        if (known != materials_.end()) return known->second;
        return materials_[key] = file_.add("materials", std::move(out));
    }

    int addTexture(const Texture& texture) {
        if (texture.mimeType != "image/png" && texture.mimeType != "image/jpeg") {
            report_.warnings.push_back(
                {"texture-format", texture.name, "The texture \"" + texture.name + "\" is neither PNG nor JPEG, which glTF needs, and was left out: convert it and import again."});
            return -1;
        }
        const std::string key(texture.bytes.begin(), texture.bytes.end());
        const auto known = textures_.find(key);
        if (known != textures_.end()) return known->second;
        if (textures_.empty()) file_.add("samplers", {{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 10497}, {"wrapT", 10497}});
        const int image = file_.add("images", {{"name", texture.name}, {"mimeType", texture.mimeType}, {"bufferView", file_.view(texture.bytes.data(), texture.bytes.size(), Target::None)}});
        return textures_[key] = file_.add("textures", {{"name", texture.name}, {"sampler", 0}, {"source", image}});
    }

    int addElement(std::size_t e) {
        const RenderSurface& surface = content_.surfaces[e];
        const std::size_t vertices = surface.body.size();
        Json node{{"name", scene_.elements[e]}, {"extras", {{kElementExtra, e}}}};
        const bool morphs = rigid();
        auto& factors = factor_.emplace_back();
        const Unit& unit = units_[e];
        const bool baked = options_.layout == ExportLayout::Baked;
        if (surface.parts.empty()) {
            if (baked) node["translation"] = vector(unit.middle);
            return file_.add("nodes", std::move(node));
        }
        const Points at = positionsOf(e);
        std::vector<float> positions(3 * vertices);
        for (std::size_t i = 0; i < vertices; ++i)
            for (int k = 0; k < 3; ++k) positions[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(at(surface.body[i], k));
        const float most = unit.size;
        const bool small = unit.whole;
        Json attributes{{"POSITION", small ? file_.quantised(positions, most, true) : file_.accessor(positions, 3, Target::Vertices, true)}};
        const std::vector<float> normals(surface.normals.data(), surface.normals.data() + surface.normals.size());
        attributes["NORMAL"] = small && content_.normalTargets.empty() ? file_.quantised(normals, 1.0f, false) : file_.accessor(normals, 3, Target::Vertices, false);
        if (surface.texCoords.rows() > 0)
            attributes["TEXCOORD_0"] = file_.accessor({surface.texCoords.data(), surface.texCoords.data() + surface.texCoords.size()}, 2, Target::Vertices, false);
        if (surface.colors.rows() > 0)
            attributes["COLOR_0"] = file_.accessor({surface.colors.data(), surface.colors.data() + surface.colors.size()}, 4, Target::Vertices, false);
        if (!baked) addInfluences(e, attributes);

        Json targets = Json::array(), names = Json::array(), zeros = Json::array();
        if (morphs) {
            const ElementMorphs& m = content_.morphs[e];
            for (Eigen::Index t = 0; t < m.targets.cols(); ++t) {
                std::vector<float> moved(3 * vertices);
                float reach = 0.0f;
                for (std::size_t i = 0; i < vertices; ++i)
                    for (int k = 0; k < 3; ++k) {
                        const float x = m.targets(3 * surface.body[i] + k, t);
                        moved[3 * i + static_cast<std::size_t>(k)] = x;
                        reach = std::max(reach, std::abs(x));
                    }
                // A target that fills the range of its integers rounds least.
                const float factor = small && reach > 0.0f && reach <= most ? most / reach : 1.0f;
                factors.push_back(factor);
                for (float& x : moved) x *= factor;
                Json target{{"POSITION", small && reach <= most ? file_.quantised(moved, most, true) : file_.accessor(scaledBy(moved, small ? 1.0f / most : 1.0f), 3, Target::Vertices, true)}};
                if (!content_.normalTargets.empty()) target["NORMAL"] = file_.accessor(scaledBy(content_.normalTargets[e][static_cast<std::size_t>(t)], factor), 3, Target::Vertices, false);
                targets.push_back(std::move(target));
                names.push_back(m.names[static_cast<std::size_t>(t)]);
                zeros.push_back(0.0);
            }
            report_.targets = std::max(report_.targets, static_cast<int>(m.targets.cols()));
            double weighed = 0.0;
            for (const auto& track : m.tracks)
                for (Eigen::Index key = 0; small && key < track.weights.cols(); ++key) {
                    double sum = 0.0;
                    for (Eigen::Index t = 0; t < track.weights.rows(); ++t) sum += std::abs(track.weights(t, key)) / factors[static_cast<std::size_t>(t)];
                    weighed = std::max(weighed, sum);
                }
            if (small) rounded(most, 1.0 + weighed, 0.0);
        } else if (small) {
            // Four weights round by a step each, and take a vertex no farther than its joints are apart: a diagonal.
            rounded(most, 1.0, 4.0 / 65535.0);
        }
        Json primitives = Json::array();
        for (const auto& part : surface.parts) {
            Json primitive{{"attributes", attributes}, {"indices", file_.indices(part.triangles, vertices)}, {"material", addMaterial(e, part.material)}};
            if (!targets.empty()) primitive["targets"] = targets;
            primitives.push_back(std::move(primitive));
            report_.triangles += static_cast<int>(part.triangles.size() / 3);
        }
        report_.vertices += static_cast<int>(vertices);
        Json mesh{{"name", scene_.elements[e]}, {"primitives", std::move(primitives)}};
        if (!names.empty()) {
            mesh["weights"] = std::move(zeros);
            mesh["extras"] = {{"targetNames", std::move(names)}};
        }
        node["mesh"] = file_.add("meshes", std::move(mesh));
        if (baked) {
            node["translation"] = vector(unit.middle);
            if (small) node["scale"] = {most, most, most};
        } else {
            node["skin"] = 0;
        }
        return file_.add("nodes", std::move(node));
    }

    /// So many half steps of 16 bits along three axes, and a part of the diagonal.
    void rounded(float unit, double times, double part) {
        report_.quantised = std::max(report_.quantised, times * 0.5 * std::sqrt(3.0) * static_cast<double>(unit) / 32767.0 / content_.motion.diagonal + part);
    }

    static std::vector<float> scaledBy(std::vector<float> numbers, float factor) {
        for (float& x : numbers) x *= factor;
        return numbers;
    }

    void addInfluences(std::size_t e, Json& attributes) {
        const auto& body = content_.surfaces[e].body;
        std::vector<std::uint16_t> joints(4 * body.size(), 0);
        std::vector<float> weights(4 * body.size(), 0.0f);
        for (std::size_t i = 0; i < body.size(); ++i) {
            if (rigid()) {
                joints[4 * i] = static_cast<std::uint16_t>(e);
                weights[4 * i] = 1.0f;
                continue;
            }
            const auto& v = content_.skin.elements[e][static_cast<std::size_t>(body[i])];
            for (std::size_t k = 0; k < FittedSkin::kMax; ++k) {
                joints[4 * i + k] = v.weight[k] > 0.0f ? static_cast<std::uint16_t>(v.joint[k]) : std::uint16_t{0};
                weights[4 * i + k] = v.weight[k];
            }
        }
        attributes["JOINTS_0"] = file_.joints(joints, options_.quantised && jointNodes_.size() <= 256);
        attributes["WEIGHTS_0"] = options_.quantised ? file_.quantisedWeights(weights) : file_.accessor(weights, 4, Target::Vertices, false);
    }

    void addClip(std::size_t c) {
        Json samplers = Json::array(), channels = Json::array();
        std::map<std::vector<std::size_t>, int> inputs;
        const auto& times = content_.motion.clips[c].times;
        const auto input = [&](const std::vector<std::size_t>& keys) {
            const auto known = inputs.find(keys);
            if (known != inputs.end()) return known->second;
            std::vector<float> numbers;
            for (const std::size_t k : keys) numbers.push_back(static_cast<float>(times[k]));
            return inputs[keys] = file_.accessor(numbers, 1, Target::None, true);
        };
        const auto channel = [&](int node, const char* path, const std::vector<std::size_t>& keys, const std::vector<float>& numbers, int width) {
            samplers.push_back({{"input", input(keys)}, {"interpolation", "LINEAR"}, {"output", file_.accessor(numbers, width, Target::None, false)}});
            channels.push_back({{"sampler", samplers.size() - 1}, {"target", {{"node", node}, {"path", path}}}});
        };
        const auto rigidMotion = [&](int node, const std::vector<std::size_t>& keys, const Eigen::Matrix4Xd& rotations, const Eigen::Matrix3Xd& places) {
            std::vector<float> turns, shifts;
            for (const std::size_t k : keys) {
                const Eigen::Vector4f q = rotations.col(static_cast<Eigen::Index>(k)).cast<float>().normalized();
                turns.insert(turns.end(), q.data(), q.data() + 4);
                for (int i = 0; i < 3; ++i) shifts.push_back(static_cast<float>(places(i, static_cast<Eigen::Index>(k))));
            }
            channel(node, "translation", keys, shifts, 3);
            channel(node, "rotation", keys, turns, 4);
        };
        if (!rigid()) {
            std::vector<std::size_t> all(times.size());
            for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
            for (std::size_t j = 0; j < content_.skin.joints.size(); ++j) {
                rigidMotion(jointNodes_[j], all, content_.skin.tracks[c][j].rotations, content_.skin.tracks[c][j].places);
                report_.keys += all.size();
            }
        }
        for (std::size_t e = 0; rigid() && e < content_.morphs.size(); ++e) {
            const ElementMorphs& m = content_.morphs[e];
            const auto& track = m.tracks[c];
            const auto keys = neededKeys(m, track, std::max(options_.tolerance, kAlways) * content_.motion.diagonal);
            report_.keys += keys.size();
            rigidMotion(options_.layout == ExportLayout::Baked ? elementNodes_[e] : jointNodes_[e], keys, track.rotations, track.places);
            if (m.targets.cols() == 0 || content_.surfaces[e].parts.empty()) continue;
            std::vector<float> weights;
            for (const std::size_t k : keys)
                for (Eigen::Index t = 0; t < m.targets.cols(); ++t)
                    weights.push_back(static_cast<float>(track.weights(t, static_cast<Eigen::Index>(k)) / factor_[e][static_cast<std::size_t>(t)]));
            channel(elementNodes_[e], "weights", keys, weights, 1);
        }
        if (channels.empty()) return;
        file_.add("animations", {{"name", scene_.clips[c].name}, {"samplers", std::move(samplers)}, {"channels", std::move(channels)}});
    }

    static constexpr double kAlways = 1e-9;  // of the diagonal: smaller motions are lost in single precision, so their keys are always left out

    const GltfContent& content_;
    const ExportScene& scene_;
    const ExportOptions& options_;
    ExportReport& report_;
    const Progress& progress_;
    GltfFile file_;
    int root_ = -1;
    std::vector<int> elementNodes_, jointNodes_;
    std::vector<Unit> units_;                 // per element
    std::vector<std::vector<float>> factor_;  // per element, per target: what its weights are divided by
    std::map<std::string, int> materials_, textures_;
};

}  // namespace

Result<std::string> writeGltf(const GltfContent& content, ExportReport& report, const Progress& progress) {
    return SceneWriter(content, report, progress).write();
}

}  // namespace imomushi
