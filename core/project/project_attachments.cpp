// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "core/document/attachments.h"
#include "core/document/command_support.h"
#include "core/project/project_rows.h"
#include "core/project/project_tables.h"

namespace imomushi {

namespace {

constexpr const char* kAttachmentTables = R"(
CREATE TABLE attachments (character INTEGER, part INTEGER, shell INTEGER, mode INTEGER, pivot BLOB, element INTEGER, PRIMARY KEY (character, part, shell));
CREATE TABLE part_turns (character INTEGER, part INTEGER, shell INTEGER, turn BLOB, from_turn BLOB, seconds REAL, elapsed REAL, PRIMARY KEY (character, part, shell));
)";

PartRef readPart(RowReader& row, const Document& document) {
    PartRef ref;
    ref.character = readId(row);
    constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
    readColumns(row, Within{ref.part.part, 0, kMost}, Within{ref.part.shell, -1, kMost});
    const auto character = document.characters.find(ref.character);
    require(character != document.characters.end() && character->second->model->namedParts().contains(ref.part), "an attached part is missing");
    return ref;
}

}  // namespace

void createAttachmentTables(Database& db) { db.run(kAttachmentTables); }

void writeAttachments(Database& db, const Document& document) {
    RowWriter attachments(db, "INSERT INTO attachments VALUES (?,?,?,?,?,?)");
    for (const auto& [id, character] : document.characters)
        for (const auto& [part, a] : character->attachments)
            attachments.row(id, part.part, part.shell, static_cast<int>(a.mode), a.pivot ? std::vector<double>(a.pivot->begin(), a.pivot->end()) : std::vector<double>(),
                            document.elements.contains(a.element) ? a.element : PartId(0));
    RowWriter turns(db, "INSERT INTO part_turns VALUES (?,?,?,?,?,?,?)");
    for (const auto& [ref, turn] : document.turns) {
        const Eigen::Vector4d target = turn.target.coeffs(), from = turn.from.coeffs();
        turns.row(ref.character, ref.part.part, ref.part.shell, target, from, turn.seconds, turn.elapsed);
    }
}

void readAttachments(Database& db, Document& document) {
    RowReader attachments(db, "SELECT * FROM attachments ORDER BY character, part, shell");
    while (attachments.next()) {
        const PartRef ref = readPart(attachments, document);
        Attachment made;
        made.mode = static_cast<Attachment::Mode>(attachments.integer(static_cast<int>(Attachment::Mode::Flesh), static_cast<int>(Attachment::Mode::Rigid)));
        const auto pivot = attachments.array<double>(3);
        require(pivot.empty() || (pivot.size() == 3 && allCoordinates(pivot)), "a pivot is out of range");
        if (!pivot.empty()) made.pivot = Vec3(pivot[0], pivot[1], pivot[2]);
        made.element = readIdOrNone(attachments);
        const auto element = document.elements.find(made.element);
        require(made.element == 0 || (element != document.elements.end() && element->second->piece && element->second->piece->character == ref.character),
                "an attached part follows an element that is not of its character");
        exchangePart(document.characters, ref.character, [&](CharacterSource& c) { c.attachments.emplace(ref.part, made); });
    }
    RowReader turns(db, "SELECT * FROM part_turns ORDER BY character, part, shell");
    while (turns.next()) {
        const PartRef ref = readPart(turns, document);
        require(isRigid(*document.characters.at(ref.character), ref.part), "a part is turned that is not rigid");
        TurnGoal goal;
        readColumns(turns, goal.target, goal.from, Within{goal.seconds, 0.0, 1e6}, Within{goal.elapsed, 0.0, 1e6});
        document.turns.emplace(ref, goal);
    }
}

}  // namespace imomushi
