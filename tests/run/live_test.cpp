// SPDX-License-Identifier: GPL-3.0-or-later
// Performances by programs that send: the senders of assets/live on loopback.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "core/input/input_decoder.h"
#include "core/input/udp_port.h"
#include "core/mesh/write_mesh.h"
#include "tests/run/performed.h"
#include "tests/support/obj.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// "egg.imomushi": an egg with a handle on top and a pinned foot.
void makeEgg() {
    TriangleMesh mesh = shapes::sphere(1.0, 3).mesh;
    mesh.vertices.col(1) *= 1.5;
    REQUIRE(writeMesh(folder() / "egg.obj", mesh.vertices, mesh.triangles).has_value());
    REQUIRE(script(R"({"do":"new"}
{"do":"import-element","path":"egg.obj","name":"egg"}
{"do":"set","target":"egg","property":"solver-mesh","value":"as-is"}
{"do":"handle","element":"egg","name":"top","point":[0,1.5,0],"radius":0.4}
{"do":"handle","element":"egg","name":"foot","point":[0,-1.5,0],"radius":0.5}
{"do":"precompute"}
{"do":"pin","endpoint":"foot"}
{"do":"map-input","source":"vmc","channel":"blend/Joy","target":"handle/top/y","out":[0,0.5]}
{"do":"save","path":"egg.imomushi"}
)").status == 0);
}

std::string live(const std::string& more) {
    return R"({"do":"open","path":"egg.imomushi"}
{"do":"record","take":"show","action":"start"}
{"do":"live","sources":[{"protocol":"osc","port":0},{"protocol":"vmc","port":0}])" + more + R"(}
{"do":"record","take":"show","action":"stop"}
{"do":"write-mesh","path":"live.obj"}
{"do":"play","take":"show","time":1.0}
{"do":"write-mesh","path":"live_second.obj"}
)";
}

}  // namespace

TEST_CASE("live: senders on this machine move a handle by its address and by a mapping; what was recorded is replayed to the same bytes") {
    makeEgg();
    writeFile("live.jsonl", live(R"(,"record":"raw.input")"));
    const Run run = performed("run live.jsonl",
                              "python3 \"$senders/face.py\" $vmc 2 &\nface=$!\npython3 \"$senders/wave.py\" $osc 2 /imomushi/handle/top/position 0.3 0.1 1.6 0 0 0.2\npython3 \"$senders/names.py\" $osc >names\n"
                              "printf 'no osc at all' >/dev/udp/127.0.0.1/$osc; python3 -c 'import socket, sys; socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(bytes(9000), (\"127.0.0.1\", int(sys.argv[1])))' $osc\n"
                              "wait $face; sleep 0.2; kill -INT $program");
    INFO(run.out << run.err);
    REQUIRE(run.status == 0);
    REQUIRE(run.answers.size() == 7);
    const Json& answer = run.answers[2];
    CHECK(answer["frames"].get<int>() > 120);
    REQUIRE(answer["sources"].size() == 2);
    // As many as a sender sends in two seconds, or at least half of them where the machine is busy.
    CHECK(answer["sources"][0]["values"].get<int>() > 60);
    CHECK(answer["sources"][0]["malformed"] == 1);
    CHECK(answer["too_long"] == 1);
    CHECK(answer["sources"][1]["values"].get<int>() > 300);
    CHECK(answer["sources"][1]["ignored"].get<int>() > 60);
    // x and z come from the address; the mapping, which is before it, has the height.
    const TriangleMesh rest = readObj((folder() / "egg.obj").string()), posed = readObj((folder() / "live.obj").string());
    Eigen::Index top = 0;
    rest.vertices.col(1).maxCoeff(&top);
    const Eigen::RowVector3d moved = posed.vertices.row(top) - rest.vertices.row(top);
    CHECK(moved.x() > 0.19);
    CHECK(moved.x() < 0.41);
    CHECK(moved.y() >= -1e-9);
    CHECK(moved.y() < 0.51);
    CHECK(readFile(folder() / "names").find("/imomushi/handle/top/position 3\n") != std::string::npos);

    const Run again = script(R"({"do":"open","path":"egg.imomushi"}
{"do":"record","take":"show","action":"start"}
{"do":"replay","path":"raw.input"}
{"do":"record","take":"show","action":"stop"}
{"do":"write-mesh","path":"replayed.obj"}
{"do":"play","take":"show","time":1.0}
{"do":"write-mesh","path":"replayed_second.obj"}
{"do":"undo","count":2}
{"do":"list"}
)");
    INFO(again.out);
    REQUIRE(again.status == 0);
    CHECK(again.answers[2]["frames"] == answer["frames"]);
    CHECK(again.answers[2]["sources"] == answer["sources"]);
    CHECK(again.answers[2]["cut"] == false);
    CHECK(readFile(folder() / "replayed.obj") == readFile(folder() / "live.obj"));
    CHECK(readFile(folder() / "replayed_second.obj") == readFile(folder() / "live_second.obj"));
    CHECK(readFile(folder() / "live_second.obj") != readFile(folder() / "live.obj"));
    // A performance and its take are a step each.
    CHECK(again.answers[7]["undone"] == Json::array({"record", "live"}));
    REQUIRE(again.answers[8]["held"].size() == 1);
    CHECK(again.answers[8]["held"][0]["endpoint"] == "foot");
}

