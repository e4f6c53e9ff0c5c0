// SPDX-License-Identifier: GPL-3.0-or-later
// A worker that does what no reader should, by the name of the file that it is asked for.
#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/io/file_codec.h"
#include "core/worker/worker.h"

using namespace imomushi;

namespace {

/// Does not return for what names no lie.
void misbehave(const std::string& how) {
    if (how == "crash") std::raise(SIGSEGV);
    if (how == "abort") std::abort();
    if (how == "quit") ::_exit(0);
    if (how == "hang") ::sleep(1000);
    if (how == "burn")
        for (;;) ::getppid();
    if (how == "memory") {
        std::vector<std::string> all;
        for (;;) all.emplace_back(std::size_t{1} << 24, 'x');
    }
}

/// One triangle, with a corner that does not exist where `how` is "lie".
ElementMesh triangle(const std::string& how) {
    ElementMesh mesh;
    mesh.body.vertices = Points::Identity(3, 3);
    mesh.body.triangles = Triangles::Zero(1, 3);
    mesh.body.triangles.row(0) << 0, 1, how == "lie" ? 7 : 2;
    mesh.renderMesh.bodyVertex = {0, 1, 2};
    mesh.renderMesh.triangles = mesh.body.triangles;
    return mesh;
}

Result<ImportResult> file(const ImportRequest& request, const Progress&) {
    const std::string how = request.path.stem().string();
    misbehave(how);
    ImportResult result;
    result.format = "obj";
    ImportedBody& body = result.bodies.emplace_back();
    body.name = how == "latin" ? "caf\xe9" : how;
    body.mesh = triangle(how);
    body.closed = how == "closed";
    return result;
}

Result<CharacterFile> character(const ImportRequest& request, const Progress&) {
    const std::string how = request.path.stem().string();
    misbehave(how);
    CharacterFile result;
    result.format = "obj";
    result.renderModel.mesh = triangle(how);
    if (how != "other") result.renderModel.part = {0};
    result.renderModel.parts = {how};
    return result;
}

const Operation<Result<ImportResult>(ImportRequest)> kFile("import-file", file);
const Operation<Result<CharacterFile>(ImportRequest)> kCharacter("import-character", character);

}  // namespace

int main() { return workerMain(); }
