// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/study_store.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "core/accuracy/study_json.h"
#include "core/base/atomic_file.h"
#include "core/comparison/model_table.h"

namespace imomushi {

namespace {

std::string read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string digest(std::string_view bytes) {
    ContentHasher hasher;
    hasher.text(bytes);
    return hasher.key().hex();
}

}  // namespace

StudyStore::StudyStore(std::filesystem::path folder, const ContentKey& key) {
    if (folder.empty()) return;
    table_ = folder / (key.hex() + ".json");
    positions_ = folder / (key.hex() + ".positions");
}

void StudyStore::save(const AccuracyStudy& study) {
    if (table_.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(table_.parent_path(), error);
    auto json = studyJson(study);
    if (study.reference) {
        std::string bytes;
        for (const auto& pose : study.reference->positions)
            for (const Points& p : pose) bytes.append(reinterpret_cast<const char*>(p.data()), static_cast<std::size_t>(p.size()) * sizeof(double));
        json["reference"]["digest"] = digest(bytes);
        if (!savedPositions_) savedPositions_ = writeFileAtomically(positions_, bytes).has_value();
    }
    (void)writeFileAtomically(table_, json.dump(1) + "\n");
}

AccuracyStudy StudyStore::load(const ReferenceInput& input) const {
    if (table_.empty()) return {};
    const auto json = nlohmann::ordered_json::parse(read(table_), nullptr, false);
    AccuracyStudy study = studyFromJson(json);
    if (!study.reference) return study;
    const std::string bytes = read(positions_);
    std::size_t wanted = 0;
    for (const auto& e : input.character.elements) wanted += static_cast<std::size_t>(e.mesh->body.vertices.size());
    wanted *= input.poses.size() * sizeof(double);
    const auto& noted = json["reference"];
    if (bytes.size() != wanted || !noted.contains("digest") || noted["digest"] != digest(bytes)) return {};  // without its reference no figure can be continued
    std::size_t at = 0;
    for (std::size_t i = 0; i < input.poses.size(); ++i) {
        auto& pose = study.reference->positions.emplace_back();
        for (const auto& e : input.character.elements) {
            Points& p = pose.emplace_back(e.mesh->body.vertices.rows(), 3);
            std::memcpy(p.data(), bytes.data() + at, static_cast<std::size_t>(p.size()) * sizeof(double));
            at += static_cast<std::size_t>(p.size()) * sizeof(double);
        }
    }
    study.reference->seen = seenVertices(input.character);
    return study;
}

}  // namespace imomushi
