// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/bend_warp_job.h"

#include <algorithm>

#include "core/character/frame.h"
#include "core/character/frame_job.h"
#include "core/warp/bend_warp.h"

namespace imomushi {

using Eigen::Matrix3d;

namespace {

/// Carried vertices for one thread.
constexpr std::size_t kOfPiece = 4096;

class BendWarpJob final : public FrameJob {
public:
    explicit BendWarpJob(Frame& frame) : FrameJob(BendWarpEffect::kName, {{Stage::LocalShape, FrameData::Joints | FrameData::JointMaps | FrameData::Elements | FrameData::Parameters | FrameData::Loads, FrameData::Local | FrameData::Positions}}) {
        for (std::size_t e = 0; e < frame.elements.size(); ++e)
            if (frame.elements[e].runtime->warp) add(frame, e);
        work_.reserve(elements_.size());
        for (auto& e : elements_)
            for (std::size_t i = 0; i < e.warp.carried(); i += kOfPiece) pieces_.push_back({&e, i, std::min(i + kOfPiece, e.warp.carried())});
    }

    void run(Stage, Frame& frame) override {
        const auto start = std::chrono::steady_clock::now();
        work_.clear();
        std::size_t bytes = 0;
        for (auto& e : elements_) {
            e.working = false;
            const VertexWork work = frame.elements[e.index].work;
            if (frame.elements[e.index].warpPart == 0.0) continue;
            if (work != VertexWork::Evaluate && work != VertexWork::EvaluateAndKeep) continue;
            e.working = true;
            work_.push_back(&e);
            bytes += e.bytes;
        }
        if (work_.empty()) return;
        frame.share(bytes, work_, [&frame](Element* e) {
            solve(*e, frame);
            if (e->warp.carried() == 0) finish(*e, frame);
        });
        // Of the wall time, loads have what they have of the work.
        double all = carry(bytes, frame), loads = 0.0;
        for (const Element* e : work_) all += e->warpMs + e->loadMs, loads += e->loadMs;
        if (all > 0.0) frame.loadMsOfWarp += milliseconds(start, std::chrono::steady_clock::now()) * loads / all;
    }

    [[nodiscard]] std::size_t bytes() const override {
        std::size_t sum = 0;
        for (const auto& e : elements_) sum += e.bytes;
        return sum;
    }

    void report(Frame& frame, double ms) const override { frame.setTime(BendWarpEffect::kName, ms - frame.loadMsOfWarp); }

private:
    struct Element {
        Element(std::size_t of, std::shared_ptr<const BendWarpTables> tables) : index(of), warp(std::move(tables)), bytes(warp.cost().bytes) {}
        std::size_t index;
        BendWarp warp;
        std::size_t bytes;                 // that an evaluation reads and writes
        std::vector<FaceMotion> motions;   // per face
        std::vector<char> sameTree;        // per face: a bone of its own tree carries the joint, and signs of rotations agree
        Eigen::VectorXd warping;           // what smooth joints add to motions, see BendWarp::evaluate()
        Points held;                       // of warp.heldVertices()
        std::vector<std::size_t> heldOf;   // where they are in ElementState::held
        AlignedBuffer<float> loaded;       // with body loads: local positions under these alone; where the warp fades, then those of the product
        bool working = false;               // in this frame
        double warpMs = 0.0, loadMs = 0.0;  // of the last run
    };

    struct Piece {
        Element* element;
        std::size_t begin, end;  // of BendWarp::carry()
    };

    void add(Frame& frame, std::size_t index) {
        const auto& given = frame.input.elements[index];
        auto& of = frame.elements[index];
        of.fades = of.runtime->watch != nullptr;
        of.warpPart = of.fades ? 0.0 : 1.0;
        if (of.fades) {
            of.watched.resize(given.faces.size());
            of.watchRoom = of.runtime->watch->room();
        }
        Element made(index, of.runtime->warp);
        made.motions.resize(given.faces.size());
        made.warping = Eigen::VectorXd::Zero(of.v.size());
        if (of.withLoads.size() > 0 || of.fades) made.loaded = AlignedBuffer<float>(of.local.size());
        for (const int j : of.jointOf) {
            auto& joint = frame.joints[static_cast<std::size_t>(j)];
            joint.warped = true;
            joint.fades = of.fades;
            joint.nu = given.nu;
            const int bone = frame.input.joints[static_cast<std::size_t>(j)].faces[0].bone;
            made.sameTree.push_back(!given.bones.empty() && bone >= 0 && frame.tree.tree[bone] == frame.tree.tree[given.bones[0]]);
        }
        std::vector<std::size_t> indexOf(of.runtime->vertices, 0);
        for (std::size_t i = 0; i < of.held.size(); ++i) indexOf[static_cast<std::size_t>(of.held[i].vertex)] = i;
        for (const auto v : made.warp.heldVertices()) made.heldOf.push_back(indexOf[static_cast<std::size_t>(v)]);
        made.held.resize(static_cast<Eigen::Index>(made.heldOf.size()), 3);
        elements_.push_back(std::move(made));
    }