TEST_CASE("live: at rest no step is made while nothing comes; its recording is replayed to the same bytes, with the same frames") {
    makeEgg();
    const std::string ends = "{\"do\":\"write-mesh\",\"path\":\"live.obj\"}\n";
    writeFile("live.jsonl", "{\"do\":\"open\",\"path\":\"egg.imomushi\"}\n"
                            "{\"do\":\"map-input\",\"source\":\"osc\",\"channel\":\"/up\",\"target\":\"handle/top/y\",\"out\":[0,0.5],\"silence\":\"rest\",\"after\":3}\n"
                            "{\"do\":\"live\",\"sources\":[{\"protocol\":\"osc\",\"port\":0},{\"protocol\":\"vmc\",\"port\":0}],\"record\":\"raw.input\"}\n" + ends);
    // One packet, silence that ends by itself, ten seconds of nothing, another packet.
    const Run run = performed("run live.jsonl", "up() { python3 -c 'import socket, struct, sys; socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b\"/up\\0,f\\0\\0\" + struct.pack(\">f\", float(sys.argv[2])), (\"127.0.0.1\", int(sys.argv[1])))' $osc $1; }\n"
                                                "up 0.6; sleep 14; up 0.3; sleep 1.5; kill -INT $program");
    INFO(run.out << run.err);
    REQUIRE(run.status == 0);
    REQUIRE(run.answers.size() == 4);
    const Json& answer = run.answers[2];
    const int frames = answer["frames"].get<int>(), rested = answer["rested"].get<int>();
    MESSAGE(frames << " frames, of which no step was made for " << rested);
    CHECK(answer["sources"][0]["values"] == 2);
    // A packet, or silence, moves it for a second or two.
    CHECK(frames - rested >= 60 + 30);
    CHECK(rested >= 60 * 10);
    const TriangleMesh rest = readObj((folder() / "egg.obj").string()), posed = readObj((folder() / "live.obj").string());
    Eigen::Index top = 0;
    rest.vertices.col(1).maxCoeff(&top);
    CHECK(posed.vertices(top, 1) - rest.vertices(top, 1) == doctest::Approx(0.15).epsilon(0.1));
    const Run again = script("{\"do\":\"open\",\"path\":\"egg.imomushi\"}\n"
                             "{\"do\":\"map-input\",\"source\":\"osc\",\"channel\":\"/up\",\"target\":\"handle/top/y\",\"out\":[0,0.5],\"silence\":\"rest\",\"after\":3}\n"
                             "{\"do\":\"replay\",\"path\":\"raw.input\"}\n{\"do\":\"write-mesh\",\"path\":\"replayed.obj\"}\n");
    INFO(again.out);
    REQUIRE(again.status == 0);
    CHECK(again.answers[2]["frames"] == frames);
    CHECK(again.answers[2]["rested"] == rested);
    CHECK(again.answers[2]["sources"] == answer["sources"]);
    CHECK(readFile(folder() / "replayed.obj") == readFile(folder() / "live.obj"));
}

