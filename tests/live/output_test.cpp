// SPDX-License-Identifier: GPL-3.0-or-later
// What other programs are told of a performance, read as another Imomushi reads it.
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <thread>

#include "core/document/morph_weights.h"
#include "core/input/input_decoder.h"
#include "core/input/udp_port.h"
#include "core/live/frame_writer.h"
#include "core/live/pose_parts.h"
#include "core/live/sending_thread.h"
#include "core/live/suggested_mappings.h"
#include "tests/live/puppet.h"
#include "tests/support/allocations.h"

using namespace imomushi;
using namespace std::chrono_literals;

namespace {

constexpr double kFloats = 1e-5;  // m, of places some metres away that are sent as floats
const std::string kSamples = IMOMUSHI_SAMPLES "/";

ShownFrame shown(const Session& session) {
    ShownFrame frame;
    frame.pose = session.shownPose();
    for (const FaceRef& handle : session.plan().handles) frame.handles.push_back(*session.poseOf(handle));
    for (const auto& [id, character] : session.document().characters)
        for (std::size_t t = 0; t < character->model->morphs.size(); ++t) frame.morphs.push_back(morphWeight(session.document(), *character, static_cast<int>(t)));
    return frame;
}

/// The values of a frame as a source of this name hears them.
std::vector<InputValue> heard(const Session& session, OutputProtocol protocol) {
    const auto decoder = makeInputDecoder(protocol == OutputProtocol::Vmc ? InputProtocol::Vmc : InputProtocol::Osc, std::string(outputProtocolName(protocol)));
    std::vector<InputValue> values;
    FrameWriter writer(protocol, session.document(), session.plan());
    writer.write(shown(session), 0.0, [&](std::span<const std::byte> packet) {
        CHECK(packet.size() <= OscBundle::kMostBytes);
        CHECK(packet.size() % 4 == 0);
        decoder->decode(packet, 0, [&](const InputValue& value) { values.push_back(value); });
    });
    CHECK(decoder->counts().malformed == 0);
    CHECK(!values.empty());
    return values;
}

/// What the driver of a session makes of values, when all has come to where it goes.
std::vector<LiveInput> driven(InputDriver& driver, const std::vector<InputValue>& values) {
    for (const InputValue& value : values) (void)driver.take(value);
    std::vector<LiveInput> last;
    for (int i = 0; i < 60; ++i)
        for (const LiveInput& input : driver.step(kStep)) {
            const auto known = std::ranges::find_if(last, [&](const LiveInput& l) { return l.sameTarget(input); });
            if (known == last.end()) last.push_back(input);
            else *known = input;
        }
    return last;
}

}  // namespace

TEST_CASE("output: a figure that hears another one by VMC has its bones as that one has them") {
    Workbench first, second;
    for (Workbench* w : {&first, &second}) w->good({{"do", "open"}, {"path", kSamples + "figure.imomushi"}});
    second.good({{"do", "suggest-mappings"}, {"protocol", "vmc"}});
    const Session& session = first.session;
    const auto drag = [&](const std::string& end, const Vec3& by) {
        const Vec3 at = *session.positionOf(*session.document().endpoint(end)) + by;
        first.good({{"do", "drag"}, {"endpoint", end}, {"to", {at.x(), at.y(), at.z()}}, {"roll", 0.3}});
    };
    drag("hand-bone.L/end", Vec3(-0.15, 0.25, 0.1));
    drag("hand-bone.R/end", Vec3(0.1, -0.2, 0.15));
    drag("head-bone/end", Vec3(0.05, -0.02, 0.05));
    first.good({{"do", "step"}, {"frames", 240}});  // its bones swing
    REQUIRE(session.builtCharacter());
    REQUIRE(second.session.builtCharacter());
    InputDriver driver(second.session.document(), second.session.plan(), {});
    const auto inputs = driven(driver, heard(session, OutputProtocol::Vmc));
    // What comes of it, as bones from joint point to joint point.
    const Skeleton& skeleton = session.plan().input.skeleton;
    std::vector<Vec3> points = skeleton.points;
    std::vector<double> rolls(points.size(), 0.0);
    for (const LiveInput& input : inputs)
        if (input.kind == LiveInput::Kind::End) {
            const auto point = static_cast<std::size_t>(second.session.plan().pointIndex(input.end));
            points[point] = input.target;
            rolls[point] = input.roll;
        }
    const Pose& pose = session.shownPose();
    const auto roles = bonesByRole(session.document(), session.plan());
    double worst = 0.0, turned = 0.0, roll = 0.0;
    for (const auto& [role, name] : roles) {
        const Bone& bone = *session.document().boneNamed(name);
        const auto b = static_cast<std::size_t>(session.plan().boneIndex(bone.id));
        const auto start = static_cast<std::size_t>(skeleton.bones[b].start), end = static_cast<std::size_t>(skeleton.bones[b].end);
        const auto angle = [&](const Vec3& u, const Vec3& v) { return 180.0 / std::numbers::pi * std::atan2(u.cross(v).norm(), u.dot(v)); };
        const Vec3 is = pose.points[end] - pose.points[start];
        worst = std::max(worst, angle(points[end] - points[start], is));
        turned = std::max(turned, angle(skeleton.points[end] - skeleton.points[start], is));
        roll = std::max(roll, std::abs(rolls[end] - pose.roll[end]));
    }
    MESSAGE(roles.size() << " bones, turned by " << turned << " degrees at most, are " << worst << " degrees off, their rolls " << roll << " radians");
    CHECK(roles.size() > 10);
    CHECK(turned > 15.0);
    CHECK(worst < 0.01);  // also of legs, whose hips have no role: they go along with the spine
    CHECK(roll < 0.01);  // told from the bone above: there hips hang otherwise
}

