// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/body/body.h"
#include "core/io/build_result.h"

using namespace imomushi;
namespace fs = std::filesystem;

namespace {

Result<RawScene> read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    return readScene({path, bytes});
}

void print(const std::string& name, const Eigen::Index vertices, const Body& body) {
    const BodyReport& r = body.report;
    std::printf("%-44.44s %6d %-8s %6d %2d  rms %.5f largest %.4f  volume %8.5f  detail %.4f  closed %.4f (%.4f-%.4f)  %.2f s\n", name.c_str(), static_cast<int>(vertices),
                std::string(nameOf(r.how)).c_str(), static_cast<int>(body.mesh.vertices.rows()), r.components, r.distanceRms, r.distanceLargest, r.volumeError, r.detail, r.gaps.area,
                r.gaps.narrowest, r.gaps.widest, r.seconds);
    std::fflush(stdout);
}

}  // namespace

TEST_CASE("trial") {
    const char* what = std::getenv("TRIAL");
    const char* how = std::getenv("HOW");
    if (!what) return;
    BodySetting setting;
    if (how && std::string(how) == "wrapped") setting.how = BodyKind::Wrapped;
    if (how && std::string(how) == "mended") setting.how = BodyKind::Mended;
    if (const char* d = std::getenv("DETAIL")) setting.detail = std::atof(d);
    std::vector<fs::path> paths;
    if (fs::is_directory(what))
        for (const auto& e : fs::directory_iterator(what)) paths.push_back(e.path());
    else
        paths.emplace_back(what);
    std::sort(paths.begin(), paths.end());
    for (const fs::path& path : paths) {
        const std::string x = path.extension();
        if (formatOf(path).empty()) continue;
        const auto scene = read(path);
        if (!scene) {
            std::printf("%s: %s\n", path.filename().c_str(), scene.error().code.c_str());
            continue;
        }
        const auto body = makeBody(scene->surface.mesh.body, scene->surface.part, setting, {});
        if (!body) {
            std::printf("%-44s %s %s\n", path.filename().c_str(), body.error().code.c_str(), body.error().message.c_str());
            continue;
        }
        print(path.filename(), scene->surface.mesh.body.vertices.rows(), *body);
        for (const MeshIssue& i : body->report.issues) std::printf("      %s: %s\n", i.code.c_str(), i.text.c_str());
    }
}
