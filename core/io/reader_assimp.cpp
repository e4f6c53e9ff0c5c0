// SPDX-License-Identifier: GPL-3.0-or-later
// FBX and COLLADA through assimp. No post-processing of assimp's runs: it drops what it finds invalid without a word, and our own weld, triangulation
// and checks tell the artist. Positions are single precision there.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/colour.h"
#include "core/base/finite.h"
#include "core/io/reader_support.h"
#include "core/io/morph_builder.h"
#include "core/io/rig_builder.h"
#include "core/io/text_scanner.h"
#include "core/worker/worker.h"

namespace imomushi {
namespace {

constexpr int kDeepestNode = 1000;  // nodes within nodes

using Matrix = Eigen::Matrix4d;

Matrix matrix(const aiMatrix4x4& m) {
    Matrix result;
    for (unsigned r = 0; r < 4; ++r)
        for (unsigned c = 0; c < 4; ++c) result(r, c) = static_cast<double>(m[r][c]);
    return result;
}

std::string_view text(const aiString& s) { return {s.data, s.length}; }

/// COLLADA's own <unit meter="..."> and <up_axis>: assimp applies them to the root node and says nothing, so it is told not to.
struct Asset {
    double meter = 1.0;
    bool zUp = false, xUp = false;
};

Asset colladaAsset(std::string_view xml) {
    Asset asset;
    const std::size_t end = std::min(xml.find("</asset>"), xml.size());
    xml = xml.substr(0, end);
    if (const std::size_t unit = xml.find("<unit"); unit != std::string_view::npos) {
        const std::string_view tag = xml.substr(unit, xml.find('>', unit) - unit);
        if (const std::size_t meter = tag.find("meter="); meter != std::string_view::npos && meter + 7 < tag.size()) {
            const char quote = tag[meter + 6];
            const std::string_view value = tag.substr(meter + 7, tag.find(quote, meter + 7) - meter - 7);
            double number = 0.0;
            if (parseNumber(trimmed(value), number) && std::isfinite(number) && number > 0.0) asset.meter = number;
        }
    }
    if (const std::size_t up = xml.find("<up_axis>"); up != std::string_view::npos) {
        const std::string_view value = trimmed(xml.substr(up + 9, 8));
        asset.zUp = value.substr(0, 1) == "Z";
        asset.xUp = value.substr(0, 1) == "X";
    }
    return asset;
}

/// The version of an FBX file, 7400 is 7.4; 0: it does not say.
int fbxVersion(std::string_view bytes) {
    constexpr std::string_view kBinary{"Kaydara FBX Binary  \0\x1a\0", 23};
    if (bytes.substr(0, kBinary.size()) == kBinary && bytes.size() >= kBinary.size() + 4) {
        std::uint32_t version = 0;
        std::memcpy(&version, bytes.data() + kBinary.size(), sizeof version);
        return version < 100'000 ? static_cast<int>(version) : 0;
    }
    const std::string_view head = bytes.substr(0, 1 << 14);
    const std::size_t at = head.find("FBXVersion:");
    double number = 0.0;
    if (at != std::string_view::npos && parseNumber(trimmed(head.substr(at + 11, head.find_first_of("\r\n", at) - at - 11)), number) && number > 0.0 && number < 100'000.0) return static_cast<int>(number);
    // The first line of those in text: "; FBX 6.1.0 project file".
    if (head.substr(0, 6) == "; FBX " && head.size() > 8 && head[6] >= '1' && head[6] <= '9' && head[7] == '.') return 1000 * (head[6] - '0') + 100 * (head[8] >= '0' && head[8] <= '9' ? head[8] - '0' : 0);
    return 0;
}

class AssimpReader : SceneVertices {
public:
    AssimpReader(const SourceFile& file, SceneUse use) : file_(file), use_(use), textures_(file, scene_) {}

    Result<RawScene> read(std::string_view format) {
        scene_.format = format;
        if (const int version = format == "fbx" ? fbxVersion(file_.bytes) : 0; version > 0 && version < 7000)
            return fail("old-fbx", file_.quoted() + " is FBX version " + std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 100) +
                                       ", and 7 or later is read: export it as FBX 2011 or later, or convert it with Autodesk's FBX Converter.");
        Assimp::Importer importer;
        importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_CAMERAS, false);
        importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_LIGHTS, false);
        importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
        importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);  // not the ids
        // From memory, with the suffix as a hint: no other file is opened, and no other importer guesses at the content.
        const bool rightKind = format == "dae" ? file_.bytes.substr(0, 4096).find("COLLADA") != std::string_view::npos
                                               : file_.bytes.substr(0, 18) == "Kaydara FBX Binary" || file_.bytes.substr(0, 65536).find("FBX") != std::string_view::npos;
        if (!rightKind) return badFile(file_, 0, format == "dae" ? "is no COLLADA file: export it again." : "is no FBX file: export it again.");
        std::optional<Attempt> animations;
        if (format == "fbx" && use_ == SceneUse::Character) animations.emplace("the animations of the file");
        importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, animations && *animations);
        const aiScene* scene = importer.ReadFileFromMemory(file_.bytes.data(), file_.bytes.size(), 0, std::string(format).c_str());
        animations.reset();
        if (!scene) return badFile(file_, 0, "cannot be read (" + cleanName(importer.GetErrorString(), "damaged") + "): export it again, best as GLB or OBJ.");
        ai_ = scene;
        unitsAndAxes(format);
        if (!scene->mRootNode || (scene->mNumMeshes == 0 && use_ == SceneUse::Elements)) return fail("empty-mesh", file_.quoted() + " has no mesh: choose a file with one.");
        materials();
        if (auto done = node(*scene->mRootNode, Matrix::Identity(), -1, 0); !done) return tl::unexpected(done.error());
        return finish();
    }

