// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string_view>

#include "core/input/input_decoder.h"

namespace imomushi {

// One for each protocol: see makeInputDecoder().
std::unique_ptr<InputDecoder> makeOscDecoder(std::string_view source);
std::unique_ptr<InputDecoder> makeVmcDecoder(std::string_view source);
std::unique_ptr<InputDecoder> makeMidiDecoder(std::string_view source);
std::unique_ptr<InputDecoder> makePadDecoder(std::string_view source);
std::unique_ptr<InputDecoder> makeKeyDecoder(std::string_view source);
std::unique_ptr<InputDecoder> makeVoiceDecoder(std::string_view source);

}  // namespace imomushi