TEST_CASE("live: a cycle runs by one number that is sent, sleeps at 0, and its recording is replayed to the same bytes") {
    makeEgg();
    const std::string cycle = R"({"do":"open","path":"egg.imomushi"}
{"do":"drag","endpoint":"top","to":[0.3,1.5,0]}
{"do":"keep-pose","name":"right"}
{"do":"drag","endpoint":"top","to":[0,1.9,0.2]}
{"do":"keep-pose","name":"up"}
{"do":"drag","endpoint":"top","to":[-0.3,1.5,0]}
{"do":"keep-pose","name":"left"}
{"do":"rest"}
{"do":"add-cycle","name":"sway","poses":["right","up","left"],"seconds":0.8}
)";
    writeFile("live.jsonl", cycle + R"({"do":"live","sources":[{"protocol":"osc","port":0},{"protocol":"vmc","port":0}],"record":"raw.input"}
{"do":"write-mesh","path":"live.obj"}
)");
    const Run run = performed("run live.jsonl", "say() { python3 -c 'import socket, struct, sys; address = sys.argv[2].encode() + b\"\\0\"; address += bytes(-len(address) % 4); socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(address + b\",f\\0\\0\" + struct.pack(\">f\", float(sys.argv[3])), (\"127.0.0.1\", int(sys.argv[1])))' $osc $1 $2; }\n"
                                                "say /imomushi/cycle/sway/amount 1; sleep 3; say /imomushi/cycle/sway/speed -0.5; sleep 1; say /imomushi/cycle/sway/amount 0; sleep 4; say /imomushi/cycle/sway/amount 0.9; sleep 1; kill -INT $program");
    INFO(run.out << run.err);
    REQUIRE(run.status == 0);
    REQUIRE(run.answers.size() == 11);
    const Json& answer = run.answers[9];
    const int frames = answer["frames"].get<int>(), rested = answer["rested"].get<int>();
    MESSAGE(frames << " frames, of which no step was made for " << rested);
    CHECK(answer["sources"][0]["values"] == 4);
    CHECK(frames - rested >= 60 * 4);  // it runs by itself
    CHECK(rested >= 60 * 2);
    const TriangleMesh rest = readObj((folder() / "egg.obj").string()), posed = readObj((folder() / "live.obj").string());
    CHECK((posed.vertices - rest.vertices).cwiseAbs().maxCoeff() > 0.05);

    const Run again = script(cycle + R"({"do":"replay","path":"raw.input"}
{"do":"write-mesh","path":"replayed.obj"}
)");
    INFO(again.out);
    REQUIRE(again.status == 0);
    CHECK(again.answers[9]["frames"] == frames);
    CHECK(again.answers[9]["rested"] == rested);
    CHECK(readFile(folder() / "replayed.obj") == readFile(folder() / "live.obj"));
}

TEST_CASE("live: Ctrl+C ends a performance and leaves a project with a take; the sub-commands are scripts") {
    makeEgg();
    const Run run = performed("live --osc 0 --vmc 0 --record raw.input --take show --save shown.imomushi egg.imomushi",
                              "python3 \"$senders/wave.py\" $osc 1 /imomushi/handle/top/position 0.3 0.1 1.6 0 0 0.2\nkill -INT $program");
    INFO(run.out << run.err);
    REQUIRE(run.status == 0);
    REQUIRE(run.answers.size() == 5);
    CHECK(run.answers[2]["frames"].get<int>() > 30);
    CHECK(run.answers[2]["sources"][0]["values"].get<int>() > 20);
    const Run again = program("replay --take show --save again.imomushi raw.input egg.imomushi");
    CHECK(again.status == 0);
    const auto exported = [](const std::string& project, const std::string& mesh) {
        const Run run = script("{\"do\":\"open\",\"path\":\"" + project + "\"}\n{\"do\":\"play\",\"take\":\"show\",\"time\":0.5}\n{\"do\":\"write-mesh\",\"path\":\"" + mesh + "\"}\n");
        CHECK(run.status == 0);
        return readFile(folder() / mesh);
    };
    CHECK(exported("shown.imomushi", "a.obj") == exported("again.imomushi", "b.obj"));
    CHECK(program("live").status == 2);
    CHECK(program("live --help").status == 0);
    CHECK(program("live --osc x egg.imomushi").status == 2);
    CHECK(program("live --pad").status == 2);
    CHECK(program("replay raw.input").status == 2);
    CHECK(program("replay egg.imomushi egg.imomushi").status == 1);
}

