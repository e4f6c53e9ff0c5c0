// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "core/io/build_result.h"
#include "core/io/character_file.h"
#include "core/io/file_codec.h"
#include "tests/io/bytes.h"
#include "tests/io/files.h"
#include "tests/support/messages.h"

/// What the readers make of bytes, before anything is built of it.
namespace imomushi::io_test {

/// What a reader says of `bytes` under this name, beside no other file.
inline Result<RawScene> scene(const std::string& name, const std::string& bytes) {
    const TestFolder folder;
    return readScene({folder.path() / name, bytes});
}

/// A character of tests/data/characters, or of any path. `bonesSuffice`: it may have no mesh.
inline Result<CharacterFile> characterAt(const std::filesystem::path& path, bool bonesSuffice = false) {
    ImportRequest request;
    request.path = path;
    request.bonesSuffice = bonesSuffice;
    return importCharacter(request, {});
}
inline const std::filesystem::path kCharacters = std::filesystem::path(IMOMUSHI_TEST_DATA) / "characters";

inline std::string code(const Result<RawScene>& r) { return r ? "read" : r.error().code; }
inline std::string said(const Result<RawScene>& r) { return r ? "" : r.error().message; }

/// It says what is wrong with the file: no worker broke down, or came to no end.
inline bool isReason(const Error& error) { return error.code.rfind("worker", 0) != 0 && error.code != "timeout" && error.code != "internal" && !error.message.empty(); }

inline const MeshIssue* find(const RawScene& s, const std::string& issue) {
    for (const MeshIssue& i : s.issues)
        if (i.code == issue) return &i;
    return nullptr;
}

}  // namespace imomushi::io_test
