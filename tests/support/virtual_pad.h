// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#define SDL_MAIN_HANDLED
#include <SDL.h>
#include <doctest/doctest.h>

#include <atomic>
#include <string>

namespace imomushi {

/// A game controller of SDL's own, plugged in for as long as this lives. Buttons and axes as SDL numbers them.
class VirtualPad {
public:
    static constexpr const char* kName = "Virtual Controller";
    VirtualPad() {
        SDL_SetHint(SDL_HINT_JOYSTICK_HIDAPI, "0");
        SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
        REQUIRE(SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) == 0);
        plug();
    }
    ~VirtualPad() {
        unplug();
        SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
    }
    VirtualPad(const VirtualPad&) = delete;
    VirtualPad& operator=(const VirtualPad&) = delete;
    void plug() {
        SDL_VirtualJoystickDesc made{};
        made.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
        made.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
        made.naxes = SDL_CONTROLLER_AXIS_MAX;
        made.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
        made.userdata = this;
        made.Rumble = [](void* self, Uint16 low, Uint16) {
            static_cast<VirtualPad*>(self)->rumble_ = low;
            if (low > 0) ++static_cast<VirtualPad*>(self)->shaken_;
            return 0;
        };
        const int index = SDL_JoystickAttachVirtualEx(&made);
        REQUIRE(index >= 0);
        joystick_ = SDL_JoystickOpen(index);
        REQUIRE(joystick_);
    }
    void unplug() {
        if (!joystick_) return;
        const SDL_JoystickID id = SDL_JoystickInstanceID(joystick_);
        SDL_JoystickClose(joystick_);
        joystick_ = nullptr;
        SDL_LockJoysticks();
        for (int i = 0; i < SDL_NumJoysticks(); ++i)
            if (SDL_JoystickGetDeviceInstanceID(i) == id) SDL_JoystickDetachVirtual(i);
        SDL_UnlockJoysticks();
    }
    void axis(int axis, int value) const { SDL_JoystickSetVirtualAxis(joystick_, axis, static_cast<Sint16>(value)); }
    void button(int button, bool down) const { SDL_JoystickSetVirtualButton(joystick_, button, down ? 1 : 0); }

    [[nodiscard]] int rumble() const { return rumble_; }  ///< of its larger motor, up to 65535
    [[nodiscard]] int shaken() const { return shaken_; }  ///< how often it was told to rumble

private:
    SDL_Joystick* joystick_ = nullptr;
    std::atomic<int> rumble_ = 0, shaken_ = 0;
};

}  // namespace imomushi