TEST_CASE("live: what cannot be listened to is refused, and nothing listens beyond this machine unless it is asked to") {
    makeEgg();
    const auto code = [](const std::string& sources) {
        const Run run = script("{\"do\":\"open\",\"path\":\"egg.imomushi\"}\n{\"do\":\"live\",\"seconds\":0.05,\"sources\":" + sources + "}\n");
        return codeOf(run.answers.at(1));
    };
    CHECK(code("[]") == "bad-value");
    CHECK(code("[1]") == "bad-type");
    CHECK(code(R"([{"protocol":"osc"}])") == "missing-key");
    CHECK(code(R"([{"protocol":"rtp","port":0}])") == "bad-value");
    CHECK(code(R"([{"protocol":"pad","port":0}])") == "unknown-key");
    CHECK(code(R"([{"protocol":"pad","device":1}])") == "bad-type");
    CHECK(code(R"([{"protocol":"midi","device":"none"}])") == "ok");
    CHECK(code(R"([{"protocol":"osc","device":"x","port":0}])") == "unknown-key");
    CHECK(code(R"([{"protocol":"osc","port":70000}])") == "bad-value");
    CHECK(code(R"([{"protocol":"osc","port":0},{"protocol":"osc","port":0}])") == "bad-value");
    CHECK(code(R"([{"protocol":"osc","port":0,"host":"x"}])") == "unknown-key");
    CHECK(code(R"([{"protocol":"osc","port":0},{"protocol":"osc","port":0,"name":"hands"}])") == "ok");
    CHECK(codeOf(script("{\"do\":\"live\",\"seconds\":0.05,\"sources\":[{\"protocol\":\"osc\",\"port\":0}]}\n").answers.at(0)) == "no-element");
    writeFile("short.jsonl", "{\"do\":\"open\",\"path\":\"egg.imomushi\"}\n{\"do\":\"live\",\"seconds\":1,\"sources\":[{\"protocol\":\"osc\",\"port\":0},{\"protocol\":\"vmc\",\"port\":0}]}\n");
    // The kernel's own table: local addresses of sockets, the low byte of 127.0.0.1 first.
    const Run run = performed("run short.jsonl", "cat /proc/net/udp >table; printf '%04X %04X' $osc $vmc >ports");
    CHECK(run.status == 0);
    const std::string table = readFile(folder() / "table"), ports = readFile(folder() / "ports");
    for (const std::string& port : {ports.substr(0, 4), ports.substr(5, 4)}) {
        CHECK(table.find("0100007F:" + port) != std::string::npos);
        CHECK(table.find("00000000:" + port) == std::string::npos);
    }
}