private:
    void unitsAndAxes(std::string_view format) {
        if (format == "dae") {
            const Asset asset = colladaAsset(file_.bytes.substr(0, 1 << 16));
            scene_.metresPerUnit = asset.meter;
            scene_.zUp = asset.zUp;
            removed_ = 1.0 / asset.meter;  // assimp scales the root by the unit
            if (asset.xUp) tell(scene_, Severity::Warning, "not-understood", "The file's up axis is X: turn the mesh after the import.", 1, false);
            return;
        }
        double factor = 1.0;
        int up = 1, upSign = 1;
        if (ai_->mMetaData) {
            float f = 0.0f;
            if (ai_->mMetaData->Get("UnitScaleFactor", factor)) {
            } else if (ai_->mMetaData->Get("UnitScaleFactor", f)) {
                factor = static_cast<double>(f);
            }
            ai_->mMetaData->Get("UpAxis", up);
            ai_->mMetaData->Get("UpAxisSign", upSign);
        }
        scene_.metresPerUnit = std::isfinite(factor) && factor > 0.0 ? factor / 100.0 : 0.01;  // UnitScaleFactor: centimetres per unit
        scene_.zUp = up == 2 && upSign > 0;
        if (up == 0 || upSign < 0) tell(scene_, Severity::Warning, "not-understood", "The file's up axis is neither Y nor Z: turn the mesh after the import.", 1, false);
    }

    void materials() {
        RenderMesh& render = scene_.surface.mesh.renderMesh;
        for (unsigned i = 0; i < ai_->mNumMaterials; ++i) {
            const aiMaterial& from = *ai_->mMaterials[i];
            Material& to = render.materials.emplace_back();
            aiString name;
            if (from.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) to.name = cleanName(text(name), "material");
            aiColor4D color;
            if (from.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS) {
                const Eigen::Vector4f c(color.r, color.g, color.b, 1.0f);
                if (allFinite(c)) to.baseColor = c.cwiseMax(0.0f).cwiseMin(1.0f);
            }
            float value = 0.0f;
            if (from.Get(AI_MATKEY_OPACITY, value) == AI_SUCCESS && std::isfinite(value) && value > 0.0f) to.baseColor[3] = std::min(value, 1.0f);
            if (from.Get(AI_MATKEY_METALLIC_FACTOR, value) == AI_SUCCESS && std::isfinite(value)) to.metallic = std::clamp(value, 0.0f, 1.0f);
            if (from.Get(AI_MATKEY_ROUGHNESS_FACTOR, value) == AI_SUCCESS && std::isfinite(value)) to.roughness = std::clamp(value, 0.0f, 1.0f);
            aiString path;
            if (from.GetTexture(aiTextureType_DIFFUSE, 0, &path) != AI_SUCCESS && from.GetTexture(aiTextureType_BASE_COLOR, 0, &path) != AI_SUCCESS) continue;
            const int texture = textureAt(std::string(text(path)));
            Material& again = render.materials.back();
            again.baseColorTexture = texture;
            if (texture >= 0) again.baseColor.head<3>().setOnes();
        }
    }

    int textureAt(const std::string& path) {
        for (const auto& [known, index] : embedded_)
            if (known == path) return index;
        const aiTexture* inside = ai_->GetEmbeddedTexture(path.c_str());
        int index = -1;
        if (inside && inside->mHeight == 0) {
            index = textures_.fromBytes(path, {reinterpret_cast<const char*>(inside->pcData), inside->mWidth});
        } else if (inside) {
            tell(scene_, Severity::Warning, "texture", "The texture '" + cleanName(path, "?") + "' is stored without a picture format and was left out.", 1);
        } else {
            index = textures_.fromFile(path);
        }
        embedded_.emplace_back(path, index);
        return index;
    }

    Result<void> node(const aiNode& at, const Matrix& parent, int parentBone, int depth) {
        if (depth > kDeepestNode) return badFile(file_, 0, "its nodes are nested too deeply: flatten the scene.");
        const Matrix local = matrix(at.mTransformation), world = parent * local;
        const int own = use_ == SceneUse::Character ? rig_.addNode(cleanName(text(at.mName), "bone"), parentBone, rigNode(-1, local), inFile(world)) : -1;
        if (own >= 0) nodeNamed_.emplace(text(at.mName), own);
        for (unsigned i = 0; i < at.mNumMeshes; ++i) {
            if (at.mMeshes[i] >= ai_->mNumMeshes) return badFile(file_, 0, "a node refers to a mesh that does not exist: export it again.");
            const aiMesh& from = *ai_->mMeshes[at.mMeshes[i]];
            const auto first = static_cast<std::int32_t>(points_.size() / 3);
            if (auto done = mesh(from, at, world); !done) return done;
            if (own >= 0 && from.mNumBones == 0) rig_.setPart(own);
            if (own >= 0 && points_.size() / 3 > static_cast<std::size_t>(first)) placed_.push_back({&from, own, first, world});
        }
        for (unsigned i = 0; i < at.mNumChildren; ++i)
            if (auto done = node(*at.mChildren[i], world, own, depth + 1); !done) return done;
        return {};
    }

    /// A transformation to assimp's scene as one to the file's coordinates.
    [[nodiscard]] Matrix inFile(const Matrix& world) const { return Eigen::Vector4d(removed_, removed_, removed_, 1.0).asDiagonal() * world; }

    /// Bones by name, since assimp refers to their nodes so. A skin says where its bones are while the mesh is as it comes.
    void skins() {
        for (const Placed& placed : placed_) {
            const aiMesh& from = *placed.mesh;
            if (from.mNumBones == 0)
                for (unsigned v = 0; v < from.mNumVertices; ++v) rig_.bind(placed.first + static_cast<std::int32_t>(v), placed.node, 1.0);
            for (unsigned b = 0; b < from.mNumBones; ++b) {
                const aiBone& bone = *from.mBones[b];
                const auto node = nodeNamed_.find(text(bone.mName));
                const Matrix offset = matrix(bone.mOffsetMatrix);
                if (node == nodeNamed_.end() || !allFinite(offset)) {
                    ++badBones_;
                    continue;
                }
                const Eigen::FullPivLU<Matrix> inverse(offset);
                rig_.setJoint(node->second, inverse.isInvertible() ? std::optional(inFile(placed.world * inverse.inverse())) : std::nullopt);
                for (unsigned w = 0; w < bone.mNumWeights; ++w)
                    if (bone.mWeights[w].mVertexId < from.mNumVertices)
                        rig_.bind(placed.first + static_cast<std::int32_t>(bone.mWeights[w].mVertexId), node->second, static_cast<double>(bone.mWeights[w].mWeight));
            }
        }
    }

    template <class Key>
    static void addTrack(RigClip& clip, int node, RigTrack::Path path, const Key* keys, unsigned count, double perSecond) {
        if (count == 0) return;
        RigTrack track;
        track.node = node;
        track.path = path;
        for (unsigned k = 0; k < count; ++k) {
            const double time = std::max(0.0, keys[k].mTime / perSecond);
            if (!track.times.empty() && !(time > track.times.back())) continue;
            track.times.push_back(time);
            const auto& v = keys[k].mValue;
            if constexpr (requires { v.w; })
                track.values.insert(track.values.end(), {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z), static_cast<double>(v.w)});
            else
                track.values.insert(track.values.end(), {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)});
        }
        clip.tracks.push_back(std::move(track));
    }

    void clips() {
        constexpr double kTicksPerSecond = 25.0;  // assimp's own where a file says nothing
        for (unsigned i = 0; i < ai_->mNumAnimations; ++i) {
            const aiAnimation& from = *ai_->mAnimations[i];
            const double perSecond = isFinite(from.mTicksPerSecond) && from.mTicksPerSecond > 0.0 ? from.mTicksPerSecond : kTicksPerSecond;
            RigClip clip;
            clip.name = cleanName(text(from.mName), "clip");
            for (unsigned c = 0; c < from.mNumChannels; ++c) {
                const aiNodeAnim& channel = *from.mChannels[c];
                const auto node = nodeNamed_.find(text(channel.mNodeName));
                if (node == nodeNamed_.end()) continue;
                addTrack(clip, node->second, RigTrack::Path::Translation, channel.mPositionKeys, channel.mNumPositionKeys, perSecond);
                addTrack(clip, node->second, RigTrack::Path::Rotation, channel.mRotationKeys, channel.mNumRotationKeys, perSecond);
                addTrack(clip, node->second, RigTrack::Path::Scale, channel.mScalingKeys, channel.mNumScalingKeys, perSecond);
            }
            for (unsigned c = 0; c < from.mNumMorphMeshChannels; ++c) addWeights(clip, *from.mMorphMeshChannels[c], perSecond);
            rig_.addClip(std::move(clip));
        }
    }

    /// A channel is called as its node, in FBX files with "*" and the number of a mesh behind. Each key weighs some targets, the others are as at the key before.
    void addWeights(RigClip& clip, const aiMeshMorphAnim& channel, double perSecond) {
        const std::string_view name = text(channel.mName);
        auto known = targetsOf_.find(name);
        if (known == targetsOf_.end()) known = targetsOf_.find(name.substr(0, name.rfind('*')));
        if (known == targetsOf_.end()) return;
        for (std::size_t t = 0; t < known->second.size(); ++t) {
            MorphTrack track;
            track.target = morphs_.nameOf(known->second[t]);
            const auto same = [&](const MorphTrack& other) { return other.target == track.target; };
            if (track.target.empty() || std::any_of(clip.morphs.begin(), clip.morphs.end(), same)) continue;
            for (unsigned k = 0; k < channel.mNumKeys; ++k) {
                const aiMeshMorphKey& key = channel.mKeys[k];
                const double time = std::max(0.0, key.mTime / perSecond);
                for (unsigned v = 0; v < key.mNumValuesAndWeights; ++v) {
                    if (key.mValues[v] != t || (!track.times.empty() && !(time > track.times.back()))) continue;
                    track.times.push_back(time);
                    track.weights.push_back(key.mWeights[v]);
                }
            }
            if (!track.times.empty()) clip.morphs.push_back(std::move(track));
        }
    }

    Result<void> mesh(const aiMesh& from, const aiNode& at, const Matrix& world) {
        const auto first = points_.size() / 3;
        if (first + from.mNumVertices > kMaxVertices) return tooManyVertices(file_);
        if (!from.mVertices || from.mNumVertices == 0) return {};
        if (use_ == SceneUse::Elements) morphsLeftOut_ += from.mNumAnimMeshes;
        const std::string name = cleanName(text(at.mName), cleanName(text(from.mName), "mesh"));
        // Pieces of one node differ by material only: they are one part.
        if (&at != lastNode_) {
            lastNode_ = &at;
            scene_.partNames.push_back(name);
        }
        const auto part = static_cast<std::int32_t>(scene_.partNames.size()) - 1;
        const Eigen::Matrix3d linear = world.topLeftCorner<3, 3>();
        const double determinant = linear.determinant();
        const bool mirrored = determinant < 0.0;
        const Eigen::Matrix3d forNormals = std::abs(determinant) > 1e-300 ? Eigen::Matrix3d(linear.inverse().transpose()) : Eigen::Matrix3d::Identity();
        for (unsigned v = 0; v < from.mNumVertices; ++v) {
            const Eigen::Vector4d p = world * Eigen::Vector4d(static_cast<double>(from.mVertices[v].x), static_cast<double>(from.mVertices[v].y), static_cast<double>(from.mVertices[v].z), 1.0);
            const Vec3 x = p.head<3>() * removed_;
            if (!allFinite(x)) scene_.nonFinite.emplace_back(static_cast<std::int32_t>(points_.size() / 3), "in '" + name + "'");
            points_.insert(points_.end(), x.data(), x.data() + 3);
            const auto flag = [&](bool finite) { badAttributes_ += !finite; return finite; };
            Vec3 n = Vec3::Zero();
            if (from.mNormals) {
                anyNormals_ = true;
                n = forNormals * Vec3(static_cast<double>(from.mNormals[v].x), static_cast<double>(from.mNormals[v].y), static_cast<double>(from.mNormals[v].z));
                n = flag(allFinite(n)) && n.norm() > 0.0 ? Vec3(n.normalized()) : Vec3::Zero();
            }
            for (int k = 0; k < 3; ++k) normals_.push_back(static_cast<float>(n[k]));
            Eigen::Vector2f uv = Eigen::Vector2f::Zero();
            if (from.mTextureCoords[0]) {
                anyUv_ = true;
                const auto& t = from.mTextureCoords[0][v];
                if (flag(std::isfinite(t.x) && std::isfinite(t.y))) uv = {t.x, 1.0f - t.y};
            }
            texCoords_.insert(texCoords_.end(), uv.data(), uv.data() + 2);
            Eigen::Vector4f color = Eigen::Vector4f::Ones();
            if (from.mColors[0]) {
                anyColors_ = true;
                const auto& c = from.mColors[0][v];
                color = {linearFromSrgb(static_cast<double>(c.r)), linearFromSrgb(static_cast<double>(c.g)), linearFromSrgb(static_cast<double>(c.b)),
                         std::isfinite(c.a) ? std::clamp(c.a, 0.0f, 1.0f) : 1.0f};
            }
            colors_.insert(colors_.end(), color.data(), color.data() + 4);
        }
        for (unsigned t = 0; use_ == SceneUse::Character && t < from.mNumAnimMeshes; ++t) {
            // Its vertices are places; the mesh itself has the shape without them.
            const aiAnimMesh& shape = *from.mAnimMeshes[t];
            if (!shape.mVertices || shape.mNumVertices != from.mNumVertices) continue;
            const std::string own(text(shape.mName));
            const int target = morphs_.target(own.empty() ? name + " " + std::to_string(t + 1) : own, !own.empty(), 0.0);
            if (auto& known = targetsOf_[std::string(text(at.mName))]; known.size() == t) known.push_back(target);
            for (unsigned v = 0; v < from.mNumVertices; ++v) {
                const auto &to = shape.mVertices[v], &at3 = from.mVertices[v];
                const Vec3 delta(static_cast<double>(to.x) - static_cast<double>(at3.x), static_cast<double>(to.y) - static_cast<double>(at3.y), static_cast<double>(to.z) - static_cast<double>(at3.z));
                morphs_.move(target, static_cast<std::int32_t>(first + v), removed_ * (linear * delta));
            }
        }
        std::vector<std::int32_t> polygon;
        std::vector<std::array<std::int32_t, 3>> cut;
        for (unsigned f = 0; f < from.mNumFaces; ++f) {
            const aiFace& face = from.mFaces[f];
            if (face.mNumIndices < 3) {
                ++linesAndPoints_;
                continue;
            }
            polygon.clear();
            for (unsigned k = 0; k < face.mNumIndices; ++k) {
                if (face.mIndices[k] >= from.mNumVertices) return badFile(file_, 0, "a face of '" + name + "' refers to a vertex that does not exist: export it again.");
                polygon.push_back(static_cast<std::int32_t>(first + face.mIndices[k]));
            }
            polygons_ += polygon.size() > 3;
            if (mirrored) std::reverse(polygon.begin(), polygon.end());
            triangulatePolygon(points_, polygon, cut);
            for (const auto& t : cut) {
                for (const std::int32_t k : t) triangles_.push_back(polygon[static_cast<std::size_t>(k)]);
                scene_.surface.part.push_back(part);
                material_.push_back(from.mMaterialIndex < ai_->mNumMaterials ? static_cast<std::int32_t>(from.mMaterialIndex) : 0);
            }
        }
        return {};
    }

    Result<RawScene> finish() {
        if (use_ == SceneUse::Character) {
            if (triangles_.empty()) points_.clear();
            scene_.surface.mesh.body.vertices = Eigen::Map<const Points>(points_.data(), static_cast<Eigen::Index>(points_.size() / 3), 3);
            skins();
            morphs_.finish(scene_);
            clips();
            scene_.rig = rig_.finish(scene_);
            if (scene_.rig) scene_.rig->toScene = inFile(Matrix::Identity());
            if (badBones_ > 0) tell(scene_, Severity::Warning, "skeleton", "Bones of skins that are not in the scene were left out.", badBones_);
            if (scene_.rig && triangles_.empty()) return std::move(scene_);
        }
        if (triangles_.empty()) return fail("empty-mesh", file_.quoted() + " has no triangles: choose a file with a mesh.");
        if (polygons_ > 0) tell(scene_, Severity::Info, "not-triangles", std::to_string(polygons_) + (polygons_ == 1 ? " polygon was" : " polygons were") + " cut into triangles.", polygons_);
        if (!scene_.surface.mesh.renderMesh.materials.empty()) scene_.surface.mesh.renderMesh.material = std::move(material_);
        putInto(scene_);
        return std::move(scene_);
    }

    /// A mesh at a node: its vertices begin with `first`.
    struct Placed {
        const aiMesh* mesh = nullptr;
        int node = -1;
        std::int32_t first = 0;
        Matrix world;
    };

    const SourceFile& file_;
    SceneUse use_;
    RawScene scene_;
    TextureLoader textures_;
    RigBuilder rig_;
    MorphBuilder morphs_;
    std::map<std::string, int, std::less<>> nodeNamed_;  // in rig_, the first of a name
    std::map<std::string, std::vector<int>, std::less<>> targetsOf_;  // by node: of morphs_, as assimp counts them
    std::vector<Placed> placed_;
    std::size_t badBones_ = 0;
    const aiScene* ai_ = nullptr;
    const aiNode* lastNode_ = nullptr;
    double removed_ = 1.0;
    std::vector<std::pair<std::string, int>> embedded_;
    std::size_t polygons_ = 0;
};

}  // namespace

Result<RawScene> readByAssimp(const SourceFile& file, std::string_view format, SceneUse use) { return AssimpReader(file, use).read(format); }

}  // namespace imomushi
