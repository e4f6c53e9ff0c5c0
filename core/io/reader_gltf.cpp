// SPDX-License-Identifier: GPL-3.0-or-later
// The scene of a glTF 2.0 file: materials, nodes, meshes at rest. gltf_file_reader.h reads the file itself.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/io/gltf_file_reader.h"
#include "core/base/colour.h"
#include "core/base/finite.h"
#include "core/io/gltf_clips.h"
#include "core/io/gltf_compression.h"
#include "core/io/morph_builder.h"
#include "core/io/reader_support.h"
#include "core/io/rig_builder.h"
#include "core/io/vertex_grids.h"
#include "core/io/vrm_reader.h"

namespace imomushi {
namespace {

using Matrix = Eigen::Matrix4d;

constexpr int kDeepest = 1000;        // nodes within nodes
constexpr double kRounding = 1e-6;    // of a mesh's coordinates: joints that move a vertex by less leave it in its place, in single precision
constexpr double kSameMatrix = 1e-6;  // joints that agree to this move a skin as one: its coordinates stay what the file says

constexpr const char* kDraco = "KHR_draco_mesh_compression";

class GltfReader : GltfFileReader, SceneVertices {
public:
    GltfReader(const SourceFile& file, SceneUse use) : GltfFileReader(file), use_(use), textures_(file, scene_) {}

    RawScene read() {
        scene_.format = isBinary() ? "glb" : "gltf";
        materials();
        const Json& scenes = list("scenes");
        std::vector<char> visited(list("nodes").size(), 0);
        global_.assign(visited.size(), Matrix::Identity());
        std::vector<std::size_t> roots;
        if (!scenes.empty()) {
            const Json& scene = scenes.at(index(member(root(), "scene"), scenes.size(), "scene", 0));
            for (const Json& root : array(member(scene, "nodes"))) roots.push_back(index(root, visited.size(), "node"));
        } else {
            std::vector<char> isChild(visited.size(), 0);
            for (const Json& node : list("nodes"))
                for (const Json& child : array(member(node, "children"))) isChild[index(child, visited.size(), "node")] = 1;
            for (std::size_t n = 0; n < visited.size(); ++n)
                if (!isChild[n]) roots.push_back(n);
        }
        rigNode_.assign(visited.size(), -1);
        for (const std::size_t root : roots) place(root, facing(), -1, visited, 0);
        if (use_ == SceneUse::Elements)
            std::sort(placed_.begin(), placed_.end());
        else
            bones();
        for (const std::size_t n : placed_) node(n);
        return finish();
    }

private:
    // --- materials ---

    /// The toon shader of VRM 0.x says its colour and picture beside the material, 1.0 in the material itself; neither is of metal.
    struct Toon {
        bool any = false;
        std::vector<double> color;  ///< linear, empty: as the material says
        std::optional<Json> texture;
    };
    Toon toonOf(std::size_t material) const {
        Toon toon;
        if (!member(member(list("materials")[material], "extensions"), "VRMC_materials_mtoon").is_null()) toon.any = true;
        const Json& properties = member(member(member(root(), "extensions"), "VRM"), "materialProperties");
        if (!properties.is_array() || material >= properties.size() || text(member(properties[material], "shader")).find("MToon") == std::string::npos) return toon;
        toon.any = true;
        if (!member(list("materials")[material], "pbrMetallicRoughness").is_null()) return toon;
        const Json& color = member(member(properties[material], "vectorProperties"), "_Color");
        if (color.is_array() && color.size() == 4) {
            for (const Json& c : color) toon.color.push_back(number(c, 1.0));
            for (std::size_t k = 0; k < 3; ++k) toon.color[k] = static_cast<double>(linearFromSrgb(toon.color[k]));
        }
        if (const Json& picture = member(member(properties[material], "textureProperties"), "_MainTex"); picture.is_number_unsigned()) toon.texture = picture;
        return toon;
    }

