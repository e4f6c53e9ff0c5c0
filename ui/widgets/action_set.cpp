// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/action_set.h"

#include <QCoreApplication>
#include <QSettings>

#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr const char* kWhy = "why";

QString settingsKey(const QByteArray& id) { return QStringLiteral("shortcuts/") + QString::fromLatin1(id); }

QList<QKeySequence> keysFrom(const char* text) {
    QList<QKeySequence> keys = QKeySequence::listFromString(QString::fromLatin1(text), QKeySequence::PortableText);
    keys.removeIf([](const QKeySequence& k) { return k.isEmpty(); });
    return keys;
}

}  // namespace

ActionSet::ActionSet(QWidget* window, const char* context) : QObject(window), window_(window), context_(context) {}

void ActionSet::add(const char* id, const char* icon, const char* text, const char* keys, bool checkable) {
    const QList<QKeySequence> standard = keysFrom(keys);
    auto* action = new QAction(window_);
    action->setObjectName(QString::fromLatin1(id));
    if (*icon) action->setIcon(themedIcon(QString::fromLatin1(icon)));
    action->setIconVisibleInMenu(!checkable);
    action->setCheckable(checkable);
    const QVariant own = QSettings().value(settingsKey(id));
    action->setShortcuts(own.isValid() ? QList<QKeySequence>{QKeySequence(own.toString(), QKeySequence::PortableText)} : standard);
    window_->addAction(action);
    entries_.push_back({id, text, standard, action});
}

QAction* ActionSet::operator[](const char* id) const {
    for (const Entry& entry : entries_)
        if (entry.id == id) return entry.action;
    Q_ASSERT_X(false, "ActionSet", id);
    return nullptr;
}

QList<QAction*> ActionSet::all() const {
    QList<QAction*> actions;
    for (const Entry& entry : entries_) actions << entry.action;
    return actions;
}

void ActionSet::retranslate() {
    for (const Entry& entry : entries_) {
        const QString text = QCoreApplication::translate(context_, entry.text), plain = withoutMnemonic(text);
        entry.action->setText(text);
        entry.action->setIconText(plain);
        tellTip(entry);
    }
}

void ActionSet::tellTip(const Entry& entry) {
    const QString keys = entry.action->shortcut().toString(QKeySequence::NativeText), why = whyDisabled(*entry.action);
    QString tip = entry.action->iconText();
    if (!keys.isEmpty()) tip += QStringLiteral("  (%1)").arg(keys);
    entry.action->setToolTip(why.isEmpty() ? tip : tip + u'\n' + why);
}

void ActionSet::setStandard(const char* id, const char* keys) {
    for (Entry& entry : entries_) {
        if (entry.id != id) continue;
        entry.standard = keysFrom(keys);
        if (!QSettings().contains(settingsKey(entry.id))) entry.action->setShortcuts(entry.standard);
        tellTip(entry);
    }
}

void ActionSet::allow(const char* id, bool allowed, const QString& why) {
    for (const Entry& entry : entries_) {
        if (entry.id != id) continue;
        entry.action->setProperty(kWhy, allowed ? QString() : why);
        entry.action->setEnabled(allowed);
        tellTip(entry);
    }
}

void ActionSet::setShortcut(const QByteArray& id, const QKeySequence& keys) {
    operator[](id.constData())->setShortcut(keys);
    QSettings().setValue(settingsKey(id), keys.toString(QKeySequence::PortableText));
    retranslate();
}

void ActionSet::resetShortcuts() {
    for (const Entry& entry : entries_) {
        entry.action->setShortcuts(entry.standard);
        QSettings().remove(settingsKey(entry.id));
    }
    retranslate();
}

QString whyDisabled(const QAction& action) { return action.isEnabled() ? QString() : action.property(kWhy).toString(); }

QString withoutMnemonic(QString text) {
    if (const auto at = text.indexOf(QStringLiteral("(&")); at >= 0) text.remove(at, 4);
    return text.remove(u'&');
}

QString commandName(const QAction& action) { return withoutMnemonic(action.text()).remove(u'…'); }

}  // namespace imomushi
