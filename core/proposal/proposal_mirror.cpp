// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/proposal_mirror.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/mesh/bounds.h"
#include "core/proposal/mirror_plane.h"

namespace imomushi {
namespace {

/// A section whose middle is at most this part of its radius off the plane of symmetry is one across it; a bone at most this part of its length off runs along it.
constexpr double kAcross = 0.5, kAlongPlane = 0.1;
/// A cut across the plane of symmetry is turned to a right angle by at most 73 degrees.
constexpr double kLeastTurned = 0.3;

std::size_t nth(int i) { return static_cast<std::size_t>(i); }

tl::unexpected<Error> notMirrored() { return fail("not-mirrored", "That cannot be done on both sides of the shape at once: switch the mirror off."); }

CutPlane image(const CutPlane& mirror, const CutPlane& plane) { return {mirroredPoint(mirror, plane.origin), mirroredDirection(mirror, plane.normal)}; }
std::optional<Vec3> image(const CutPlane& mirror, const std::optional<Vec3>& p) { return p ? std::optional(mirroredPoint(mirror, *p)) : std::nullopt; }
double offPlane(const CutPlane& mirror, const Vec3& p) { return std::abs(mirror.normal.dot(p - mirror.origin)); }

/// m
double sizeOf(const Proposal& p) {
    Points places(static_cast<Eigen::Index>(2 * p.bones.size() + p.cuts.size() + p.handles.size()), 3);
    if (places.rows() == 0) return 0.0;
    Eigen::Index row = 0;
    for (const ProposedBone& bone : p.bones) places.row(row++) = bone.start, places.row(row++) = bone.end;
    for (const ProposedCut& cut : p.cuts) places.row(row++) = cut.plane.origin;
    for (const ProposedHandle& handle : p.handles) places.row(row++) = handle.point;
    return diagonalOf(places);
}

/// Pairs things with their images, each with one, in their order. `error(a, b)`: how far b is from the image of a, in parts of the size; equal both ways round.
template <class F>
std::vector<int> paired(std::size_t count, F error) {
    std::vector<int> images(count, -1);
    for (int a = 0; a < static_cast<int>(count); ++a)
        for (int b = a; b < static_cast<int>(count) && images[nth(a)] < 0; ++b)
            if (images[nth(b)] < 0 && error(a, b) <= kMirrored) images[nth(a)] = b, images[nth(b)] = a;
    return images;
}

/// Errors in parts of the size.
class Measure {
public:
    explicit Measure(const Proposal& p) : p_(p), mirror_(*p.symmetry), size_(std::max(sizeOf(p), std::numeric_limits<double>::min())) {}
    [[nodiscard]] double places(const Vec3& a, const Vec3& b) const { return (mirroredPoint(mirror_, a) - b).norm() / size_; }
    [[nodiscard]] double cuts(int a, int b) const {
        const CutPlane &from = p_.cuts[nth(a)].plane, &to = p_.cuts[nth(b)].plane;
        return std::max(places(from.origin, to.origin), (mirroredDirection(mirror_, from.normal.stableNormalized()) - to.normal.stableNormalized()).norm());
    }
    [[nodiscard]] double straight(int a, int b) const {
        const ProposedBone &from = p_.bones[nth(a)], &to = p_.bones[nth(b)];
        return std::max(places(from.start, to.start), places(from.end, to.end));
    }
    [[nodiscard]] double across(int bone) const { return places(p_.bones[nth(bone)].start, p_.bones[nth(bone)].end); }
    [[nodiscard]] double bones(int a, int b) const { return a == b ? std::min(straight(a, b), across(a)) : straight(a, b); }
    [[nodiscard]] double handles(int a, int b) const { return places(p_.handles[nth(a)].point, p_.handles[nth(b)].point); }

private:
    const Proposal& p_;
    const CutPlane& mirror_;
    double size_;
};

ProposedEnd imageOf(const ProposalImages& images, const ProposedEnd& end) { return {images.bones[nth(end.bone)], images.reversed[nth(end.bone)] ? !end.atEnd : end.atEnd}; }

/// The image of a joint: of the first of its ends that has one; bone -1: none has.
ProposedEnd jointImage(const Proposal& p, const ProposalImages& images, const ProposedEnd& end) {
    if (images.bones[nth(end.bone)] >= 0) return imageOf(images, end);
    for (const ProposedEnd& other : jointOf(p, end))
        if (images.bones[nth(other.bone)] >= 0) return imageOf(images, other);
    return {-1, true};
}

bool sameJoint(const Proposal& p, const ProposedEnd& a, const ProposedEnd& b) { return jointOf(p, a).front() == jointOf(p, b).front(); }

int pieceImage(const ProposalImages& images, int piece) { return piece < 0 ? piece : images.cuts[nth(piece)]; }

/// At a right angle to the plane of symmetry.
std::optional<CutPlane> laidAcross(const CutPlane& mirror, const CutPlane& plane) {
    const Vec3 unit = plane.normal.stableNormalized(), normal = unit - mirror.normal.dot(unit) * mirror.normal;
    if (!(normal.norm() > kLeastTurned)) return std::nullopt;
    return CutPlane{ontoPlane(mirror, plane.origin), normal.normalized()};
}

bool oneSided(const Proposal& p, Sides sides) { return sides == Sides::One || !p.symmetry; }

Result<Proposal> stillMirrored(const Proposal& before, Result<Proposal> after) {
    if (after && mirrorError(before) <= kMirrored && !(mirrorError(*after) <= kMirrored)) return notMirrored();
    return after;
}

/// Two cuts that were added last, one for each side of the trunk, get names of sides: "trunk 2.L" and "trunk 2.R", with their bones.
void nameSides(Proposal& p) {
    const int first = static_cast<int>(p.cuts.size()) - 2;
    const std::string common = p.cuts[nth(first)].piece;
    const auto withoutNumber = [&](int cut) { return p.cuts[nth(cut)].piece.substr(0, p.cuts[nth(cut)].piece.find_last_not_of("0123456789") + 1); };
    if (withoutNumber(first) != withoutNumber(first + 1)) return;  // of limbs that have sides in their names
    for (const int c : {first, first + 1}) {
        ProposedCut& cut = p.cuts[nth(c)];
        const std::string old = cut.piece + ' ', side = p.symmetry->normal.dot(cut.plane.origin - p.symmetry->origin) > 0.0 ? ".L" : ".R";
        const auto rename = [&](std::string& name) {
            if (name.starts_with(old)) name = common + name.substr(old.size() - 1) + side;
        };
        rename(cut.name);
        for (ProposedBone& bone : p.bones) rename(bone.name);
        cut.piece = common + side;
    }
}

/// The joint nearest to a place: of all, or of those in the plane of symmetry.
ProposedEnd nearestJoint(const Proposal& p, const ProposalImages& images, const Vec3& place, bool inPlane) {
    ProposedEnd best{-1, true};
    double nearest = std::numeric_limits<double>::infinity();
    for (int b = 0; b < static_cast<int>(p.bones.size()); ++b)
        for (const bool atEnd : {true, false}) {
            const ProposedEnd end{b, atEnd};
            const double d = (placeOf(p, end) - place).norm();
            if (d >= nearest || (inPlane && (images.bones[nth(b)] < 0 || !sameJoint(p, end, imageOf(images, end))))) continue;
            nearest = d;
            best = end;
        }
    return best;
}

}  // namespace

ProposalImages imagesOf(const Proposal& p) {
    ProposalImages images;
    if (!p.symmetry) return {std::vector<int>(p.cuts.size(), -1), std::vector<int>(p.bones.size(), -1), std::vector<int>(p.handles.size(), -1), std::vector<char>(p.bones.size(), 0)};
    const Measure measure(p);
    images.cuts = paired(p.cuts.size(), [&](int a, int b) { return measure.cuts(a, b); });
    images.bones = paired(p.bones.size(), [&](int a, int b) { return measure.bones(a, b); });
    images.handles = paired(p.handles.size(), [&](int a, int b) { return measure.handles(a, b); });
    for (int b = 0; b < static_cast<int>(p.bones.size()); ++b) images.reversed.push_back(images.bones[nth(b)] == b && measure.across(b) < measure.straight(b, b));
    return images;
}

double mirrorError(const Proposal& p) {
    if (!p.symmetry) return 0.0;
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const Measure measure(p);
    const ProposalImages images = imagesOf(p);
    double error = 0.0;
    for (int c = 0; c < static_cast<int>(p.cuts.size()); ++c) {
        if (images.cuts[nth(c)] < 0) return kNone;
        error = std::max(error, measure.cuts(c, images.cuts[nth(c)]));
    }
    for (int b = 0; b < static_cast<int>(p.bones.size()); ++b) {
        if (images.bones[nth(b)] < 0) return kNone;
        error = std::max(error, measure.bones(b, images.bones[nth(b)]));
        const ProposedBone &bone = p.bones[nth(b)], &other = p.bones[nth(images.bones[nth(b)])];
        const bool turned = images.reversed[nth(b)];
        if (pieceImage(images, bone.piece) != other.piece || pieceImage(images, bone.startCut) != (turned ? other.endCut : other.startCut) ||
            pieceImage(images, bone.endCut) != (turned ? other.startCut : other.endCut))
            return kNone;
    }
    for (const ProposedPin& pin : p.pins)
        if (!isPinned(p, imageOf(images, {pin.bone, pin.atEnd}))) return kNone;
    for (int h = 0; h < static_cast<int>(p.handles.size()); ++h) {
        if (images.handles[nth(h)] < 0) return kNone;
        const ProposedHandle &handle = p.handles[nth(h)], &other = p.handles[nth(images.handles[nth(h)])];
        if (handle.pinned != other.pinned) return kNone;
        error = std::max({error, measure.handles(h, images.handles[nth(h)]), std::abs(handle.radius - other.radius) / handle.radius});
    }
    return error;
}

// ---- cuts --------------------------------------------------------------------------------------------------------------

Result<Proposal> withCutMoved(const Proposal& p, int cut, const CutPlane& plane, const Vec3& middle, Sides sides) {
    if (oneSided(p, sides)) return withCutMoved(p, cut, plane, middle);
    const CutPlane& mirror = *p.symmetry;
    const int twin = imagesOf(p).cuts[nth(cut)];
    if (twin == cut) {
        const auto laid = laidAcross(mirror, plane);
        if (laid) return stillMirrored(p, withCutMoved(p, cut, *laid, ontoPlane(mirror, middle)));
        const auto alone = withCutMoved(p, cut, plane, middle);
        return alone ? notMirrored() : tl::unexpected(alone.error());
    }
    auto changed = withCutMoved(p, cut, plane, middle);
    if (changed && twin >= 0) changed = withCutMoved(*changed, twin, image(mirror, plane), mirroredPoint(mirror, middle));
    return stillMirrored(p, std::move(changed));
}

Result<Proposal> withoutCut(const Proposal& p, int cut, Sides sides) {
    auto changed = withoutCut(p, cut);
    if (!changed || oneSided(p, sides)) return changed;
    const int twin = imagesOf(p).cuts[nth(cut)];
    if (twin >= 0 && twin != cut) changed = withoutCut(*changed, twin > cut ? twin - 1 : twin);
    return stillMirrored(p, std::move(changed));
}

Result<Proposal> withCutAdded(const Proposal& p, const CutPlane& plane, const Vec3& middle, double radius, const std::optional<Vec3>& tip, Sides sides) {
    // What cannot be added on one side is told as there.
    auto changed = withCutAdded(p, plane, middle, radius, tip);
    if (!changed || oneSided(p, sides)) return changed;
    const CutPlane& mirror = *p.symmetry;
    const ProposalImages images = imagesOf(p);
    const bool one = offPlane(mirror, middle) <= kAcross * radius;
    const auto meant = one ? laidAcross(mirror, plane) : plane;
    if (!meant) return notMirrored();
    const Vec3 centre = one ? ontoPlane(mirror, middle) : middle;
    CutPlace place = placeOfCut(p, *meant, centre, radius);
    // One cut divides a bone that is its own image, two divide two. Of a bone across the plane both would be in front of one cut and behind the other.
    if (place.crossed >= 0 && images.reversed[nth(place.crossed)]) return notMirrored();
    if (place.crossed >= 0 && (images.bones[nth(place.crossed)] == place.crossed) != one) place.crossed = -1;
    if (place.crossed < 0) place.from = nearestJoint(p, images, centre, one);
    if (one) return stillMirrored(p, withCutAdded(p, *meant, centre, place, tip ? std::optional(ontoPlane(mirror, *tip)) : std::nullopt));
    changed = withCutAdded(p, plane, middle, place, tip);
    if (!changed) return changed;
    CutPlace other;
    if (place.crossed >= 0) {
        other.crossed = images.bones[nth(place.crossed)];
        if (other.crossed > place.crossed) ++other.crossed;  // the new bone comes right after the one that is divided
    } else if (place.from.bone >= 0) {
        other.from = jointImage(p, images, place.from);
    }
    if (place.crossed >= 0 ? other.crossed < 0 : place.from.bone >= 0 && other.from.bone < 0) return stillMirrored(p, std::move(changed));
    changed = withCutAdded(*changed, image(mirror, plane), mirroredPoint(mirror, middle), other, image(mirror, tip));
    if (changed) {
        Proposal named = *changed;
        nameSides(named);
        if (checkProposal(named)) changed = std::move(named);  // names that are taken stay away
    }
    return stillMirrored(p, std::move(changed));
}

// ---- bones -------------------------------------------------------------------------------------------------------------

Result<Proposal> withEndMoved(const Proposal& p, const ProposedEnd& end, const Vec3& to, Sides sides) {
    if (oneSided(p, sides)) return withEndMoved(p, end, to);
    const ProposedEnd twin = jointImage(p, imagesOf(p), end);
    if (twin.bone >= 0 && sameJoint(p, end, twin)) return stillMirrored(p, withEndMoved(p, end, ontoPlane(*p.symmetry, to)));
    auto changed = withEndMoved(p, end, to);
    if (changed && twin.bone >= 0) changed = withEndMoved(*changed, twin, mirroredPoint(*p.symmetry, to));
    return stillMirrored(p, std::move(changed));
}

Result<Proposal> withoutBone(const Proposal& p, int bone, Sides sides) {
    auto changed = withoutBone(p, bone);
    if (!changed || oneSided(p, sides)) return changed;
    const int twin = imagesOf(p).bones[nth(bone)];
    if (twin >= 0 && twin != bone) changed = withoutBone(*changed, twin > bone ? twin - 1 : twin);
    return stillMirrored(p, std::move(changed));
}

Result<Proposal> withBoneAdded(const Proposal& p, const ProposedEnd& from, const Vec3& to, int piece, Sides sides) {
    if (oneSided(p, sides)) return withBoneAdded(p, from, to, piece);
    const CutPlane& mirror = *p.symmetry;
    const ProposalImages images = imagesOf(p);
    const ProposedEnd twin = jointImage(p, images, from);
    if (twin.bone >= 0 && sameJoint(p, from, twin) && offPlane(mirror, to) <= kAlongPlane * (to - placeOf(p, from)).norm())
        return stillMirrored(p, withBoneAdded(p, from, ontoPlane(mirror, to), piece));
    auto changed = withBoneAdded(p, from, to, piece);
    if (changed && twin.bone >= 0) changed = withBoneAdded(*changed, twin, mirroredPoint(mirror, to), pieceImage(images, piece));
    return stillMirrored(p, std::move(changed));
}

Result<Proposal> withBoneAdded(const Proposal& p, const Vec3& from, const Vec3& to, int piece, Sides sides) {
    if (oneSided(p, sides)) return withBoneAdded(p, from, to, piece);
    const CutPlane& mirror = *p.symmetry;
    if (std::max(offPlane(mirror, from), offPlane(mirror, to)) <= kAlongPlane * (to - from).norm())
        return stillMirrored(p, withBoneAdded(p, ontoPlane(mirror, from), ontoPlane(mirror, to), piece));
    auto changed = withBoneAdded(p, from, to, piece);
    if (changed) changed = withBoneAdded(*changed, mirroredPoint(mirror, from), mirroredPoint(mirror, to), pieceImage(imagesOf(p), piece));
    return stillMirrored(p, std::move(changed));
}

// ---- pins and handles --------------------------------------------------------------------------------------------------

Result<Proposal> withPinToggled(const Proposal& p, const ProposedEnd& end, Sides sides) {
    Proposal changed = withPinToggled(p, end);
    if (oneSided(p, sides)) return changed;
    const ProposedEnd twin = jointImage(p, imagesOf(p), end);
    if (twin.bone >= 0 && isPinned(changed, twin) != isPinned(changed, end)) changed = withPinToggled(changed, twin);
    return stillMirrored(p, std::move(changed));
}

Result<Proposal> withHandlePinToggled(const Proposal& p, int handle, Sides sides) {
    Proposal changed = withHandlePinToggled(p, handle);
    if (oneSided(p, sides)) return changed;
    const int twin = imagesOf(p).handles[nth(handle)];
    if (twin >= 0) changed.handles[nth(twin)].pinned = changed.handles[nth(handle)].pinned;
    return stillMirrored(p, std::move(changed));
}

Result<Proposal> withoutHandle(const Proposal& p, int handle, Sides sides) {
    Proposal changed = withoutHandle(p, handle);
    if (oneSided(p, sides)) return changed;
    const int twin = imagesOf(p).handles[nth(handle)];
    if (twin >= 0 && twin != handle) changed = withoutHandle(changed, twin > handle ? twin - 1 : twin);
    return stillMirrored(p, std::move(changed));
}

Result<Proposal> withHandleMoved(const Proposal& p, int handle, const Vec3& to, Sides sides) {
    if (oneSided(p, sides)) return withHandleMoved(p, handle, to);
    const int twin = imagesOf(p).handles[nth(handle)];
    if (twin == handle) return withHandleMoved(p, handle, ontoPlane(*p.symmetry, to));
    auto changed = withHandleMoved(p, handle, to);
    if (changed && twin >= 0) changed = withHandleMoved(*changed, twin, mirroredPoint(*p.symmetry, to));
    return stillMirrored(p, std::move(changed));
}

}  // namespace imomushi
