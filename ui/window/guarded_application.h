// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QApplication>

#include "ui/models/failures.h"

namespace imomushi {

/// An application that leaves out what an event did where its handler throws, and says so: Qt would end the program.
class GuardedApplication : public QApplication {
public:
    using QApplication::QApplication;

    bool notify(QObject* receiver, QEvent* event) override {
        bool handled = false;
        attempt([&] { handled = QApplication::notify(receiver, event); });
        return handled;
    }
};

}  // namespace imomushi
