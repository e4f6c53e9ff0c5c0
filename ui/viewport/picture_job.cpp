// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/picture_job.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "ui/render/image.h"
#include "ui/render/offscreen.h"

namespace imomushi {
namespace {

/// A scene that has what it points to.
struct OwnScene {
    explicit OwnScene(const render::Scene& of) : scene(of) {
        numbers.reserve(2 * scene.bodies.size());
        for (render::Body& body : scene.bodies) {
            const auto keep = [&](const float* given) -> const float* {
                if (!given) return nullptr;
                const std::span all(given, std::size_t(body.mesh->body.vertices.size()));
                return numbers.emplace_back(all.begin(), all.end()).data();
            };
            body.positions = keep(body.positions);
            body.normals = keep(body.normals);
            body.highlightedTriangles = body.modelVertices = nullptr;
        }
    }
    OwnScene(const OwnScene&) = delete;
    OwnScene& operator=(const OwnScene&) = delete;

    render::Scene scene;
    std::vector<std::vector<float>> numbers;
};

Result<void> draw(const render::Scene& scene, QSize size, QSize crop, const std::string& path, const Progress& progress) {
    auto rows = render::drawOffscreen(scene, size.width(), size.height());
    if (!rows) return tl::unexpected(rows.error());
    if (progress.cancelled()) return {};
    if (!crop.isValid()) return render::writePng(path, *rows, size.width(), size.height());
    std::vector<std::uint8_t> middle;
    const QSize kept = crop.boundedTo(size), edge = (size - kept) / 2;
    for (int y = 0; y < kept.height(); ++y) {
        const auto row = rows->begin() + 4 * (std::ptrdiff_t(edge.height() + y) * size.width() + edge.width());
        middle.insert(middle.end(), row, row + 4 * std::ptrdiff_t(kept.width()));
    }
    return render::writePng(path, middle, kept.width(), kept.height());
}

}  // namespace

void PictureJob::start(const render::Scene& scene, QSize size, const QString& path, Done done, QSize crop) {
    cancel();
    auto result = std::make_shared<Result<void>>();
    launch([result, own = std::make_shared<const OwnScene>(scene), size, crop, file = path.toStdString()](const Progress& progress) { *result = draw(own->scene, size, crop, file, progress); },
           [result, done = std::move(done)] { done(*result); });
}

}  // namespace imomushi
