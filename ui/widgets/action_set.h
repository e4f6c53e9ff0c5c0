// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAction>
#include <QKeySequence>
#include <QObject>
#include <QWidget>
#include <vector>

namespace imomushi {

/// Actions of a window by a stable id. Their texts follow the language, their shortcuts can be changed and are kept in QSettings.
class ActionSet : public QObject {
    Q_OBJECT
public:
    /// `context`: the translation context of the texts.
    ActionSet(QWidget* window, const char* context);
    /// `icon`: name of a line icon, may be empty. `keys`: standard shortcuts as portable text, several separated by "; ".
    void add(const char* id, const char* icon, const char* text, const char* keys, bool checkable = false);

    /// The action of that id; asserts that it exists.
    [[nodiscard]] QAction* operator[](const char* id) const;
    [[nodiscard]] QList<QAction*> all() const;

    /// Lets an action be done, or says in one sentence why it cannot be done now (translated).
    void allow(const char* id, bool allowed, const QString& why);

    /// Other standard shortcuts; the action has them where nobody chose its own.
    void setStandard(const char* id, const char* keys);

    void retranslate();

    struct Entry {
        QByteArray id;
        const char* text;             ///< untranslated
        QList<QKeySequence> standard;
        QAction* action;
    };
    [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
    /// Sets and keeps a shortcut; empty: none.
    void setShortcut(const QByteArray& id, const QKeySequence& keys);
    void resetShortcuts();

private:
    void tellTip(const Entry& entry);

    QWidget* window_;
    const char* context_;
    std::vector<Entry> entries_;
};

/// Why an action cannot be done now, one sentence; empty: it can, or nobody said.
QString whyDisabled(const QAction& action);
/// The text of an action without the mark of its mnemonic: "&Save…" and "保存(&S)…" -> "Save…", "保存…".
QString withoutMnemonic(QString text);
/// The same without the ellipsis, as a name: "Save", "保存".
QString commandName(const QAction& action);

}  // namespace imomushi
