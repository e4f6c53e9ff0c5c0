// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/rig.h"
#include "core/proposal/proposal.h"

class QLabel;
class QTreeWidget;
class QTreeWidgetItem;

namespace imomushi {

/// Which bones of a file's skeleton become bones of a character: a check for each. What is not checked is merged into what carries it, which the list says.
class BonesDialog : public QDialog {
    Q_OBJECT
public:
    /// `proposal`: from this skeleton; its bones are checked at first.
    BonesDialog(const Rig& rig, const Proposal& proposal, QWidget* parent = nullptr);
    /// Names of the bones that stay; none: as the program proposes by itself.
    [[nodiscard]] std::optional<std::vector<std::string>> chosen() const;

private:
    void check(bool all);
    void follow();

    const Rig& rig_;
    QTreeWidget* tree_;
    QLabel* count_;
    std::vector<QTreeWidgetItem*> items_;  // by bone of the rig
    bool asProposed_ = false, following_ = false;
};

}  // namespace imomushi