TEST_CASE("output: what hears another one by OSC goes where that one is: ends of bones, handles and morph targets") {
    Puppet first, second;
    first.good({{"do", "precompute"}});
    first.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.5, 1.0, 5.0}}, {"roll", 0.4}});
    first.good({{"do", "drag"}, {"endpoint", "tip"}, {"to", {0.8, 0.3, 4.7}}});
    first.good({{"do", "morph"}, {"character", "man"}, {"target", "smile"}, {"weight", 0.7}});
    InputDriver driver = second.driver();
    const auto inputs = driven(driver, heard(first.session, OutputProtocol::Osc));
    const Pose& pose = first.session.shownPose();
    std::set<int> points;
    int handles = 0;
    for (const LiveInput& input : inputs) {
        if (input.kind == LiveInput::Kind::End) {
            const int point = second.session.plan().pointIndex(input.end);
            points.insert(point);
            CHECK((input.target - pose.points[static_cast<std::size_t>(point)]).norm() < kFloats);
            CHECK(std::abs(input.roll - pose.roll[static_cast<std::size_t>(point)]) < kFloats);
        } else if (input.kind == LiveInput::Kind::Handle) {
            ++handles;
            const HandlePose at = *first.session.poseOf(first.session.plan().handles[static_cast<std::size_t>(input.handle)]);
            CHECK((input.target - at.at).norm() < kFloats);
            CHECK(input.rotation.angularDistance(at.rotation) < 1e-3);
        } else if (input.kind == LiveInput::Kind::Morph && input.morph.target == 0) {
            CHECK(input.weight == doctest::Approx(0.7));
        }
    }
    CHECK(points.size() == pose.points.size());
    CHECK(handles == 1);
}

TEST_CASE("output: handles of a creature go out as trackers of VMC, in Unity's axes") {
    Puppet p;
    p.good({{"do", "precompute"}});
    p.good({{"do", "drag"}, {"endpoint", "tip"}, {"to", {0.8, 0.3, 4.7}}});
    const auto values = heard(p.session, OutputProtocol::Vmc);
    const auto tip = std::ranges::find_if(values, [](const InputValue& v) { return v.channel.text() == "tracker/tip"; });
    REQUIRE(tip != values.end());
    const HandlePose at = *p.session.poseOf(p.session.plan().handles.front());
    CHECK((Vec3(tip->numbers[0], tip->numbers[1], tip->numbers[2]) - at.at).norm() < kFloats);
}

