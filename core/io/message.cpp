// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/message.h"

#include <algorithm>
#include <cmath>

#include "core/base/finite.h"
#include "core/io/message_bytes.h"
#include "core/mesh/bounds.h"

namespace imomushi {

constexpr Unit lastOf(Unit) { return Unit::Metre; }
constexpr UpAxis lastOf(UpAxis) { return UpAxis::Z; }
constexpr Severity lastOf(Severity) { return Severity::Error; }
constexpr RigTrack::Path lastOf(RigTrack::Path) { return RigTrack::Path::Scale; }
constexpr RigTrack::Interpolation lastOf(RigTrack::Interpolation) { return RigTrack::Interpolation::Cubic; }

auto fields(Some<Error> auto& e) { return listed(named(e.code), e.message); }
auto fields(Some<MeshIssue> auto& i) { return listed(i.severity, named(i.code, "unknown"), i.text, i.count, i.fixed, i.triangles, i.vertices); }
auto fields(Some<Material> auto& m) { return listed(named(m.name, "material"), m.baseColor, m.metallic, m.roughness, m.baseColorTexture); }
auto fields(Some<Texture> auto& t) { return listed(named(t.name, "texture"), named(t.mimeType, "application/octet-stream"), t.bytes); }
auto fields(Some<RenderMesh> auto& m) { return listed(m.bodyVertex, m.triangles, m.normals, m.texCoords, m.colors, m.material, m.materials, m.textures); }
auto fields(Some<ElementMesh> auto& m) { return listed(m.body.vertices, m.body.triangles, m.renderMesh); }
auto fields(Some<ImportedBody> auto& b) { return listed(named(b.name, "mesh"), b.mesh, b.issues, b.components, b.closed); }
auto fields(Some<ImportResult> auto& r) { return listed(named(r.format), r.metresPerUnit, r.zUpConverted, r.bodies, r.issues); }
auto fields(Some<MorphTarget> auto& t) { return listed(named(t.name), t.atRest, t.vertices, t.deltas); }
auto fields(Some<RenderModel> auto& m) { return listed(m.mesh, m.part, m.parts, m.morphs); }
auto fields(Some<RigBone> auto& b) { return listed(named(b.name), b.parent, b.node, b.head, b.tail, b.rotation); }
auto fields(Some<RigNode> auto& n) { return listed(n.parent, n.translation, n.rotation, n.scale, named(n.name)); }
auto fields(Some<RigTrack> auto& t) { return listed(t.node, t.path, t.interpolation, t.times, t.values); }
auto fields(Some<MorphTrack> auto& t) { return listed(named(t.target), t.interpolation, t.times, t.weights); }
auto fields(Some<RigClip> auto& c) { return listed(named(c.name), c.seconds, c.tracks, c.morphs); }
auto fields(Some<RigWeights> auto& w) { return listed(w.first, w.bone, w.weight); }
auto fields(Some<Rig> auto& r) { return listed(r.bones, r.nodes, r.toScene, r.weights, r.clips); }
auto fields(Some<CharacterFile> auto& f) { return listed(named(f.format), f.metresPerUnit, f.zUpConverted, f.renderModel, f.issues, f.rig); }

namespace {

constexpr char kMagic[4] = {'i', 'm', 'o', '1'};

/// Whether all are in [0, end).
bool inRange(const std::vector<std::int32_t>& indices, Eigen::Index end) {
    return std::all_of(indices.begin(), indices.end(), [&](std::int32_t i) { return i >= 0 && i < end; });
}

bool inRange(const Triangles& t, Eigen::Index end) { return t.rows() == 0 || (t.minCoeff() >= 0 && t.maxCoeff() < end); }

/// `triangles`, `vertices`: how many there are to refer to.
bool inRange(const std::vector<MeshIssue>& issues, Eigen::Index triangles, Eigen::Index vertices) {
    return std::all_of(issues.begin(), issues.end(), [&](const MeshIssue& i) { return inRange(i.triangles, triangles) && inRange(i.vertices, vertices); });
}

bool usable(const RenderMesh& render, const TriangleMesh& body) {
    const auto renderVertices = static_cast<Eigen::Index>(render.bodyVertex.size());
    const auto fits = [&](Eigen::Index rows) { return rows == 0 || rows == renderVertices; };
    bool good = inRange(render.bodyVertex, body.vertices.rows()) && render.triangles.rows() == body.triangles.rows() &&
                inRange(render.triangles, renderVertices) && fits(render.normals.rows()) && fits(render.texCoords.rows()) && fits(render.colors.rows()) &&
                allFinite(render.normals) && allFinite(render.texCoords) && allFinite(render.colors) &&
                (render.material.empty() || static_cast<Eigen::Index>(render.material.size()) == body.triangles.rows()) &&
                inRange(render.material, static_cast<Eigen::Index>(render.materials.size()));
    for (const Material& m : render.materials)
        good = good && allFinite(m.baseColor) && std::isfinite(m.metallic) && std::isfinite(m.roughness) && m.baseColorTexture >= -1 &&
               m.baseColorTexture < static_cast<int>(render.textures.size());
    for (Eigen::Index i = 0; good && i < render.triangles.size(); ++i)
        good = render.bodyVertex[static_cast<std::size_t>(render.triangles.data()[i])] == body.triangles.data()[i];
    return good;
}

bool usable(const ElementMesh& mesh) {
    const TriangleMesh& body = mesh.body;
    return body.triangles.rows() > 0 && allFinite(body.vertices) && inRange(body.triangles, body.vertices.rows()) &&
           body.vertices.cwiseAbs().maxCoeff() <= kMaxCoordinate && usable(mesh.renderMesh, body);
}

bool usable(ImportResult& result) {
    for (ImportedBody& body : result.bodies) {
        const TriangleMesh& mesh = body.mesh.body;
        if (!usable(body.mesh) || !inRange(body.issues, mesh.triangles.rows(), mesh.vertices.rows()) || body.components < 1) return false;
        if (!body.closed) continue;
        const MeshFacts facts = meshFacts(mesh);
        body.closed = facts.closed && facts.outward;
    }
    return !result.bodies.empty() && inRange(result.issues, 0, 0);
}

/// Bones may come without a mesh.
bool usable(CharacterFile& file) {
    RenderModel& model = file.renderModel;
    for (std::string& part : model.parts) part = cleanName(part, "mesh");
    const TriangleMesh& mesh = model.mesh.body;
    const auto vertices = static_cast<std::size_t>(mesh.vertices.rows());
    const bool empty = file.rig && vertices == 0 && mesh.triangles.rows() == 0;
    return (empty ? usable(model.mesh.renderMesh, mesh) : usable(model.mesh)) && checkMorphs(model.morphs, vertices).empty() &&
           static_cast<Eigen::Index>(model.part.size()) == mesh.triangles.rows() && inRange(model.part, static_cast<Eigen::Index>(model.parts.size())) &&
           inRange(file.issues, mesh.triangles.rows(), mesh.vertices.rows()) && (!file.rig || checkRig(*file.rig, vertices).empty());
}

/// What it is, or the error instead.
template <class Answer>
std::string encode(const Result<Answer>& answer) {
    MessageWriter w;
    w(answer.has_value());
    if (answer)
        w(*answer);
    else
        w(answer.error());
    return w.take();
}

/// An error: the worker's own, or that it contradicts itself.
template <class Answer>
Result<Answer> decode(std::string_view content) {
    MessageReader r(content);
    bool made = false;
    r(made);
    Error error;
    if (r.good() && !made) r(error);
    if (r.finished() && !error.code.empty() && !error.message.empty()) return tl::unexpected(std::move(error));
    Answer answer;
    if (made) r(answer);
    if (!made || !r.finished() || !isFinite(answer.metresPerUnit) || answer.metresPerUnit <= 0.0 || !usable(answer))
        return fail("worker-failed", "The import worker answered with something that contradicts itself: the file is probably damaged, export it again.");
    return answer;
}

}  // namespace

std::string frame(FrameKind kind, std::string_view content) {
    MessageWriter w;
    w(static_cast<std::uint32_t>(kind), static_cast<std::uint64_t>(content.size()));
    std::string bytes(kMagic, sizeof kMagic);
    bytes += w.take();
    bytes += content;
    return bytes;
}

bool parseFrameHeader(std::string_view header, FrameKind& kind, std::uint64_t& length) {
    if (header.size() < kFrameHeader || header.substr(0, 4) != std::string_view(kMagic, 4)) return false;
    MessageReader r(header.substr(4, kFrameHeader - 4));
    std::uint32_t k = 0;
    r(k, length);
    if (k < 1 || k > 4) return false;
    kind = static_cast<FrameKind>(k);
    return true;
}

std::string encodeRequest(const ImportRequest& request) {
    MessageWriter w;
    w(request.path.native(), request.unit, request.up, request.split, request.bonesSuffice);
    return w.take();
}

Result<ImportRequest> decodeRequest(std::string_view content) {
    MessageReader r(content);
    ImportRequest request;
    std::string path;
    r(path, request.unit, request.up, request.split, request.bonesSuffice);
    if (!r.finished()) return fail("worker-failed", "The import worker was asked something that it does not understand.");
    request.path = path;
    return request;
}

std::string encodeProgress(std::string_view stage, double fraction) {
    MessageWriter w;
    w(stage, fraction);
    return w.take();
}

bool decodeProgress(std::string_view content, std::string& stage, double& fraction) {
    MessageReader r(content);
    r(named(stage, "import"), fraction);
    return r.finished() && std::isfinite(fraction) && fraction >= 0.0 && fraction <= 1.0;
}

std::string encodeAnswer(const Result<ImportResult>& answer) { return encode(answer); }
Result<ImportResult> decodeAnswer(std::string_view content) { return decode<ImportResult>(content); }
std::string encodeCharacter(const Result<CharacterFile>& answer) { return encode(answer); }
Result<CharacterFile> decodeCharacter(std::string_view content) { return decode<CharacterFile>(content); }

}  // namespace imomushi
