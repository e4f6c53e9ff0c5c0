// SPDX-License-Identifier: GPL-3.0-or-later
// The VMC protocol (protocol.vmc.info), as its "marionette" receives it. Channels:
//   bone/NAME, root, tracker/SERIAL, hmd/SERIAL, controller/SERIAL   ten numbers: position x y z (m), rotation x y z w (unit), the same as a rotation vector x y z (radians)
//   blend/NAME                                                       one number, as it was sent: values have no range
// Unity's axes are left-handed, ours right-handed: x is mirrored, so positions are (-x, y, z) and rotations (x, -y, -z, w). Bones are relative to their parents, as they were sent.
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/rotation_vector.h"
#include "core/input/decoders.h"
#include "core/input/osc_packet.h"
#include "core/input/pose_numbers.h"

namespace imomushi {

namespace {

/// Blend values that wait for their "Apply"; a sender with more is broken.
constexpr std::size_t kMostBlends = 512;
/// Rotations are sent as floats: their length is 1 up to this, or they are none.
constexpr double kUnitRotation = 0.05;

class VmcDecoder final : public InputDecoder {
public:
    using InputDecoder::InputDecoder;

private:
    bool read(std::span<const std::byte> packet) override {
        read_ = waiting_;
        return readOscPacket(packet, [this](const OscMessage& message) { return take(message); });
    }
    void accept() override { std::swap(waiting_, read_); }

    bool take(const OscMessage& message) {
        const std::string_view address = message.address;
        if (address == "/VMC/Ext/Bone/Pos") return pose(message, "bone/");
        if (address == "/VMC/Ext/Root/Pos") return pose(message, "");
        if (address == "/VMC/Ext/Tra/Pos") return pose(message, "tracker/");
        if (address == "/VMC/Ext/Hmd/Pos") return pose(message, "hmd/");
        if (address == "/VMC/Ext/Con/Pos") return pose(message, "controller/");
        if (address == "/VMC/Ext/Blend/Val") return blend(message);
        if (address == "/VMC/Ext/Blend/Apply") return apply();
        ignore();
        return true;
    }

    /// A name and seven numbers; later versions add some, which are left out.
    bool pose(const OscMessage& message, std::string_view kind) {
        const auto& a = message.arguments;
        if (message.count < 8 || !a[0].isText || a[0].text.empty()) return false;
        std::array<double, 7> n{};
        for (std::size_t i = 0; i < n.size(); ++i) {
            if (a[i + 1].isText || !InputValue::isSound(a[i + 1].number)) return false;
            n[i] = a[i + 1].number;
        }
        if (kind == "bone/" && a[0].text == "LastBone") {  // the end of a list of names, sent by mistake
            ignore();
            return true;
        }
        const double length = std::sqrt(n[3] * n[3] + n[4] * n[4] + n[5] * n[5] + n[6] * n[6]);
        if (!(std::abs(length - 1.0) <= kUnitRotation)) return false;
        const Eigen::Quaterniond turn(n[6] / length, n[3] / length, -n[4] / length, -n[5] / length);
        const Vec3 v = rotationVector(turn);
        const std::array<double, kPoseNumbers> said = {-n[0], n[1], n[2], turn.x(), turn.y(), turn.z(), turn.w(), v.x(), v.y(), v.z()};
        return add(kind.empty() ? std::string("root") : std::string(kind) + std::string(a[0].text), said);
    }

    bool blend(const OscMessage& message) {
        const auto& a = message.arguments;
        if (message.count < 2 || !a[0].isText || a[0].text.empty() || a[1].isText || !InputValue::isSound(a[1].number)) return false;
        const std::string name(a[0].text);
        if (!InputName::fits("blend/" + name)) return false;
        if (read_.size() == kMostBlends && !read_.contains(name)) return false;
        read_[name] = a[1].number;
        return true;
    }

    /// What was sent since the last one counts together.
    bool apply() {
        for (const auto& [name, value] : read_)
            if (!add("blend/" + name, std::span(&value, 1))) return false;
        read_.clear();
        return true;
    }

    std::map<std::string, double> waiting_, read_;  // blend values without their "Apply"; with those of the packet that is read
};

}  // namespace

std::unique_ptr<InputDecoder> makeVmcDecoder(std::string_view source) { return std::make_unique<VmcDecoder>(source); }

}  // namespace imomushi
