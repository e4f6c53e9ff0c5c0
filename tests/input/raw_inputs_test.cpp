// SPDX-License-Identifier: GPL-3.0-or-later
#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <iterator>
#include <random>

#include "core/input/raw_inputs.h"
#include "core/input/udp_port.h"
#include "tests/support/osc_bytes.h"
#include "tests/support/folder.h"

using namespace imomushi;

namespace {

std::string bytesOfFile(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void write(const std::filesystem::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

}  // namespace

TEST_CASE("raw inputs: what was written is read, with its steps; a file that was cut anywhere is whole up to its last step") {
    const TestFolder folder("raw-inputs");
    const auto path = folder / "raw";
    {
        auto writer = RawInputWriter::begin(path, {{"face", InputProtocol::Vmc}, {"knobs", InputProtocol::Midi}, {"keys", InputProtocol::Keys}}, 1.0 / 60.0);
        REQUIRE(writer);
        for (int step = 0; step < 10; ++step) {
            for (int p = 0; p < step % 3; ++p) writer->packet(static_cast<std::size_t>(p), 1000 * step + p, asBytes(std::string(static_cast<std::size_t>(step), 'x')));
            writer->endStep();
            if (step == 3) writer->rest(600);
        }
        REQUIRE(writer->finish());
    }
    const auto read = RawInputs::read(path);
    REQUIRE(read);
    CHECK(read->sources == std::vector<RawSource>{{"face", InputProtocol::Vmc}, {"knobs", InputProtocol::Midi}, {"keys", InputProtocol::Keys}});
    CHECK(read->steps == 610);
    REQUIRE(read->rests.size() == 1);
    CHECK(read->rests[0].step == 4);
    CHECK(read->rests[0].count == 600);
    CHECK(read->packets.size() == 9);
    CHECK(!read->cut);
    CHECK(read->packets.back().step == 608);
    CHECK(read->packets.back().nanoseconds == 8001);
    CHECK(read->bytesOf(read->packets.back()).size() == 8);
    const std::string whole = bytesOfFile(path);
    std::size_t before = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
        write(path, whole.substr(0, size));
        const auto part = RawInputs::read(path);
        if (!part) {
            CHECK(part.error().code == "not-raw-input");
            CHECK(before == 0);
            continue;
        }
        CHECK(part->steps >= before);
        before = part->steps;
        for (const auto& packet : part->packets) CHECK(packet.step < part->steps);
    }
    CHECK(before == 609);
}

TEST_CASE("raw inputs: of 20,000 files with bytes changed none is read beyond its end, and what is no recording says so") {
    const TestFolder folder("raw-inputs changed");
    const auto path = folder / "raw";
    CHECK(RawInputs::read(path).error().code == "file-not-found");
    {
        auto writer = RawInputWriter::begin(path, {{"face", InputProtocol::Vmc}}, 1.0 / 60.0);
        for (int step = 0; step < 5; ++step) writer->packet(0, step, asBytes("1234")), writer->endStep();
        REQUIRE(writer->finish());
    }
    const std::string whole = bytesOfFile(path);
    std::mt19937 random(7);
    int refused = 0;
    for (int i = 0; i < 20'000; ++i) {
        std::string changed = whole;
        for (unsigned k = 1 + random() % 3; k > 0; --k) changed[random() % changed.size()] = static_cast<char>(random());
        write(path, changed);
        const auto read = RawInputs::read(path);
        if (!read) {
            ++refused;
            continue;
        }
        for (const auto& packet : read->packets) CHECK((packet.source < read->sources.size() && packet.begin + packet.size <= read->bytes.size() && packet.step < read->steps));
    }
    CHECK(refused > 1000);
}

TEST_CASE("udp: a port is of this machine alone unless asked, one at a time, and a datagram that is too long says so") {
    auto listened = UdpPort::listen(0);
    REQUIRE(listened);
    const std::vector<std::unique_ptr<InputPort>> ports = [&] {
        std::vector<std::unique_ptr<InputPort>> one;
        one.push_back(std::make_unique<UdpPort>(std::move(*listened)));
        return one;
    }();
    auto* port = static_cast<UdpPort*>(ports[0].get());
    CHECK(port->port() > 0);
    CHECK(UdpPort::listen(port->port()).error().code == "port-taken");
    std::array<std::byte, 16> room{};
    CHECK(!port->take(room));
    const int sender = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port->port());
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (const std::size_t size : {room.size(), 2 * room.size()}) {
        const std::string datagram(size, 'x');
        REQUIRE(::sendto(sender, datagram.data(), size, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to) == static_cast<ssize_t>(size));
        InputPort::wait(ports, std::chrono::steady_clock::now() + std::chrono::seconds(60));
        CHECK(port->take(room) == size);
    }
    ::close(sender);
    // How the system lists it: by address and port.
    std::ifstream table("/proc/net/udp");
    const std::string listed{std::istreambuf_iterator<char>(table), {}};
    char wanted[16];
    std::snprintf(wanted, sizeof wanted, "0100007F:%04X", port->port());
    CHECK(listed.find(wanted) != std::string::npos);
    std::snprintf(wanted, sizeof wanted, "00000000:%04X", port->port());
    CHECK(listed.find(wanted) == std::string::npos);
}
