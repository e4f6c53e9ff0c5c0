// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/import.h"

#include <unistd.h>

#include <fstream>
#include <new>

#include "core/base/try.h"
#include "core/io/build_result.h"
#include "core/io/file_codec.h"
#include "core/io/limited_import.h"

namespace imomushi {
namespace {

constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 30;

/// An STL of 1.7 million triangles needs 0.9 GB and 15 s.
WorkLimits readingLimits() {
    WorkLimits limits;
    limits.cpuSeconds = 240;
    limits.wallSeconds = 600.0;
    return limits;
}

Result<RawScene> read(const ImportRequest& request, SceneUse use, const Progress& progress) {
    SourceFile file{request.path, {}};
    std::string bytes;
    {
        std::ifstream in(request.path, std::ios::binary | std::ios::ate);
        const auto size = in ? static_cast<std::streamoff>(in.tellg()) : std::streamoff{-1};
        if (size < 0) return fail("not-readable", file.quoted() + " cannot be read: check its permissions.");
        bytes.resize(static_cast<std::size_t>(size));
        in.seekg(0);
        if (size > 0 && !in.read(bytes.data(), size)) return fail("not-readable", file.quoted() + " cannot be read to its end: copy it again.");
    }
    file.bytes = bytes;
    progress.report("read", 0.05);
    return readScene(file, use);
}

/// Reads the scene and builds the answer of it: buildResult() or buildCharacter().
template <class Answer>
Result<Answer> answerFor(const ImportRequest& request, SceneUse use, Result<Answer> (*build)(RawScene, const ImportRequest&, const Progress&), const Progress& progress) {
    try {
        IMOMUSHI_TRY(auto scene, read(request, use, progress));
        auto answer = build(std::move(scene), request, progress);
        if (answer) sayLeftOut(answer->issues);
        return answer;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        return fail("bad-file", quotedName(request.path) + " cannot be read (" + cleanName(e.what(), "damaged") + "): export it again.");
    }
}

Result<ImportResult> importHere(const ImportRequest& request, const Progress& progress) { return answerFor(request, SceneUse::Elements, buildResult, progress); }
Result<CharacterFile> importCharacterHere(const ImportRequest& request, const Progress& progress) {
    return answerFor(request, SceneUse::Character, buildCharacter, progress);
}

const Operation<Result<ImportResult>(ImportRequest)> kImport("import-file", importHere);
const Operation<Result<CharacterFile>(ImportRequest)> kImportCharacter("import-character", importCharacterHere);

template <class Answer>
Result<Answer> ask(const Operation<Result<Answer>(ImportRequest)>& operation, const ImportRequest& request, const Progress& progress, const WorkLimits& limits) {
    namespace fs = std::filesystem;
    const std::string quoted = quotedName(request.path);
    std::error_code error;
    const fs::file_status status = fs::status(request.path, error);
    if (!fs::exists(status)) return fail("file-not-found", "There is no file '" + cleanName(request.path.string(), "?") + "': check the path.");
    if (!fs::is_regular_file(status)) return fail("not-readable", quoted + " is not a file: choose a mesh file.");
    if (formatOf(request.path).empty())
        return fail("unknown-format", quoted + " is of no kind that can be read: OBJ, PLY, STL, glTF, GLB, VRM, FBX and DAE can.");
    if (::access(request.path.c_str(), R_OK) != 0) return fail("not-readable", quoted + " cannot be read: check its permissions.");
    const std::uintmax_t size = fs::file_size(request.path, error);
    if (error) return fail("not-readable", quoted + " cannot be read: check its permissions.");
    if (size > kLargestFile)
        return fail("too-large", quoted + " is larger than " + std::to_string(kLargestFile >> 20) + " MB: reduce the mesh, or split the file.");
    ImportRequest absolute = request;
    absolute.path = fs::absolute(request.path, error);
    if (error) return fail("not-readable", quoted + " cannot be read: check its path.");
    auto answer = operation(absolute, progress, limits);
    // What is said of a worker does not name the file.
    if (!answer && answer.error().message.find(quoted) == std::string::npos) answer.error().message = quoted + ": " + answer.error().message;
    return answer;
}

}  // namespace

Result<ImportResult> importFile(const ImportRequest& request, const Progress& progress) { return importFile(request, progress, readingLimits()); }
Result<ImportResult> importFile(const ImportRequest& request, const Progress& progress, const WorkLimits& limits) { return ask(kImport, request, progress, limits); }

Result<CharacterFile> importCharacter(const ImportRequest& request, const Progress& progress) { return importCharacter(request, progress, readingLimits()); }
Result<CharacterFile> importCharacter(const ImportRequest& request, const Progress& progress, const WorkLimits& limits) {
    return ask(kImportCharacter, request, progress, limits);
}

}  // namespace imomushi