TEST_CASE("live: a body of the VMC protocol turns the arm of the figure: its bones have the angles that were sent, within a degree") {
    std::string lines = R"({"do":"open","path":")" IMOMUSHI_SOURCE_DIR R"(/assets/samples/figure.imomushi"}
{"do":"disable","effect":"bone-dynamics"}
{"do":"disable","effect":"ground"}
)";
    for (const auto& [sent, bone] : {std::pair("LeftUpperArm", "upper-arm-bone.L"), std::pair("LeftLowerArm", "lower-arm-bone.L")})
        for (int axis = 0; axis < 3; ++axis)
            lines += std::string(R"({"do":"map-input","source":"vmc","channel":"bone/)") + sent + R"(","component":)" + std::to_string(7 + axis) + R"(,"target":"bone/)" + bone + "/turn-" + "xyz"[axis] + R"(","in":[-4,4]})" "\n";
    const std::vector<std::string> ends = {"upper-arm-bone.L/start", "upper-arm-bone.L/end", "lower-arm-bone.L/end"};
    const auto measured = [&] {
        std::string made;
        for (const std::string& end : ends) made += R"({"do":"measure","what":"position","endpoint":")" + end + "\"}\n";
        return made;
    };
    writeFile("arm.jsonl", lines + measured() + R"({"do":"live","sources":[{"protocol":"osc","port":0},{"protocol":"vmc","port":0}]})" "\n" + measured());
    const Run run = performed("run arm.jsonl", "python3 \"$senders/body.py\" $vmc 2 LeftUpperArm 0 -20 30 LeftLowerArm 0 -40 0\nsleep 0.2; kill -INT $program");
    INFO(run.out << run.err);
    REQUIRE(run.status == 0);
    REQUIRE(run.answers.size() == 16);
    const auto at = [&](std::size_t answer) {
        const Json& p = run.answers[answer]["value"];
        return Eigen::Vector3d(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
    };
    const auto turn = [](double x, double y, double z) {
        const Eigen::Vector3d v = Eigen::Vector3d(x, y, z) * (std::numbers::pi / 180.0);
        return Eigen::AngleAxisd(v.norm(), v.normalized()).toRotationMatrix();
    };
    const Eigen::Matrix3d upper = turn(0, -20, 30), lower = upper * turn(0, -40, 0);
    const auto away = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi; };
    CHECK(away(upper * (at(10) - at(9)), at(14) - at(13)) < 1.0);
    CHECK(away(lower * (at(11) - at(10)), at(15) - at(14)) < 1.0);
    CHECK(away(at(10) - at(9), at(14) - at(13)) > 20.0);  // it was elsewhere
}

TEST_CASE("live: a source that is calibrated leaves the character at rest when it says what it said then; its recording is replayed to the same bytes") {
    makeEgg();
    // As the sender says 20 degrees about -y and 30 about z, with which its body leans.
    const Eigen::Vector3d leans = Eigen::Vector3d(0, -20, 30) * (std::numbers::pi / 180.0);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(leans.norm(), leans.normalized()));
    const Json measured = {{"do", "calibrate-source"}, {"source", "vmc"}, {"values", {{"bone/LeftUpperArm", {0, 0, 0, turn.x(), turn.y(), turn.z(), turn.w(), leans.x(), leans.y(), leans.z()}}}}};
    std::string lines = "{\"do\":\"open\",\"path\":\"egg.imomushi\"}\n";
    for (int axis = 0; axis < 3; ++axis)
        lines += R"({"do":"map-input","source":"vmc","channel":"bone/LeftUpperArm","component":)" + std::to_string(7 + axis) + R"(,"target":"handle/top/turn-)" + "xyz"[axis] + R"(","in":[-4,4]})" "\n";
    const std::string body = "python3 \"$senders/body.py\" $vmc 2 LeftUpperArm 0 -20 30\nsleep 0.2; kill -INT $program";
    const auto performs = [&](const std::string& before, const std::string& input, const std::string& mesh) {
        writeFile("live.jsonl", before + R"({"do":"live","sources":[{"protocol":"osc","port":0},{"protocol":"vmc","port":0}],"record":")" + input + "\"}\n{\"do\":\"write-mesh\",\"path\":\"" + mesh + "\"}\n");
        const Run run = performed("run live.jsonl", body);
        INFO(run.out << run.err);
        REQUIRE(run.status == 0);
        return readObj((folder() / mesh).string());
    };
    const TriangleMesh rest = readObj((folder() / "egg.obj").string());
    const auto off = [&](const TriangleMesh& posed) { return (posed.vertices - rest.vertices).cwiseAbs().maxCoeff(); };
    CHECK(off(performs(lines, "plain.input", "plain.obj")) > 0.05);
    lines += measured.dump() + "\n";
    CHECK(off(performs(lines, "raw.input", "live.obj")) < 1e-3);
    // From the project, too, which has it.
    const Run again = script(lines + R"({"do":"save","path":"calibrated.imomushi"}
{"do":"replay","path":"raw.input"}
{"do":"write-mesh","path":"replayed.obj"}
{"do":"open","path":"calibrated.imomushi"}
{"do":"replay","path":"plain.input"}
{"do":"replay","path":"raw.input"}
{"do":"write-mesh","path":"opened.obj"}
)");
    INFO(again.out);
    REQUIRE(again.status == 0);
    CHECK(readFile(folder() / "replayed.obj") == readFile(folder() / "live.obj"));
    CHECK(off(readObj((folder() / "opened.obj").string())) < 1e-3);
}

