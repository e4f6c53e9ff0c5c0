// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/character/handle_pose.h"
#include "core/document/character_input.h"
#include "core/input/osc_packet.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

class LiveCharacter;

/// What other programs are told of a frame.
struct ShownFrame {
    Pose pose;                        ///< as it is shown; empty: at rest
    std::vector<HandlePose> handles;  ///< of CharacterPlan::handles, as they are shown, in the world
    std::vector<double> morphs;       ///< weights of all morph targets of all characters, in their order
};
/// Takes memory only where `frame` is of another character.
void showFrame(const LiveCharacter& live, ShownFrame& frame);

/// The languages in which frames are sent.
enum class OutputProtocol { Vmc, Osc };
std::optional<OutputProtocol> outputProtocolNamed(std::string_view name);  ///< "vmc", "osc"
std::string_view outputProtocolName(OutputProtocol protocol);

/// Writes frames of a character as packets for other programs. What is sent is what is heard: another Imomushi that hears it moves alike.
///
/// VMC (as its "performer" sends it; protocol.vmc.info): "/VMC/Ext/OK", "/VMC/Ext/T", "/VMC/Ext/Root/Pos"; a "/VMC/Ext/Bone/Pos" of each bone with a role of a human, relative to the nearest such bone that it hangs on, from rest; each handle as a tracker
/// ("/VMC/Ext/Tra/Pos", its name for a serial); the expressions of an avatar by the names of VRM 0, as senders call them, and all morph targets by their own ("/VMC/Ext/Blend/Val", then "Apply"). Axes are Unity's: x is mirrored.
///
/// OSC, without names that are too long for a channel: positions of handles and ends of bones (m), turns of handles (a rotation vector, radians), rolls of ends, weights of morph targets, each by its direct name (directNames()).
class FrameWriter {
public:
    FrameWriter(OutputProtocol protocol, const Document& document, const CharacterPlan& plan);

    /// Calls `send` with each packet, a bundle of at most OscBundle::kMostBytes. `time`: s, of the performance.
    void write(const ShownFrame& frame, double time, const std::function<void(std::span<const std::byte>)>& send);

    /// How many bones, or ends of bones, it tells of.
    [[nodiscard]] std::size_t bones() const { return protocol_ == OutputProtocol::Vmc ? human_.size() : ends_.size(); }

private:
    struct HumanBone {
        std::string name;      // as VMC calls it
        std::size_t bone = 0;
        int parent = -1;       // of these
    };
    struct Expression {
        std::string name;
        std::vector<std::pair<std::size_t, double>> morphs;  // of ShownFrame::morphs, and how much of each
    };
    void writeVmc(const ShownFrame& frame, double time);
    void writeOsc(const ShownFrame& frame);
    /// A place and a rotation in Unity's axes.
    void placed(std::string_view address, std::string_view name, const Vec3& at, const Eigen::Quaterniond& turn);

    OutputProtocol protocol_;
    Skeleton skeleton_;
    BoneTree tree_;
    Pose rest_;
    std::vector<HumanBone> human_;           // parents before children
    std::vector<Eigen::Quaterniond> whole_;  // of human_, in the frame that is written
    std::vector<Expression> expressions_;
    /// What is sent under an address, or for VMC under a name.
    struct Named {
        std::string address, second;  // places and turns, or rolls, have one each
        std::size_t of = 0;           // a joint point, a handle, a morph target
    };
    std::vector<Named> ends_, handles_, morphs_;
    OscBundle bundle_;
};

}  // namespace imomushi
