// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/headless/live_command.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "app/headless/live_performance.h"
#include "core/document/command_support.h"
#include "core/input/devices.h"
#include "core/input/input_listener.h"
#include "core/input/udp_port.h"
#include "core/input/udp_target.h"
#include "core/live/direct_names.h"
#include "core/live/frame_writer.h"

namespace imomushi {

namespace {

using Clock = InputListener::Clock;

constexpr double kLongestLive = 86400.0;  // s
/// Whoever sleeps asks so often whether it is over, s.
constexpr double kLongestSleep = 1.0;

/// Of a source that nobody needs.
class SilentPort final : public InputPort {
public:
    std::optional<std::size_t> take(std::span<std::byte>) override { return std::nullopt; }
};

bool namesSource(const Document& document, const std::string& source) {
    return document.mappings && std::any_of(document.mappings->begin(), document.mappings->end(), [&](const InputMapping& m) { return m.row.source == source; });
}

/// SIGINT and SIGTERM end a performance, and not the program, while one of these lives.
class Interruption {
public:
    Interruption() {
        interrupted_ = false;
        struct sigaction action = {};
        action.sa_handler = [](int) { interrupted_ = true; };
        ::sigaction(SIGINT, &action, &formerInt_);
        ::sigaction(SIGTERM, &action, &formerTerm_);
    }
    ~Interruption() {
        ::sigaction(SIGINT, &formerInt_, nullptr);
        ::sigaction(SIGTERM, &formerTerm_, nullptr);
    }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;
    [[nodiscard]] static bool came() { return interrupted_; }

private:
    static inline std::atomic<bool> interrupted_ = false;
    struct sigaction formerInt_ = {}, formerTerm_ = {};
};

/// That this process has used so far, ms.
double processorMilliseconds() {
    timespec used{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return 1e3 * static_cast<double>(used.tv_sec) + 1e-6 * static_cast<double>(used.tv_nsec);
}

struct Listening {
    std::vector<RawSource> sources;
    std::vector<std::unique_ptr<InputPort>> ports;
};

/// The port of a source, or nobody's where it is a device that drives nothing. Standard error says which.
Result<std::unique_ptr<InputPort>> portFor(const RawSource& source, const Json& given, UdpPort::From from, const Document& document) {
    if (isOfDevices(source.protocol)) {
        if (given.contains("port")) return fail("unknown-key", "A source of devices has no \"port\": it has \"device\".");
        std::string device;
        if (const Json* named = find(given, "device")) {
            if (!named->is_string()) return fail("bad-type", "\"device\" of a source must be a text.");
            device = named->get<std::string>();
        }
        if (!namesSource(document, source.name)) {
            std::cerr << "Nothing is mapped to " << source.name << ": no device is opened for it\n" << std::flush;
            return std::unique_ptr<InputPort>(std::make_unique<SilentPort>());
        }
        auto port = openDevice(source.protocol, device);
        if (!port) {
            std::cerr << source.name << " is not heard: " << port.error().message << "\n" << std::flush;
            return std::unique_ptr<InputPort>(std::make_unique<SilentPort>());
        }
        std::cerr << "Listening to " << source.name << " on " << (device.empty() ? "the first device" : device) << "\n" << std::flush;
        return port;
    }
    if (given.contains("device")) return fail("unknown-key", "A source of other programs has no \"device\": it has \"port\".");
    if (!given.contains("port")) return fail("missing-key", "A source of other programs needs \"protocol\" and \"port\".");
    IMOMUSHI_TRY(const auto port, numberWithin(given["port"], "port", 0, 65535));
    IMOMUSHI_TRY(auto opened, UdpPort::listen(static_cast<std::uint16_t>(port), from));
    std::cerr << "Listening to " << source.name << " on " << (from == UdpPort::From::Loopback ? "127.0.0.1:" : "0.0.0.0:") << opened.port() << "\n" << std::flush;
    return std::unique_ptr<InputPort>(std::make_unique<UdpPort>(std::move(opened)));
}

Result<Listening> listen(const Json& list, UdpPort::From from, const Document& document) {
    Listening made;
    if (list.empty() || list.size() > RawInputs::kMostSources) return fail("bad-value", "\"sources\" must name 1 to " + std::to_string(RawInputs::kMostSources) + " senders.");
    for (const Json& given : list) {
        if (!given.is_object()) return fail("bad-type", "A source is an object: {\"protocol\":\"osc\",\"port\":9000}.");
        for (const auto& [key, value] : given.items())
            if (key != "protocol" && key != "port" && key != "device" && key != "name") return fail("unknown-key", "A source has no \"" + key + "\".");
        const Json* called = find(given, "protocol");
        const auto protocol = called && called->is_string() ? protocolNamed(called->get_ref<const std::string&>()) : std::nullopt;
        if (!protocol) return fail("bad-value", "\"protocol\" of a source is \"osc\", \"vmc\", \"midi\", \"pad\", \"voice\" or \"keys\".");
        RawSource source{std::string(protocolName(*protocol)), *protocol};
        if (const Json* name = find(given, "name")) {
            if (!name->is_string() || name->get_ref<const std::string&>().empty() || !InputName::fits(name->get_ref<const std::string&>())) return fail("bad-value", "\"name\" of a source must be a short text.");
            source.name = name->get<std::string>();
        }
        if (std::any_of(made.sources.begin(), made.sources.end(), [&](const RawSource& s) { return s.name == source.name; }))
            return fail("bad-value", "Two sources are called \"" + source.name + "\": give one another \"name\".");
        IMOMUSHI_TRY(auto port, portFor(source, given, from, document));
        made.sources.push_back(std::move(source));
        made.ports.push_back(std::move(port));
    }
    return made;
}

/// Nobody sees a character that is performed without a window: while one of these lives, its vertices are evaluated where effects need them.
class Unseen {
public:
    explicit Unseen(LiveCharacter& live) : live_(live) { live_.leaveVerticesToOthers(true); }
    ~Unseen() { live_.leaveVerticesToOthers(false); }
    Unseen(const Unseen&) = delete;
    Unseen& operator=(const Unseen&) = delete;

private:
    LiveCharacter& live_;
};

/// Other programs that are told what is shown.
struct Sending {
    std::vector<FrameWriter> writers;
    std::vector<UdpTarget> targets;
    ShownFrame frame;
    std::uint64_t packets = 0, lost = 0;

    void send(const LiveCharacter& live, double time) {
        if (writers.empty()) return;
        showFrame(live, frame);
        for (std::size_t i = 0; i < writers.size(); ++i)
            writers[i].write(frame, time, [&](std::span<const std::byte> packet) {
                ++packets;
                if (!targets[i].send(packet)) ++lost;
            });
    }
};

Result<Sending> sendingTo(const Json& list, SessionAccess& access) {
    Sending made;
    if (list.size() > RawInputs::kMostSources) return fail("bad-value", "\"send\" must name at most " + std::to_string(RawInputs::kMostSources) + " receivers.");
    IMOMUSHI_TRY(const auto alive, access.live.built());
    for (const Json& given : list) {
        if (!alive) break;  // which is said by whoever performs
        if (!given.is_object()) return fail("bad-type", "A receiver is an object: {\"protocol\":\"vmc\",\"host\":\"127.0.0.1\",\"port\":39539}.");
        for (const auto& [key, value] : given.items())
            if (key != "protocol" && key != "host" && key != "port") return fail("unknown-key", "A receiver has no \"" + key + "\".");
        const Json* called = find(given, "protocol");
        const auto protocol = called && called->is_string() ? outputProtocolNamed(called->get_ref<const std::string&>()) : std::nullopt;
        if (!protocol) return fail("bad-value", "\"protocol\" of a receiver is \"vmc\" or \"osc\".");
        const Json host = given.value("host", Json("127.0.0.1"));
        if (!host.is_string() || !given.contains("port")) return fail("missing-key", "A receiver needs \"protocol\" and \"port\", and has \"host\", a text.");
        IMOMUSHI_TRY(const auto port, numberWithin(given["port"], "port", 1, 65535));
        if (port != std::floor(port)) return fail("bad-value", "\"port\" must be a whole number.");
        IMOMUSHI_TRY(auto target, UdpTarget::open(host.get<std::string>(), static_cast<std::uint16_t>(port)));
        made.targets.push_back(std::move(target));
        made.writers.emplace_back(*protocol, access.document(), access.live.plan());
    }
    return made;
}

Result<Json> live(SessionAccess& access, const Json& arguments, const Progress& progress) {
    double longest = kLongestLive;
    if (auto ok = readNumber(arguments, "seconds", 0.0, kLongestLive, longest); !ok) return tl::unexpected(ok.error());
    IMOMUSHI_TRY(auto heard, listen(arguments.at("sources"), arguments.value("open", false) ? UdpPort::From::Anywhere : UdpPort::From::Loopback, access.document()));
    const double stepSeconds = 1.0 / access.document().settings.rate;
    IMOMUSHI_TRY(auto sending, sendingTo(arguments.value("send", Json::array()), access));
    const Unseen unseen(access.live);
    IMOMUSHI_TRY(auto performance, LivePerformance::begin(access, heard.sources, stepSeconds));
    std::optional<RawInputWriter> recording;
    if (const Json* path = find(arguments, "record")) {
        IMOMUSHI_TRY(recording, RawInputWriter::begin(path->get<std::string>(), heard.sources, stepSeconds));
    }
    const Interruption interruption;
    const Clock::time_point start = Clock::now();
    const auto stepTime = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(stepSeconds));
    Clock::time_point until = start;
    InputListener listener(std::move(heard.ports));
    std::vector<double> milliseconds, processor, latency;  // of each step, by the clock and of processors; from its first packet until it was made
    std::uint64_t tooLong = 0, late = 0;
    const auto frames = static_cast<std::size_t>(longest / stepSeconds + 0.5);
    const auto since = [](Clock::time_point from, Clock::time_point to) { return std::chrono::duration<double, std::milli>(to - from).count(); };
    const auto failed = [&](const Error& error) {
        performance.cancel();
        return tl::unexpected(error);
    };
    std::optional<Clock::time_point> first;
    const auto heardSome = [&](std::size_t i, std::int64_t nanoseconds, std::span<const std::byte> packet) {
        if (!first) first = start + std::chrono::nanoseconds(nanoseconds);
        if (recording) recording->packet(i, nanoseconds, packet);
        performance.take(i, nanoseconds, packet, [&] { listener.answerList(i, [&] { return nameMessages(access.document()); }); });
    };
    // Sleeps where no step would change anything, until something comes. False: nothing has, and it may sleep on.
    const auto sleep = [&] {
        const std::size_t most = std::min({performance.restingSteps(), frames - performance.steps(), static_cast<std::size_t>(std::ceil(kLongestSleep / stepSeconds))});
        if (most == 0) return true;
        const auto rest = [&](std::size_t steps) {
            if (steps == 0) return;
            performance.rest(steps);
            if (recording) recording->rest(steps);
            until += static_cast<Clock::duration::rep>(steps) * stepTime;
        };
        bool woken = false;
        listener.hear(start, until + static_cast<Clock::duration::rep>(most) * stepTime, [&] { return woken || Interruption::came(); }, [&](std::size_t i, std::int64_t nanoseconds, std::span<const std::byte> packet) {
            // The step that takes it is the next one in time with those before.
            if (!std::exchange(woken, true)) rest(std::min(most, static_cast<std::size_t>(std::max<Clock::duration::rep>(0, (Clock::now() - until) / stepTime))));
            heardSome(i, nanoseconds, packet);
        });
        if (!woken && !Interruption::came()) rest(most);
        return woken;
    };
    while (performance.steps() < frames && !Interruption::came() && !progress.cancelled()) {
        first.reset();
        if (!sleep()) {
            sending.send(access.live, static_cast<double>(performance.steps()) * stepSeconds);  // so that receivers know that somebody is there
            continue;
        }
        until += stepTime;
        if (const auto now = Clock::now(); now > until + stepTime) {
            ++late;
            until = now;
        }
        listener.hear(start, until, Interruption::came, heardSome);
        const Clock::time_point began = Clock::now();
        const double used = processorMilliseconds();
        if (auto stepped = performance.step(progress); !stepped) return failed(stepped.error());
        processor.push_back(processorMilliseconds() - used);
        if (recording) recording->endStep();
        const Clock::time_point made = Clock::now();
        milliseconds.push_back(since(began, made));
        if (first) latency.push_back(since(*first, made));
        if (const double felt = access.live.landing(); felt > 0.0)
            for (const auto& port : listener.ports()) port->shake(felt);
        sending.send(access.live, static_cast<double>(performance.steps()) * stepSeconds);
    }
    auto answer = performance.end(progress);
    if (!answer) return failed(answer.error());
    if (recording)
        if (auto whole = recording->finish(); !whole) (*answer)["not_recorded"] = whole.error().message;
    for (std::size_t i = 0; i < listener.ports().size(); ++i) {
        tooLong += listener.tooLong(i);
        if (isOfDevices(heard.sources[i].protocol)) (*answer)["devices"][heard.sources[i].name] = listener.ports()[i]->device();
    }
    if (!sending.writers.empty()) (*answer)["sent"] = {{"packets", sending.packets}, {"lost", sending.lost}};
    (*answer)["too_long"] = tooLong;
    (*answer)["late"] = late;
    (*answer)["ms_per_step"] = summary(std::move(milliseconds));
    (*answer)["processor_ms_per_step"] = summary(std::move(processor));
    (*answer)["latency_ms"] = summary(std::move(latency));
    return answer;
}

Result<Json> replay(SessionAccess& access, const Json& arguments, const Progress& progress) {
    IMOMUSHI_TRY(const auto path, pathFrom(arguments));
    IMOMUSHI_TRY(const auto inputs, RawInputs::read(path));
    const Unseen unseen(access.live);
    IMOMUSHI_TRY(auto performance, LivePerformance::begin(access, inputs.sources, inputs.seconds));
    const auto failed = [&](const Error& error) {
        performance.cancel();
        return tl::unexpected(error);
    };
    auto packet = inputs.packets.begin();
    auto rest = inputs.rests.begin();
    while (performance.steps() < inputs.steps) {
        if (progress.cancelled()) return failed({kCancelled, "Replaying was cancelled."});
        if (rest != inputs.rests.end() && rest->step == performance.steps()) {
            performance.rest(rest++->count);
            continue;
        }
        for (; packet != inputs.packets.end() && packet->step == performance.steps(); ++packet) performance.take(packet->source, packet->nanoseconds, inputs.bytesOf(*packet));
        if (auto stepped = performance.step(progress); !stepped) return failed(stepped.error());
    }
    auto answer = performance.end(progress);
    if (!answer) return failed(answer.error());
    (*answer)["cut"] = inputs.cut;
    return answer;
}

}  // namespace

void addLiveCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("live",
                       "Performs the character by what devices and other programs say, at its rate (60 steps a second unless set), by its mappings (map-input) and by OSC addresses that everything has: \"/imomushi/handle/NAME/position\" x y z (metres), "
                       "\"/imomushi/handle/NAME/turn\" x y z (radians), \"/imomushi/bone/NAME/end/position\", \"/imomushi/bone/NAME/end/roll\", \"/imomushi/morph/CHARACTER/NAME\", \"/imomushi/pose/NAME\", \"/imomushi/cycle/NAME/amount\" and \"/imomushi/cycle/NAME/speed\", \"/imomushi/effect/NAME/PROPERTY\" of effects that are on; \"/imomushi/list\" is answered by all of them. "
                       "What is moved is held from then on. It ends after its seconds, or when the program is interrupted (Ctrl+C), which ends nothing else.",
                       {{"sources", Type::Array, true, "Who is listened to: objects {\"protocol\":\"osc\" or \"vmc\",\"port\":9000,\"name\":as mappings call it (its protocol)}; port 0 is any that is free, standard error tells it. Or {\"protocol\":\"pad\", \"midi\" or \"voice\",\"device\":its name, of a game controller also its number (the first one),\"name\":...}: a game controller, a MIDI device or a microphone, opened where a mapping names its source, plugged in and out at any time."},
                        {"seconds", Type::Number, false, "How long, up to a day (until it is interrupted)."},
                        {"open", Type::Boolean, false, "Other machines may send, too (false: programs of this machine alone)."},
                        {"record", Type::Text, false, "A file for all that comes in, with its times, for replay."},
                        {"send", Type::Array, false, "Other programs that are told each step: objects {\"protocol\":\"vmc\" or \"osc\",\"host\":its address (127.0.0.1),\"port\":39539}. By VMC: bones with roles of a human, handles as trackers, expressions and morph targets. By OSC: places and rolls of ends of bones, places and turns of handles and weights of morph targets, by the addresses above, so that another imomushi that listens moves alike."}},
                       live);
    registry.addAction("replay", "Performs the character by a recording of \"live\", as fast as it can: what was begun alike ends in the same bytes. \"cut\": the recording ended within a step.",
                       {{"path", Type::Text, true, "A file that live recorded."}}, replay);
}

}  // namespace imomushi
