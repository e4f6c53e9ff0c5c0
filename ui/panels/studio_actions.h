// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAction>
#include <QKeySequence>
#include <QObject>
#include <QWidget>
#include <vector>

namespace imomushi {

/// All actions of the studio by a stable id, with texts that can be said again in another language and shortcuts that can be changed.
class StudioActions : public QObject {
    Q_OBJECT
public:
    explicit StudioActions(QWidget* window);

    /// The action of that id; asserts that it exists.
    [[nodiscard]] QAction* operator[](const char* id) const;
    [[nodiscard]] QList<QAction*> all() const;

    void retranslate();

    struct Entry {
        QByteArray id;
        const char* text;             ///< in the translation context "Actions"
        QList<QKeySequence> standard;
        QAction* action;
    };
    [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
    /// Sets and keeps a shortcut; empty: none.
    void setShortcut(const QByteArray& id, const QKeySequence& keys);
    void resetShortcuts();

private:
    void add(const char* id, const char* icon, const char* text, const QList<QKeySequence>& keys, bool checkable);
    static QString settingsKey(const QByteArray& id);

    QWidget* window_;
    std::vector<Entry> entries_;
};

}  // namespace imomushi
