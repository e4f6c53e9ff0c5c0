// SPDX-License-Identifier: GPL-3.0-or-later
// What jobs say that they read and write: the types in frame_job.h.
#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/character/frame.h"
#include "core/character/frame_job.h"
#include "core/effects/touch_job.h"
#include "tests/character/random_characters.h"

using namespace imomushi;

namespace {

constexpr std::array kAll{FrameData::Joints, FrameData::JointMaps, FrameData::Elements, FrameData::Parameters, FrameData::Loads, FrameData::FaceOffsets,
                          FrameData::Wants, FrameData::Local, FrameData::Forces, FrameData::Positions, FrameData::Normals, FrameData::Ground};

struct Bytes {
    std::string all;
    template <class T>
    void add(const T* first, std::size_t count) {
        all.append(reinterpret_cast<const char*>(first), count * sizeof(T));
    }
    template <class Derived>
    void add(const Eigen::PlainObjectBase<Derived>& m) {
        add(m.data(), static_cast<std::size_t>(m.size()));
    }
    void add(const AffineMap& map) { add(map.linear), add(map.shift); }
    void add(double x) { add(&x, 1); }
};

/// One kind of data of a frame, as FrameData names it.
std::string bytesOf(const Frame& frame, FrameData data) {
    Bytes out;
    for (const JointState& j : frame.joints) {
        if (data == FrameData::Joints) out.add(j.rotation.coeffs()), out.add(j.rotationMatrix), out.add(j.at), out.add(j.stretch);
        if (data == FrameData::JointMaps) out.add(j.map), out.add(j.warping), out.add(j.part);
    }
    for (const ElementState& e : frame.elements) {
        if (data == FrameData::Elements) out.add(e.rotation.coeffs()), out.add(e.frame);
        if (data == FrameData::Parameters) out.add(e.v);
        if (data == FrameData::Loads && e.withLoads.size() > 0) out.add(Eigen::VectorXd(e.withLoads.tail(e.withLoads.size() - e.v.size())));
        if (data == FrameData::Loads) out.add(e.jointForces);
        if (data == FrameData::Wants) out.add(e.wantsLocal), out.add(e.wantsHere);
        if (data == FrameData::Local) out.add(e.local.data(), e.local.size());
        if (data == FrameData::Forces) {
            out.add(e.patchForces);
            for (const Dent& d : e.fingerDents) out.add(reinterpret_cast<const char*>(&d), sizeof d);
        }
        if (data == FrameData::Positions) out.add(e.positions.data(), e.positions.size());
        if (data == FrameData::Normals) out.add(e.normals.data(), e.normals.size());
        if (data == FrameData::Ground) out.add(e.aloft);
    }
    if (data == FrameData::FaceOffsets)
        for (const Vec3& at : frame.offsets) out.add(at);
    if (data == FrameData::Ground) out.add(frame.up);
    return out.all;
}

/// Says that it writes what its stage does not allow.
class Trespasser final : public FrameJob {
public:
    Trespasser(FrameDataSet reads, FrameDataSet writes) : FrameJob("trespasser", {{Stage::Loads, reads, writes}}) {}
    void run(Stage, Frame&) override {}
};

}  // namespace

TEST_CASE("jobs: none writes what it does not say, whatever effects a character has") {
    std::mt19937 random(11);
    std::set<std::string> wrong, seen;
    for (int kind = 0; kind < 30; ++kind) {
        CharacterInput input = randomCharacter(random);
        if (kind % 2 == 1) addRandomRenderMesh(input, random);
        auto character = Character::build(input).value();
        std::array<std::string, kAll.size()> before;
        character.jobs().watch([&](const FrameJob& job, const StageUse& use, const Frame& frame, bool done) {
            for (std::size_t k = 0; k < kAll.size(); ++k) {
                std::string now = bytesOf(frame, kAll[k]);
                if (done && now != before[k]) {
                    seen.insert(std::string(job.effect()));
                    if (!use.writes.has(kAll[k])) wrong.insert(std::string(job.effect()) + " in stage " + std::to_string(static_cast<int>(use.stage)) + ": data " + std::to_string(k));
                }
                before[k] = std::move(now);
            }
        });
        Pose pose = restPose(input.skeleton);
        for (int frame = 0; frame < 8; ++frame) {
            wander(character, random, pose);
            if (input.effects.has<TouchEffect>()) {
                const Vec3 at = input.elements[0].mesh->body.vertices.row(0).transpose();
                if (frame == 2) (void)setFinger(character, 0, 0, at, 0.8 * at, 0.0);
                if (frame == 5) liftFinger(character, 0, 0);
            }
            character.update(pose, 1.0 / 60.0);
        }
    }
    for (const std::string& what : wrong) { CAPTURE(what); CHECK(false); }
    CHECK(seen.size() >= 4);  // the test sees jobs at work
}

TEST_CASE("jobs: one that reads what is not known yet, or writes what its stage does not allow, is refused before it runs") {
    const auto verdict = [](FrameDataSet reads, FrameDataSet writes) {
        FrameJobs jobs;
        jobs.add<Trespasser>(reads, writes);
        return jobs.validate();
    };
    CHECK(verdict(FrameData::JointMaps | FrameData::Parameters, FrameData::Loads).has_value());
    CHECK(verdict(FrameData::Positions, FrameData::Loads).error().code == "internal");
    CHECK(verdict({}, FrameData::JointMaps).error().code == "internal");
}
