// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/axial_squash.h"

#include <algorithm>

namespace imomushi {

namespace {

// A pose counts as straight where the distance of its ends, over the length along the bones, is less than that of rest by no more than this: an arc of 6 degrees
// before it squashes, ...
constexpr double kBow = 5e-4;
// ... and of 90 while it does: bones lag behind an end that moves fast.
constexpr double kBowSquashed = 0.1;
// Natural lengths are shorter than the distance of the targets asks for by this part of the squash: a little tension, which straightens what lags.
constexpr double kTension = 0.05;

}  // namespace

AxialSquash::AxialSquash(const Skeleton& skeleton) : skeleton_(skeleton), bonesAt_(skeleton.points.size()), held_(skeleton.points.size(), 0),
                                                     via_(skeleton.points.size(), -1), natural_(skeleton.bones.size(), 1.0) {
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b)
        for (const int point : {skeleton.bones[b].start, skeleton.bones[b].end}) bonesAt_[point].push_back(static_cast<int>(b));
    chains_.reserve(skeleton.bones.size());
    bones_.reserve(skeleton.bones.size());
    stack_.reserve(skeleton.points.size());
}

bool AxialSquash::isHinge(int a, int b) const {
    const auto hinged = [&](int child, int parent) { return skeleton_.bones[child].parent == parent && skeleton_.bones[child].hinge.squaredNorm() > 0.0; };
    return hinged(a, b) || hinged(b, a);
}

void AxialSquash::addChain(int start, int end) {
    Chain chain;
    chain.start = start;
    chain.end = end;
    chain.first = static_cast<int>(bones_.size());
    double along = 0.0;
    bool folds = false;  // at a knee or an elbow
    for (int at = end; at != start;) {
        const auto& bone = skeleton_.bones[via_[at]];
        bones_.push_back(via_[at]);
        along += bone.length;
        folds = folds || (at != end && isHinge(via_[at], bones_[bones_.size() - 2]));
        chain.least = std::max(chain.least, bone.minStretch + kReserve);
        at = bone.start + bone.end - at;
    }
    chain.last = static_cast<int>(bones_.size());
    chain.length = (skeleton_.points[end] - skeleton_.points[start]).norm();
    chain.straightness = chain.length / along;
    if (!folds && chain.straightness >= kRestStraight && chain.least < 1.0)
        chains_.push_back(chain);
    else
        bones_.resize(static_cast<std::size_t>(chain.first));
}

void AxialSquash::findChains(const std::vector<char>& held) {
    held_ = held;
    chains_.clear();
    bones_.clear();
    for (int start = 0; start < static_cast<int>(held.size()); ++start) {
        if (!held[start]) continue;
        for (const int first : bonesAt_[start]) {
            // What is between this held point and others, by its first bone.
            int found = 0, end = -1;
            const int next = skeleton_.bones[first].start + skeleton_.bones[first].end - start;
            via_[next] = first;
            stack_.assign(1, next);
            while (!stack_.empty()) {
                const int at = stack_.back();
                stack_.pop_back();
                if (held[at]) {
                    ++found;
                    end = at;
                    continue;
                }
                for (const int b : bonesAt_[at]) {
                    if (b == via_[at]) continue;
                    const int far = skeleton_.bones[b].start + skeleton_.bones[b].end - at;
                    via_[far] = b;
                    stack_.push_back(far);
                }
            }
            if (found == 1 && end > start) addChain(start, end);
        }
    }
}

double AxialSquash::partOf(Chain& chain, const Vec3& apart, const Vec3& along, const std::vector<Vec3>& points) const {
    const double chord = along.norm();
    if (!(chord > 1e-6 * chain.length) || !(apart.dot(along) > 0.0)) return 0.0;
    double length = 0.0;
    for (int i = chain.first; i < chain.last; ++i) {
        const auto& bone = skeleton_.bones[bones_[i]];
        length += (points[bone.end] - points[bone.start]).norm();
    }
    if (chord < (chain.straightness - (chain.squashes ? kBowSquashed : kBow)) * length) return 0.0;
    if (chord < (1.0 - kReserve) * chain.length) chain.axis = along / chord;
    const double ahead = apart.dot(chain.axis);
    const double aside = (apart - ahead * chain.axis).norm() / (kAside * chain.length + kAsidePerSquash * (chain.length - ahead));
    const double off = std::clamp(aside - 1.0, 0.0, 1.0);
    return 1.0 - off * off * (3.0 - 2.0 * off);
}

const std::vector<double>& AxialSquash::update(const IkTargets& targets, const std::vector<Vec3>& points, bool continued) {
    const bool other = targets.held != held_;
    if (other) findChains(targets.held);
    std::fill(natural_.begin(), natural_.end(), 1.0);
    for (auto& chain : chains_) {
        const Vec3 apart = targets.place[chain.end] - targets.place[chain.start], along = points[chain.end] - points[chain.start];
        const double ratio = apart.norm() / chain.length;
        if (other || !continued || ratio >= 1.0) chain.axis = along.norm() > 0.0 ? Vec3(along.normalized()) : Vec3(Vec3::UnitX());
        chain.squashes = chain.squashes && continued && ratio < 1.0;
        if (ratio >= 1.0) continue;
        const double part = partOf(chain, apart, along, points);
        chain.squashes = part > 0.0;
        const double natural = 1.0 - part * std::min((1.0 + kTension) * (1.0 - ratio), 1.0 - chain.least);
        for (int i = chain.first; i < chain.last; ++i) natural_[bones_[i]] = natural;
    }
    return natural_;
}

}  // namespace imomushi
