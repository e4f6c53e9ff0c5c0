// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/commands/core_commands.h"
#include "core/project/project_file.h"
#include "core/reports/report_commands.h"
#include "core/session/session.h"
#include "tests/support/folder.h"
#include "tests/support/shapes.h"
#include "tests/support/thorough.h"

namespace imomushi {

inline const CommandRegistry& coreRegistry() {
    static const CommandRegistry registry = [] {
        CommandRegistry made;
        addCoreCommands(made);
        addReportCommands(made);
        return made;
    }();
    return registry;
}

inline ImportedBody importedBody(std::string name, TriangleMesh mesh, bool closed = true) {
    ImportedBody body;
    body.name = std::move(name);
    body.closed = closed;
    for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v) body.mesh.renderMesh.bodyVertex.push_back(v);
    body.mesh.renderMesh.triangles = mesh.triangles;
    body.mesh.body = std::move(mesh);
    return body;
}

/// A session whose files are shapes: "barN" is a bar of 1 x 1 x 3 m from z = 3 N, "coarseN" one with other triangles, "pair" holds two bodies, "half"
/// a good and an open one, "open" an open one.
///
/// Whole characters: "trunk" is a bar of 1 x 1 x 12 m from z = 0; "ball" a sphere; "two balls" overlap, a part each; "tube" is open at both ends; "snowman" is a bar with a
/// separate eye off its surface.
class Workbench {
public:
    explicit Workbench(std::shared_ptr<ResponseStore> store = nullptr) : session(coreRegistry(), std::move(store)) {
        session.services().import = [](const ImportRequest& request, const Progress&) -> Result<ImportResult> {
            const std::string name = request.path.string();
            ImportResult result;
            result.format = "shape";
            const auto bar = [&](int cells, int place) {
                TriangleMesh mesh = shapes::bar(cells).mesh;
                mesh.vertices.col(2).array() += 3.0 * place;
                return mesh;
            };
            if (name.starts_with("bar"))
                result.bodies.push_back(importedBody(name, bar(2, std::stoi(name.substr(3)))));
            else if (name.starts_with("coarse"))
                result.bodies.push_back(importedBody(name, bar(3, std::stoi(name.substr(6)))));
            else if (name == "pair" || name == "half")
                result.bodies = {importedBody("one", bar(2, 0)), importedBody("one", bar(2, 3), name == "pair")};
            else if (name == "open")
                result.bodies = {importedBody("open", bar(2, 0), false)};
            else
                return fail("file-not-found", "There is no such shape.");
            return result;
        };
        session.services().importCharacter = characterFile;
    }

