// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QColor>
#include <QIcon>
#include <QObject>
#include <QTranslator>
#include <memory>

class QTemporaryDir;
class QWidget;

namespace imomushi {

/// How the studio looks and speaks: theme, scale and language, changed at run time and kept in QSettings.
class Appearance : public QObject {
    Q_OBJECT
public:
    enum class Theme { Dark, Light, HighContrast };
    enum class Role { Window, Panel, Field, Hover, Line, Text, Muted, Accent, OnAccent, Info, Warning, Error, Good };

    /// The one of this program; made by start().
    static Appearance& instance();
    /// Loads fonts, style, translations and the saved choices into the running QApplication. Call once, before any widget is made.
    static void start();
    ~Appearance() override;

    [[nodiscard]] Theme theme() const { return theme_; }
    void setTheme(Theme theme);
    /// 1.0 = as the desktop says; 1.0...3.0.
    [[nodiscard]] double scale() const { return scale_; }
    void setScale(double scale);
    /// "en", "ja", or "" for the language of the desktop.
    [[nodiscard]] QString language() const { return language_; }
    void setLanguage(const QString& language);

    [[nodiscard]] bool dark() const { return theme_ != Theme::Light; }
    [[nodiscard]] QColor color(Role role) const;
    /// Pixels of the design at the present scale.
    [[nodiscard]] int px(double designPixels) const;

signals:
    void aboutToChange();
    /// Theme or scale changed: sizes and hand-painted colours must be taken again. Icons and stylesheets follow by themselves.
    void changed();

private:
    Appearance();
    void apply();
    void loadTranslations();

    Theme theme_ = Theme::Dark;
    double scale_ = 1.0;
    QString language_;
    double basePointSize_ = 10.0;
    QTranslator ours_, qts_;
    std::unique_ptr<QTemporaryDir> images_;  // arrows and check marks that stylesheets can only take from files
    int imagesMade_ = 0;
};

/// A line icon of assets/icons in the colours of the theme; follows the theme by itself.
QIcon themedIcon(const QString& name, Appearance::Role role = Appearance::Role::Text);
inline QColor themeColor(Appearance::Role role) { return Appearance::instance().color(role); }
/// The background of panels.
void usePanelBackground(QWidget* widget);
inline int px(double designPixels) { return Appearance::instance().px(designPixels); }

}  // namespace imomushi
