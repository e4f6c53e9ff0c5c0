// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/input/input_decoder.h"

namespace imomushi {

/// Who sent raw input.
struct RawSource {
    std::string name;  ///< at most InputName::kLongest bytes
    InputProtocol protocol = InputProtocol::Osc;
    bool operator==(const RawSource&) const = default;
};

/// Packets as they came, with their times and the step of the performance that took them: whoever plays them does what was done then.
/// File, numbers with their low byte first: "imomushi input 2\n"; seconds of a step (double); number of sources (u8), of each protocol (u8), length (u8) and name; then records. A packet is
/// 'p', source (u8), nanoseconds since the beginning (i64), length (u16) and bytes; 's' ends a step, 'r' and a number (u32) stand for so many steps that were not made, as nothing moved. A file that ends within a record is whole up to its last step.
struct RawInputs {
    static constexpr std::size_t kMostSources = 64;
    std::vector<RawSource> sources;
    double seconds = 1.0 / 60.0;  ///< of a step
    struct Packet {
        std::uint8_t source = 0;
        std::int64_t nanoseconds = 0;
        std::size_t step = 0;     ///< ascending
        std::size_t begin = 0, size = 0;  ///< in `bytes`
    };
    std::vector<Packet> packets;
    /// Steps that were not made, before what came for the next one.
    struct Rest {
        std::size_t step = 0, count = 0;  ///< ascending
    };
    std::vector<Rest> rests;
    std::vector<std::byte> bytes;
    std::size_t steps = 0;        ///< with those
    bool cut = false;             ///< the file ended within a step
    [[nodiscard]] std::span<const std::byte> bytesOf(const Packet& packet) const { return std::span(bytes).subspan(packet.begin, packet.size); }

    /// Errors: "file-not-found", "not-readable", "not-raw-input", "input-too-long".
    static Result<RawInputs> read(const std::filesystem::path& path);
};

/// Writes such a file while it goes on: what is older than a second is on the disk, whatever happens to the program.
class RawInputWriter {
public:
    /// Errors: "not-writable".
    static Result<RawInputWriter> begin(const std::filesystem::path& path, const std::vector<RawSource>& sources, double seconds);
    void packet(std::size_t source, std::int64_t nanoseconds, std::span<const std::byte> bytes);
    void endStep();
    /// So many steps are left out.
    void rest(std::size_t steps);
    /// Errors: "not-writable", "disk-full": of anything that was written.
    Result<void> finish();

private:
    struct Closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    void flush();
    std::unique_ptr<std::FILE, Closer> file_;
    std::filesystem::path path_;
    std::size_t steps_ = 0, stepsOfFlush_ = 60;
    int error_ = 0;
};

}  // namespace imomushi
