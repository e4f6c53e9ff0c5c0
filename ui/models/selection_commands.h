// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "ui/models/studio_document.h"

namespace imomushi {

/// All of the kind that is selected (bones, joint faces, handles, cuts; else elements) that are visible and not locked.
void selectAll(StudioDocument& document);

/// What is not selected, of the kind that is; visible and not locked.
void invertSelection(StudioDocument& document);
/// Adds what is next to it: bones that meet the selected ones, elements that are joined to them.
void growSelection(StudioDocument& document);
/// Adds all bones that hang on the selected ones.
void selectChain(StudioDocument& document);

/// What artists do with what is selected; each is one undo step.
void hideSelected(StudioDocument& document);
/// Hides all elements and bones but those that are selected or belong to what is; of bones alone, only other bones.
void isolateSelected(StudioDocument& document);
/// Locks what is selected; unlocks it where all of it is locked.
void lockSelected(StudioDocument& document);
[[nodiscard]] bool canHide(const StudioDocument& document);
void showAll(StudioDocument& document);
/// Copies elements, characters and bones, and selects the copies.
void duplicateSelected(StudioDocument& document);
[[nodiscard]] bool canDuplicate(const StudioDocument& document);
/// Makes mirror images across an axis ('x', 'y' or 'z') and selects them. `done`: all of them were made; else the document tells by failed().
void mirrorSelected(StudioDocument& document, char axis, std::function<void()> done = {});
[[nodiscard]] bool canMirror(const StudioDocument& document);
/// How commands call what is selected and can be copied.
[[nodiscard]] std::vector<std::string> copiedNames(const StudioDocument& document);
/// What joint faces, handles and cuts are pasted onto: the element or the character that is selected, or whose part is; empty: none, or several.
[[nodiscard]] std::string pastedOnto(const StudioDocument& document);
/// Selects the parts that "duplicate", "mirror" or "paste" tells of; those of elements and characters alone where there are any.
void selectCopies(StudioDocument& document, const Json& answer);
/// What another mesh can be given to: the character or the element of its own that is selected, alone. Without a name: none is.
struct Replaceable {
    std::string name;
    bool character = false;
};
[[nodiscard]] Replaceable replaceable(const StudioDocument& document);
/// The character that is selected, or whose part is, or the only one there is; null: none.
[[nodiscard]] const CharacterSource* chosenCharacter(const StudioDocument& document);
/// What is meant by "Make it soft": the element of its own that is selected, else chosenCharacter(), else the only element there is. At most one of both.
struct SoftWish {
    const CharacterSource* character = nullptr;
    const Element* element = nullptr;
};
[[nodiscard]] SoftWish softWish(const StudioDocument& document);
/// Pins or unpins the selected endpoints, and the ends of the selected bones.
void togglePins(StudioDocument& document);
/// Joins the two joint faces that are selected and returns their paths; none where it failed or others than two are selected.
std::optional<std::pair<std::string, std::string>> joinSelected(StudioDocument& document);

}  // namespace imomushi