TEST_CASE("output: a performance is sent as it is made, what stays is sent again each second, and nothing while the character is made anew") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "enable"}, {"effect", "bone-dynamics"}});
    auto port = UdpPort::listen(0);
    REQUIRE(port);
    const auto decoder = makeInputDecoder(InputProtocol::Osc, "osc");
    std::map<std::string, Vec3> places;
    int times = 0;
    const auto listen = [&](std::chrono::milliseconds most, const std::function<bool()>& enough) {
        std::array<std::byte, 65536> room{};
        for (const auto start = std::chrono::steady_clock::now(); std::chrono::steady_clock::now() - start < most && !enough();) {
            const auto size = port->take(room);
            if (!size) {
                std::this_thread::sleep_for(1ms);
                continue;
            }
            decoder->decode(std::span(room).first(*size), 0, [&](const InputValue& value) {
                times += value.channel.text() == "/imomushi/bone/b/end/position";
                if (value.count == 3) places[std::string(value.channel.text())] = Vec3(value.numbers[0], value.numbers[1], value.numbers[2]);
            });
        }
        return enough();
    };
    SendingThread sending;
    sending.add(7, OutputProtocol::Osc, UdpTarget::open("localhost", port->port()).value());
    w.session.perform([] {});
    REQUIRE(w.session.builtCharacter());
    sending.follow(w.session.document(), w.session.plan());
    w.session.performOutputs(&sending);
    const EndpointRef end = *w.session.document().endpoint("b/end");
    const auto told = [&] { return places.contains("/imomushi/bone/b/end/position") ? places["/imomushi/bone/b/end/position"] : Vec3(Vec3::Zero()); };
    // Where it is, at once.
    CHECK(listen(20s, [&] { return (told() - *w.session.positionOf(end)).norm() < kFloats; }));
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.0, 1.0, 5.0}}});
    CHECK(listen(60s, [&] {
        w.session.takeFrame();
        return !w.session.moving() && (told() - *w.session.positionOf(end)).norm() < kFloats;
    }));
    CHECK((told() - Vec3(1.0, 1.0, 5.0)).norm() < 0.05);
    CHECK(times > 5);
    CHECK(sending.sent(7)->frames >= static_cast<std::uint64_t>(times));
    CHECK(sending.sent(7)->lost == 0);
    // It stays, and is sent again.
    times = 0;
    CHECK(listen(20s, [&] { return times >= 2; }));
    sending.pause();
    (void)listen(100ms, [] { return false; });  // what was under way
    times = 0;
    CHECK(!listen(1500ms, [&] { return times > 0; }));
    w.session.performOutputs(nullptr);
}

TEST_CASE("output: of a take that is shown the weights of the take are sent, not those of the document") {
    Puppet p;
    p.good({{"do", "precompute"}});
    const auto weight = [&](double to) { p.good({{"do", "morph"}, {"character", "man"}, {"target", "smile"}, {"weight", to}}); };
    weight(0.75);
    p.good({{"do", "record"}, {"take", "grin"}, {"action", "start"}});
    p.good({{"do", "step"}, {"frames", 3}});
    p.good({{"do", "record"}, {"take", "grin"}, {"action", "stop"}});
    weight(0.25);
    auto port = UdpPort::listen(0);
    REQUIRE(port);
    const auto decoder = makeInputDecoder(InputProtocol::Osc, "osc");
    double told = -1.0;
    const auto hear = [&](double until) {
        std::array<std::byte, 65536> room{};
        for (const auto start = std::chrono::steady_clock::now(); std::abs(told - until) > 1e-6 && std::chrono::steady_clock::now() - start < 20s;) {
            if (const auto size = port->take(room))
                decoder->decode(std::span(room).first(*size), 0, [&](const InputValue& value) {
                    if (value.channel.text() == "/imomushi/morph/man/smile") told = value.numbers[0];
                });
            else std::this_thread::sleep_for(1ms);
        }
        return told;
    };
    SendingThread sending;
    sending.add(1, OutputProtocol::Osc, UdpTarget::open("127.0.0.1", port->port()).value());
    p.session.perform([] {});
    REQUIRE(p.session.builtCharacter());
    sending.follow(p.session.document(), p.session.plan());
    p.session.performOutputs(&sending);
    CHECK(hear(0.25) == doctest::Approx(0.25));
    p.good({{"do", "play"}, {"take", "grin"}, {"time", 0.0}});
    CHECK(p.session.showsTake());
    CHECK(hear(0.75) == doctest::Approx(0.75));
    p.session.performOutputs(nullptr);
}

TEST_CASE("output: writing a frame takes no memory once it was written") {
    Puppet p;
    p.good({{"do", "precompute"}});
    const ShownFrame frame = shown(p.session);
    for (const auto protocol : {OutputProtocol::Vmc, OutputProtocol::Osc}) {
        FrameWriter writer(protocol, p.session.document(), p.session.plan());
        std::size_t bytes = 0;
        const std::function<void(std::span<const std::byte>)> count = [&](std::span<const std::byte> packet) { bytes += packet.size(); };
        writer.write(frame, 0.0, count);
        const std::size_t before = allocations();
        writer.write(frame, 1.0, count);
        CHECK(allocations() == before);
        CHECK(bytes > 0);
    }
}

TEST_CASE("output: what is no address or no port is refused") {
    for (const auto& [host, number] : {std::pair("stage", 9000), std::pair("256.1.1.1", 9000), std::pair("", 9000), std::pair("127.0.0.1", 0)}) {
        const auto refused = UdpTarget::open(host, static_cast<std::uint16_t>(number));
        REQUIRE(!refused);
        CHECK(refused.error().code == (number == 0 ? "bad-value" : "no-address"));
    }
}
