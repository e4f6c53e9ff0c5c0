// SPDX-License-Identifier: GPL-3.0-or-later
// Memory and time that saving and opening take, beside the project itself: one of several hundred megabytes of responses, and one of an hour of a take of thirty
// elements that all move.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "core/project/project_file.h"
#include "tests/support/folder.h"
#include "tests/support/long_take.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

constexpr int kElements = 8, kFreeVertices = 100'000, kFaces = 2;

/// Of /proc/self/status, in MB.
double megabytes(const std::string& field) {
    std::ifstream status("/proc/self/status");
    for (std::string name, line; status >> name && std::getline(status, line);)
        if (name == field + ":") return std::strtod(line.c_str(), nullptr) / 1024.0;
    return 0.0;
}

/// Prints how far resident memory grew during `work` at most, and how long it took.
void measure(const char* name, const std::function<bool()>& work) {
    std::ofstream("/proc/self/clear_refs") << "5";  // the highest so far begins anew
    const double before = megabytes("VmRSS");
    const auto start = std::chrono::steady_clock::now();
    const bool good = work();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%-10s %8.0f MB more at most, %6.2f s%s\n", name, megabytes("VmHWM") - before, seconds, good ? "" : "  FAILED");
}

Project project() {
    Project made;
    for (int n = 0; n < kElements; ++n) {
        auto element = std::make_shared<Element>();
        element->id = made.document.nextId++;
        element->name = "e" + std::to_string(n);
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body = shapes::bar(2).mesh;
        for (std::int32_t v = 0; v < mesh->body.vertices.rows(); ++v) mesh->renderMesh.bodyVertex.push_back(v);
        element->mesh = mesh;
        auto response = std::make_shared<ElementResponse>();
        for (std::int32_t v = 0; v < kFreeVertices; ++v) response->freeVertices.push_back(v);
        response->firstColumn.push_back(0);
        for (int f = 0; f < kFaces; ++f) {
            response->bases.emplace_back();
            response->firstColumn.push_back(response->firstColumn.back() + response->bases.back().columns());
        }
        response->response.setRandom(3 * kFreeVertices, response->columns());
        response->stiffness.setIdentity(response->columns(), response->columns());
        made.responses[element->id] = {{1, static_cast<std::uint64_t>(n)}, {2, static_cast<std::uint64_t>(n)}, response};
        made.document.elements[element->id] = element;
    }
    return made;
}

}  // namespace

int main() {
    const TestFolder folder;
    const auto path = folder.path() / "large.imomushi";
    const auto saveAndOpen = [&](const Project& made) {
        std::printf("project    %8.0f MB\n", megabytes("VmRSS"));
        measure("save", [&] { return saveProject(path, made).has_value(); });
        std::error_code error;
        std::printf("file       %8.0f MB\n", static_cast<double>(std::filesystem::file_size(path, error)) / 1048576.0);
        measure("save again", [&] { return saveProject(path, made).has_value(); });
        measure("open", [&] { return openProject(path).has_value(); });
    };
    std::puts("responses");
    saveAndOpen(project());
    constexpr std::size_t kFrames = 60 * 60 * 60;
    std::puts("an hour of a take of 30 elements");
    Project take;
    auto hour = longTake(30, kFrames);
    hour->id = take.document.nextId++;
    take.document.takes[hour->id] = std::move(hour);
    saveAndOpen(take);
    return 0;
}
