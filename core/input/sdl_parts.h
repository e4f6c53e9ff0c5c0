// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <mutex>

#include "core/base/result.h"

namespace imomushi {

// Parts of SDL (SDL_INIT_...). SDL begins and ends them on one thread at a time, so whoever does either, or asks what another thread may change, holds this.
std::mutex& sdlMutex();

/// `what` it is for, for the reason. Errors: "no-devices".
Result<void> beginSdlPart(std::uint32_t part, const char* what);
void endSdlPart(std::uint32_t part);

}  // namespace imomushi
