// SPDX-License-Identifier: GPL-3.0-or-later
// An import worker that does what no worker should, by the name of the file it is asked for.
#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "core/io/message.h"

using namespace imomushi;

namespace {

void say(const std::string& bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
        const ssize_t n = ::write(STDOUT_FILENO, bytes.data() + at, bytes.size() - at);
        if (n <= 0) std::_Exit(1);
        at += static_cast<std::size_t>(n);
    }
}

}  // namespace

int main() {
    char buffer[65536];
    const ssize_t got = ::read(STDIN_FILENO, buffer, sizeof buffer);
    if (got < static_cast<ssize_t>(kFrameHeader)) return 1;
    const auto request = decodeRequest({buffer + kFrameHeader, static_cast<std::size_t>(got) - kFrameHeader});
    const std::string how = request ? request->path.stem().string() : "";
    if (how == "crash") std::raise(SIGSEGV);
    if (how == "abort") std::abort();
    if (how == "quit") return 0;
    if (how == "hang") ::sleep(1000);
    if (how == "mute") {  // closes its connection and lives on
        ::close(STDIN_FILENO);
        ::close(STDOUT_FILENO);
        ::sleep(1000);
    }
    if (how == "burn")
        for (std::uint64_t i = 1; i != 0; i += 2) ::getppid();
    if (how == "memory") {
        std::vector<char*> all;
        for (;;) {
            char* p = static_cast<char*>(std::malloc(1 << 24));
            if (!p) std::abort();
            std::memset(p, 1, 1 << 24);
            all.push_back(p);
        }
    }
    if (how == "garbage") say("this is not what a worker should ever say to anybody");
    if (how == "long") say(frame(FrameKind::Answer, "x").replace(8, 8, 8, '\xff'));
    if (how == "huge") {  // announces more than it sends
        std::string header = frame(FrameKind::Answer, "");
        const std::uint64_t length = std::uint64_t{3} << 30;
        std::memcpy(header.data() + 8, &length, sizeof length);
        say(header + "and then nothing");
    }
    if (how == "descriptors") {  // which are open besides 0, 1 and 2?
        for (int fd = 3; fd < 64; ++fd)
            if (::fcntl(fd, F_GETFD) != -1) return 1;
        say(frame(FrameKind::Answer, encodeAnswer(fail("test", "all closed"))));
    }
    if (how == "lie") {  // an answer with an index that is out of range
        ImportResult result;
        result.format = "obj";
        ImportedBody body;
        body.name = "lie";
        body.mesh.body.vertices = Points::Zero(3, 3);
        body.mesh.body.triangles = Triangles::Constant(1, 3, 7);
        result.bodies.push_back(body);
        say(frame(FrameKind::Answer, encodeAnswer(result)));
    }
    if (how == "other") {  // asked for a character, it answers with an element
        ImportResult result;
        result.format = "obj";
        ImportedBody& body = result.bodies.emplace_back();
        body.name = "other";
        body.mesh.body.vertices = Points::Identity(3, 3);
        body.mesh.body.triangles = Triangles::Zero(1, 3);
        body.mesh.body.triangles.row(0) << 0, 1, 2;
        body.mesh.renderMesh.bodyVertex = {0, 1, 2};
        body.mesh.renderMesh.triangles = body.mesh.body.triangles;
        say(frame(FrameKind::Answer, encodeAnswer(result)));
    }
    return 0;
}
