// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractItemModel>
#include <memory>
#include <optional>
#include <vector>

#include "ui/models/paths.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// The document as a tree: elements > joint faces, whole characters > their elements and cuts, the bones as they hang on each other, joints, and effects that are on. A bone that is dropped on another hangs on it then, a joint
/// face that is dropped on another is joined with it.
class OutlinerModel : public QAbstractItemModel {
    Q_OBJECT
public:
    enum Column { Name, State, Visible, Locked, kColumns };
    enum class Kind { Character, Element, Face, Bones, Bone, Whole, Cut, Joints, Joint, Effects, Effect };
    enum Roles {
        KindRole = Qt::UserRole,  ///< int of Kind
        IconRole,                 ///< QString: name of a line icon; empty: none
        NoteRole,                 ///< QString: said behind the name, muted (what a face is joined with)
    };

    explicit OutlinerModel(StudioDocument& document, QObject* parent = nullptr);
    ~OutlinerModel() override;

    [[nodiscard]] std::optional<SelectionItem> item(const QModelIndex& index) const;
    /// What a click on a row selects: its item, or the faces of a joint.
    [[nodiscard]] std::vector<SelectionItem> items(const QModelIndex& index) const;
    /// Of the row of an effect.
    [[nodiscard]] std::optional<EffectKind> effect(const QModelIndex& index) const;
    /// Where an item is shown; an endpoint is shown at its bone.
    [[nodiscard]] QModelIndex indexOf(const SelectionItem& item) const;

    [[nodiscard]] QModelIndex index(int row, int column, const QModelIndex& parent = {}) const override;
    [[nodiscard]] QModelIndex parent(const QModelIndex& index) const override;
    [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    bool setData(const QModelIndex& index, const QVariant& value, int role) override;
    [[nodiscard]] Qt::ItemFlags flags(const QModelIndex& index) const override;
    [[nodiscard]] QStringList mimeTypes() const override;
    [[nodiscard]] QMimeData* mimeData(const QModelIndexList& indexes) const override;
    [[nodiscard]] Qt::DropActions supportedDropActions() const override { return Qt::LinkAction; }
    [[nodiscard]] bool canDropMimeData(const QMimeData* data, Qt::DropAction action, int row, int column, const QModelIndex& parent) const override;
    bool dropMimeData(const QMimeData* data, Qt::DropAction action, int row, int column, const QModelIndex& parent) override;

    /// Shows or hides, locks or unlocks an element, joint face, bone or cut, or all elements of a character or of the scene, or all bones. The eye of an effect turns it off.
    void toggle(const QModelIndex& index);
    /// Says everything again, in the present language.
    void retranslate();

private:
    struct Node;
    void rebuild();
    [[nodiscard]] Node* node(const QModelIndex& index) const;
    [[nodiscard]] QModelIndex indexOf(const Node* node, int column = 0) const;
    [[nodiscard]] std::shared_ptr<const Element> element(const Node& node) const;
    /// What a row's eye and lock are of: itself, or all elements of a character or of the scene, or all bones. `name`: how commands call it.
    struct Switched {
        std::string name;
        Shown shown;
    };
    [[nodiscard]] std::vector<Switched> switched(const Node& node) const;
    /// What dropping on `onto` does, a command for each dragged row; empty: they have no place there.
    [[nodiscard]] std::vector<Json> dropped(const QMimeData& data, const QModelIndex& onto) const;

    StudioDocument& document_;
    std::unique_ptr<Node> root_;
};

}  // namespace imomushi
