// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/panels/inspector/inspector_form.h"

namespace imomushi {

/// Nothing is selected: settings and contents of the whole character.
class CharacterForm : public InspectorForm {
    Q_OBJECT
public:
    CharacterForm(StudioDocument& document, QWidget* parent);
};

/// One element or several: material, effects, mesh, and what its precompute takes and gave.
class ElementForm : public InspectorForm {
    Q_OBJECT
public:
    ElementForm(StudioDocument& document, const Items& items, QWidget* parent);

private:
    void addMaterial(const Items& items);
    void addPreset(const Items& items);
    void addColor(const Items& items);
    void addJointPlanes(const Items& items);
    void addEffects(const Items& items);
    void addMesh(const Items& items);
    // element_precompute_form.cpp
    void addSolverMesh(const Items& items);
    void addPrecompute(const SelectionItem& item);
    void addResponse(const SelectionItem& item);
    void addEstimate(const SelectionItem& item);
    [[nodiscard]] bool hasFaces(const SelectionItem& item) const;
    [[nodiscard]] const Element* sharedWith(const SelectionItem& item) const;
    void addShared(const SelectionItem& item);
};

/// A joint face and what it is joined with.
class FaceForm : public InspectorForm {
    Q_OBJECT
public:
    FaceForm(StudioDocument& document, const SelectionItem& item, QWidget* parent);
};

/// A whole character: how its body was made and how far that is from what is seen, its cuts, and how its parts follow.
class WholeCharacterForm : public InspectorForm {
    Q_OBJECT
public:
    WholeCharacterForm(StudioDocument& document, const SelectionItem& item, QWidget* parent);

private:
    void addBody(const CharacterSource& character);
    void addGaps(const CharacterSource& character);
    void addMorphs(const SelectionItem& item);
    void addAvatar(const SelectionItem& item);
    // character_parts_form.cpp
    void addParts(const SelectionItem& item);
    void addPivot(const SelectionItem& item, const std::function<commands::Attach(std::optional<std::string>)>& command);
    void addTurn(const SelectionItem& item);

    std::vector<ModelPart> parts_;
    std::optional<ModelPart> chosen_;
    std::vector<QGridLayout*> rigidRows_;  ///< for parts that are rigid by themselves
};

/// A cut: its plane, and what lies beside it.
class CutForm : public InspectorForm {
    Q_OBJECT
public:
    CutForm(StudioDocument& document, const SelectionItem& item, QWidget* parent);

private:
    void addPlane(const SelectionItem& item);
    /// Of the cut at rest, as it will be when what is under way is done. None: there is no such cut.
    [[nodiscard]] std::optional<CutPlane> plane(const SelectionItem& item) const;
    [[nodiscard]] QString beside(const SelectionItem& item, bool front) const;
};

/// A handle: its disc, what carries it, and where it is held.
class HandleForm : public InspectorForm {
    Q_OBJECT
public:
    HandleForm(StudioDocument& document, const SelectionItem& item, QWidget* parent);

private:
    void addDisc(const SelectionItem& item);
    void addPlace(const SelectionItem& item);
    void addButtons(const SelectionItem& item);
    [[nodiscard]] const Handle* handle(const SelectionItem& item) const;
    [[nodiscard]] const JointFace* face(const SelectionItem& item) const;
    [[nodiscard]] const HandleGoal* goal(const SelectionItem& item) const;
};

/// One bone or several.
class BoneForm : public InspectorForm {
    Q_OBJECT
public:
    BoneForm(StudioDocument& document, const Items& items, QWidget* parent);

private:
    void addPlaceInTree(const SelectionItem& item);
    void addLength(const SelectionItem& item);
    void addEnd(const SelectionItem& item, bool atEnd);
};

/// An end of a bone: where it is, and where it is held.
class EndpointForm : public InspectorForm {
    Q_OBJECT
public:
    EndpointForm(StudioDocument& document, const SelectionItem& item, QWidget* parent);

private:
    void addTarget(const SelectionItem& item);
    void addButtons(const SelectionItem& item);
    [[nodiscard]] const EndpointGoal* held(const SelectionItem& item) const;
    [[nodiscard]] std::optional<Vec3> shownAt(const SelectionItem& item) const;  ///< m
};

}  // namespace imomushi
