// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unistd.h>

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "core/io/import.h"
#include "core/worker/worker.h"
#include "tests/support/folder.h"

namespace imomushi::io_test {

/// Another program's workers while this lives.
struct WithWorker {
    explicit WithWorker(const char* program) { setWorkerProgram(program); }
    ~WithWorker() { setWorkerProgram("/proc/self/exe"); }
};

inline Result<ImportResult> import(ImportRequest request) {
    return importFile(request, {});
}

inline Result<ImportResult> import(const std::filesystem::path& path) {
    ImportRequest request;
    request.path = path;
    return import(request);
}

/// `code` among the issues of the file or its bodies; null: not there.
inline const MeshIssue* find(const ImportResult& result, const std::string& code) {
    for (const MeshIssue& i : result.issues)
        if (i.code == code) return &i;
    for (const ImportedBody& b : result.bodies)
        for (const MeshIssue& i : b.issues)
            if (i.code == code) return &i;
    return nullptr;
}

/// The simplest reading of an OBJ of triangles that is right: by the C library.
inline TriangleMesh plainObj(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::vector<double> v;
    std::vector<std::int32_t> f;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string key, word;
        words >> key;
        if (key == "v")
            for (int k = 0; k < 3; ++k) words >> word, v.push_back(std::strtod(word.c_str(), nullptr));
        if (key == "f")
            for (int k = 0; k < 3; ++k) words >> word, f.push_back(std::atoi(word.c_str()) - 1);
    }
    TriangleMesh mesh;
    mesh.vertices = Eigen::Map<Points>(v.data(), static_cast<Eigen::Index>(v.size() / 3), 3);
    mesh.triangles = Eigen::Map<Triangles>(f.data(), static_cast<Eigen::Index>(f.size() / 3), 3);
    return mesh;
}

inline bool sameBits(const Points& a, const Points& b) {
    if (a.rows() != b.rows()) return false;
    for (Eigen::Index i = 0; i < a.size(); ++i)
        if (std::bit_cast<std::uint64_t>(a.data()[i]) != std::bit_cast<std::uint64_t>(b.data()[i])) return false;
    return true;
}

inline std::string objOf(const TriangleMesh& mesh) {
    std::ostringstream out;
    out.precision(17);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) out << "v " << mesh.vertices(v, 0) << ' ' << mesh.vertices(v, 1) << ' ' << mesh.vertices(v, 2) << '\n';
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f)
        out << "f " << mesh.triangles(f, 0) + 1 << ' ' << mesh.triangles(f, 1) + 1 << ' ' << mesh.triangles(f, 2) + 1 << '\n';
    return out.str();
}

}  // namespace imomushi::io_test