    // Of elements that a coarse body carries; their vertices are shared by the threads. Milliseconds, without what is added to them.
    double carry(std::size_t bytes, Frame& frame) {
        if (pieces_.empty()) return 0.0;
        const auto start = std::chrono::steady_clock::now();
        frame.share(bytes, pieces_, [&frame](const Piece& p) {
            if (!p.element->working) return;
            p.element->warp.carry(p.begin, p.end, frame.elements[p.element->index].local.data());
        });
        const double carried = milliseconds(start, std::chrono::steady_clock::now());
        frame.share(bytes, work_, [&frame](Element* e) {
            if (e->warp.carried() > 0) finish(*e, frame);
        });
        return carried;
    }

    static void solve(Element& w, Frame& frame) {
        const auto start = std::chrono::steady_clock::now();
        auto& out = frame.elements[w.index];
        const auto& response = *out.runtime->input.response;
        const Matrix3d toElement = out.frame.linear.transpose();
        for (std::size_t f = 0; f < w.motions.size(); ++f) {
            const auto& joint = frame.joints[static_cast<std::size_t>(out.jointOf[f])];
            auto& motion = w.motions[f];
            motion.linear = toElement * joint.map.linear;
            motion.shift = toElement * (joint.map.shift - out.frame.shift);
            motion.rotation = out.rotation.conjugate() * joint.rotation;
            if (!w.sameTree[f] && motion.rotation.w() < 0.0) motion.rotation.coeffs() = -motion.rotation.coeffs();
            if (const int modes = response.bases[f].modes; frame.smooth && modes > 0) {
                const int first = response.firstColumn[f] + response.bases[f].plainColumns();
                w.warping.segment(first, modes) = joint.part * out.v.segment(first, modes);
            }
        }
        for (std::size_t i = 0; i < w.heldOf.size(); ++i)
            w.held.row(static_cast<Eigen::Index>(i)) = (toElement * (frame.heldAt(out, w.heldOf[i]) - out.frame.shift)).transpose();
        w.warp.solve(w.motions, w.warping, w.held, out.local.data());
        w.warpMs = milliseconds(start, std::chrono::steady_clock::now());
    }

    // What loads and the product add.
    static void finish(Element& w, Frame& frame) {
        const auto start = std::chrono::steady_clock::now();
        auto& out = frame.elements[w.index];
        w.loadMs = 0.0;
        // Embedded points follow the warp later (RenderMeshJob).
        const std::size_t bodyNumbers = 3 * static_cast<std::size_t>(kVertexBlock) * out.runtime->bodyBlocks;
        if (out.withLoads.size() > 0) {
            // What loads do to the shape at rest is added: weights without those of joints are what they do alone.
            out.withLoads.head(out.v.size()).setZero();
            out.blocks.weigh(out.withLoads);
            evaluateAndPlace(out.blocks.view(), out.blocks.weights(), out.placement, 0, out.blocks.count(), w.loaded.data(), out.positions.data());
            out.withLoads.head(out.v.size()) = out.v;
            const float* rest = out.blocks.rest().data();
            for (std::size_t i = 0; i < bodyNumbers; ++i) out.local[i] += w.loaded[i] - rest[i];
            w.loadMs = milliseconds(start, std::chrono::steady_clock::now());
        }
        if (out.warpPart < 1.0) {
            out.blocks.weigh(out.weights());
            evaluateAndPlace(out.blocks.view(), out.blocks.weights(), out.placement, 0, out.blocks.count(), w.loaded.data(), out.positions.data());
            const auto part = static_cast<float>(out.warpPart);
            for (std::size_t i = 0; i < bodyNumbers; ++i) out.local[i] = w.loaded[i] + part * (out.local[i] - w.loaded[i]);
            std::copy(w.loaded.data() + bodyNumbers, w.loaded.data() + out.local.size(), out.local.data() + bodyNumbers);
        }
        out.localShown = true;
        out.work = VertexWork::Place;
    }

    std::vector<Element> elements_;
    std::vector<Element*> work_;  // of this frame
    std::vector<Piece> pieces_;   // of all elements that are carried
};

}  // namespace

void BendWarpEffect::ask(ElementTables& tables) const {
    tables.warp = true;
    tables.fades = automatic;
}

Result<void> BendWarpEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    jobs.add<BendWarpJob>(frame);
    return {};
}

}  // namespace imomushi