    static Result<CharacterFile> characterFile(const ImportRequest& request, const Progress&) {
        const std::string name = request.path.string();
        const auto shifted = [](TriangleMesh mesh, const Vec3& by) {
            mesh.vertices.rowwise() += by.transpose();
            return mesh;
        };
        if (name == "trunk") return characterOf({longBar()}, {"trunk"});
        if (name == "ball") return characterOf({shapes::sphere(1.0, 3).mesh}, {"ball"});
        if (name == "two balls") return characterOf({shapes::sphere(1.0, 3).mesh, shifted(shapes::sphere(1.0, 3).mesh, {1.2, 0.1, 0.05})}, {"left", "right"});
        if (name == "snowman") return characterOf({longBar(), shifted(shapes::sphere(0.05, 1).mesh, {0.0, 0.56, 6.03})}, {"trunk", "eye"});
        if (name == "tube") {
            TriangleMesh mesh = shapes::cylinder(0.5, 4.0, 16, 12).mesh;
            const double low = mesh.vertices.col(2).minCoeff(), high = mesh.vertices.col(2).maxCoeff();
            std::vector<Eigen::Index> wall;
            for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
                const auto z = [&](int k) { return mesh.vertices(mesh.triangles(t, k), 2); };
                const bool end = (z(0) == low && z(1) == low && z(2) == low) || (z(0) == high && z(1) == high && z(2) == high);
                if (!end) wall.push_back(t);
            }
            mesh.triangles = Triangles(mesh.triangles(wall, Eigen::indexing::all));
            return characterOf({mesh}, {"tube"});
        }
        return fail("file-not-found", "There is no such shape.");
    }
    static TriangleMesh longBar() { return shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 12.0}, 3, 3, 30).mesh; }
    /// One part for each mesh, one after the other.
    static CharacterFile characterOf(const std::vector<TriangleMesh>& meshes, std::vector<std::string> parts) {
        CharacterFile file;
        file.format = "shape";
        TriangleMesh& all = file.renderModel.mesh.body;
        for (std::size_t p = 0; p < meshes.size(); ++p) {
            const Eigen::Index v = all.vertices.rows(), t = all.triangles.rows();
            all.vertices.conservativeResize(v + meshes[p].vertices.rows(), 3);
            all.vertices.bottomRows(meshes[p].vertices.rows()) = meshes[p].vertices;
            all.triangles.conservativeResize(t + meshes[p].triangles.rows(), 3);
            all.triangles.bottomRows(meshes[p].triangles.rows()) = meshes[p].triangles.array() + static_cast<std::int32_t>(v);
            file.renderModel.part.resize(static_cast<std::size_t>(all.triangles.rows()), static_cast<std::int32_t>(p));
        }
        for (std::int32_t v = 0; v < all.vertices.rows(); ++v) file.renderModel.mesh.renderMesh.bodyVertex.push_back(v);
        file.renderModel.mesh.renderMesh.triangles = all.triangles;
        file.renderModel.parts = std::move(parts);
        return file;
    }

    Result<Json> run(const Json& command) { return session.execute(command); }
    Json good(const Json& command) {
        const auto answer = session.execute(command);
        if (!answer) FAIL(command.dump() << " -> " << answer.error().code << ": " << answer.error().message);
        return *answer;
    }
    std::string code(const Json& command) {
        const auto answer = session.execute(command);
        return answer ? std::string("ok") : answer.error().code;
    }

    /// Coarse answers of all elements, except in thorough tests: for what is stepped for long and asks that numbers hold, not how good they are.
    void solveCoarsely() {
        if (thorough()) return;
        std::vector<std::string> names;
        for (const auto& [id, element] : session.document().elements) names.push_back(element->name);
        for (const std::string& name : names) good({{"do", "set"}, {"target", name}, {"property", "solver-mesh"}, {"value", "draft"}});
    }

    /// Two bars along z, joined, a bone through each, and a tip face at the far end. Solved as they are: most cases do not ask how good a response is, and
    /// by default it takes a second or two.
    void buildChain(const std::string& solverMesh = "as-is") {
        good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
        good({{"do", "import-element"}, {"path", "bar1"}, {"name", "B"}});
        for (const char* element : {"A", "B"})
            if (solverMesh != "default") good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", solverMesh}});
        addFace("A", "in", 0, -1);
        addFace("A", "out", 3, 1);
        addFace("B", "in", 3, -1);
        addFace("B", "out", 6, 1);
        good({{"do", "join"}, {"a", "A/out"}, {"b", "B/in"}});
        good({{"do", "add-bone"}, {"name", "a"}, {"from", "A/in"}, {"to", "A/out"}});
        good({{"do", "add-bone"}, {"name", "b"}, {"from", "a/end"}, {"to", "B/out"}});
    }
    /// The same, but B has no face at its far end, which goes where it will.
    void buildFreeEnd() {
        good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
        good({{"do", "import-element"}, {"path", "bar1"}, {"name", "B"}});
        for (const char* element : {"A", "B"}) good({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
        addFace("A", "in", 0, -1);
        addFace("A", "out", 3, 1);
        addFace("B", "in", 3, -1);
        good({{"do", "join"}, {"a", "A/out"}, {"b", "B/in"}});
        good({{"do", "add-bone"}, {"name", "a"}, {"from", "A/in"}, {"to", "A/out"}});
        good({{"do", "add-bone"}, {"name", "b"}, {"element", "B"}, {"from", "a/end"}, {"to", {0.0, 0.0, 6.0}}});
    }
    Json addFace(const std::string& element, const std::string& name, double z, double normal) {
        return good({{"do", "add-joint-face"}, {"element", element}, {"name", name},
                     {"plane", {{"origin", {0, 0, z}}, {"normal", {0, 0, normal}}}}});
    }

    /// Everything that a project file says of the document, as bytes. Ids that were given out do not count.
    std::string content() {
        Project project;
        project.document = session.document();
        project.document.nextId = 1'000'000;
        const auto path = folder() / "content.imomushi";
        const auto saved = saveProject(path, project);
        if (!saved) FAIL(saved.error().message);
        return readFile(path);
    }

    static void writeFile(const std::filesystem::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }
    static std::filesystem::path folder() {
        static const TestFolder folder;
        return folder.path();
    }

    Session session;
};

}  // namespace imomushi