    void materials() {
        std::size_t toons = 0;
        for (std::size_t at = 0; at < list("materials").size(); ++at) {
            const Json& from = list("materials")[at];
            const Toon toon = toonOf(at);
            toons += toon.any ? 1 : 0;
            Material to;
            to.name = cleanName(text(member(from, "name")), "material");
            const Json& pbr = member(from, "pbrMetallicRoughness");
            const Json& gloss = member(member(from, "extensions"), "KHR_materials_pbrSpecularGlossiness");
            const bool glossy = pbr.is_null() && !gloss.is_null();
            const auto color = toon.color.empty() ? numbers(glossy ? member(gloss, "diffuseFactor") : member(pbr, "baseColorFactor"), 4, {1, 1, 1, 1}, "base colour") : toon.color;
            for (int k = 0; k < 4; ++k) to.baseColor[k] = static_cast<float>(std::clamp(color[static_cast<std::size_t>(k)], 0.0, 1.0));
            to.metallic = glossy || toon.any ? 0.0f : static_cast<float>(std::clamp(number(member(pbr, "metallicFactor"), 1.0), 0.0, 1.0));
            to.roughness = static_cast<float>(std::clamp(glossy ? 1.0 - number(member(gloss, "glossinessFactor"), 1.0) : number(member(pbr, "roughnessFactor"), 1.0), 0.0, 1.0));
            UvUse use;
            const Json& info = glossy ? member(gloss, "diffuseTexture") : member(pbr, "baseColorTexture");
            if (!info.is_null()) {
                use.set = number(member(info, "texCoord"), "texture coordinate set", 0);
                if (const Json& transform = member(member(info, "extensions"), "KHR_texture_transform"); !transform.is_null()) {
                    const auto offset = numbers(member(transform, "offset"), 2, {0, 0}, "texture transform"), scale = numbers(member(transform, "scale"), 2, {1, 1}, "texture transform");
                    const double turn = number(member(transform, "rotation"), 0.0), c = std::cos(turn), s = std::sin(turn);
                    use.linear << c * scale[0], s * scale[1], -s * scale[0], c * scale[1];
                    use.offset = {offset[0], offset[1]};
                    use.set = number(member(transform, "texCoord"), "texture coordinate set", use.set);
                }
                to.baseColorTexture = texture(member(info, "index"));
            } else if (toon.texture) {
                to.baseColorTexture = texture(*toon.texture);
            }
            scene_.surface.mesh.renderMesh.materials.push_back(to);
            uvUse_.push_back(use);
        }
        if (toons > 0) tell(scene_, Severity::Info, "toon", "Of toon shading, colours and pictures were imported. Shade colours, rims and outlines are not shown, and not exported.", toons, false);
    }

    int texture(const Json& reference) {
        const Json& textures = list("textures");
        const Json& from = textures[index(reference, textures.size(), "texture")];
        const Json& webp = member(member(from, "extensions"), "EXT_texture_webp");
        const Json& source = member(from, "source").is_null() ? member(webp, "source") : member(from, "source");
        const Json& images = list("images");
        if (source.is_null() && !member(member(from, "extensions"), "KHR_texture_basisu").is_null()) {
            ++ktx_;
            return -1;
        }
        if (source.is_null()) {
            tell(scene_, Severity::Warning, "texture", "A texture is in a picture format that is not read here and was left out.", 1);
            return -1;
        }
        const std::size_t i = index(source, images.size(), "image");
        if (const auto known = images_.find(i); known != images_.end()) return known->second;
        const Json& image = images[i];
        const std::string uri = text(member(image, "uri")), name = text(member(image, "name"));
        if (text(member(image, "mimeType")) == "image/ktx2") {
            ++ktx_;
            return -1;
        }
        int result = -1;
        if (uri.empty())
            result = textures_.fromBytes(name.empty() ? "texture " + std::to_string(i) : name, bufferView(index(member(image, "bufferView"), list("bufferViews").size(), "buffer view")));
        else if (uri.rfind("data:", 0) == 0)
            result = textures_.fromBytes(name.empty() ? "texture " + std::to_string(i) : name, decodeData(uri));
        else
            result = textures_.fromFile(decodePercent(uri));
        images_.emplace(i, result);
        return result;
    }

    // --- nodes and meshes ---

