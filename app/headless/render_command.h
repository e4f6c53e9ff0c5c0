// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/command.h"

namespace imomushi {

/// `render`: a picture of the character as it is now, drawn without a display.
void addRenderCommand(CommandRegistry& registry);

}  // namespace imomushi
