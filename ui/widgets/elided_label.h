// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QLabel>

namespace imomushi {

/// One line of plain text that ends in an ellipsis where it has no room; its tip tells all of it.
class ElidedLabel : public QLabel {
    Q_OBJECT
public:
    explicit ElidedLabel(QWidget* parent = nullptr);
    void setText(const QString& text);
    /// It asks for as much width as for this text, whatever it says: what is beside it stays where it is.
    void setRoomFor(const QString& widest);
    [[nodiscard]] QSize sizeHint() const override;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    QString widest_;
};

}  // namespace imomushi