    void place(std::size_t n, const Matrix& parent, int parentBone, std::vector<char>& visited, int depth) {
        if (visited[n] || depth > kDeepest) refuse("has nodes that contain themselves, or too many within each other: export it again.");
        visited[n] = 1;
        placed_.push_back(n);
        const Json& node = list("nodes")[n];
        Matrix local = Matrix::Identity();
        RigNode turned;
        if (const Json& m = member(node, "matrix"); !m.is_null()) {
            const auto x = numbers(m, 16, {}, "matrix of a node");
            for (int i = 0; i < 16; ++i) local(i % 4, i / 4) = x[static_cast<std::size_t>(i)];
            if (use_ == SceneUse::Character) turned = rigNode(-1, local);
        } else {
            const auto t = numbers(member(node, "translation"), 3, {0, 0, 0}, "translation of a node"), r = numbers(member(node, "rotation"), 4, {0, 0, 0, 1}, "rotation of a node"),
                       s = numbers(member(node, "scale"), 3, {1, 1, 1}, "scale of a node");
            Eigen::Quaterniond q(r[3], r[0], r[1], r[2]);
            if (!(q.norm() > 0.0)) q.setIdentity();
            local.topLeftCorner<3, 3>() = q.normalized().toRotationMatrix() * Eigen::Vector3d(s[0], s[1], s[2]).asDiagonal();
            local.topRightCorner<3, 1>() = Vec3(t[0], t[1], t[2]);
            turned = {-1, local.topRightCorner<3, 1>(), q.normalized(), Vec3(s[0], s[1], s[2])};
        }
        global_[n] = parent * local;
        if (use_ == SceneUse::Character) rigNode_[n] = rig_.addNode(cleanName(text(member(node, "name")), "bone"), parentBone, turned, global_[n]);
        for (const Json& child : array(member(node, "children"))) {
            const std::size_t c = index(child, visited.size(), "node");
            above_[c] = n;
            place(c, global_[n], rigNode_[n], visited, depth + 1);
        }
    }

    /// VRM 0.x looks along -Z, all others along +Z.
    [[nodiscard]] Matrix facing() const { return vrmOf(*this) == Vrm::Zero ? Matrix(Eigen::Vector4d(-1.0, 1.0, -1.0, 1.0).asDiagonal()) : Matrix(Matrix::Identity()); }

    /// Joints, of the nodes of the scene.
    void bones() {
        for (const std::size_t n : vrmNodes(*this))
            if (rigNode_[n] >= 0) rig_.setJoint(rigNode_[n]);
        for (const Json& skin : list("skins"))
            for (const Json& joint : array(member(skin, "joints")))
                if (const int node = rigNode_[index(joint, rigNode_.size(), "node")]; node >= 0) rig_.setJoint(node);
    }

    /// What turns the coordinates of a skinned vertex into the scene's: a matrix per joint, or one for all.
    struct Skin {
        std::vector<Matrix> joints;
        std::vector<int> nodes;  ///< of the rig, -1: not in the scene
        bool rigid = false;      ///< all joints agree: joints[0] is it
    };

    Skin skin(const Json& reference) {
        const Json& skins = list("skins");
        const Json& from = skins[index(reference, skins.size(), "skin")];
        Skin result;
        for (const Json& joint : array(member(from, "joints"))) {
            const std::size_t node = index(joint, global_.size(), "node");
            result.joints.push_back(global_[node]);
            result.nodes.push_back(rigNode_[node]);
        }
        if (result.joints.empty()) refuse("has a skin without joints: export it again.");
        if (const Json& inverse = member(from, "inverseBindMatrices"); !inverse.is_null()) {
            const Values m = accessor(inverse, "inverse bind matrices");
            if (m.width != 16 || m.count < result.joints.size()) refuse("has fewer bind matrices than joints: export it again.");
            for (std::size_t j = 0; j < result.joints.size(); ++j) {
                const Matrix bind = Eigen::Map<const Matrix>(m.at.data() + 16 * j);
                if (!allFinite(bind)) refuse("has a bind matrix that is not finite: export it again.");
                result.joints[j] = result.joints[j] * bind;
            }
        }
        const double size = result.joints[0].cwiseAbs().maxCoeff();
        result.rigid = std::all_of(result.joints.begin(), result.joints.end(), [&](const Matrix& m) { return (m - result.joints[0]).cwiseAbs().maxCoeff() <= kSameMatrix * size; });
        if (result.rigid && (result.joints[0] - Matrix::Identity()).cwiseAbs().maxCoeff() <= kSameMatrix) result.joints[0].setIdentity();
        return result;
    }

