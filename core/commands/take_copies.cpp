// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/take_copies.h"

#include <Eigen/Geometry>
#include <map>
#include <utility>

#include "core/base/try.h"
#include "core/document/character_input.h"
#include "core/document/embed_model.h"

namespace imomushi {

namespace {

/// Where numbers of a shape come from: `count` at `at` of the shape before; those of copies are shifted, of the frame of an element or a joint.
struct CopiedNumbers {
    enum class Kind { Same, Frame, Joint } kind = Kind::Same;
    int at = 0, count = 0;
};

class TakeCopier {
public:
    TakeCopier(Document& document, const Document& from, const PartCopier& copier) : document_(document), from_(from), copier_(copier), shift_(copier.placing().shift) {
        for (const auto& [original, copy] : copier.ids()) originals_.emplace(copy, original);
    }

    Result<std::vector<std::string>> run() {
        std::vector<std::string> names;
        if (document_.takes.empty()) return names;
        IMOMUSHI_TRY(before_, planCharacter(from_));
        IMOMUSHI_TRY(after_, planCharacter(document_));
        if (!standsFree()) return names;
        for (auto& [id, take] : document_.takes) {
            Take made = *take;
            const bool posed = copyPoses(made), shaped = copyShapes(made);
            if (!posed && !shaped) continue;
            names.push_back(made.name);
            take = std::make_shared<const Take>(std::move(made));
        }
        return names;
    }

private:
    [[nodiscard]] bool isCopy(PartId part) const { return originals_.contains(part); }
    [[nodiscard]] PartId originOf(PartId part) const {
        const auto copy = originals_.find(part);
        return copy == originals_.end() ? part : copy->second;
    }

    /// No joint point is one of copied bones and others.
    [[nodiscard]] bool standsFree() const {
        std::map<int, bool> copied;
        const auto& bones = after_.input.skeleton.bones;
        for (std::size_t b = 0; b < bones.size(); ++b)
            for (const int p : {bones[b].start, bones[b].end})
                if (const auto [other, isNew] = copied.try_emplace(p, isCopy(after_.bones[b])); !isNew && other->second != isCopy(after_.bones[b])) return false;
        return true;
    }

    /// False: the take moves no bone that was copied.
    bool copyPoses(Take& take) const {
        std::vector<std::size_t> bones;   // of the take, which have copies
        std::vector<int> points;          // of these, in order of their copies
        std::map<int, int> copyOf;        // of points
        const std::size_t all = take.bones.size();
        for (std::size_t b = 0; b < all; ++b) {
            const auto copy = copier_.ids().find(take.bones[b].bone);
            if (copy == copier_.ids().end() || !document_.bones.contains(copy->second)) continue;
            const auto pointFor = [&](int p) {
                const auto [known, isNew] = copyOf.try_emplace(p, take.points + static_cast<int>(points.size()));
                if (isNew) points.push_back(p);
                return known->second;
            };
            const int start = pointFor(take.bones[b].start), end = pointFor(take.bones[b].end);
            bones.push_back(b);
            take.bones.push_back({copy->second, start, end});
        }
        if (bones.empty()) return false;
        const auto was = static_cast<std::size_t>(take.points), frames = 3 * was, rolls = frames + 4 * all;
        FrameNumbers poses;
        std::vector<double> old(take.poses.width()), row;
        for (std::size_t f = 0; f < take.times.size(); ++f) {
            take.poses.at(f, old.data());
            const auto at = [&](std::size_t i) { return old.begin() + static_cast<std::ptrdiff_t>(i); };
            row.assign(old.begin(), at(frames));
            for (const int p : points)
                for (int k = 0; k < 3; ++k) row.push_back(old[static_cast<std::size_t>(3 * p + k)] + shift_[k]);
            row.insert(row.end(), at(frames), at(rolls));
            for (const std::size_t b : bones) row.insert(row.end(), at(frames + 4 * b), at(frames + 4 * b + 4));
            row.insert(row.end(), at(rolls), old.end());
            for (const int p : points) row.push_back(old[rolls + static_cast<std::size_t>(p)]);
            poses.add(row);
        }
        poses.finish();
        take.points += static_cast<int>(points.size());
        take.poses = std::move(poses);
        std::vector<Take::Target> told;
        for (const Take::Target& target : take.targets) {
            told.push_back(target);
            const auto copy = copier_.ids().find(target.bone);
            if (copy == copier_.ids().end() || !document_.bones.contains(copy->second)) continue;
            told.push_back(target);
            told.back().bone = copy->second;
            if (target.held) told.back().to += shift_;
        }
        take.targets = std::move(told);
        return true;
    }

    /// The joint of the plan before that has a face of an element.
    [[nodiscard]] int jointBefore(int element, int face) const {
        const auto& joints = before_.input.joints;
        for (std::size_t j = 0; j < joints.size(); ++j)
            for (const auto& f : joints[j].faces)
                if (f.element == element && f.face == face) return static_cast<int>(j);
        return -1;
    }

