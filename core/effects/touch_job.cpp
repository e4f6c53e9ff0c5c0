// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/touch_job.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/finite.h"
#include "core/character/frame.h"

namespace imomushi {

void TouchEffect::ask(ElementTables& tables) const {
    tables.touch = true;
    tables.patches = std::max(tables.patches, static_cast<int>(std::lround(patches)));
    tables.dents = tip > 0.0;
}

Result<void> TouchEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    auto made = TouchJob::build(frame, *this);
    if (!made) return tl::unexpected(made.error());
    jobs.add<TouchJob>(std::move(*made));
    return {};
}

Result<TouchJob> TouchJob::build(Frame& frame, const TouchEffect& settings) {
    TouchJob made(settings);
    for (std::size_t e = 0; e < frame.elements.size(); ++e) {
        auto& of = frame.elements[e];
        if (!of.runtime->touch || !settings.on(e)) continue;
        auto contact = TouchContact::build(of.runtime->touch, settings, of.runtime->dents);
        if (!contact) return tl::unexpected(contact.error());
        made.elements_.push_back({static_cast<int>(e), std::move(*contact), {}, false});
    }
    return made;
}

void TouchJob::run(Stage stage, Frame& frame) {
    if (frame.replaying) return;
    for (auto& touched : elements_) {
        auto& out = frame.elements[static_cast<std::size_t>(touched.index)];
        touched.pressed = active(touched);
        if (!touched.pressed) continue;
        if (stage == Stage::Weights) {
            out.wantsLocal = true;
        } else {
            if (!frame.shifted) aimFingers(touched, frame);  // else the dents are those that are shifted
            out.patchForces += touched.contact.patchForces();
            if (!out.fingerDents.empty()) std::copy_n(touched.contact.dents().begin(), out.fingerDents.size(), out.fingerDents.begin());
        }
    }
}

bool TouchJob::active(const Element& touched) {
    bool down = !touched.contact.idle();
    for (int i = 0; i < TouchContact::kFingers; ++i) down = down || touched.contact.down(i);
    return down;
}

void TouchJob::aimFingers(Element& touched, const Frame& frame) {
    const auto& of = frame.elements[static_cast<std::size_t>(touched.index)];
    const Eigen::Matrix3d toElement = of.frame.linear.transpose();
    const auto& triangles = of.runtime->input.mesh->body.triangles;
    // Where the pose alone has a body vertex in the frame of its element.
    const auto poseAt = [&](std::int32_t vertex) -> Vec3 {
        const auto held = std::find_if(of.held.begin(), of.held.end(), [vertex](const HeldVertex& h) { return h.vertex == vertex; });
        if (held == of.held.end()) return of.localAt(vertex, of.local.data());
        return of.frame.linear.transpose() * (frame.heldAt(of, static_cast<std::size_t>(held - of.held.begin())) - of.frame.shift);
    };
    for (int i = 0; i < TouchContact::kFingers; ++i) {
        if (!touched.contact.down(i)) continue;
        std::array<Vec3, 3> corners;
        for (int c = 0; c < 3; ++c) corners[static_cast<std::size_t>(c)] = poseAt(triangles(touched.contact.triangle(i), c));
        touched.contact.aim(i, corners, toElement * (touched.fingers[static_cast<std::size_t>(i)].target - of.frame.shift));
    }
    if (frame.seconds > 0.0 || frame.again)
        touched.contact.step(frame.seconds);
    else
        touched.contact.converge();
}

bool TouchJob::setFinger(int element, int finger, const Vec3& rest, const Vec3& target, double radius) {
    const auto found = std::find_if(elements_.begin(), elements_.end(), [element](const Element& e) { return e.index == element; });
    if (found == elements_.end() || !allFinite(target)) return false;
    auto& known = found->fingers[static_cast<std::size_t>(finger)];
    // A finger that only moves keeps its place: finding it again costs more than a frame.
    if (!found->contact.down(finger) || rest != known.rest || radius != known.radius)
        if (!found->contact.place(finger, found->contact.surface().nearest(rest), radius)) return false;
    known = {rest, target, radius};
    return true;
}

void TouchJob::liftFinger(int element, int finger) {
    for (auto& e : elements_)
        if (e.index == element) e.contact.lift(finger);
}

bool TouchJob::take(const TouchEffect& settings) {
    bool taken = true;  // refused numbers leave it as it is
    for (auto& e : elements_) taken = e.contact.set(settings).has_value() && taken;
    return taken;
}

bool TouchJob::resting(const Frame&) const {
    return std::none_of(elements_.begin(), elements_.end(), [](const Element& e) { return active(e) || e.pressed; });
}

std::size_t TouchJob::bytes() const {
    std::size_t sum = 0;
    for (const auto& e : elements_) sum += e.contact.bytes();
    return sum;
}

void TouchJob::report(Frame& frame, double ms) const {
    const bool presses = std::any_of(elements_.begin(), elements_.end(), active);
    frame.setTime(TouchEffect::kName, ms + (presses ? std::exchange(frame.dentMs, 0.0) : 0.0));
}

}  // namespace imomushi