    void node(std::size_t n) {
        const Json& from = list("nodes")[n];
        if (member(from, "mesh").is_null()) return;
        const Json& meshes = list("meshes");
        const Json& mesh = meshes[index(member(from, "mesh"), meshes.size(), "mesh")];
        const std::string above = above_.contains(n) ? text(member(list("nodes")[above_[n]], "name")) : std::string();
        const std::string name = cleanName(text(member(from, "name")), cleanName(text(member(mesh, "name")), cleanName(above, "mesh")));
        std::optional<Skin> bones;
        if (const Json& s = member(from, "skin"); !s.is_null()) bones = skin(s);
        const Json& weights = member(from, "weights").is_null() ? member(mesh, "weights") : member(from, "weights");
        scene_.partNames.push_back(name);
        partOf_[n] = name;
        if (rigNode_[n] >= 0 && !bones) rig_.setPart(rigNode_[n], text(member(from, "name")).empty());
        const Json& targetNames = array(member(member(mesh, "extras"), "targetNames"));
        for (const Json& primitive : array(member(mesh, "primitives"))) this->primitive(primitive, name, n, bones, weights, targetNames);
    }

    void primitive(const Json& from, const std::string& name, std::size_t at, const std::optional<Skin>& bones, const Json& weights, const Json& targetNames) {
        const std::uint64_t mode = number(member(from, "mode"), "mode", 4);
        if (mode > 6) refuse("has a primitive of unknown mode in '" + name + "': export it again.");
        if (!member(member(from, "extensions"), "KHR_gaussian_splatting").is_null()) {
            ++splats_;
            return;
        }
        if (mode < 4) {
            ++linesAndPoints_;
            return;
        }
        const Json& attributes = member(from, "attributes");
        if (member(attributes, "POSITION").is_null()) {
            tell(scene_, Severity::Warning, "not-understood", "A part of '" + name + "' without positions was left out" + (member(from, "extensions").is_null() ? "." : ": it is compressed, export it without compression."), 1);
            return;
        }
        const DracoMesh* draco = dracoOf(from, name);
        const auto compressed = [&](const std::string& key) -> const DracoMesh::Attribute* {
            if (!draco) return nullptr;
            const Json& id = member(member(member(member(from, "extensions"), kDraco), "attributes"), key.c_str());
            const auto found = id.is_null() ? draco->attributes.end() : draco->attributes.find(number(id, "attribute"));
            return found == draco->attributes.end() ? nullptr : &found->second;
        };
        const auto numbersOf = [&](const std::string& key, const char* what) {
            if (const auto *in = compressed(key)) return accessor(member(attributes, key.c_str()), in->bytes, in->width, in->type, what);
            if (draco && !hasNumbers(member(attributes, key.c_str()))) refuse("has data of '" + name + "' compressed by Draco without the " + what + " that they should have: export it again.");
            return accessor(member(attributes, key.c_str()), what);
        };
        Values positions = numbersOf("POSITION", "positions");
        if (positions.width != 3) refuse("has positions of '" + name + "' that are not three numbers: export it again.");
        const std::size_t n = positions.count;
        const auto optional = [&](const std::string& key, std::size_t width, const char* what) {
            const Json& reference = member(attributes, key.c_str());
            Values v;
            if (reference.is_null()) return v;
            v = numbersOf(key, what);
            if (v.count != n || v.width < width) refuse("has " + std::string(what) + " of '" + name + "' that do not fit its positions: export it again.");
            return v;
        };
        // The shape at rest is that of the default weights.
        const Json& targets = array(member(from, "targets"));
        std::vector<std::pair<int, Values>> shifts;  // target of morphs_, and how far
        if (use_ == SceneUse::Elements) morphsLeftOut_ += targets.size();
        for (std::size_t t = 0; t < targets.size(); ++t) {
            const double w = weights.is_array() && t < weights.size() ? number(weights[t], 0.0) : 0.0;
            // Targets of all primitives have their numbers, whatever these move.
            const std::string own = t < targetNames.size() ? text(targetNames[t]) : "";
            const int target = use_ == SceneUse::Elements ? -1 : own.empty() ? unnamedTarget(at, t, name, w) : morphs_.target(own, true, w);
            if (target >= 0) {
                auto& known = targetsOf_[at];
                known.resize(targets.size(), -1);
                known[t] = target;
            }
            if ((w == 0.0 && target < 0) || member(targets[t], "POSITION").is_null()) continue;
            Values shift = accessor(member(targets[t], "POSITION"), "morph target");
            if (shift.count != n || shift.width != 3) refuse("has a morph target of '" + name + "' that does not fit its positions: export it again.");
            for (std::size_t i = 0; w != 0.0 && i < 3 * n; ++i) positions.at[i] += w * shift.at[i];
            if (target >= 0) shifts.emplace_back(target, std::move(shift));
        }

        std::int32_t material = -1;
        if (const Json& m = member(from, "material"); !m.is_null()) material = static_cast<std::int32_t>(index(m, uvUse_.size(), "material"));
        const UvUse use = material >= 0 ? uvUse_[static_cast<std::size_t>(material)] : UvUse{};
        const Values normals = optional("NORMAL", 3, "normals"), colors = optional("COLOR_0", 3, "colours"), uv = optional("TEXCOORD_" + std::to_string(use.set), 2, "texture coordinates");
        std::vector<Values> joints, jointWeights;
        if (bones && (!bones->rigid || use_ == SceneUse::Character))
            for (int set = 0; set < 4 && !member(attributes, ("JOINTS_" + std::to_string(set)).c_str()).is_null(); ++set) {
                joints.push_back(optional("JOINTS_" + std::to_string(set), 4, "joints"));
                jointWeights.push_back(optional("WEIGHTS_" + std::to_string(set), 4, "joint weights"));
                if (jointWeights.back().count != n) refuse("has joints of '" + name + "' without weights: export it again.");
            }

        const auto first = static_cast<std::int32_t>(points_.size() / 3);
        if (points_.size() / 3 + n > kMaxVertices) refuseAsTooLarge();
        addGrid(n, member(attributes, "POSITION"), positions, compressed("POSITION"), bones ? bones->joints[0] : global_[at]);
        double reach = 0.0;  // of the coordinates
        for (const double x : positions.at)
            if (isFinite(x)) reach = std::max(reach, std::abs(x));
        const auto orZero = [&](double x) { return attributeOrZero(x, badAttributes_); };
        bool mirrored = false;
        for (std::size_t v = 0; v < n; ++v) {
            Matrix m = global_[at];
            if (bones && bones->rigid) m = bones->joints[0];
            if (use_ == SceneUse::Character) bind(first + static_cast<std::int32_t>(v), v, at, bones, joints, jointWeights);
            if (!joints.empty() && !bones->rigid) {
                Matrix blend = Matrix::Zero();
                double sum = 0.0;
                for (std::size_t set = 0; set < joints.size(); ++set)
                    for (std::size_t k = 0; k < 4; ++k) {
                        const double w = jointWeights[set].at[4 * v + k], j = joints[set].at[4 * v + k];
                        if (!(w > 0.0) || !std::isfinite(w)) continue;
                        if (!(j >= 0.0 && j < static_cast<double>(bones->joints.size()))) refuse("has a vertex of '" + name + "' on a joint that does not exist: export it again.");
                        blend += w * bones->joints[static_cast<std::size_t>(j)];
                        sum += w;
                    }
                if (sum > 0.0) m = blend / sum;
            }
            const Vec3 p(positions.at[3 * v], positions.at[3 * v + 1], positions.at[3 * v + 2]);
            Vec3 x = m == Matrix::Identity() ? p : Vec3(m.topLeftCorner<3, 3>() * p + m.topRightCorner<3, 1>());
            if (use_ == SceneUse::Character && bones && allFinite(x) && (x - p).cwiseAbs().maxCoeff() <= kRounding * reach) x = p;
            if (!allFinite(x)) scene_.nonFinite.emplace_back(first + static_cast<std::int32_t>(v), "vertex " + std::to_string(v) + " of '" + name + "'");
            points_.insert(points_.end(), x.data(), x.data() + 3);
            for (const auto& [target, shift] : shifts)
                morphs_.move(target, first + static_cast<std::int32_t>(v), m.topLeftCorner<3, 3>() * Vec3(shift.at[3 * v], shift.at[3 * v + 1], shift.at[3 * v + 2]));
            const double determinant = m.topLeftCorner<3, 3>().determinant();
            if (v == 0) mirrored = determinant < 0.0;
            Vec3 normal = Vec3::Zero();
            if (normals.count == n) {
                anyNormals_ = true;
                const Vec3 from3(orZero(normals.at[normals.width * v]), orZero(normals.at[normals.width * v + 1]), orZero(normals.at[normals.width * v + 2]));
                normal = std::abs(determinant) > 1e-300 ? Vec3(m.topLeftCorner<3, 3>().inverse().transpose() * from3) : from3;
                normal = normal.norm() > 0.0 && allFinite(normal) ? Vec3(normal.normalized()) : Vec3::Zero();
                if (m.isIdentity(0.0)) normal = from3;
            }
            for (int k = 0; k < 3; ++k) normals_.push_back(static_cast<float>(normal[k]));
            Eigen::Vector2d t = Eigen::Vector2d::Zero();
            if (uv.count == n) {
                anyUv_ = true;
                t = use.linear * Eigen::Vector2d(orZero(uv.at[uv.width * v]), orZero(uv.at[uv.width * v + 1])) + use.offset;
            }
            texCoords_.push_back(orZero(t[0]));
            texCoords_.push_back(orZero(t[1]));
            for (std::size_t k = 0; k < 4; ++k) {
                double c = 1.0;
                if (colors.count == n && k < colors.width) {
                    anyColors_ = true;
                    c = colors.at[colors.width * v + k];
                    badAttributes_ += !std::isfinite(c);
                    c = std::isfinite(c) ? std::clamp(c, 0.0, 1.0) : 1.0;
                }
                colors_.push_back(static_cast<float>(c));
            }
        }

        std::vector<std::int32_t> corners;
        if (draco) {
            if (draco->vertices != n || mode == 6) refuse("has compressed triangles of '" + name + "' that do not fit its positions: export it again.");
            corners.assign(draco->corners.begin(), draco->corners.end());
        } else if (const Json& indices = member(from, "indices"); !indices.is_null()) {
            const Values values = accessor(indices, "indices");
            if (values.width != 1) refuse("has indices of '" + name + "' that are no single numbers: export it again.");
            for (const double i : values.at) {
                if (!(i >= 0.0 && i < static_cast<double>(n)) || i != std::floor(i))
                    refuse("a triangle of '" + name + "' refers to vertex " + (std::isfinite(i) ? std::to_string(static_cast<std::int64_t>(i)) : "?") + ", and there are " + std::to_string(n) +
                           " (counted from 0): export it again.");
                corners.push_back(static_cast<std::int32_t>(i));
            }
        } else {
            for (std::size_t i = 0; i < n; ++i) corners.push_back(static_cast<std::int32_t>(i));
        }
        const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
            if (mirrored) std::swap(b, c);
            triangles_.insert(triangles_.end(), {first + corners[a], first + corners[b], first + corners[c]});
            scene_.surface.part.push_back(static_cast<std::int32_t>(scene_.partNames.size()) - 1);
            material_.push_back(material);
        };
        if (mode == 4 || draco) {  // strips come out of Draco as triangles
            if (corners.size() % 3 != 0) refuse("has a number of corners in '" + name + "' that makes no triangles: export it again.");
            for (std::size_t i = 0; i + 2 < corners.size(); i += 3) add(i, i + 1, i + 2);
        } else if (mode == 5) {
            for (std::size_t i = 0; i + 2 < corners.size(); ++i) add(i, i + 1 + i % 2, i + 2 - i % 2);
        } else {
            for (std::size_t i = 1; i + 1 < corners.size(); ++i) add(0, i, i + 1);
        }
    }

