// SPDX-License-Identifier: GPL-3.0-or-later
// A frame of a caterpillar of 5 bent elements, basis "affine", from its pose to display vertices in the memory of the renderer, both ways: by the processor
// (vertices, normals, upload) and by OpenGL (GpuDeformer: joint parameters are uploaded); then the same with a render mesh of as many vertices over bodies of
// 10,000. Waits for the renderer each frame. `bench_gpu [vertices ...]`
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/character/character.h"
#include "tests/character/caterpillar.h"
#include "tests/character/embedded.h"
#include "ui/render/gpu_deformer.h"
#include "ui/render/offscreen.h"
#include "ui/render/scene_renderer.h"

using namespace imomushi;
using namespace imomushi::render;

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from) { return std::chrono::duration<double, std::milli>(Clock::now() - from).count(); }

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

// A smooth response instead of a solved one: a frame costs the same.
CharacterInput caterpillarOf(int vertices) {
    caterpillar::Shape shape;
    const int side = std::max(6, static_cast<int>(std::lround(std::sqrt(vertices / 5.0 * 0.8))));
    shape.around = {side};
    shape.along = {side};
    shape.precomputed = false;
    CharacterInput input = caterpillar::make(shape);
    for (auto& element : input.elements) {
        auto response = std::make_shared<ElementResponse>();
        response->firstColumn.push_back(0);
        const auto& rest = element.mesh->body.vertices;
        std::vector<char> held(static_cast<std::size_t>(rest.rows()), 0);
        for (const auto& face : element.faces) {
            response->bases.push_back(FaceBasis::on(element.mesh->body, face, BasisKind::Affine));
            response->firstColumn.push_back(response->firstColumn.back() + response->bases.back().columns());
            for (const auto v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
        }
        for (Eigen::Index v = 0; v < rest.rows(); ++v)
            if (!held[static_cast<std::size_t>(v)]) response->freeVertices.push_back(static_cast<std::int32_t>(v));
        response->response.resize(3 * static_cast<Eigen::Index>(response->freeVertices.size()), response->columns());
        for (Eigen::Index c = 0; c < response->response.cols(); ++c)
            for (std::size_t i = 0; i < response->freeVertices.size(); ++i) {
                const Vec3 p = rest.row(response->freeVertices[i]).transpose();
                for (int axis = 0; axis < 3; ++axis)
                    response->response(3 * static_cast<Eigen::Index>(i) + axis, c) = std::sin(p[(axis + c) % 3] * static_cast<double>(c + 1) + axis);
            }
        response->stiffness = Eigen::MatrixXd::Identity(response->columns(), response->columns());
        element.response = std::move(response);
    }
    return input;
}

struct Shown {
    std::unique_ptr<BodyGeometry> geometry;
    Buffer vertices;
    GpuDeformer::DisplayMap displayMap;
    std::vector<float> staging;
};

// renderMesh: over bodies of 10,000 vertices.
void measure(int wanted, ResponseFormat format, int threads, bool renderMesh) {
    CharacterInput input = caterpillarOf(renderMesh ? 10'000 : wanted);
    ElementMesh seen;
    if (renderMesh) {
        const int side = static_cast<int>(std::lround(std::sqrt(wanted)));
        seen.body = embedded::tube(0.53, 0.02, 4.98, side, side);
        embedded::addRenderMesh(input, seen.body, 1.0);
    }
    input.format = format;
    input.threads = threads;
    auto character = Character::build(std::move(input)).value();
    const auto elements = character.input().elements.size();
    int vertices = 0;
    std::vector<Shown> shown(renderMesh ? 1 : elements);
    for (std::size_t s = 0; s < shown.size(); ++s) {
        const auto& mesh = renderMesh ? seen : *character.input().elements[s].mesh;
        vertices += static_cast<int>(mesh.body.vertices.rows());
        shown[s].geometry = std::make_unique<BodyGeometry>(mesh, nullptr);
        shown[s].vertices = makeBuffer();
        shown[s].staging.resize(static_cast<std::size_t>(shown[s].geometry->vertexCount()) * BodyGeometry::kFloats);
    }
    const int first = renderMesh ? static_cast<int>(elements) : 0;  // of surfaces of the deformer
    const auto bytes = [](const Shown& s) { return static_cast<GLsizeiptr>(s.staging.size() * sizeof(float)); };
    const int frames = std::clamp(2'000'000 / wanted, 7, 200);
    Pose pose = restPose(character.input().skeleton);
    const auto bend = [&](int frame) {
        const double angle = 0.3 * frame;
        for (int i = 0; i < 4; ++i) character.solvePose({{0, Vec3::Zero()}, {5, Vec3(1.2 * std::cos(angle), 1.2 * std::sin(angle), 4.0)}}, pose);
    };

    std::vector<double> here, there, alone;
    for (int frame = 0; frame < frames; ++frame) {
        bend(frame);
        glFinish();
        const auto start = Clock::now();
        character.update(pose);
        for (std::size_t e = 0; e < shown.size(); ++e) {
            const auto s = renderMesh ? character.renderSurface(0) : character.surface(static_cast<int>(e));
            shown[e].geometry->sumNormals(s.positions);
            shown[e].geometry->fill(s.positions, s.normals, shown[e].staging.data());
            glBindBuffer(GL_ARRAY_BUFFER, shown[e].vertices);
            glBufferData(GL_ARRAY_BUFFER, bytes(shown[e]), shown[e].staging.data(), GL_STREAM_DRAW);
        }
        glFinish();
        here.push_back(milliseconds(start));
    }

    GpuDeformer deformer;
    if (!deformer.prepare() || !deformer.upload(character.deformInput())) {
        std::printf("%9d vertices: the driver has no room for them\n", vertices);
        return;
    }
    for (int e = 0; e < static_cast<int>(elements); ++e) character.deformExternally(e, deformer.supports(e));
    for (std::size_t e = 0; e < shown.size(); ++e) {
        shown[e].displayMap = deformer.makeDisplayMap({first + static_cast<int>(e), nullptr}, *shown[e].geometry, {});
        glBindBuffer(GL_ARRAY_BUFFER, shown[e].vertices);
        glBufferData(GL_ARRAY_BUFFER, bytes(shown[e]), nullptr, GL_DYNAMIC_COPY);
    }
    std::size_t uploaded = 0;
    for (int frame = -2; frame < frames; ++frame) {
        bend(frame);
        glFinish();
        const auto start = Clock::now();
        character.update(pose);
        deformer.deform(character.deformInput());
        for (std::size_t e = 0; e < shown.size(); ++e) deformer.writeDisplayVertices(first + static_cast<int>(e), shown[e].displayMap, shown[e].vertices);
        const double own = milliseconds(start);
        glFinish();
        if (frame < 0) continue;  // shaders are compiled for good at their first use
        there.push_back(milliseconds(start));
        alone.push_back(own);
        uploaded = deformer.stats().uploaded;
    }
    const double a = median(here), b = median(there);
    std::printf("%9d vertices%s, %-5s: processor %8.3f ms, OpenGL %8.3f ms (until it is told all %8.3f, %6.1f kB uploaded), ratio %.2f\n", vertices, renderMesh ? " of a render mesh" : "",
                formatName(format).c_str(), a, b, median(alone), static_cast<double>(uploaded) * 1e-3, a / b);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const auto context = OffscreenContext::create();
    const auto renderer = context ? SceneRenderer::create() : Result<std::unique_ptr<SceneRenderer>>(fail("no-opengl", ""));
    if (!context || !renderer) {
        std::printf("%s\n", (context ? renderer.error() : context.error()).message.c_str());
        return 1;
    }
    std::printf("OpenGL: %s%s\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                (*renderer)->software() ? " - software on the processor, not a graphics card: this says what OpenGL costs without one" : "");
    std::vector<int> sizes = {2'000, 28'000, 250'000, 1'000'000};
    if (argc > 1) sizes.clear();
    for (int i = 1; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
    for (const bool renderMesh : {false, true})
        for (const int n : sizes)
            for (const auto format : {ResponseFormat::Float, ResponseFormat::Half, ResponseFormat::Int16}) measure(n, format, 1, renderMesh);
    return 0;
}
