// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/pose_pictures.h"

#include <cstring>
#include <utility>
#include <vector>

#include "core/document/kept_pose.h"
#include "core/session/session_access.h"
#include "ui/models/commands.h"
#include "ui/picking/picking.h"
#include "ui/render/offscreen.h"
#include "ui/scene/document_scene.h"
#include "ui/viewport/camera_controller.h"

namespace imomushi {
namespace {

constexpr int kAfterMs = 400;  // after the last change: what changes again and again is drawn once

std::string contentOf(KeptPose pose) {
    pose.name.clear();
    return keptPosesJson({std::move(pose)}).dump();
}

/// Null: it cannot be drawn.
QImage pictureOf(const Session& session) {
    std::vector<SelectionItem> all;
    for (const auto& [id, element] : session.document().elements)
        if (element->visible) all.push_back({SelectionItem::Kind::Element, id, {}, false});
    for (const auto& [id, bone] : session.document().bones) all.push_back({SelectionItem::Kind::Bone, id, {}, false});
    CameraController camera;
    camera.setViewport(PosePictures::kWidth, PosePictures::kHeight);
    camera.frame(pointsOf(session, all), false);
    render::Scene scene;
    SceneOptions options;
    options.bones = session.document().elements.empty();
    DocumentScene().update(session, options, scene);
    scene.camera = camera.camera();
    scene.grid = scene.groundShadow = false;
    scene.transparentBackground = true;
    const auto rows = render::drawOffscreen(scene, PosePictures::kWidth, PosePictures::kHeight);
    if (!rows) return {};
    QImage picture(PosePictures::kWidth, PosePictures::kHeight, QImage::Format_RGBA8888);
    for (int y = 0; y < picture.height(); ++y) std::memcpy(picture.scanLine(y), rows->data() + std::size_t(y) * PosePictures::kWidth * 4, std::size_t(PosePictures::kWidth) * 4);
    return picture;
}

}  // namespace

PosePictures::PosePictures(StudioDocument& document, QObject* parent) : BackgroundJob(parent), document_(document) {
    later_.setSingleShot(true);
    later_.setInterval(kAfterMs);
    connect(&later_, &QTimer::timeout, this, &PosePictures::follow);
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (change.has(&DocumentChange::poses) || change.has(&DocumentChange::elements) || change.has(&DocumentChange::bones) || change.has(&DocumentChange::characters)) later_.start();
    });
    connect(&document, &StudioDocument::responsesChanged, this, [this] {
        pictures_.clear();
        later_.start();
    });
    connect(this, &BackgroundJob::finished, this, [this](bool completed) {
        if (completed) later_.start();
    });
}

void PosePictures::setWanted(bool wanted) {
    wanted_ = wanted;
    if (wanted_) later_.start();
}

void PosePictures::tell() {
    for (const KeptPose& pose : keptPoses(document_.document()))
        if (const auto known = pictures_.find(contentOf(pose)); known != pictures_.end() && !known->second.isNull()) Q_EMIT drawn(QString::fromStdString(pose.name), known->second);
}

void PosePictures::follow() {
    if (!wanted_ || running()) return;
    if (document_.inGesture()) return later_.start();
    const Document& d = document_.document();
    Posed posed{d.elements, d.bones, d.characters};
    if (!(posed == posed_)) pictures_.clear();
    posed_ = std::move(posed);
    std::map<std::string, QImage> kept;
    std::vector<std::pair<std::string, std::string>> missing;  // name, content
    for (const KeptPose& pose : keptPoses(d)) {
        std::string content = contentOf(pose);
        if (const auto known = pictures_.find(content); known != pictures_.end()) kept.insert(*known);
        else missing.emplace_back(pose.name, std::move(content));
    }
    pictures_ = std::move(kept);
    tell();
    if (missing.empty()) return;
    auto made = std::make_shared<std::map<std::string, QImage>>();
    launch(
        [made, missing, &registry = document_.session().registry(), project = document_.project()](const Progress& progress) {
            Session session(registry);
            SessionAccess(session).replace(project, {}, true, Json{{"do", "open"}});
            for (const auto& [name, content] : missing) {
                if (progress.cancelled()) return;
                const bool applied = session.execute(commands::applyPose(name)).has_value();
                made->emplace(content, applied ? pictureOf(session) : QImage());
            }
        },
        [this, made, of = posed_] {
            if (!(of == posed_)) return;
            pictures_.merge(*made);
            tell();
        });
}

}  // namespace imomushi
