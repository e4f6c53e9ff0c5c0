// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "ui/widgets/appearance.h"

namespace imomushi {

/// A line of text with digits of one width, at the right: numbers that change do not jump.
class FigureLabel : public QWidget {
    Q_OBJECT
public:
    explicit FigureLabel(QWidget* parent = nullptr);
    void setText(const QString& text);
    void setRole(Appearance::Role role);
    [[nodiscard]] const QString& text() const { return text_; }
    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override { return sizeHint(); }

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    [[nodiscard]] int advance(QChar c) const;
    QString text_;
    Appearance::Role role_ = Appearance::Role::Muted;
};

}  // namespace imomushi
