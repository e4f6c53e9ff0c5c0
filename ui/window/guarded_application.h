// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractSlider>
#include <QApplication>
#include <QComboBox>
#include <QScrollArea>
#include <QScrollBar>

#include "ui/models/failures.h"

namespace imomushi {

/// An application that leaves out what an event did where its handler throws, and says so: Qt would end the program. The wheel scrolls what is scrolled: a list of choices or a fader under the
/// pointer takes it only where it has the focus, so that nobody changes a setting on the way.
class GuardedApplication : public QApplication {
public:
    using QApplication::QApplication;

    bool notify(QObject* receiver, QEvent* event) override {
        bool handled = false;
        attempt([&] { handled = QApplication::notify(event->type() == QEvent::Wheel ? scrolled(receiver) : receiver, event); });
        return handled;
    }

private:
    static QObject* scrolled(QObject* receiver) {
        auto* field = qobject_cast<QWidget*>(receiver);
        if (!field || field->hasFocus() || (!qobject_cast<QComboBox*>(field) && (!qobject_cast<QAbstractSlider*>(field) || qobject_cast<QScrollBar*>(field)))) return receiver;
        for (QWidget* up = field->parentWidget(); up; up = up->parentWidget())
            if (auto* area = qobject_cast<QScrollArea*>(up)) return area->viewport();
        return receiver;
    }
};

}  // namespace imomushi
