// SPDX-License-Identifier: GPL-3.0-or-later
#define SDL_MAIN_HANDLED  // this program has a main() of its own
#include "core/input/sdl_parts.h"

#include <SDL.h>

#include <string>

namespace imomushi {

std::mutex& sdlMutex() {
    static std::mutex mutex;
    return mutex;
}

Result<void> beginSdlPart(std::uint32_t part, const char* what) {
    SDL_SetMainReady();
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    if (SDL_InitSubSystem(part) != 0) return fail("no-devices", std::string(what) + " cannot be had on this machine (" + SDL_GetError() + ").");
    return {};
}

void endSdlPart(std::uint32_t part) { SDL_QuitSubSystem(part); }

}  // namespace imomushi
