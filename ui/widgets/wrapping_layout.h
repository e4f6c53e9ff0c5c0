// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QLayout>
#include <memory>
#include <vector>

namespace imomushi {

/// Widgets beside each other, in as many lines as it takes. The last one that is seen gets what is left of its line.
class WrappingLayout : public QLayout {
public:
    /// `between`: pixels between two widgets and between two lines.
    explicit WrappingLayout(QWidget* parent = nullptr, int between = 2);
    ~WrappingLayout() override;
    void addItem(QLayoutItem* item) override;
    [[nodiscard]] int count() const override { return int(items_.size()); }
    [[nodiscard]] QLayoutItem* itemAt(int index) const override;
    QLayoutItem* takeAt(int index) override;
    [[nodiscard]] Qt::Orientations expandingDirections() const override { return {}; }
    [[nodiscard]] bool hasHeightForWidth() const override { return true; }
    [[nodiscard]] int heightForWidth(int width) const override { return arrange({0, 0, width, 0}, false); }
    [[nodiscard]] QSize sizeHint() const override;     ///< of one line
    [[nodiscard]] QSize minimumSize() const override;  ///< of the widest widget
    void setGeometry(const QRect& rect) override;

private:
    /// The height of all lines; puts the widgets there if `put`.
    int arrange(const QRect& rect, bool put) const;
    std::vector<QLayoutItem*> items_;
};

}  // namespace imomushi