    /// What Draco compressed of a primitive, which is kept until the next one; null: nothing, or plain data is there too, which is exact.
    const DracoMesh* dracoOf(const Json& primitive, const std::string& name) {
        const Json& compressed = member(member(primitive, "extensions"), kDraco);
        if (compressed.is_null() || hasNumbers(member(member(primitive, "attributes"), "POSITION"))) return nullptr;
        draco_ = decodeDraco(bufferView(index(member(compressed, "bufferView"), list("bufferViews").size(), "buffer view")));
        if (!draco_) refuse("has data of '" + name + "' compressed by Draco that are damaged or of a kind that is not read here: export it without compression.");
        return &*draco_;
    }

    /// The next n vertices are on the grid to which their places were rounded. `toScene`: what the places are transformed by.
    void addGrid(std::size_t n, const Json& reference, const Values& positions, const DracoMesh::Attribute* inDraco, const Matrix& toScene) {
        const Json& accessors = list("accessors");
        const Json& from = accessors[index(reference, accessors.size(), "accessor")];
        const std::uint64_t type = number(member(from, "componentType"), "component type");
        const Json& normalized = member(from, "normalized");
        const double scale = toScene.topLeftCorner<3, 3>().colwise().norm().maxCoeff();
        VertexGrid grid{points_.size() / 3, n, 0.0};
        if (inDraco && inDraco->step > 0.0)
            grid.step = inDraco->step * scale;
        else if (type != 5126 && !(normalized.is_boolean() && normalized.get<bool>()))
            grid.step = scale;
        else if (type >= 5120 && type <= 5123) {
            static constexpr std::uint32_t kLargest[] = {127, 255, 32767, 65535};
            auto [bits, isNew] = storedBits_.try_emplace(type, kLargest[type - 5120]);
            for (const double x : positions.at) bits->second.see(x);
            grid.step = scale;
            if (isFinite(scale)) storedIn_.emplace_back(grids_.size(), type);
        }
        if (!isFinite(grid.step)) grid.step = 0.0;
        grids_.push_back(grid);
    }

