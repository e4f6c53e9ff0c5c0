// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/obj_model.h"

#include <charconv>
#include <set>
#include <string>

#include "core/base/atomic_file.h"

namespace imomushi {

namespace {

template <class T>
void append(std::string& out, T value) {
    char text[32];
    out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

template <class Row>
void appendLine(std::string& out, const char* word, const Row& values) {
    out += word;
    for (Eigen::Index i = 0; i < values.size(); ++i) out += ' ', append(out, values[i]);
    out += '\n';
}

/// A name ends with its line, and some readers end it at a space.
std::string oneWord(const std::string& name) {
    std::string out = name.empty() ? "_" : name;
    for (char& c : out)
        if (static_cast<unsigned char>(c) <= 0x20 || c == 0x7f) c = '_';
    return out;
}

/// Names of materials, each once.
std::vector<std::string> materialNames(const RenderMesh& render) {
    std::vector<std::string> out;
    std::set<std::string> taken;
    for (const Material& material : render.materials) {
        const std::string wish = oneWord(material.name);
        std::string name = wish;
        for (int n = 2; !taken.insert(name).second; ++n) name = wish + "_" + std::to_string(n);
        out.push_back(std::move(name));
    }
    return out;
}

}  // namespace

Result<void> writeObjModel(const std::filesystem::path& path, const RenderModel& model, const Points& vertices, const float* normals, const std::filesystem::path& materials) {
    const RenderMesh& render = model.mesh.renderMesh;
    const TriangleMesh& body = model.mesh.body;
    const auto count = static_cast<Eigen::Index>(render.bodyVertex.size());
    const bool split = render.triangles.rows() == body.triangles.rows() && count > 0;
    const bool texCoords = split && render.texCoords.rows() == count, ownNormals = split && !normals && render.normals.rows() == count;
    std::string out;
    out.reserve(static_cast<std::size_t>(vertices.rows()) * 100 + static_cast<std::size_t>(body.triangles.rows()) * 40);
    if (!materials.empty()) out += "mtllib " + materials.filename().string() + "\n";
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) appendLine(out, "v", vertices.row(v));
    // OBJ counts texture coordinates from below.
    for (Eigen::Index r = 0; texCoords && r < count; ++r) appendLine(out, "vt", Eigen::RowVector2f(render.texCoords(r, 0), 1.0f - render.texCoords(r, 1)));
    for (Eigen::Index r = 0; ownNormals && r < count; ++r) appendLine(out, "vn", render.normals.row(r));
    for (Eigen::Index v = 0; normals && v < vertices.rows(); ++v) appendLine(out, "vn", Eigen::RowVector3f(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]));
    const auto names = materialNames(render);
    std::int32_t part = -1, material = -1;
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        const auto f = static_cast<std::size_t>(t);
        if (f < model.part.size() && model.part[f] != part) {
            part = model.part[f];
            out += "g " + oneWord(model.parts[static_cast<std::size_t>(part)]) + "\n";
        }
        const std::int32_t wanted = names.empty() ? -1 : f < render.material.size() ? render.material[f] : names.size() == 1 ? 0 : -1;
        if (!materials.empty() && wanted != material && wanted >= 0) {
            material = wanted;
            out += "usemtl " + names[static_cast<std::size_t>(material)] + "\n";
        }
        out += 'f';
        for (int k = 0; k < 3; ++k) {
            const std::int32_t v = body.triangles(t, k) + 1, r = split ? render.triangles(t, k) + 1 : v;
            out += ' ';
            append(out, v);
            if (texCoords || ownNormals || normals) out += '/';
            if (texCoords) append(out, r);
            if (ownNormals || normals) out += '/', append(out, normals ? v : r);
        }
        out += '\n';
    }
    return writeFileAtomically(path, out);
}

Result<std::vector<std::filesystem::path>> writeObjMaterials(const std::filesystem::path& path, const RenderModel& model) {
    const RenderMesh& render = model.mesh.renderMesh;
    std::vector<std::filesystem::path> files;
    if (render.materials.empty()) return files;
    files.push_back(std::filesystem::path(path).replace_extension(".mtl"));
    std::vector<std::string> textures;
    for (std::size_t i = 0; i < render.textures.size(); ++i) {
        const Texture& texture = render.textures[i];
        std::string kind = texture.mimeType.substr(texture.mimeType.find('/') + 1);
        if (kind == "jpeg") kind = "jpg";
        std::filesystem::path file = path;
        file.replace_filename(path.stem().string() + "_" + std::to_string(i + 1) + "." + (kind.empty() ? "image" : kind));
        if (auto written = writeFileAtomically(file, {reinterpret_cast<const char*>(texture.bytes.data()), texture.bytes.size()}); !written) return tl::unexpected(written.error());
        textures.push_back(file.filename().string());
        files.push_back(std::move(file));
    }
    std::string out;
    const auto names = materialNames(render);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Material& material = render.materials[i];
        out += "newmtl " + names[i] + "\n";
        appendLine(out, "Kd", material.baseColor.head<3>());
        for (const auto& [key, value] : {std::pair("d", material.baseColor[3]), std::pair("Pm", material.metallic), std::pair("Pr", material.roughness)})
            appendLine(out, key, Eigen::Matrix<float, 1, 1>(value));
        if (material.baseColorTexture >= 0) out += "map_Kd " + textures[static_cast<std::size_t>(material.baseColorTexture)] + "\n";
    }
    if (auto written = writeFileAtomically(files.front(), out); !written) return tl::unexpected(written.error());
    return files;
}

}  // namespace imomushi
