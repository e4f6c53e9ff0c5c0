// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#define SDL_MAIN_HANDLED
#include <SDL.h>
#include <doctest/doctest.h>

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
        const int index = SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX, SDL_CONTROLLER_BUTTON_MAX, 0);
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

private:
    SDL_Joystick* joystick_ = nullptr;
};

}  // namespace imomushi
