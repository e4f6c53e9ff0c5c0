// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/proposal/proposal_mirror.h"
#include "ui/jobs/cut_trial_job.h"
#include "ui/picking/cut_preview.h"
#include "ui/picking/picking.h"
#include "ui/tools/tool.h"

namespace imomushi {

/// Shows how a character would be made soft and changes that, before anything is done: planes are dragged along their normals and turned (Ctrl, or the arrow of the selected
/// one), ends of bones dragged, a click on the flesh adds a cut, on a joint a pin; Shift and a drag add a bone; Delete drops. On a shape that mirrors itself the other
/// side follows, until X switches that off. Steps of its own can be undone. Enter makes the character soft as it is shown, by one make-soft command; Esc leaves everything
/// as it is. Cuts are tried in the background: until it is known what they do they are drawn unfilled, and what depends on it waits.
class ProposalTool : public Tool {
public:
    struct Host {
        /// Does make-soft, now or later. handBack() where it is not done.
        std::function<void(const Json& command)> accept;
        std::function<void()> changed = {};  ///< what is shown has changed by itself
    };
    ProposalTool(StudioDocument& document, PartId character, Proposal proposal, Host host);

    void press(const PointerEvent& e) override;
    void move(const PointerEvent& e) override;
    void release(const PointerEvent& e) override;
    void leave() override { hovered_ = {}, wouldCut_.reset(); }
    void doubleClick(const PointerEvent& e) override { press(e); }
    bool key(int key, Qt::KeyboardModifiers modifiers, const QString& text = {}) override;
    [[nodiscard]] bool wants(int key) const override;
    void cancel() override;
    [[nodiscard]] bool busy() const override { return drag_.has_value(); }
    [[nodiscard]] bool hasSteps() const override { return !over(); }
    void undo() override;
    void redo() override;
    [[nodiscard]] bool over() const override { return finished_ || !source(); }
    [[nodiscard]] QString hint() const override;
    [[nodiscard]] QString banner() const override;
    void decorate(render::Scene& scene) const override;

    /// As it is shown.
    [[nodiscard]] const Proposal& proposal() const { return drag_ && drag_->shown ? *drag_->shown : history_.now(); }
    [[nodiscard]] PartId character() const { return character_; }
    /// The artist left it by Esc: it is not wanted any more.
    [[nodiscard]] bool dropped() const { return finished_; }
    /// It was accepted, and nothing changes until it is done or handed back.
    [[nodiscard]] bool handedOver() const { return handedOver_; }
    void handBack();
    /// What its cuts do is not known yet.
    [[nodiscard]] bool trying() const { return trial_.running(); }
    /// Per cut: why it does not cut; none: it does. As far as they were tried.
    [[nodiscard]] const std::vector<std::optional<Error>>& refused() const { return tried_.refused; }

private:
    /// A thing of the proposal.
    struct Grip {
        enum class Kind { Nothing, Cut, Bone, End, Handle } kind = Kind::Nothing;
        int index = -1;     ///< of the cut, the bone or the handle
        bool atEnd = true;  ///< End only
        bool operator==(const Grip&) const = default;
    };
    /// A cut as it is drawn.
    struct Shown {
        CutPlane plane;
        std::vector<std::vector<Vec3>> loops;  ///< of its section; none: it misses the body
        Vec3 centre = Vec3::Zero();
        double reach = 0.0;                    ///< m, of the section from its centre
    };
    struct Drag {
        Grip grip;
        enum class Does { Slides, Turns, Moves, AddsBone, AddsCut, Nothing } does = Does::Nothing;
        bool moved = false;
        Eigen::Vector2d pressed = Eigen::Vector2d::Zero();  ///< logical pixels
        Vec3 held = Vec3::Zero();                           ///< where the pointer was at the last move, m
        Vec3 from = Vec3::Zero(), to = Vec3::Zero();        ///< m: of a new bone; `to` of an end that is moved
        CutPlane plane;                                     ///< of a cut under way, its origin the middle of the section that was taken
        double along = 0.0;                                 ///< that it slid, m
        std::optional<Proposal> shown;                      ///< with what the drag changes
    };

    /// Whether the other side follows.
    [[nodiscard]] Sides sides() const { return mirrors_ ? Sides::Both : Sides::One; }
    [[nodiscard]] const CharacterSource* source() const;
    [[nodiscard]] Grip gripUnder(const PointerEvent& e) const;
    [[nodiscard]] bool onArrow(const PointerEvent& e) const;  ///< of the selected cut
    [[nodiscard]] std::optional<RayHit> fleshUnder(const PointerEvent& e) const;
    /// The triangle of the body that was hit.
    [[nodiscard]] std::int32_t onBody(const RayHit& hit) const;
    [[nodiscard]] std::optional<Vec3> insideUnder(const PointerEvent& e) const;  ///< in the middle of the flesh
    [[nodiscard]] Shown shownAt(const CutPlane& plane) const;
    [[nodiscard]] int pieceAt(const Vec3& place) const;
    void begin(Drag drag, const PointerEvent& e);
    void dragTo(const PointerEvent& e);
    /// What waits until it is known which flesh lies in front of which cut.
    struct Waiting {
        std::optional<CutPlane> cut;  ///< of a new one, its origin on the flesh
        Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< of a new bone, m
    };
    /// Makes a change a step. False: it is refused, which is said.
    bool take(Result<Proposal> changed);
    void wait(Waiting waiting);
    /// The proposal with a cut, and the section of that.
    [[nodiscard]] Result<Proposal> withCut(const CutPlane& plane, const Shown& shown) const;
    void addCut(const CutPlane& plane, const Result<TriedCuts>& tried);
    void addBone(const Vec3& from, const Vec3& to);
    void drop(Grip grip);
    void accept();
    /// Brings what is drawn in step with the proposal.
    void show();
    /// Tries the cuts, where that was not done, and then does what waits.
    void tryNext();
    void takeTrial();
    /// What the cuts of a proposal do is known.
    [[nodiscard]] bool isTried(const Proposal& proposal) const;
    [[nodiscard]] bool isTried(int cut) const;

    PartId character_;
    std::shared_ptr<const CharacterSource> kept_;
    SectionFinder sections_;
    ProposalHistory history_;
    Host host_;
    std::vector<Shown> cuts_;
    TriedCuts tried_;
    std::vector<CutPlane> triedPlanes_;
    bool refusalTold_ = true;  ///< which of its cuts are refused
    CutTrialJob trial_;
    std::deque<Waiting> waiting_;
    bool acceptsNext_ = false;  ///< when nothing waits any more
    Grip hovered_, selected_;
    std::optional<CutPlane> wouldCut_;  ///< what a click would add
    std::vector<std::vector<Vec3>> wouldCutRim_;
    std::optional<Drag> drag_;
    bool mirrors_ = true;  ///< where the shape has a plane of symmetry
    bool finished_ = false, handedOver_ = false;
};

}  // namespace imomushi
