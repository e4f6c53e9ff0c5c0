// SPDX-License-Identifier: GPL-3.0-or-later
// Every sample, deformed by the processor and by OpenGL, vertex by vertex and pixel by pixel.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "tests/document/workbench.h"
#include "tests/render/picture.h"
#include "tests/support/plain_sample.h"
#include "ui/render/gpu_deformer.h"
#include "ui/render/image.h"
#include "ui/render/offscreen.h"
#include "ui/render/scene_renderer.h"
#include "ui/scene/document_scene.h"
#include "ui/scene/framing.h"

using namespace imomushi;
using Eigen::Vector3f;
namespace fs = std::filesystem;

namespace {

constexpr int kWidth = 480, kHeight = 360;

/// A renderer on a context that is current here.
struct Live {
    Result<std::unique_ptr<render::OffscreenContext>> context = render::OffscreenContext::create();
    std::unique_ptr<render::SceneRenderer> renderer;
    render::GpuDeformer deformer;
    Live() {
        REQUIRE(context.has_value());
        auto made = render::SceneRenderer::create();
        REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
        renderer = std::move(*made);
        REQUIRE(deformer.prepare().has_value());
    }
    Picture draw(const render::Scene& scene) const {
        render::Target target;
        REQUIRE(target.resize(kWidth, kHeight, GL_RGBA8, 0));
        renderer->draw(scene, target.framebuffer(), kWidth, kHeight);
        Picture out{kWidth, kHeight, std::vector<std::uint8_t>(std::size_t(4) * kWidth * kHeight)};
        glBindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer());
        glReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_UNSIGNED_BYTE, out.rgba.data());
        CHECK(glGetError() == GL_NO_ERROR);
        // From the top.
        for (int y = 0; y < kHeight / 2; ++y)
            std::swap_ranges(&out.rgba[4 * std::size_t(y) * kWidth], &out.rgba[4 * std::size_t(y) * kWidth] + 4 * kWidth, &out.rgba[4 * std::size_t(kHeight - 1 - y) * kWidth]);
        return out;
    }
};

// To be looked at.
void keep(const Picture& picture, const std::string& name) {
    const char* folder = std::getenv("IMOMUSHI_SCREENSHOTS");
    if (folder) CHECK(render::writePng((fs::path(folder) / (name + ".png")).string(), picture.rgba, picture.width, picture.height).has_value());
}

}  // namespace

TEST_CASE("gpu: samples have the same vertices and pictures, whoever deforms them") {
    Live live;
    for (const std::string name : {"caterpillar", "octopus", "figure", "dragon"}) {
        CAPTURE(name);
        Session session(coreRegistry());
        const fs::path file = fs::path(IMOMUSHI_SAMPLES) / (name + ".imomushi");
        const auto opened = session.execute({{"do", "open"}, {"path", file.string()}});
        REQUIRE_MESSAGE(opened.has_value(), (opened ? "" : opened.error().message));
        for (const auto& line : plainLines(name)) REQUIRE(session.execute(line));
        // Something bent: the end of the first bone that has nothing after it is drawn aside.
        const Document& document = session.document();
        REQUIRE(session.character());
        const auto& points = session.character()->input().skeleton.points;
        Vec3 low = points.front(), high = low;
        for (const auto& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
        const auto& bone = *document.bones.rbegin()->second;
        const int end = session.pointIndex({bone.id, true});
        const Vec3 target = points[static_cast<std::size_t>(end)] + 0.2 * (high - low).norm() * Vec3(0.3, 0.8, 0.3);
        for (int i = 0; i < 30; ++i)
            (void)session.execute({{"do", "drag"}, {"endpoint", bone.name + "/end"}, {"to", {target.x(), target.y(), target.z()}}});

        DocumentScene here, there;
        render::Scene byProcessor, byGpu;
        here.update(session, {}, byProcessor);
        byProcessor.camera = byGpu.camera = framed(byProcessor, threeQuarterDirection(), double(kWidth) / kHeight);
        const Picture expected = live.draw(byProcessor);

        SceneOptions options;
        options.gpu = live.renderer.get();
        there.update(session, options, byGpu);
        // From the next frame on.
        Character& character = *session.character();
        character.update(session.shownPose());
        int external = 0;
        for (const auto& e : character.deformInput().elements) external += e.external;
        CHECK(external > 0);
        there.update(session, options, byGpu);
        const Picture made = live.draw(byGpu);
        keep(expected, name + "-processor");
        keep(made, name + "-gpu");
        const int pixels = differing(expected, made);
        MESSAGE(name << ": " << external << " of " << character.deformInput().elements.size() << " elements on the GPU; " << pixels << " pixels differ visibly");
        // Vertices are the same; what is left is light that follows the extent of the character, which is known less exactly (BoundingBoxes).
        CHECK(pixels <= kWidth * kHeight / 500);

        auto& deformer = live.deformer;
        REQUIRE(deformer.upload(character.deformInput()));
        deformer.deform(character.deformInput());
        double worst = 0.0;
        for (int e = 0; e < static_cast<int>(character.deformInput().elements.size()); ++e) {
            const auto& rest = character.input().elements[static_cast<std::size_t>(e)].mesh->body.vertices;
            const double size = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
            const auto s = character.surface(e);
            std::vector<float> positions(3 * static_cast<std::size_t>(s.vertices));
            deformer.readBack(e, 0, s.vertices, positions.data());
            for (std::size_t i = 0; i < positions.size(); i += 3)
                worst = std::max(worst, (Eigen::Map<const Vector3f>(&positions[i]) - Eigen::Map<const Vector3f>(s.positions + i)).cast<double>().norm() / size);
        }
        MESSAGE(name << ": positions within " << worst << " of the size of their element");
        CHECK(worst <= 1e-5);
    }
}
