// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/io/character_file.h"
#include "core/io/import.h"

namespace imomushi {

// What importFile() and importCharacter() and their worker say to each other over one socket, in the machine's own byte order (both are the same program).
// A message is a frame: 4 bytes "imo1", uint32 kind, uint64 length of the content, content. Strings and arrays are a uint64 count and
// the items. The parent believes nothing: every length, index and number is checked before use.

/// The kind of a request says which of the two asks.
enum class FrameKind : std::uint32_t { Request = 1, Progress = 2, Answer = 3, CharacterRequest = 4 };
inline constexpr std::size_t kFrameHeader = 16;

std::string frame(FrameKind kind, std::string_view content);

/// The kind and length of the frame whose first kFrameHeader bytes are `header`. False: no frame begins so.
bool parseFrameHeader(std::string_view header, FrameKind& kind, std::uint64_t& length);

std::string encodeRequest(const ImportRequest& request);
Result<ImportRequest> decodeRequest(std::string_view content);

std::string encodeProgress(std::string_view stage, double fraction);
bool decodeProgress(std::string_view content, std::string& stage, double& fraction);

std::string encodeAnswer(const Result<ImportResult>& answer);
/// Errors: "worker-failed" where the content contradicts itself; else the answer, which may be an error of the worker's.
Result<ImportResult> decodeAnswer(std::string_view content);

/// The same for importCharacter().
std::string encodeCharacter(const Result<CharacterFile>& answer);
Result<CharacterFile> decodeCharacter(std::string_view content);

}  // namespace imomushi