TEST_CASE("live: a recording of a program that was killed is whole but for its last second") {
    makeEgg();
    const Run run = performed("live --osc 0 --vmc 0 --record killed.input egg.imomushi",
                              "python3 \"$senders/wave.py\" $osc 4 /imomushi/handle/top/position 0.3 0.1 1.6 0 0 0.2\nkill -9 $program");
    CHECK(run.status != 0);
    const Run replayed = script(R"({"do":"open","path":"egg.imomushi"}
{"do":"replay","path":"killed.input"}
{"do":"measure","what":"position","endpoint":"top"}
)");
    INFO(replayed.out);
    REQUIRE(replayed.status == 0);
    // Four seconds less one, and less what a busy machine leaves out.
    CHECK(replayed.answers[1]["frames"].get<int>() >= 120);
    CHECK(replayed.answers[1]["sources"][0]["values"].get<int>() >= 60);
    CHECK(std::abs(replayed.answers[2]["value"][0].get<double>() - 0.3) < 0.1 + 1e-9);
}

TEST_CASE("live: a game controller that is not there is no error, and one that nothing is mapped to is not opened") {
    makeEgg();
    const Run unmapped = script("{\"do\":\"open\",\"path\":\"egg.imomushi\"}\n{\"do\":\"live\",\"seconds\":0.05,\"sources\":[{\"protocol\":\"pad\"}]}\n");
    CHECK(unmapped.status == 0);
    CHECK(unmapped.err.find("Nothing is mapped to pad") != std::string::npos);
    const Run run = script(R"({"do":"open","path":"egg.imomushi"}
{"do":"map-input","source":"hands","channel":"left-y","target":"handle/top/y","in":[-1,1]}
{"do":"live","seconds":0.1,"sources":[{"protocol":"pad","device":"No such pad","name":"hands"}]}
)");
    REQUIRE(run.status == 0);
    CHECK(run.err.find("Listening to hands on No such pad") != std::string::npos);
    CHECK(run.answers[2]["devices"]["hands"] == "");
    CHECK(run.answers[2]["sources"][0]["packets"] == 0);
}

TEST_CASE("live: the keyboard is not heard without a window, and that is said") {
    makeEgg();
    const Run run = script(R"({"do":"open","path":"egg.imomushi"}
{"do":"map-input","source":"keys","channel":"space","target":"handle/top/y"}
{"do":"live","seconds":0.05,"sources":[{"protocol":"keys"}]}
)");
    CHECK(run.status == 0);
    CHECK(run.err.find("keys is not heard") != std::string::npos);
}

TEST_CASE("live: another program that listens is told where handles are, each step and while all stands still; an address that is none is refused") {
    makeEgg();
    auto port = UdpPort::listen(0);
    REQUIRE(port);
    const Run run = performed("live --osc 0 --vmc 0 --seconds 1.5 --send osc=" + std::to_string(port->port()) + " egg.imomushi", "python3 \"$senders/wave.py\" $osc 0.5 /imomushi/handle/top/position 0.3 0.1 1.6 0 0 0.2");
    INFO(run.out << run.err);
    REQUIRE(run.status == 0);
    const Json& answer = run.answers.back();
    CHECK(answer["sent"]["lost"] == 0);
    const auto decoder = makeInputDecoder(InputProtocol::Osc, "osc");
    std::array<std::byte, 65536> room{};
    std::optional<Vec3> first, last;
    int packets = 0;
    while (const auto size = port->take(room)) {
        ++packets;
        decoder->decode(std::span(room).first(*size), 0, [&](const InputValue& value) {
            if (value.channel.text() != "/imomushi/handle/top/position") return;
            last = Vec3(value.numbers[0], value.numbers[1], value.numbers[2]);
            if (!first) first = last;
        });
    }
    CHECK(packets == answer["sent"]["packets"].get<int>());
    CHECK(decoder->counts().malformed == 0);
    REQUIRE(first);
    CHECK((*last - *first).norm() > 0.1);  // from rest to where it was led
    const Run refused = script(R"({"do":"open","path":"egg.imomushi"}
{"do":"live","sources":[{"protocol":"osc","port":0}],"seconds":1,"send":[{"protocol":"vmc","host":"stage","port":9000}]}
)");
    CHECK(refused.status != 0);
    CHECK(refused.answers.back()["error"]["code"] == "no-address");
}

