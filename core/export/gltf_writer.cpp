// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/gltf_writer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/export/driver.h"
#include "core/export/gltf_file.h"
#include "core/export/gltf_rigs.h"
#include "core/export/key_reduction.h"
#include "core/export/vrm_writer.h"
#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

using Json = GltfFile::Json;
using Target = GltfFile::Target;

Json vector(const Vec3& v) { return Json::array({static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())}); }

class SceneWriter {
public:
    SceneWriter(const GltfContent& content, ExportReport& report, const Progress& progress)
        : content_(content), scene_(content.scene), options_(content.options), report_(report), progress_(progress), rigs_(content.scene, file_) {}

    Result<std::string> write() {
        file_.root["asset"] = {{"version", "2.0"}, {"generator", "Imomushi"}};
        if (options_.quantised) {
            file_.root["extensionsUsed"] = {"KHR_mesh_quantization"};
            file_.root["extensionsRequired"] = {"KHR_mesh_quantization"};
        }
        file_.root["scene"] = 0;
        const std::size_t count = content_.surfaces.size();
        chooseUnits();
        movingNodes_.assign(scene_.elements.size(), -1);
        jointOf_.assign(scene_.elements.size(), 0);
        if (options_.layout != ExportLayout::Baked || !scene_.meshes.empty()) addSkeleton();
        Json roots = Json::array(), children = Json::array();
        if (root_ >= 0) roots.push_back(root_);
        for (std::size_t s = 0; s < count; ++s) {
            if (progress_.cancelled()) return fail(kCancelled, "The export was cancelled.");
            progress_.report("write", 0.7 * static_cast<double>(s) / static_cast<double>(count));
            if (!begins(s)) {
                surfaceNodes_.push_back(surfaceNodes_.back());
                continue;
            }
            const int node = addSurface(s);
            surfaceNodes_.push_back(node);
            (skinned(content_.surfaces[s]) ? roots : children).push_back(node);
            if (const int e = content_.surfaces[s].element; options_.layout == ExportLayout::Baked && e >= 0) movingNodes_[static_cast<std::size_t>(e)] = node;
        }
        if (root_ < 0 || !children.empty()) {
            Json node{{"name", scene_.name}};
            if (!children.empty()) node["children"] = std::move(children);
            roots.push_back(file_.add("nodes", std::move(node)));
        }
        for (std::size_t c = 0; c < content_.motion.clips.size(); ++c) addClip(c);
        Json scene{{"name", scene_.name}, {"nodes", std::move(roots)}};
        scene["extras"] = {{"unit", "m"}, {"fps", options_.fps > 0.0 ? options_.fps : framesPerSecond(content_.motion)}};
        file_.add("scenes", std::move(scene));
        if (options_.avatar) {
            VrmPlaces places;
            places.node = [this](int bone) { return rigs_.bone(avatarBone(bone)); };
            places.parts = [this](const std::string& part) {
                std::vector<int> nodes;
                for (std::size_t s = 0; s < content_.surfaces.size(); ++s)
                    if (begins(s) && content_.surfaces[s].element < 0 && content_.surfaces[s].name == part) nodes.push_back(surfaceNodes_[s]);
                return nodes;
            };
            for (const int node : surfaceNodes_)
                if (file_.root["nodes"][static_cast<std::size_t>(node)].contains("mesh") && (places.meshNodes.empty() || places.meshNodes.back() != node)) places.meshNodes.push_back(node);
            addAvatar(*options_.avatar, places, file_);
        }
        std::string bytes = file_.glb();
        if (bytes.empty()) return fail("too-large", "The file would be larger than glTF allows (4 GiB): choose fewer targets, or export elements by themselves.");
        return bytes;
    }

private:
    [[nodiscard]] bool rigid() const { return options_.layout != ExportLayout::Skinned; }
    /// Its part has no surface before.
    [[nodiscard]] bool begins(std::size_t s) const { return content_.surfaces[s].part < 0 || s == 0 || content_.surfaces[s - 1].part != content_.surfaces[s].part; }
    [[nodiscard]] bool skinned(const RenderSurface& surface) const { return options_.layout != ExportLayout::Baked || surface.element < 0; }

