// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/shape_fade.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace imomushi {

namespace {

constexpr float kHidden = std::numeric_limits<float>::quiet_NaN();

std::vector<float> copied(const float* values, std::size_t count) { return values ? std::vector<float>(values, values + count) : std::vector<float>(); }

std::size_t numbersOf(const render::Body& body) { return static_cast<std::size_t>(body.mesh->body.vertices.size()); }

void scatter(const float* values, const std::vector<std::int32_t>& to, std::vector<float>& all) {
    for (std::size_t i = 0; i < to.size(); ++i) std::copy_n(values + 3 * i, 3, &all[3 * static_cast<std::size_t>(to[i])]);
}

/// Values of a whole model at some of its vertices; `otherwise` where they are not known.
std::vector<float> gathered(const std::vector<float>& all, const std::vector<std::int32_t>& from, const float* otherwise) {
    std::vector<float> out(3 * from.size());
    for (std::size_t i = 0; i < from.size(); ++i) {
        const float* known = &all[3 * static_cast<std::size_t>(from[i])];
        std::copy_n(std::isnan(*known) ? otherwise + 3 * i : known, 3, &out[3 * i]);
    }
    return out;
}

}  // namespace

void ShapeFade::keep(const render::Scene& scene) {
    std::map<std::uint64_t, Kept> kept;  // beside those before, which a fading scene points to
    std::map<const ElementMesh*, Model> models;
    for (const render::Body& body : scene.bodies) {
        if (!body.mesh || !body.positions) continue;
        Kept& now = kept[body.id];
        now.mesh = body.mesh;
        now.outdated = body.outdated;
        now.away = copied(body.positions, numbersOf(body));
        now.normals = copied(body.normals, numbersOf(body));
        if (!body.modelVertices || !body.textures) continue;
        Model& model = models[body.textures.get()];
        model.mesh = body.textures;
        model.positions.resize(static_cast<std::size_t>(model.mesh->body.vertices.size()), kHidden);
        scatter(body.positions, *body.modelVertices, model.positions);
        if (!body.normals) continue;
        model.normals.resize(model.positions.size(), kHidden);
        scatter(body.normals, *body.modelVertices, model.normals);
    }
    kept_ = std::move(kept);
    models_ = std::move(models);
    dropped_.clear();
    first_ = true;
}

void ShapeFade::retain(const Asks& wanted) {
    for (auto entry = kept_.begin(); entry != kept_.end();)
        if (wanted(entry->first)) {
            ++entry;
        } else {
            dropped_.insert(entry->first);
            entry = kept_.erase(entry);
        }
}

ShapeFade::Kept* ShapeFade::keptOf(const render::Body& body) {
    const auto found = kept_.find(body.id);
    if (found != kept_.end() && found->second.mesh == body.mesh) return &found->second;
    // A part of a model that is divided in another way now.
    const auto model = body.modelVertices && body.textures && !dropped_.contains(body.id) ? models_.find(body.textures.get()) : models_.end();
    if (model == models_.end() || (!first_ && found == kept_.end())) return nullptr;
    Kept& kept = kept_[body.id];
    kept = {};
    kept.mesh = body.mesh;
    kept.away = gathered(model->second.positions, *body.modelVertices, body.positions);
    if (!model->second.normals.empty() && body.normals) kept.normals = gathered(model->second.normals, *body.modelVertices, body.normals);
    return &kept;
}

void ShapeFade::show(render::Body& body, Kept& kept, double seconds, bool waits) {
    const std::size_t count = numbersOf(body);
    const bool begins = kept.passed < 0.0;
    if (begins && waits && kept.waited < kLongestWait) {
        kept.waited += seconds;
        body.outdated = kept.outdated;
        kept.shown = kept.away;
        kept.shownNormals = kept.normals;
    } else {
        kept.passed = begins ? 0.0 : kept.passed + seconds;
        const double left = std::max(0.0, 1.0 - kept.passed / kSeconds);
        const auto part = static_cast<float>(left * left * (3.0 - 2.0 * left));  // begins and ends slowly
        if (begins)
            for (std::size_t i = 0; i < count; ++i) kept.away[i] -= body.positions[i];
        kept.shown.resize(count);
        for (std::size_t i = 0; i < count; ++i) kept.shown[i] = body.positions[i] + part * kept.away[i];
        kept.shownNormals.resize(kept.normals.empty() || !body.normals ? 0 : count);
        for (std::size_t i = 0; i < kept.shownNormals.size(); ++i) kept.shownNormals[i] = body.normals[i] + part * (kept.normals[i] - body.normals[i]);
    }
    kept.seen = true;
    body.positions = kept.shown.data();
    body.normals = kept.shownNormals.empty() ? nullptr : kept.shownNormals.data();
    body.revision += ++revision_;
}

void ShapeFade::apply(render::Scene& scene, double seconds, const Asks& waits) {
    if (!active()) return;
    for (render::Body& body : scene.bodies) {
        if (!body.mesh || !body.positions) continue;
        Kept* kept = keptOf(body);
        if (!kept) continue;
        if (kept->passed >= 0.0 && kept->passed + seconds >= kSeconds)
            kept_.erase(body.id);
        else
            show(body, *kept, seconds, waits && waits(body.id));
    }
    // One that was not there in the first frame would jump to where it never was.
    if (first_) std::erase_if(kept_, [](const auto& entry) { return !entry.second.seen; });
    first_ = false;
    if (kept_.empty()) models_.clear();
}

}  // namespace imomushi
