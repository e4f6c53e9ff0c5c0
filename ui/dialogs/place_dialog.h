// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <array>
#include <optional>
#include <string>
#include <variant>

#include "ui/models/studio_document.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QVBoxLayout;

namespace imomushi {

class DialogForm;
class NumberField;

/// Places a bone, a joint face, a cut or a handle by names and numbers instead of by the mouse, and selects what was made.
class PlaceDialog : public QDialog {
    Q_OBJECT
public:
    enum class Kind { Bone, Face, Cut, Handle };
    PlaceDialog(StudioDocument& document, Kind kind, QWidget* parent = nullptr);
    /// Moves a joint face that is there to another plane.
    PlaceDialog(StudioDocument& document, const FaceRef& edited, QWidget* parent = nullptr);

private:
    PlaceDialog(StudioDocument& document, Kind kind, std::optional<FaceRef> edited, QWidget* parent);
    /// An end of a bone: what it is at, or a point of its own.
    struct End {
        QComboBox* at;
        std::array<NumberField*, 3> point;
    };
    [[nodiscard]] const Document& now() const { return document_.document(); }
    DialogForm* addSection(const QString& title);
    std::array<NumberField*, 3> addVector(const QString& title, const QString& unit, double step, const Vec3& value);
    void addElements(bool characters);
    End addEnd(const QString& title, const std::string& place, double step, const Vec3& point);
    void addBoneFields();
    void addPlaneFields();
    void addHandleFields();
    /// Says where what is chosen has its proposed plane or place, and what it would be called.
    void propose();
    void place();
    void placeCut();
    void refuse(const Error& error);
    [[nodiscard]] Result<SelectionItem> placed();
    [[nodiscard]] Result<SelectionItem> placedBone();
    [[nodiscard]] std::string chosen() const;

    StudioDocument& document_;
    Kind kind_;
    std::optional<FaceRef> edited_;
    QString proposedName_;
    QVBoxLayout* sections_;
    QLineEdit* name_ = nullptr;
    QComboBox* on_ = nullptr;  ///< the element or character
    End from_ = {}, to_ = {};
    std::array<NumberField*, 3> origin_ = {}, normal_ = {};
    NumberField* size_ = nullptr;  ///< tolerance of a face, radius of a handle; m
    QLabel* refused_;
    QPushButton* place_;
};

}  // namespace imomushi
