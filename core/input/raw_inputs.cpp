// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/raw_inputs.h"

#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/base/atomic_file.h"
#include "core/base/utf8.h"

namespace imomushi {

namespace {

constexpr std::string_view kFirst = "imomushi input 2\n";
constexpr std::size_t kMostBytes = std::size_t{2} << 30;  // of a file: hours of two senders
constexpr std::size_t kMostSteps = 10'000'000;            // as the command "step" makes at once
constexpr double kLongestStep = 10.0;                     // s
constexpr char kPacket = 'p', kStepEnds = 's', kRests = 'r';

/// `bytes` of an integer, low byte first.
template <int bytes>
std::array<char, bytes> lowFirst(std::uint64_t value) {
    std::array<char, bytes> made;
    for (char& c : made) c = static_cast<char>(value & 0xFF), value >>= 8;
    return made;
}

/// Reads from the front. ok is false from where it ended too early.
struct RawReader {
    std::span<const std::byte> left;
    bool ok = true;
    std::span<const std::byte> take(std::size_t count) {
        ok = ok && left.size() >= count;
        if (!ok) return {};
        const auto taken = left.first(count);
        left = left.subspan(count);
        return taken;
    }
    std::uint64_t number(std::size_t bytes) {
        std::uint64_t value = 0;
        int shift = 0;
        for (const std::byte b : take(bytes)) value |= std::to_integer<std::uint64_t>(b) << shift, shift += 8;
        return value;
    }
};

}  // namespace

Result<RawInputs> RawInputs::read(const std::filesystem::path& path) {
    const std::string name = "\"" + path.string() + "\"";
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return fail("file-not-found", "There is no file " + name + ": check its path.");
    const auto size = std::filesystem::is_regular_file(path, error) ? std::filesystem::file_size(path, error) : 0;
    if (error) return fail("not-readable", name + " cannot be read: check its permissions.");
    if (size > kMostBytes) return fail("input-too-long", name + " is larger than 2 GB: record shorter parts.");
    RawInputs made;
    made.bytes.resize(size);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), [](std::FILE* f) { return f ? std::fclose(f) : 0; });
    if (!file || std::fread(made.bytes.data(), 1, made.bytes.size(), file.get()) != made.bytes.size()) return fail("not-readable", name + " cannot be read: check its permissions.");
    const auto refuse = [&](const char* why) { return fail("not-raw-input", name + " is no recording of live input (" + why + "): choose one that \"live\" made."); };
    const auto tooLong = [&] { return fail("input-too-long", name + " has more than ten million steps: record shorter parts."); };
    RawReader in{made.bytes};
    const auto first = in.take(kFirst.size());
    if (!in.ok || std::memcmp(first.data(), kFirst.data(), kFirst.size()) != 0) return refuse("its beginning is another one");
    made.seconds = std::bit_cast<double>(in.number(8));
    if (!in.ok || !(made.seconds > 0.0 && made.seconds <= kLongestStep)) return refuse("its steps have no length");
    const std::size_t sources = in.number(1);
    if (!in.ok || sources > kMostSources) return refuse("it has too many sources");
    for (std::size_t i = 0; i < sources; ++i) {
        const std::size_t protocol = in.number(1), length = in.number(1);
        const auto text = in.take(length);
        const std::string_view called(reinterpret_cast<const char*>(text.data()), text.size());
        if (!in.ok || protocol >= kInputProtocols || called.empty() || !InputName::fits(called) || !isUtf8(called)) return refuse("a source is broken");
        made.sources.push_back({std::string(called), static_cast<InputProtocol>(protocol)});
    }
    while (!in.left.empty()) {
        const auto kind = static_cast<char>(in.number(1));
        if (kind == kStepEnds) {
            if (++made.steps > kMostSteps) return tooLong();
            continue;
        }
        if (kind == kRests) {
            const Rest rest{made.steps, in.number(4)};
            if (!in.ok) break;
            // What came before it belongs to a step.
            if (rest.count == 0 || (!made.packets.empty() && made.packets.back().step == made.steps)) return refuse("a rest is broken");
            made.rests.push_back(rest);
            made.steps += rest.count;
            if (made.steps > kMostSteps) return tooLong();
            continue;
        }
        if (kind != kPacket) return refuse("a record is broken");
        Packet packet;
        packet.source = static_cast<std::uint8_t>(in.number(1));
        packet.nanoseconds = static_cast<std::int64_t>(in.number(8));
        packet.size = in.number(2);
        const auto content = in.take(packet.size);
        if (!in.ok) break;
        if (packet.source >= made.sources.size() || packet.nanoseconds < 0) return refuse("a packet is broken");
        packet.step = made.steps;
        packet.begin = static_cast<std::size_t>(content.data() - made.bytes.data());
        made.packets.push_back(packet);
    }
    // What no step took did nothing.
    while (!made.packets.empty() && made.packets.back().step == made.steps) {
        made.packets.pop_back();
        made.cut = true;
    }
    made.cut = made.cut || !in.ok;
    return made;
}

Result<RawInputWriter> RawInputWriter::begin(const std::filesystem::path& path, const std::vector<RawSource>& sources, double seconds) {
    RawInputWriter made;
    made.path_ = path;
    made.stepsOfFlush_ = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(1.0 / seconds)));
    made.file_.reset(std::fopen(path.c_str(), "wb"));
    if (!made.file_) return fail("not-writable", "\"" + path.string() + "\" cannot be written (" + std::strerror(errno) + "): choose another place.");
    std::string head(kFirst);
    const auto bits = lowFirst<8>(std::bit_cast<std::uint64_t>(seconds));
    head.append(bits.data(), bits.size());
    head += static_cast<char>(sources.size());
    for (const RawSource& source : sources) {
        head += static_cast<char>(source.protocol);
        head += static_cast<char>(source.name.size());
        head += source.name;
    }
    if (std::fwrite(head.data(), 1, head.size(), made.file_.get()) != head.size()) made.error_ = errno;
    made.flush();
    return made;
}

void RawInputWriter::packet(std::size_t source, std::int64_t nanoseconds, std::span<const std::byte> bytes) {
    std::array<char, 12> head{};
    head[0] = kPacket;
    head[1] = static_cast<char>(source);
    std::ranges::copy(lowFirst<8>(static_cast<std::uint64_t>(nanoseconds)), head.begin() + 2);
    std::ranges::copy(lowFirst<2>(bytes.size()), head.begin() + 10);
    if (std::fwrite(head.data(), 1, head.size(), file_.get()) != head.size() || std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) error_ = errno;
}

void RawInputWriter::endStep() {
    if (std::fputc(kStepEnds, file_.get()) == EOF) error_ = errno;
    if (++steps_ % stepsOfFlush_ == 0) flush();
}

void RawInputWriter::rest(std::size_t steps) {
    std::array<char, 5> record{};
    record[0] = kRests;
    std::ranges::copy(lowFirst<4>(steps), record.begin() + 1);
    if (std::fwrite(record.data(), 1, record.size(), file_.get()) != record.size()) error_ = errno;
    flush();
}

void RawInputWriter::flush() {
    if (std::fflush(file_.get()) != 0) error_ = errno;
}

Result<void> RawInputWriter::finish() {
    flush();
    if (file_ && error_ == 0 && ::fsync(::fileno(file_.get())) != 0 && errno != EINVAL) error_ = errno;
    file_.reset();
    if (error_ == 0) return {};
    if (isDiskFull(error_)) return failDiskFull(path_);
    return fail("not-writable", "\"" + path_.string() + "\" could not be written (" + std::strerror(error_) + "): the recording is not whole.");
}

}  // namespace imomushi