    /// Attached parts of elements that keep their shape, as ShapeLayout counts them.
    static std::vector<int> attachedParts(CharacterPlan plan, const Document& document) {
        EmbeddedModels models;
        addRenderMeshes(plan, document, models);
        std::vector<int> counts(plan.elements.size(), 0);
        for (std::size_t e = 0; e < counts.size(); ++e)
            if (const auto& points = plan.input.elements[e].embedded) counts[e] = static_cast<int>(points->attached.size());
        return counts;
    }

    /// False: the take does not show what `from_` is.
    bool copyShapes(Take& take) const {
        const ShapeLayout was = take.layout;
        if (take.elements != before_.elements || was.joints != static_cast<int>(before_.input.joints.size()) || was.nodes > 0) return false;
        ShapeLayout now = was;
        now.elements.clear();
        std::vector<CopiedNumbers> pieces;
        const auto same = [&](int at, int count) {
            if (count > 0) pieces.push_back({CopiedNumbers::Kind::Same, at, count});
        };
        std::vector<int> elements;  // before, of those after
        for (const PartId id : after_.elements) {
            const int e = before_.elementIndex(originOf(id));
            if (e < 0) return false;
            elements.push_back(e);
            const auto& size = now.elements.emplace_back(was.elements[static_cast<std::size_t>(e)]);
            const int at = was.element(static_cast<std::size_t>(e));
            pieces.push_back({isCopy(id) ? CopiedNumbers::Kind::Frame : CopiedNumbers::Kind::Same, at, ShapeLayout::kFrame});
            same(at + ShapeLayout::kFrame, size.weights + size.forces + size.fades);
        }
        now.joints = static_cast<int>(after_.input.joints.size());
        for (const auto& joint : after_.input.joints) {
            const auto& face = joint.faces[0];
            const int j = jointBefore(elements[static_cast<std::size_t>(face.element)], face.face);
            if (j < 0) return false;
            pieces.push_back({isCopy(after_.elements[static_cast<std::size_t>(face.element)]) ? CopiedNumbers::Kind::Joint : CopiedNumbers::Kind::Same, was.joint(j), was.jointSize()});
        }
        const int turns = was.joint(was.joints);
        if (was.turns > 0) {
            const std::vector<int> had = attachedParts(before_, from_), has = attachedParts(after_, document_);
            std::vector<int> first(had.size(), turns);
            for (std::size_t e = 1; e < had.size(); ++e) first[e] = first[e - 1] + 3 * had[e - 1];
            now.turns = 0;
            for (std::size_t e = 0; e < has.size(); ++e) {
                const auto of = static_cast<std::size_t>(elements[e]);
                if (has[e] != had[of]) return false;
                same(first[of], 3 * has[e]);
                now.turns += has[e];
            }
        }
        if (was.morphs > 0) {
            std::map<PartId, int> first;
            int next = was.morph(0);
            const auto countOf = [](const CharacterSource& character) { return static_cast<int>(character.model->morphs.size()); };
            for (const auto& [id, character] : from_.characters) {
                first.emplace(id, next);
                next += countOf(*character);
            }
            if (next != was.size()) return false;
            now.morphs = 0;
            for (const auto& [id, character] : document_.characters) {
                same(first.at(originOf(id)), countOf(*character));
                now.morphs += countOf(*character);
            }
        }
        FrameNumbers shapes;
        std::vector<double> old(take.shapes.width()), row;
        for (std::size_t f = 0; f < take.times.size(); ++f) {
            take.shapes.at(f, old.data());
            row.clear();
            for (const CopiedNumbers& piece : pieces) {
                const std::size_t at = row.size();
                row.insert(row.end(), old.begin() + piece.at, old.begin() + piece.at + piece.count);
                if (piece.kind == CopiedNumbers::Kind::Frame) shiftMap(Eigen::Quaterniond(row.data() + at).toRotationMatrix(), row.data() + at + 4);
                if (piece.kind == CopiedNumbers::Kind::Joint) shiftMap(Eigen::Map<const Eigen::Matrix3d>(row.data() + at + 4), row.data() + at + 13);
            }
            shapes.add(row);
        }
        shapes.finish();
        take.elements = after_.elements;
        take.layout = std::move(now);
        take.shapes = std::move(shapes);
        return true;
    }

    /// x -> linear x + s, of what stands elsewhere at rest.
    void shiftMap(const Eigen::Matrix3d& linear, double* s) const { Eigen::Map<Vec3>(s, 3) += shift_ - linear * shift_; }

    Document& document_;
    const Document& from_;
    const PartCopier& copier_;
    const Vec3 shift_;
    std::map<PartId, PartId> originals_;  // by their copies
    CharacterPlan before_, after_;
};

}  // namespace

Result<std::vector<std::string>> performCopies(Document& document, const Document& from, const PartCopier& copier) { return TakeCopier(document, from, copier).run(); }

}  // namespace imomushi
