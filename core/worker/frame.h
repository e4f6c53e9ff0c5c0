// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Of this room and its tests: what a program and its worker say to each other over one socket. A frame is 4 bytes "imo1", uint32 kind, uint64 length of the content, content.
// Besides they share kBoard bytes of memory, which outlive the worker: there stands what it tries, up to a 0; nothing: nothing that may break.
namespace imomushi::worker {

enum class FrameKind : std::uint32_t {
    Keep = 1,  ///< to the worker: a key, and the bytes to keep under it
    Forget,    ///< to the worker: a key
    Request,   ///< to the worker: the name of an operation, steps to leave out, arguments
    Progress,  ///< from the worker: a stage and a fraction
    Answer,    ///< from the worker, to each request: the bytes
    NoMemory,  ///< from the worker, instead of an answer
};
inline constexpr std::size_t kFrameHeader = 16;
inline constexpr std::size_t kBoard = 4096;

std::string frameHeader(FrameKind kind, std::uint64_t length);
/// False: no frame begins so.
bool parseFrameHeader(std::string_view header, FrameKind& kind, std::uint64_t& length);

/// Where an argument of a request is: a kept one, or the bytes themselves.
struct RequestArgument {
    std::uint64_t high = 0, low = 0;  ///< of the key, 0: inline
    std::vector<char> bytes;
};
struct Request {
    std::string operation;
    std::vector<std::string> leftOut;
    std::vector<RequestArgument> arguments;
};
void members(auto& archive, RequestArgument& a) { archive(a.high, a.low, a.bytes); }
void members(auto& archive, Request& r) { archive(r.operation, r.leftOut, r.arguments); }

/// Set in a worker's environment: a worker never starts another one.
inline constexpr const char* kWorkerMark = "IMOMUSHI_WORKER";

}  // namespace imomushi::worker
