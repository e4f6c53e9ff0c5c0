// SPDX-License-Identifier: GPL-3.0-or-later
#define SDL_MAIN_HANDLED  // this program has a main() of its own
#include "core/input/pad_port.h"

#include <SDL.h>

#include <algorithm>
#include <array>
#include <deque>
#include <mutex>
#include <utility>

#include "core/input/pad_packet.h"
#include "core/input/sdl_parts.h"

namespace imomushi {

static_assert(kPadAxes.size() == SDL_CONTROLLER_AXIS_MAX && kPadButtons.size() == SDL_CONTROLLER_BUTTON_MAX);

namespace {

using Record = std::array<std::byte, PadPacket::kBytes>;
/// What waits of a pad that nobody takes; the rest is lost.
constexpr std::size_t kMostWaiting = 4096;
/// One stick says two numbers: a packet has fewer values than a decoder takes.
constexpr std::size_t kMostRecords = 256;
constexpr Uint32 kShakeMs = 120;

PadId padAt(int index) {
    PadId id;
    std::array<char, 33> guid{};
    SDL_JoystickGetGUIDString(SDL_JoystickGetDeviceGUID(index), guid.data(), static_cast<int>(guid.size()));
    id.guid = guid.data();
    id.vendor = SDL_JoystickGetDeviceVendor(index);
    id.product = SDL_JoystickGetDeviceProduct(index);
    if (const char* name = SDL_GameControllerNameForIndex(index)) id.name = name;
    return id;
}

}  // namespace

struct PadPort::Pad {
    std::string wanted;
    SDL_GameController* controller = nullptr;  // null: none is plugged in
    SDL_JoystickID instance = -1;
    std::string name;
    std::deque<Record> waiting;
    void say(unsigned kind, unsigned control, std::int16_t value) {
        if (waiting.size() < kMostWaiting) waiting.push_back(PadPacket::of(kind, control, value));
    }
};

/// SDL's game controllers, which this program has once, and which any of its threads may ask.
class PadPort::Hub {
public:
    static Result<std::shared_ptr<Hub>> get() {
        static std::weak_ptr<Hub> known;
        const std::lock_guard lock(sdlMutex());
        if (auto hub = known.lock()) return hub;
        // The system's own drivers: SDL's would open pads that nobody asked for.
        SDL_SetHint(SDL_HINT_JOYSTICK_HIDAPI, "0");
        SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");  // it knows no window of ours
        if (auto ok = beginSdlPart(SDL_INIT_GAMECONTROLLER, "Game controllers"); !ok) return tl::unexpected(ok.error());
        auto hub = std::shared_ptr<Hub>(new Hub);
        known = hub;
        return hub;
    }
    ~Hub() {
        const std::lock_guard lock(sdlMutex());
        endSdlPart(SDL_INIT_GAMECONTROLLER);
    }
    Hub(const Hub&) = delete;
    Hub& operator=(const Hub&) = delete;

    std::vector<PadId> plugged() {
        const Locked locked(*this);
        std::vector<PadId> pads;
        for (int i = 0; i < SDL_NumJoysticks(); ++i)
            if (SDL_IsGameController(i)) pads.push_back(padAt(i));
        return pads;
    }
    void add(Pad& pad) {
        const Locked locked(*this);
        pads_.push_back(&pad);
        changed_ = true;
    }
    void remove(Pad& pad) {
        const Locked locked(*this);
        std::erase(pads_, &pad);
        if (pad.controller) SDL_GameControllerClose(pad.controller);
        changed_ = true;  // another port may have it now
    }
    std::optional<std::size_t> take(Pad& pad, std::span<std::byte> room) {
        const Locked locked(*this);
        if (pad.waiting.empty()) pump();
        const std::size_t count = std::min({pad.waiting.size(), room.size() / PadPacket::kBytes, kMostRecords});
        if (count == 0) return std::nullopt;
        for (std::size_t i = 0; i < count; ++i, pad.waiting.pop_front()) std::ranges::copy(pad.waiting.front(), room.begin() + static_cast<std::ptrdiff_t>(i * PadPacket::kBytes));
        return count * PadPacket::kBytes;
    }
    void shake(const Pad& pad, double strength) {
        const Locked locked(*this);
        const auto motor = static_cast<Uint16>(65535.0 * std::clamp(strength, 0.0, 1.0));
        if (pad.controller) (void)SDL_GameControllerRumble(pad.controller, motor, motor, kShakeMs);
    }
    std::string nameOf(const Pad& pad) {
        const Locked locked(*this);
        return pad.name;
    }

private:
    /// SDL's own lock, too: a pad that leaves does so as a whole.
    struct Locked {
        std::lock_guard<std::mutex> lock;
        explicit Locked(Hub& hub) : lock(hub.mutex_) { SDL_LockJoysticks(); }
        ~Locked() { SDL_UnlockJoysticks(); }
        Locked(const Locked&) = delete;
        Locked& operator=(const Locked&) = delete;
    };
    Hub() = default;

