// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>

#include "core/project/response_store.h"
#include "core/project/version_limits.h"

class QComboBox;
class QLabel;
class QTableWidget;
class QTabWidget;

namespace imomushi {

class ActionSet;

/// Look, language, navigation, who deforms, how much can be undone and kept of what was saved and precomputed, and shortcuts. Everything takes effect at once.
class PreferencesDialog : public QDialog {
    Q_OBJECT
public:
    explicit PreferencesDialog(ActionSet& actions, QWidget* parent = nullptr);

    /// As chosen: see DocumentHistory::setDepth().
    static int historyDepth();
    static VersionLimits versionLimits();
    static ResponseStore::Limits responseLimits();

    /// Opens where this setting is chosen.
    void choose(const QString& setting);
    /// What the settings are called.
    [[nodiscard]] static QStringList settings();

signals:
    void navigationChanged(int preset);
    void deformOnChanged(int where);  ///< of ViewportWidget::DeformOn
    void pictureQualityChanged(int quality);  ///< of ViewportWidget::PictureQuality
    void historyDepthChanged(int steps);
    void versionsChanged();
    void responsesChanged();

protected:
    void changeEvent(QEvent* event) override;

private:
    void rebuild();
    void fillShortcuts();
    void markConflicts();
    ActionSet& actions_;
    QWidget* content_ = nullptr;
    QTabWidget* tabs_ = nullptr;
    QTableWidget* table_ = nullptr;
    QLabel* conflict_ = nullptr;
};

}  // namespace imomushi
