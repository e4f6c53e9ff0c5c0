// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <optional>
#include <vector>

#include "core/body/body.h"
#include "core/io/character_file.h"

class QTreeWidget;

namespace imomushi {

class NumberField;

/// Which links of flesh a body has between parts that do not touch, and how thick they are.
class LinksDialog : public QDialog {
    Q_OBJECT
public:
    /// `asked`: the links that were asked for before, some of which `body` may not have; none: those of `body`.
    LinksDialog(const CharacterFile& file, const Body& body, const std::optional<std::vector<FleshLink>>& asked, QWidget* parent = nullptr);
    /// Without the volumes that they add; none: as the program finds them.
    [[nodiscard]] std::optional<std::vector<FleshLink>> chosen() const;

private:
    QTreeWidget* tree_;
    std::vector<FleshLink> links_;
    std::vector<NumberField*> radii_;
    bool asFound_ = false;
};

}  // namespace imomushi
