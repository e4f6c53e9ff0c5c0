// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <span>

#include "core/base/result.h"
#include "core/document/document.h"
#include "core/document/stored_response.h"

namespace imomushi {

/// What a project file holds: the document and the responses that its elements have.
struct Project {
    Document document;
    std::map<PartId, StoredResponse> responses;  ///< by element; elements without one are left out
};

/// "IMOM": SQLite's application id of a .imomushi file.
inline constexpr int kProjectApplicationId = 0x494d4f4d;
/// Version of the tables. A file of a newer one is refused.
inline constexpr int kProjectVersion = 13;
/// What a file of this document gets: the oldest version that has its tables, so that programs that know neither handles nor characters nor attached parts nor skeletons of files nor morph targets open it where it has none.
[[nodiscard]] int projectVersion(const Document& document);
/// The same with its responses: newer where one was solved in tetrahedra, or says why not. An array over kPartBytes makes the file newer yet.
[[nodiscard]] int projectVersion(const Project& project);

/// All tables that hold the project; "info" holds their digest. Effects and touch came with version 4, takes with 5, handles and characters with 6, attached parts with 7, skeletons of files with 8, morph targets and
/// names of nodes that are no bones with 9, clips that weigh morph targets and what finite elements say of responses with 10, limits, stiffness and weight of bones and pins that hold them as turned with 11, damping of elements with 13.
inline constexpr std::array<const char*, 45> kProjectTables = {"settings", "meshes", "materials", "textures",    "elements", "issues",    "faces",
                                                               "joints",   "joint_faces", "bones",  "held", "pose",  "responses", "element_responses",
                                                               "effects",  "effect_elements", "effect_settings", "touch_responses",
                                                               "takes",    "take_targets",
                                                               "handles",  "handle_goals", "characters", "character_parts", "character_issues", "cuts", "pieces", "piece_sides",
                                                               "attachments", "part_turns", "take_turns",
                                                               "rigs", "rig_bones", "rig_nodes", "rig_clips", "rig_tracks",
                                                               "rig_node_names", "morph_targets", "morph_weights", "take_morphs",
                                                               "rig_morph_tracks", "filled_responses", "bone_properties", "held_turns", "element_damping"};
[[nodiscard]] inline std::span<const char* const> projectTables(std::int64_t version) {
    return std::span<const char* const>(kProjectTables).first(version >= 13 ? kProjectTables.size() : version >= 11 ? 44 : version == 10 ? 42 : version == 9 ? 40 : version == 8 ? 36 : version == 7 ? 31 : version == 6 ? 28 : version == 5 ? 20 : version == 4 ? 18 : 14);
}

/// Writes one self-contained SQLite file: beside its place first, on disk, then renamed, so that there is always a whole file. Nothing of an old
/// file is lost when this fails. What is written is read as openProject() reads it before it takes its place. Errors: "not-writable", "disk-full", "not-sound": it would not open
/// again, with the part and what is wrong with it.
Result<void> saveProject(const std::filesystem::path& path, const Project& project);

/// Reads a project without changing its file; trusts nothing in it.
/// Errors: "file-not-found", "not-readable", "not-a-project", "newer-version", "damaged" with what is wrong.
Result<Project> openProject(const std::filesystem::path& path);

}  // namespace imomushi
