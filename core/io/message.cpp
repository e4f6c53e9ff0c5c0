// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/message.h"

#include <algorithm>
#include <cmath>

#include "core/base/finite.h"
#include "core/io/message_bytes.h"
#include "core/io/raw_scene.h"
#include "core/mesh/bounds.h"

namespace imomushi {
namespace {

using Writer = MessageWriter;
using Reader = MessageReader;

constexpr char kMagic[4] = {'i', 'm', 'o', '1'};
void write(Writer& w, const std::vector<MeshIssue>& issues) {
    w.value(static_cast<std::uint64_t>(issues.size()));
    for (const MeshIssue& i : issues) {
        w.value(static_cast<std::uint8_t>(i.severity));
        w.text(i.code);
        w.text(i.text);
        w.value(static_cast<std::int32_t>(i.count));
        w.value(static_cast<std::uint8_t>(i.fixed));
        w.items(i.triangles.data(), i.triangles.size());
        w.items(i.vertices.data(), i.vertices.size());
    }
}

bool inRange(const std::vector<std::int32_t>& indices, Eigen::Index end) {
    return std::all_of(indices.begin(), indices.end(), [&](std::int32_t i) { return i >= 0 && i < end; });
}

bool inRange(const Triangles& t, Eigen::Index end) { return t.rows() == 0 || (t.minCoeff() >= 0 && t.maxCoeff() < end); }

/// `triangles`, `vertices`: how many there are to refer to.
std::vector<MeshIssue> readIssues(Reader& r, Eigen::Index triangles, Eigen::Index vertices) {
    std::vector<MeshIssue> issues;
    const std::size_t n = r.count(1);
    for (std::size_t i = 0; i < n && r.good(); ++i) {
        MeshIssue& issue = issues.emplace_back();
        const auto severity = r.value<std::uint8_t>();
        if (severity > static_cast<std::uint8_t>(Severity::Error)) r.refuse();
        issue.severity = static_cast<Severity>(severity);
        issue.code = cleanName(r.text(), "unknown");
        issue.text = r.text();
        issue.count = r.value<std::int32_t>();
        issue.fixed = r.value<std::uint8_t>() != 0;
        issue.triangles = r.items<std::int32_t>();
        issue.vertices = r.items<std::int32_t>();
        if (!inRange(issue.triangles, triangles) || !inRange(issue.vertices, vertices)) r.refuse();
    }
    return issues;
}

void write(Writer& w, const RenderMesh& render) {
    w.items(render.bodyVertex.data(), render.bodyVertex.size());
    w.matrix(render.triangles);
    w.matrix(render.normals);
    w.matrix(render.texCoords);
    w.matrix(render.colors);
    w.items(render.material.data(), render.material.size());
    w.value(static_cast<std::uint64_t>(render.materials.size()));
    for (const Material& m : render.materials) {
        w.text(m.name);
        w.matrix(m.baseColor);
        w.value(m.metallic);
        w.value(m.roughness);
        w.value(static_cast<std::int32_t>(m.baseColorTexture));
    }
    w.value(static_cast<std::uint64_t>(render.textures.size()));
    for (const Texture& t : render.textures) {
        w.text(t.name);
        w.text(t.mimeType);
        w.items(t.bytes.data(), t.bytes.size());
    }
}

void readRenderMesh(Reader& r, const TriangleMesh& body, RenderMesh& render) {
    render.bodyVertex = r.items<std::int32_t>();
    r.matrix(render.triangles);
    r.matrix(render.normals);
    r.matrix(render.texCoords);
    r.matrix(render.colors);
    render.material = r.items<std::int32_t>();
    const std::size_t materials = r.count(1);
    for (std::size_t i = 0; i < materials && r.good(); ++i) {
        Material& m = render.materials.emplace_back();
        m.name = cleanName(r.text(), "material");
        Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor> color;
        r.matrix(color);
        m.metallic = r.value<float>();
        m.roughness = r.value<float>();
        m.baseColorTexture = r.value<std::int32_t>();
        if (color.rows() != 1 || !allFinite(color) || !std::isfinite(m.metallic) || !std::isfinite(m.roughness)) {
            r.refuse();
            return;
        }
        m.baseColor = color.row(0).transpose();
    }
    const std::size_t textures = r.count(1);
    for (std::size_t i = 0; i < textures && r.good(); ++i) {
        Texture& t = render.textures.emplace_back();
        t.name = cleanName(r.text(), "texture");
        t.mimeType = cleanName(r.text(), "application/octet-stream");
        t.bytes = r.items<std::uint8_t>();
    }
    if (!r.good()) return;

    const auto renderVertices = static_cast<Eigen::Index>(render.bodyVertex.size());
    const auto fits = [&](Eigen::Index rows) { return rows == 0 || rows == renderVertices; };
    bool good = inRange(render.bodyVertex, body.vertices.rows()) && render.triangles.rows() == body.triangles.rows() &&
                inRange(render.triangles, renderVertices) && fits(render.normals.rows()) && fits(render.texCoords.rows()) && fits(render.colors.rows()) &&
                allFinite(render.normals) && allFinite(render.texCoords) && allFinite(render.colors) &&
                (render.material.empty() || static_cast<Eigen::Index>(render.material.size()) == body.triangles.rows()) &&
                inRange(render.material, static_cast<Eigen::Index>(render.materials.size()));
    for (const Material& m : render.materials)
        good = good && m.baseColorTexture >= -1 && m.baseColorTexture < static_cast<int>(render.textures.size());
    for (Eigen::Index i = 0; good && i < render.triangles.size(); ++i)
        good = render.bodyVertex[static_cast<std::size_t>(render.triangles.data()[i])] == body.triangles.data()[i];
    if (!good) r.refuse();
}

void write(Writer& w, const ElementMesh& mesh) {
    w.matrix(mesh.body.vertices);
    w.matrix(mesh.body.triangles);
    write(w, mesh.renderMesh);
}

/// `empty`: it may have neither vertices nor triangles.
void readMesh(Reader& r, ElementMesh& mesh, bool empty = false) {
    r.matrix(mesh.body.vertices);
    r.matrix(mesh.body.triangles);
    const TriangleMesh& body = mesh.body;
    if (r.good() && empty && body.vertices.rows() == 0 && body.triangles.rows() == 0)
        readRenderMesh(r, body, mesh.renderMesh);
    else if (!r.good() || body.triangles.rows() == 0 || !allFinite(body.vertices) || !inRange(body.triangles, body.vertices.rows()) ||
        body.vertices.cwiseAbs().maxCoeff() > kMaxCoordinate)
        r.refuse();
    else
        readRenderMesh(r, body, mesh.renderMesh);
}

tl::unexpected<Error> contradicts() {
    return fail("worker-failed", "The import worker answered with something that contradicts itself: the file is probably damaged, export it again.");
}

/// What both answers begin with. False: an error, which is all of the answer.
template <class Answer>
bool begin(Writer& w, const Result<Answer>& answer) {
    w.value(static_cast<std::uint8_t>(answer.has_value()));
    if (!answer) {
        w.text(answer.error().code);
        w.text(answer.error().message);
        return false;
    }
    w.text(answer->format);
    w.value(answer->metresPerUnit);
    w.value(static_cast<std::uint8_t>(answer->zUpConverted));
    return true;
}

/// An error: the worker's own, or that it contradicts itself.
template <class Answer>
Result<void> begin(Reader& r, Answer& answer) {
    if (r.value<std::uint8_t>() == 0) {
        std::string code = cleanName(r.text(), ""), message = r.text();
        if (!r.finished() || code.empty() || message.empty()) return contradicts();
        return fail(std::move(code), std::move(message));
    }
    answer.format = cleanName(r.text(), "");
    answer.metresPerUnit = r.value<double>();
    answer.zUpConverted = r.value<std::uint8_t>() != 0;
    if (!r.good() || !isFinite(answer.metresPerUnit) || answer.metresPerUnit <= 0.0) return contradicts();
    return {};
}

}  // namespace

std::string frame(FrameKind kind, std::string_view content) {
    Writer w;
    w.value(static_cast<std::uint32_t>(kind));
    w.value(static_cast<std::uint64_t>(content.size()));
    std::string bytes(kMagic, sizeof kMagic);
    bytes += w.take();
    bytes += content;
    return bytes;
}

bool parseFrameHeader(std::string_view header, FrameKind& kind, std::uint64_t& length) {
    if (header.size() < kFrameHeader || header.substr(0, 4) != std::string_view(kMagic, 4)) return false;
    Reader r(header.substr(4, kFrameHeader - 4));
    const auto k = r.value<std::uint32_t>();
    length = r.value<std::uint64_t>();
    if (k < 1 || k > 4) return false;
    kind = static_cast<FrameKind>(k);
    return true;
}

std::string encodeRequest(const ImportRequest& request) {
    Writer w;
    w.text(request.path.native());
    w.value(static_cast<std::uint8_t>(request.unit));
    w.value(static_cast<std::uint8_t>(request.up));
    w.value(static_cast<std::uint8_t>(request.split));
    w.value(static_cast<std::uint8_t>(request.bonesSuffice));
    return w.take();
}

Result<ImportRequest> decodeRequest(std::string_view content) {
    Reader r(content);
    ImportRequest request;
    request.path = r.text();
    const auto unit = r.value<std::uint8_t>(), up = r.value<std::uint8_t>(), split = r.value<std::uint8_t>(), bones = r.value<std::uint8_t>();
    if (!r.finished() || unit > static_cast<std::uint8_t>(Unit::Metre) || up > static_cast<std::uint8_t>(UpAxis::Z) || split > 1 || bones > 1)
        return fail("worker-failed", "The import worker was asked something that it does not understand.");
    request.unit = static_cast<Unit>(unit);
    request.up = static_cast<UpAxis>(up);
    request.split = split != 0;
    request.bonesSuffice = bones != 0;
    return request;
}

std::string encodeProgress(std::string_view stage, double fraction) {
    Writer w;
    w.text(stage);
    w.value(fraction);
    return w.take();
}

bool decodeProgress(std::string_view content, std::string& stage, double& fraction) {
    Reader r(content);
    stage = cleanName(r.text(), "import");
    fraction = r.value<double>();
    return r.finished() && std::isfinite(fraction) && fraction >= 0.0 && fraction <= 1.0;
}

std::string encodeAnswer(const Result<ImportResult>& answer) {
    Writer w;
    if (!begin(w, answer)) return w.take();
    w.value(static_cast<std::uint64_t>(answer->bodies.size()));
    for (const ImportedBody& body : answer->bodies) {
        w.text(body.name);
        write(w, body.mesh);
        write(w, body.issues);
        w.value(static_cast<std::int32_t>(body.components));
        w.value(static_cast<std::uint8_t>(body.closed));
    }
    write(w, answer->issues);
    return w.take();
}

Result<ImportResult> decodeAnswer(std::string_view content) {
    Reader r(content);
    ImportResult result;
    if (auto begun = begin(r, result); !begun) return tl::unexpected(begun.error());
    const std::size_t bodies = r.count(1);
    for (std::size_t i = 0; i < bodies && r.good(); ++i) {
        ImportedBody& body = result.bodies.emplace_back();
        body.name = cleanName(r.text(), "mesh");
        readMesh(r, body.mesh);
        const TriangleMesh& mesh = body.mesh.body;
        body.issues = readIssues(r, mesh.triangles.rows(), mesh.vertices.rows());
        body.components = r.value<std::int32_t>();
        body.closed = r.value<std::uint8_t>() != 0;
        if (!r.good() || body.components < 1) return contradicts();
        if (body.closed) {
            const MeshFacts facts = meshFacts(mesh);
            body.closed = facts.closed && facts.outward;
        }
    }
    result.issues = readIssues(r, 0, 0);
    if (!r.finished() || result.bodies.empty()) return contradicts();
    return result;
}

std::string encodeCharacter(const Result<CharacterFile>& answer) {
    Writer w;
    if (!begin(w, answer)) return w.take();
    const RenderModel& model = answer->renderModel;
    write(w, model.mesh);
    w.items(model.part.data(), model.part.size());
    w.value(static_cast<std::uint64_t>(model.parts.size()));
    for (const std::string& name : model.parts) w.text(name);
    w.value(static_cast<std::uint64_t>(model.morphs.size()));
    for (const MorphTarget& target : model.morphs) {
        w.text(target.name);
        w.value(target.atRest);
        w.items(target.vertices.data(), target.vertices.size());
        w.matrix(target.deltas);
    }
    write(w, answer->issues);
    w.value(static_cast<std::uint8_t>(answer->rig.has_value()));
    if (answer->rig) writeRig(w, *answer->rig);
    return w.take();
}

Result<CharacterFile> decodeCharacter(std::string_view content) {
    Reader r(content);
    CharacterFile file;
    if (auto begun = begin(r, file); !begun) return tl::unexpected(begun.error());
    RenderModel& model = file.renderModel;
    readMesh(r, model.mesh, true);
    model.part = r.items<std::int32_t>();
    const std::size_t parts = r.count(sizeof(std::uint64_t));
    for (std::size_t i = 0; i < parts && r.good(); ++i) model.parts.push_back(cleanName(r.text(), "mesh"));
    const std::size_t morphs = r.count(1);
    for (std::size_t i = 0; i < morphs && r.good(); ++i) {
        MorphTarget& target = model.morphs.emplace_back();
        target.name = cleanName(r.text(), "");
        target.atRest = r.value<double>();
        target.vertices = r.items<std::int32_t>();
        r.matrix(target.deltas);
    }
    const TriangleMesh& mesh = model.mesh.body;
    if (r.good() && !checkMorphs(model.morphs, static_cast<std::size_t>(mesh.vertices.rows())).empty()) r.refuse();
    if (static_cast<Eigen::Index>(model.part.size()) != mesh.triangles.rows() || !inRange(model.part, static_cast<Eigen::Index>(model.parts.size()))) r.refuse();
    if (r.good()) file.issues = readIssues(r, mesh.triangles.rows(), mesh.vertices.rows());
    const auto rigged = r.value<std::uint8_t>();
    if (rigged > 1 || (rigged == 0 && mesh.triangles.rows() == 0)) r.refuse();
    if (rigged == 1) readRig(r, static_cast<std::size_t>(mesh.vertices.rows()), file.rig.emplace());
    if (!r.finished()) return contradicts();
    return file;
}

}  // namespace imomushi