    void pump() {
        SDL_GameControllerUpdate();
        // What has left says that its sticks are in the middle: that is not so.
        for (Pad* pad : pads_)
            if (pad->controller && SDL_GameControllerGetAttached(pad->controller) == SDL_FALSE) {
                SDL_GameControllerClose(std::exchange(pad->controller, nullptr));
                pad->instance = -1;
                pad->name.clear();
                pad->say(PadPacket::kGone, 0, 0);
                changed_ = true;
            }
        std::array<SDL_Event, 64> events;
        for (int count = 0; (count = SDL_PeepEvents(events.data(), static_cast<int>(events.size()), SDL_GETEVENT, SDL_FIRSTEVENT, SDL_LASTEVENT)) > 0;)
            for (const SDL_Event& event : std::span(events).first(static_cast<std::size_t>(count))) hear(event);
        if (std::exchange(changed_, false)) connect();
    }
    void hear(const SDL_Event& event) {
        switch (event.type) {
            case SDL_CONTROLLERDEVICEADDED:
            case SDL_CONTROLLERDEVICEREMOVED:
            case SDL_JOYDEVICEADDED:
            case SDL_JOYDEVICEREMOVED: changed_ = true; break;
            case SDL_CONTROLLERAXISMOTION:
                if (Pad* pad = of(event.caxis.which)) pad->say(PadPacket::kAxis, event.caxis.axis, event.caxis.value);
                break;
            case SDL_CONTROLLERBUTTONDOWN:
            case SDL_CONTROLLERBUTTONUP:
                if (Pad* pad = of(event.cbutton.which)) pad->say(PadPacket::kButton, event.cbutton.button, event.cbutton.state == SDL_PRESSED ? 1 : 0);
                break;
            default: break;
        }
    }
    Pad* of(SDL_JoystickID instance) {
        const auto found = std::ranges::find_if(pads_, [&](const Pad* pad) { return pad->controller && pad->instance == instance; });
        return found == pads_.end() ? nullptr : *found;
    }
    /// Each port gets the pad that is most like the one it wants; those that want any come last.
    void connect() {
        for (const bool choosy : {true, false})
            for (Pad* pad : pads_) {
                if (pad->controller || pad->wanted.empty() == choosy) continue;
                int best = -1, like = 0;
                for (int i = 0; i < SDL_NumJoysticks(); ++i) {
                    if (!SDL_IsGameController(i) || of(SDL_JoystickGetDeviceInstanceID(i))) continue;
                    if (const int is = likeness(pad->wanted, padAt(i)); is > like) best = i, like = is;
                }
                if (best < 0 || !(pad->controller = SDL_GameControllerOpen(best))) continue;
                pad->instance = SDL_JoystickInstanceID(SDL_GameControllerGetJoystick(pad->controller));
                pad->name = padAt(best).name;
            }
    }

    std::mutex mutex_;  // of all below
    std::vector<Pad*> pads_;
    bool changed_ = false;  // pads came or went
};

Result<std::unique_ptr<PadPort>> PadPort::open(std::string_view wanted) {
    auto hub = Hub::get();
    if (!hub) return tl::unexpected(hub.error());
    return std::unique_ptr<PadPort>(new PadPort(std::move(*hub), wanted));
}

PadPort::PadPort(std::shared_ptr<Hub> hub, std::string_view wanted) : hub_(std::move(hub)), pad_(std::make_unique<Pad>()) {
    pad_->wanted = wanted;
    hub_->add(*pad_);
}
PadPort::~PadPort() { hub_->remove(*pad_); }

std::optional<std::size_t> PadPort::take(std::span<std::byte> room) { return hub_->take(*pad_, room); }
void PadPort::shake(double strength) { hub_->shake(*pad_, strength); }
std::string PadPort::device() const { return hub_->nameOf(*pad_); }

std::vector<PadId> pluggedPads() {
    const auto hub = PadPort::Hub::get();
    return hub ? (*hub)->plugged() : std::vector<PadId>();
}

}  // namespace imomushi
