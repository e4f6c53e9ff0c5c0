// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer over everything of an import that reads bytes which it did not write: first byte 0 = OBJ, 1 = PLY, 2 = STL, 3 = GLB, 4 = the answer of a
// worker; what is read is mended and checked too, and read as a whole character. Configure with clang and -DIMOMUSHI_FUZZ=ON, then: fuzz_import CORPUS -max_len=4096
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/io/build_result.h"
#include "core/io/file_codec.h"
#include "tests/support/messages.h"

using namespace imomushi;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    if (data[0] % 5 == 4) {
        const auto answer = inMessage<ImportResult>(bytes);
        if (answer && inMessage<ImportResult>(messageOf(answer)).has_value() != answer.has_value()) std::abort();
        const auto character = inMessage<CharacterFile>(bytes);
        if (character && !inMessage<CharacterFile>(messageOf(character))) std::abort();
        return 0;
    }
    static const char* const kNames[] = {"fuzz.obj", "fuzz.ply", "fuzz.stl", "fuzz.glb"};
    ImportRequest request;
    request.path = std::filesystem::path("/nonexistent") / kNames[data[0] % 5];
    request.split = size % 2 == 0;
    try {
        if (auto whole = readScene({request.path, bytes}, SceneUse::Character)) {
            const auto character = buildCharacter(std::move(*whole), request, {});
            if (character && !inMessage<CharacterFile>(messageOf(character))) std::abort();
        }
        auto scene = readScene({request.path, bytes});
        if (!scene) return 0;
        const auto result = buildResult(std::move(*scene), request, {});
        if (!result) return 0;
        const auto again = inMessage<ImportResult>(messageOf(result));  // what the worker sends, the parent accepts
        if (!again) std::abort();
        for (std::size_t b = 0; b < result->bodies.size(); ++b)
            if (again->bodies[b].closed != result->bodies[b].closed) std::abort();
    } catch (const std::bad_alloc&) {  // the worker answers "too-large"
    }
    return 0;
}