    /// A target without a name is one of its node.
    int unnamedTarget(std::size_t node, std::size_t target, const std::string& name, double atRest) {
        const auto [known, isNew] = unnamed_.try_emplace({node, target}, -1);
        if (isNew) known->second = morphs_.target(name + " " + std::to_string(target + 1), false, atRest);
        return known->second;
    }

    /// Vertex v of a primitive follows its joints, or the node of its mesh.
    void bind(std::int32_t vertex, std::size_t v, std::size_t at, const std::optional<Skin>& bones, const std::vector<Values>& joints, const std::vector<Values>& weights) {
        if (!bones) rig_.bind(vertex, rigNode_[at], 1.0);
        for (std::size_t set = 0; set < joints.size(); ++set)
            for (std::size_t k = 0; k < 4; ++k) {
                const double w = weights[set].at[weights[set].width * v + k], j = joints[set].at[joints[set].width * v + k];
                if (!isFinite(w) || w <= 0.0) continue;
                if (!isFinite(j) || j < 0.0 || j >= static_cast<double>(bones->nodes.size()))
                    ++badJoints_;
                else if (const int node = bones->nodes[static_cast<std::size_t>(j)]; node >= 0)
                    rig_.bind(vertex, node, w);
            }
    }

    RawScene finish() {
        for (const auto& [grid, type] : storedIn_) grids_[grid].step *= storedBits_.at(type).step();
        joinGrids(points_, std::move(grids_));
        if (ktx_ > 0) tell(scene_, Severity::Warning, "ktx2", "Textures in KTX2 (KHR_texture_basisu) are not read and were left out: export them as PNG or JPEG.", ktx_, false);
        if (splats_ > 0 && triangles_.empty())
            throw Refused{{"splats", file().quoted() + " holds gaussian splats, a cloud without a surface: make a mesh of it in the program that it came from, and import that."}};
        if (splats_ > 0) tell(scene_, Severity::Warning, "splats", "Gaussian splats have no surface and were left out.", splats_, false);
        if (use_ == SceneUse::Character) {
            if (triangles_.empty()) points_.clear();
            scene_.surface.mesh.body.vertices = Eigen::Map<const Points>(points_.data(), static_cast<Eigen::Index>(points_.size() / 3), 3);
            morphs_.finish(scene_);
            std::map<std::size_t, std::vector<std::string>> names;
            for (const auto& [node, targets] : targetsOf_)
                for (const int target : targets) names[node].push_back(target < 0 ? std::string() : morphs_.nameOf(target));
            readGltfClips(*this, rigNode_, names, rig_, scene_);
            scene_.rig = rig_.finish(scene_);
            if (scene_.rig) {
                scene_.rig->toScene = facing();
                VrmNames known;
                known.bone = [&](std::size_t n) { return rigNode_[n] < 0 ? -1 : rig_.boneOf(rigNode_[n]); };
                known.part = [&](std::size_t n) { return partOf_.contains(n) ? partOf_[n] : std::string(); };
                known.morph = [&](std::size_t n, std::size_t t) { return names.contains(n) && t < names[n].size() ? names[n][t] : std::string(); };
                known.material = [&](std::size_t m) { return scene_.surface.mesh.renderMesh.materials[m].name; };
                readVrm(*this, known, *scene_.rig, scene_);
            }
            if (badJoints_ > 0) tell(scene_, Severity::Warning, "skeleton", "Weights of bones that do not exist were left out.", badJoints_);
            if (scene_.rig && triangles_.empty()) return std::move(scene_);
        }
        if (triangles_.empty()) {
            const bool rig = !list("skins").empty() || !list("nodes").empty();
            throw Refused{{"empty-mesh", file().quoted() + (rig && list("meshes").empty() ? " holds bones but no mesh" : " has no triangles") + ": choose a file with a mesh."}};
        }
        if (use_ == SceneUse::Elements && (!list("skins").empty() || !list("animations").empty()))
            tell(scene_, Severity::Info, "bones", "Bones and animations of the file left out.", list("skins").size() + list("animations").size());
        RenderMesh& render = scene_.surface.mesh.renderMesh;
        if (std::any_of(material_.begin(), material_.end(), [](std::int32_t m) { return m >= 0; })) {
            if (std::find(material_.begin(), material_.end(), -1) != material_.end()) {
                std::replace(material_.begin(), material_.end(), -1, static_cast<std::int32_t>(render.materials.size()));
                render.materials.emplace_back().name = "material";
            }
            render.material = std::move(material_);
        } else {
            render.materials.clear();
            render.textures.clear();
        }
        putInto(scene_);
        return std::move(scene_);
    }