    /// What positions in the file are multiplied by and shifted from: by the node (baked), by its joint alone (rigged), by all joints alike (skinned).
    struct Unit {
        Vec3 middle = Vec3::Zero();  // m
        float size = 1.0f;           // m
        bool whole = false;          // whole numbers, of -1 ... 1
    };
    [[nodiscard]] std::vector<float> positionsOf(const RenderSurface& surface) const {
        std::vector<float> out(3 * surface.vertices());
        for (std::size_t i = 0; i < surface.vertices(); ++i) {
            const auto e = static_cast<std::size_t>(surface.elements[i]);
            const Vec3 from = rigid() ? Vec3(units_[e].middle - content_.morphs[e].middle) : units_[e].middle;
            const Points& at = rigid() ? content_.morphs[e].rest : content_.skin.bind[e];
            for (int k = 0; k < 3; ++k) out[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(at(surface.rows[i], k) - from[k]);
        }
        // Without the targets of the file, whose weights at rest the mesh says.
        for (const int t : fileTargets(surface)) {
            const auto weight = static_cast<float>(scene_.meshes[static_cast<std::size_t>(surface.mesh)].model->morphs[static_cast<std::size_t>(t)].atRest);
            if (weight == 0.0f) continue;
            const std::vector<float> moved = fileTarget(surface, t);
            for (std::size_t i = 0; i < out.size(); ++i) out[i] -= weight * moved[i];
        }
        return out;
    }
    void chooseUnits() {
        units_.resize(scene_.elements.size());
        std::vector<std::vector<std::size_t>> alike;  // elements that have one unit
        if (rigid()) {
            for (const auto& surface : content_.surfaces)
                if (surface.element >= 0) alike.push_back({static_cast<std::size_t>(surface.element)});
            for (const auto& mesh : scene_.meshes) alike.emplace_back(mesh.elements.begin(), mesh.elements.end());
        } else {
            alike.emplace_back();
            for (std::size_t e = 0; e < units_.size(); ++e) alike[0].push_back(e);
        }
        std::vector<Bounds> bounds(units_.size());
        std::vector<double> reach(units_.size(), 0.0);  // from the middle of the element
        std::vector<char> any(units_.size(), 0);
        for (const auto& surface : content_.surfaces)
            for (std::size_t i = 0; i < surface.vertices(); ++i) {
                const auto e = static_cast<std::size_t>(surface.elements[i]);
                const Vec3 p = (rigid() ? content_.morphs[e].rest : content_.skin.bind[e]).row(surface.rows[i]).transpose();
                reach[e] = std::max(reach[e], p.cwiseAbs().maxCoeff());
                const Vec3 at = rigid() ? Vec3(p + content_.morphs[e].middle) : p;
                bounds[e] = any[e] ? Bounds{bounds[e].low.cwiseMin(at), bounds[e].high.cwiseMax(at)} : Bounds{at, at};
                any[e] = 1;
            }
        for (const auto& group : alike) {
            Unit unit;
            const bool alone = rigid() && group.size() == 1 && content_.motion.seen[group[0]].mesh < 0;
            if (alone && (options_.quantised || options_.layout == ExportLayout::Baked)) unit.middle = content_.morphs[group[0]].middle;
            bool drawn = false;
            Bounds whole;
            for (const std::size_t e : group)
                if (any[e]) {
                    whole = drawn ? Bounds{whole.low.cwiseMin(bounds[e].low), whole.high.cwiseMax(bounds[e].high)} : bounds[e];
                    drawn = true;
                }
            if (options_.quantised && drawn) {
                if (!alone) unit.middle = 0.5 * (whole.low + whole.high);
                const double most = alone ? reach[group[0]] : 0.5 * (whole.high - whole.low).maxCoeff();
                // A little more than the farthest: it must not round beyond the range.
                unit.size = static_cast<float>(most * (1.0 + 1e-6));
                unit.whole = unit.size > 0.0f;
                if (!unit.whole) unit.size = 1.0f;
            }
            for (const std::size_t e : group) units_[e] = unit;
        }
    }

    void addSkeleton() {
        std::vector<float> inverse;
        Json joints = Json::array(), below = Json::array();
        const auto bind = [&](int node, const Eigen::Affine3d& place, const Unit& unit) {
            const Eigen::Matrix4d back = (place.inverse() * Eigen::Translation3d(unit.middle) * Eigen::Scaling(static_cast<double>(unit.size))).matrix();
            joints.push_back(node);
            for (int i = 0; i < 16; ++i) inverse.push_back(i == 15 ? 1.0f : i % 4 == 3 ? 0.0f : static_cast<float>(back.data()[i]));
        };
        const auto addJoint = [&](const std::string& name, const Vec3& origin, const Unit& unit) {
            below.push_back(file_.add("nodes", {{"name", name}, {"translation", vector(origin)}}));
            jointNodes_.push_back(below.back());
            bind(jointNodes_.back(), Eigen::Affine3d(Eigen::Translation3d(origin)), unit);
        };
        if (rigid()) {
            for (std::size_t e = 0; e < content_.morphs.size(); ++e) {
                if (options_.layout == ExportLayout::Baked && content_.motion.seen[e].mesh < 0) continue;
                jointOf_[e] = static_cast<std::uint16_t>(jointNodes_.size());
                addJoint(scene_.elements[e] + " frame", content_.morphs[e].middle, units_[e]);
                movingNodes_[e] = jointNodes_.back();
            }
            rigs_.add(below, names_);
            for (std::size_t b = 0; b < rigs_.bones(); ++b) bind(rigs_.bone(b), rigs_.place(b), Unit{});
        } else {
            rigs_.add(below, names_);
            const auto drawn = std::find_if(units_.begin(), units_.end(), [](const Unit& unit) { return unit.whole; });
            const Unit unit = drawn == units_.end() ? Unit{} : *drawn;
            for (const auto& joint : content_.skin.joints) {
                if (joint.rigBone < 0 && joint.parent < 0) {
                    addJoint(joint.name, joint.origin, unit);
                    continue;
                }
                jointNodes_.push_back(rigs_.joint(joint));
                bind(jointNodes_.back(), rigs_.place(joint), unit);
            }
        }
        Json root{{"name", scene_.name}, {"children", below}};
        if (options_.layout == ExportLayout::Rigged) root["extras"] = {{"imomushi", driverData(content_)}};
        root_ = file_.add("nodes", std::move(root));
        file_.add("skins", {{"name", scene_.name}, {"joints", joints}, {"skeleton", root_}, {"inverseBindMatrices", file_.accessor(inverse, 16, Target::None, false)}});
    }

    int addMaterial(const RenderSurface& surface, int material) {
        Material m;
        if (material >= 0 && material < static_cast<int>(surface.look->materials.size())) {
            m = surface.look->materials[static_cast<std::size_t>(material)];
        } else {
            m.name = surface.materialName;
            m.baseColor << surface.color, 1.0f;
            if (surface.colors.rows() > 0) m.baseColor.setOnes();
        }
        Json color = Json::array();
        for (int i = 0; i < 4; ++i) color.push_back(std::clamp(m.baseColor[i], 0.0f, 1.0f));
        Json shading{{"baseColorFactor", std::move(color)}, {"metallicFactor", std::clamp(m.metallic, 0.0f, 1.0f)}, {"roughnessFactor", std::clamp(m.roughness, 0.0f, 1.0f)}};
        if (m.baseColorTexture >= 0 && surface.texCoords.rows() > 0)
            if (const int texture = addTexture(surface.look->textures[static_cast<std::size_t>(m.baseColorTexture)]); texture >= 0) shading["baseColorTexture"] = {{"index", texture}};
        Json out{{"name", m.name}, {"pbrMetallicRoughness", std::move(shading)}};
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

    /// Bones are counted over all rigs.
    [[nodiscard]] std::size_t avatarBone(int bone) const {
        std::size_t first = 0;
        for (const auto& rig : scene_.rigs) {
            if (rig.rig.get() == options_.avatar) break;
            first += rig.rig->bones.size();
        }
        return first + static_cast<std::size_t>(bone);
    }

    /// A node with its mesh: a surface, or all of a part.
    int addSurface(std::size_t s) {
        const RenderSurface& surface = content_.surfaces[s];
        const bool ofMesh = surface.element < 0;
        Json node{{"name", ofMesh ? onlyName(surface.name) : surface.name}, {"extras", {{ofMesh ? kPartExtra : kElementExtra, ofMesh ? surface.part : surface.element}}}};
        const Unit unit = units_[static_cast<std::size_t>(ofMesh ? surface.movers.front() : surface.element)];
        const bool skin = skinned(surface);
        factor_.resize(content_.surfaces.size());
        if (surface.parts.empty()) {
            if (!skin) node["translation"] = vector(unit.middle);
            return file_.add("nodes", std::move(node));
        }
        std::size_t end = s + 1;
        while (end < content_.surfaces.size() && !begins(end)) ++end;
        const auto movers = rigid() ? content_.movers(surface) : std::vector<GltfContent::Mover>();
        const Eigen::Index count = content_.targets(movers);
        const std::vector<float> factors = factorsOf(s, end, unit, count);
        Json names = Json::array(), primitives = Json::array();
        for (Eigen::Index t = 0; t < count; ++t) names.push_back(targetName(surface, movers, t));
        for (std::size_t i = s; i < end; ++i) {
            addPrimitives(i, unit, factors, primitives);
            factor_[i] = factors;
        }
        // Those of the imported file come last, as they are there: the weights of its own animations suit them.
        const std::vector<int> own = fileTargets(surface);
        std::vector<double> standing(names.size(), 0.0);
        for (const int t : own) {
            const MorphTarget& target = scene_.meshes[static_cast<std::size_t>(surface.mesh)].model->morphs[static_cast<std::size_t>(t)];
            names.push_back(target.name);
            standing.push_back(target.atRest);
        }
        report_.targets = std::max(report_.targets, static_cast<int>(names.size()));
        if (unit.whole) tellRounding(movers, unit, factors);
        Json mesh{{"name", surface.name}, {"primitives", std::move(primitives)}};
        if (!names.empty()) {
            mesh["weights"] = std::move(standing);
            mesh["extras"] = {{"targetNames", std::move(names)}};
        }
        node["mesh"] = file_.add("meshes", std::move(mesh));
        if (skin) {
            node["skin"] = 0;
        } else {
            node["translation"] = vector(unit.middle);
            if (unit.whole) node["scale"] = {unit.size, unit.size, unit.size};
        }
        return file_.add("nodes", std::move(node));
    }

    /// A target that fills the range of its integers rounds least.
    [[nodiscard]] std::vector<float> factorsOf(std::size_t begin, std::size_t end, const Unit& unit, Eigen::Index count) const {
        std::vector<float> out;
        for (Eigen::Index t = 0; t < count; ++t) {
            float reach = 0.0f;
            for (std::size_t i = begin; unit.whole && i < end; ++i)
                for (const float x : targetOf(content_.surfaces[i], t)) reach = std::max(reach, std::abs(x));
            out.push_back(unit.whole && reach > 0.0f && reach <= unit.size ? unit.size / reach : 1.0f);
        }
        return out;
    }

    void addPrimitives(std::size_t s, const Unit& unit, const std::vector<float>& factors, Json& primitives) {
        const RenderSurface& surface = content_.surfaces[s];
        const bool ofMesh = surface.element < 0, small = unit.whole;
        const std::vector<float> positions = positionsOf(surface);
        Json attributes{{"POSITION", small ? file_.quantised(positions, unit.size, true) : file_.accessor(positions, 3, Target::Vertices, true)}};
        const std::vector<float> normals(surface.normals.data(), surface.normals.data() + surface.normals.size());
        attributes["NORMAL"] = small && content_.normalTargets.empty() ? file_.quantised(normals, 1.0f, false) : file_.accessor(normals, 3, Target::Vertices, false);
        if (surface.texCoords.rows() > 0)
            attributes["TEXCOORD_0"] = file_.accessor({surface.texCoords.data(), surface.texCoords.data() + surface.texCoords.size()}, 2, Target::Vertices, false);
        if (surface.colors.rows() > 0)
            attributes["COLOR_0"] = file_.accessor({surface.colors.data(), surface.colors.data() + surface.colors.size()}, 4, Target::Vertices, false);
        if (skinned(surface)) addInfluences(surface, attributes);
        Json targets = Json::array();
        for (std::size_t t = 0; t < factors.size(); ++t) {
            std::vector<float> moved = targetOf(surface, static_cast<Eigen::Index>(t));
            float reach = 0.0f;
            for (float& x : moved) {
                reach = std::max(reach, std::abs(x));
                x *= factors[t];
            }
            Json target{{"POSITION", addTarget(moved, small && reach <= unit.size ? unit.size : 0.0f, small ? 1.0f / unit.size : 1.0f, ofMesh)}};
            if (!content_.normalTargets.empty()) target["NORMAL"] = file_.accessor(scaledBy(content_.normalTargets[s][t], factors[t]), 3, Target::Vertices, false);
            targets.push_back(std::move(target));
        }
        for (const int t : fileTargets(surface)) {
            const std::vector<float> moved = fileTarget(surface, t);
            Json target{{"POSITION", file_.mostlyZero(scaledBy(moved, small ? 1.0f / unit.size : 1.0f), 0.0f)}};
            if (!content_.normalTargets.empty()) target["NORMAL"] = file_.mostlyZero(std::vector<float>(moved.size(), 0.0f), 0.0f);
            targets.push_back(std::move(target));
        }
        int triangles = 0;
        for (const auto& part : surface.parts) {
            Json primitive{{"attributes", attributes}, {"indices", file_.indices(part.triangles, surface.vertices())}, {"material", addMaterial(surface, part.material)}};
            if (!targets.empty()) primitive["targets"] = targets;
            primitives.push_back(std::move(primitive));
            triangles += static_cast<int>(part.triangles.size() / 3);
        }
        tell(s, triangles);
    }

    void tellRounding(const std::vector<GltfContent::Mover>& movers, const Unit& unit, const std::vector<float>& factors) {
        // Four weights round by a step each, and take a vertex no farther than its joints are apart: a diagonal.
        if (!rigid()) return rounded(unit.size, 1.0, 4.0 / 65535.0);
        double weighed = 0.0;
        for (const auto& mover : movers)
            for (const auto& track : content_.morphs[static_cast<std::size_t>(mover.element)].tracks)
                for (Eigen::Index key = 0; key < track.weights.cols(); ++key) {
                    double sum = 0.0;
                    for (Eigen::Index t = 0; t < track.weights.rows(); ++t) sum += std::abs(track.weights(t, key)) / factors[static_cast<std::size_t>(mover.first + t)];
                    weighed = std::max(weighed, sum);
                }
        rounded(unit.size, 1.0 + weighed, 0.0);
    }

    /// Most programs want each object to have a name of its own; meshes of parts keep theirs.
    std::string onlyName(const std::string& wish) {
        names_.insert(scene_.elements.begin(), scene_.elements.end());
        std::string name = wish;
        for (int n = 2; !names_.insert(name).second; ++n) name = wish + " " + std::to_string(n);
        return name;
    }

    void tell(std::size_t s, int triangles) {
        const RenderSurface& surface = content_.surfaces[s];
        const int vertices = static_cast<int>(surface.vertices());
        report_.vertices += vertices;
        report_.triangles += triangles;
        const bool ofMesh = surface.element < 0;
        const std::string& name = ofMesh ? scene_.meshes[static_cast<std::size_t>(surface.mesh)].name : surface.name;
        // Parts of a mesh come one after the other.
        if (!ofMesh || toldMesh_ != surface.mesh) report_.written.push_back({name, ofMesh, 0, 0, 0});
        toldMesh_ = surface.mesh;
        auto& told = report_.written.back();
        told.parts += ofMesh && begins(s) ? 1 : 0;
        told.vertices += vertices;
        told.triangles += triangles;
    }

    /// The morph targets of its file that move vertices of the part of a surface.
    [[nodiscard]] std::vector<int> fileTargets(const RenderSurface& surface) const {
        if (surface.mesh < 0 || content_.motion.morphs(surface.mesh) == 0) return {};
        const auto& morphs = scene_.meshes[static_cast<std::size_t>(surface.mesh)].model->morphs;
        std::vector<int> out;
        for (std::size_t t = 0; t < morphs.size(); ++t) {
            const auto moves = [&](std::int32_t v) { return std::binary_search(morphs[t].vertices.begin(), morphs[t].vertices.end(), v); };
            if (std::any_of(content_.surfaces.begin(), content_.surfaces.end(), [&](const RenderSurface& other) { return other.part == surface.part && std::any_of(other.seen.begin(), other.seen.end(), moves); }))
                out.push_back(static_cast<int>(t));
        }
        return out;
    }
    [[nodiscard]] std::vector<float> fileTarget(const RenderSurface& surface, int target) const {
        const MorphTarget& morph = scene_.meshes[static_cast<std::size_t>(surface.mesh)].model->morphs[static_cast<std::size_t>(target)];
        std::vector<float> out(3 * surface.vertices(), 0.0f);
        for (std::size_t i = 0; i < surface.vertices(); ++i) {
            const auto at = std::lower_bound(morph.vertices.begin(), morph.vertices.end(), surface.seen[i]);
            if (at != morph.vertices.end() && *at == surface.seen[i]) std::copy_n(morph.deltas.data() + 3 * (at - morph.vertices.begin()), 3, out.begin() + static_cast<std::ptrdiff_t>(3 * i));
        }
        return out;
    }

    /// What a unit of a target moves each vertex by, 3 per vertex, m.
    [[nodiscard]] std::vector<float> targetOf(const RenderSurface& surface, Eigen::Index target) const {
        std::vector<float> out(3 * surface.vertices(), 0.0f);
        std::vector<Eigen::Index> column(scene_.elements.size(), -1);
        for (const auto& mover : content_.movers(surface)) {
            const auto e = static_cast<std::size_t>(mover.element);
            if (target >= mover.first && target < mover.first + content_.morphs[e].targets.cols()) column[e] = target - mover.first;
        }
        for (std::size_t i = 0; i < surface.vertices(); ++i) {
            const auto e = static_cast<std::size_t>(surface.elements[i]);
            for (int k = 0; column[e] >= 0 && k < 3; ++k) out[3 * i + static_cast<std::size_t>(k)] = content_.morphs[e].targets(3 * surface.rows[i] + k, column[e]);
        }
        return out;
    }
    /// Several elements may call theirs alike.
    [[nodiscard]] std::string targetName(const RenderSurface& surface, const std::vector<GltfContent::Mover>& movers, Eigen::Index target) const {
        for (const auto& mover : movers) {
            const ElementMorphs& m = content_.morphs[static_cast<std::size_t>(mover.element)];
            if (target < mover.first || target >= mover.first + m.targets.cols()) continue;
            const std::string& name = m.names[static_cast<std::size_t>(target - mover.first)];
            return surface.element >= 0 || m.shared ? name : scene_.elements[static_cast<std::size_t>(mover.element)] + " " + name;
        }
        return {};
    }
    /// whole: its unit, 0: in single precision and times `size`.
    int addTarget(const std::vector<float>& moved, float whole, float size, bool ofMesh) {
        if (ofMesh) return file_.mostlyZero(whole > 0.0f ? moved : scaledBy(moved, size), whole);
        return whole > 0.0f ? file_.quantised(moved, whole, true) : file_.accessor(scaledBy(moved, size), 3, Target::Vertices, true);
    }

    /// So many half steps of 16 bits along three axes, and a part of the diagonal.
    void rounded(float unit, double times, double part) {
        report_.quantised = std::max(report_.quantised, times * 0.5 * std::sqrt(3.0) * static_cast<double>(unit) / 32767.0 / content_.motion.diagonal + part);
    }

    static std::vector<float> scaledBy(std::vector<float> numbers, float factor) {
        for (float& x : numbers) x *= factor;
        return numbers;
    }

    void addInfluences(const RenderSurface& surface, Json& attributes) {
        const std::size_t vertices = surface.vertices();
        std::vector<std::uint16_t> joints(4 * vertices, 0);
        std::vector<float> weights(4 * vertices, 0.0f);
        for (std::size_t i = 0; i < vertices; ++i) {
            const auto e = static_cast<std::size_t>(surface.elements[i]);
            if (rigid()) {
                joints[4 * i] = jointOf_[e];
                weights[4 * i] = 1.0f;
                continue;
            }
            const auto& v = content_.skin.elements[e][static_cast<std::size_t>(surface.rows[i])];
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
        std::vector<std::size_t> all(times.size());
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
        if (!rigid()) {
            for (std::size_t j = 0; j < content_.skin.joints.size(); ++j) {
                if (content_.skin.joints[j].rigBone >= 0 || content_.skin.joints[j].parent >= 0) continue;
                rigidMotion(jointNodes_[j], all, content_.skin.tracks[c][j].rotations, content_.skin.tracks[c][j].places);
                report_.keys += all.size();
            }
        }
        for (const auto& track : rigs_.tracks(content_.motion.clips[c], rigid() ? nullptr : &content_.skin, c)) {
            channel(track.node, track.path, all, track.numbers, track.path[0] == 't' ? 3 : 4);
            report_.keys += all.size();
        }
        const double tolerance = std::max(options_.tolerance, kAlways) * content_.motion.diagonal;
        const auto needed = [&](std::size_t e) { return neededKeys(content_.morphs[e], content_.morphs[e].tracks[c], tolerance); };
        // All elements under a mesh have the keys of its weights.
        std::vector<std::vector<std::size_t>> keysOfMesh;
        for (const auto& mesh : scene_.meshes) {
            std::set<std::size_t> some;
            for (const int e : mesh.elements)
                if (rigid())
                    for (const std::size_t k : needed(static_cast<std::size_t>(e))) some.insert(k);
            const bool every = content_.motion.morphsChange(c, static_cast<int>(keysOfMesh.size()));
            keysOfMesh.push_back(every ? all : std::vector<std::size_t>(some.begin(), some.end()));
        }
        const auto surfaceOf = [&](std::size_t e) {
            return std::find_if(content_.surfaces.begin(), content_.surfaces.end(), [e](const RenderSurface& surface) { return surface.element == static_cast<int>(e); }) - content_.surfaces.begin();
        };
        for (std::size_t e = 0; rigid() && e < content_.morphs.size(); ++e) {
            const auto& track = content_.morphs[e].tracks[c];
            const int mesh = content_.motion.seen[e].mesh;
            const auto keys = mesh < 0 ? needed(e) : keysOfMesh[static_cast<std::size_t>(mesh)];
            report_.keys += keys.size();
            rigidMotion(movingNodes_[e], keys, track.rotations, track.places);
            if (mesh < 0) weigh(static_cast<std::size_t>(surfaceOf(e)), c, keys, channel);
        }
        for (std::size_t s = 0; s < content_.surfaces.size(); ++s)
            if (const int mesh = content_.surfaces[s].mesh; mesh >= 0 && begins(s)) weigh(s, c, keysOfMesh[static_cast<std::size_t>(mesh)], channel);
        if (channels.empty()) return;
        file_.add("animations", {{"name", scene_.clips[c].name}, {"samplers", std::move(samplers)}, {"channels", std::move(channels)}});
    }

    template <class Channel>
    void weigh(std::size_t s, std::size_t c, const std::vector<std::size_t>& keys, const Channel& channel) {
        const RenderSurface& surface = content_.surfaces[s];
        const auto movers = rigid() ? content_.movers(surface) : std::vector<GltfContent::Mover>();
        const std::vector<int> own = fileTargets(surface);
        const auto elastic = static_cast<std::size_t>(content_.targets(movers)), count = elastic + own.size();
        // The skin alone has no weights but those of the file, where they are other than at rest.
        if (count == 0 || surface.parts.empty() || keys.empty()) return;
        std::vector<float> weights;
        for (const std::size_t k : keys) {
            const std::size_t first = weights.size();
            weights.resize(first + count);
            for (const auto& mover : movers) {
                const auto& track = content_.morphs[static_cast<std::size_t>(mover.element)].tracks[c];
                for (Eigen::Index t = 0; t < track.weights.rows(); ++t) {
                    const auto at = static_cast<std::size_t>(mover.first + t);
                    weights[first + at] = static_cast<float>(track.weights(t, static_cast<Eigen::Index>(k)) / factor_[s][at]);
                }
            }
            for (std::size_t t = 0; t < own.size(); ++t)
                weights[first + elastic + t] = static_cast<float>(content_.motion.morphWeight(surface.mesh, own[t], content_.motion.clips[c].shapes[k].data()));
        }
        channel(surfaceNodes_[s], "weights", keys, weights, 1);
    }

    static constexpr double kAlways = 1e-9;  // of the diagonal: smaller motions are lost in single precision, so their keys are always left out

    const GltfContent& content_;
    const ExportScene& scene_;
    const ExportOptions& options_;
    ExportReport& report_;
    const Progress& progress_;
    GltfFile file_;
    GltfRigs rigs_;
    int root_ = -1, toldMesh_ = -1;
    std::vector<int> surfaceNodes_, jointNodes_;
    std::vector<int> movingNodes_;            // per element: of its frame
    std::vector<std::uint16_t> jointOf_;      // per element: that of its frame, among those of the skeleton
    std::vector<Unit> units_;                 // per element
    std::vector<std::vector<float>> factor_;  // per surface, per target: what its weights are divided by
    std::set<std::string> names_;             // of nodes of elements and parts
    std::map<std::string, int> materials_, textures_;
};

}  // namespace

std::vector<GltfContent::Mover> GltfContent::movers(const RenderSurface& surface) const {
    std::vector<Mover> out;
    if (surface.element >= 0) return {{surface.element, 0}};
    // Weights of targets that are shared follow from all elements.
    if (morphs[static_cast<std::size_t>(surface.movers.front())].shared) {
        for (const int e : scene.meshes[static_cast<std::size_t>(surface.mesh)].elements) out.push_back({e, 0});
        return out;
    }
    for (const int e : surface.movers) {
        out.push_back({e, out.empty() ? 0 : targets(out)});
    }
    return out;
}

Eigen::Index GltfContent::targets(const std::vector<Mover>& movers) const {
    return movers.empty() ? 0 : movers.back().first + morphs[static_cast<std::size_t>(movers.back().element)].targets.cols();
}

Result<std::string> writeGltf(const GltfContent& content, ExportReport& report, const Progress& progress) {
    return SceneWriter(content, report, progress).write();
}

}  // namespace imomushi