TEST_CASE("live: there are mappings of a pad for each sample, and all that they drive is there") {
    for (const std::string name : {"caterpillar", "octopus", "figure", "dragon"}) {
        CAPTURE(name);
        const std::string assets = IMOMUSHI_SOURCE_DIR "/assets/";
        const Run run = script("{\"do\":\"open\",\"path\":\"" + assets + "samples/" + name + ".imomushi\"}\n{\"do\":\"load-mappings\",\"path\":\"" + assets + "live/pads/" + name + ".json\"}\n");
        REQUIRE(run.status == 0);
        CHECK(run.answers[1]["loaded"].get<int>() >= 5);
        CHECK(run.answers[1]["missing"] == Json::array());
    }
}

TEST_CASE("live: a pad, keys and a body are mapped to the limbs of each sample: what reaches farthest to both sides and to the front, then what is highest; a figure's bones by their names") {
    const std::string assets = IMOMUSHI_SOURCE_DIR "/assets/samples/";
    // Of both sticks of the pad, of the third one of the keys, and of the left upper arm and the head of who performs.
    struct Expected {
        std::string sample, left, right, third, arm, head;
    };
    for (const Expected& is : {Expected{"caterpillar", "bone/head-bone/end", "", "", "", "bone/head-bone"}, Expected{"octopus", "bone/arm7-tip-bone/end", "bone/arm2-tip-bone/end", "bone/arm1-tip-bone/end", "bone/arm2-root-bone", "bone/arm1-tip-bone"},
                               Expected{"figure", "bone/hand-bone.R/end", "bone/hand-bone.L/end", "bone/head-bone/end", "bone/upper-arm-bone.L", "bone/head-bone"},
                               Expected{"dragon", "bone/arm.R/end", "bone/arm.L/end", "bone/head/end", "bone/arm.L", "bone/head"}}) {
        CAPTURE(is.sample);
        const Run run = script("{\"do\":\"open\",\"path\":\"" + assets + is.sample + ".imomushi\"}\n{\"do\":\"suggest-mappings\",\"protocol\":\"pad\"}\n{\"do\":\"suggest-mappings\",\"protocol\":\"keys\"}\n{\"do\":\"suggest-mappings\",\"protocol\":\"vmc\"}\n{\"do\":\"suggest-mappings\",\"protocol\":\"pad\"}\n");
        REQUIRE(run.status == 0);
        const auto target = [&](std::size_t answer, const std::string& channel, int component) {
            for (const Json& row : run.answers[answer]["rows"])
                if (row["channel"] == channel && row["component"] == component) return row["target"].get<std::string>();
            return std::string();
        };
        const auto of = [](const std::string& end, const char* number) { return end.empty() ? end : end + number; };
        CHECK(target(1, "left-x", 0) == of(is.left, "/x"));
        CHECK(target(1, "left-y", 0) == of(is.left, "/y"));
        CHECK(target(1, "right-x", 0) == of(is.right, "/x"));
        CHECK(target(1, "back", 0) == "trigger/let-go");
        CHECK(target(2, "wasd", 0) == of(is.left, "/x"));
        CHECK(target(2, "arrows", 1) == of(is.right, "/y"));
        CHECK(target(2, "ijkl", 1) == of(is.third, "/y"));
        CHECK(target(3, "bone/LeftUpperArm", 7) == of(is.arm, "/turn-x"));
        CHECK(target(3, "bone/Head", 8) == of(is.head, "/turn-y"));
        for (const Json& row : run.answers[3]["rows"])
            if (row["target"].get<std::string>().find("/turn-") != std::string::npos) CHECK(row["in"] == row["out"]);  // radians stay radians
        // Asked again, they are in the place of those from before.
        CHECK(run.answers[4]["mappings"] == run.answers[3]["mappings"]);
    }
}