    /// Which texture coordinates a material uses, and how they are moved (KHR_texture_transform).
    struct UvUse {
        std::uint64_t set = 0;
        Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
        Eigen::Vector2d offset = Eigen::Vector2d::Zero();
    };

    SceneUse use_;
    RawScene scene_;
    TextureLoader textures_;
    std::vector<UvUse> uvUse_;
    std::map<std::size_t, int> images_;
    std::vector<Matrix> global_;        // of each node, to the scene
    std::vector<std::size_t> placed_;   // the nodes of the scene, depth first
    RigBuilder rig_;
    MorphBuilder morphs_;
    std::vector<VertexGrid> grids_;     // of the primitives
    std::map<std::uint64_t, StoredBits> storedBits_;                  // by component type
    std::vector<std::pair<std::size_t, std::uint64_t>> storedIn_;     // grids of normalised numbers, and their component type
    std::map<std::pair<std::size_t, std::size_t>, int> unnamed_;  // by node and number
    std::map<std::size_t, std::vector<int>> targetsOf_;           // by node, of its mesh: of morphs_, -1: left out
    std::vector<int> rigNode_;          // of each node, its index in rig_; -1: not in the scene, or no bones are wanted
    std::map<std::size_t, std::size_t> above_;   // by node, its parent
    std::map<std::size_t, std::string> partOf_;  // by node
    std::size_t badJoints_ = 0, ktx_ = 0, splats_ = 0;  // ktx_: textures
    std::optional<DracoMesh> draco_;
};

}  // namespace

Result<RawScene> readGltf(const SourceFile& file, SceneUse use) {
    try {
        return GltfReader(file, use).read();
    } catch (const GltfFileReader::Refused& refused) {
        return tl::unexpected(refused.error);
    }
}

}  // namespace imomushi
