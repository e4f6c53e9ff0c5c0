// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/appearance.h"

#include <QApplication>
#include <QFile>
#include <QFontDatabase>
#include <QIconEngine>
#include <QLibraryInfo>
#include <QLocale>
#include <QPainter>
#include <QPalette>
#include <QPixmapCache>
#include <QRegularExpression>
#include <QSettings>
#include <QStyleFactory>
#include <QSvgRenderer>
#include <QTemporaryDir>
#include <QWidget>
#include <algorithm>
#include <array>
#include <cmath>

namespace imomushi {
namespace {

using Role = Appearance::Role;
constexpr int kRoles = int(Role::Good) + 1;

// In the order of Role. Text on every ground it is used on has a contrast of at least 4.5 : 1, in the last theme 7 : 1.
struct Colors {
    std::array<const char*, kRoles> values;
};
//                                 Window     Panel      Field      Hover      Line       Text       Muted      Accent     OnAccent   Info       Warning    Error      Good
constexpr Colors kDark = {{"#191b1f", "#202328", "#2a2e34", "#343940", "#31363d", "#e6e8eb", "#9ba3ad", "#8ccb6b", "#10180b", "#7cb7f0", "#ecb45a", "#f28b7d", "#8ccb6b"}};
constexpr Colors kLight = {{"#e9ebe8", "#f7f8f6", "#ffffff", "#e3e7e0", "#d3d8d0", "#1f2421", "#5b635d", "#3c7a2a", "#ffffff", "#1f66a8", "#8a5a00", "#b3321f", "#3c7a2a"}};
constexpr Colors kContrast = {{"#000000", "#000000", "#0c0c0c", "#2b2b2b", "#c8c8c8", "#ffffff", "#dedede", "#ffd84d", "#000000", "#8fd0ff", "#ffd84d", "#ffa89c", "#9dff8a"}};

const Colors& colorsOf(Appearance::Theme theme) {
    switch (theme) {
        case Appearance::Theme::Light: return kLight;
        case Appearance::Theme::HighContrast: return kContrast;
        case Appearance::Theme::Dark: break;
    }
    return kDark;
}

QByteArray iconSource(const QString& name, const QColor& color) {
    QFile file(QStringLiteral(":/icons/%1.svg").arg(name));
    if (!file.open(QIODevice::ReadOnly)) return {};
    QByteArray svg = file.readAll();
    svg.replace("currentColor", color.name().toLatin1());
    return svg;
}

class LineIconEngine : public QIconEngine {
public:
    LineIconEngine(QString name, Role role) : name_(std::move(name)), role_(role) {}

    void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State state) override {
        painter->drawPixmap(rect, draw(rect.size() * painter->device()->devicePixelRatioF(), mode, state));
    }
    QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override { return draw(size, mode, state); }
    QPixmap scaledPixmap(const QSize& size, QIcon::Mode mode, QIcon::State state, qreal) override { return draw(size, mode, state); }
    QIconEngine* clone() const override { return new LineIconEngine(*this); }

private:
    // size in device pixels
    QPixmap draw(const QSize& size, QIcon::Mode mode, QIcon::State state) const {
        Role role = role_;
        if (state == QIcon::On && role == Role::Text) role = Role::Accent;
        QColor color = themeColor(role);
        const qreal opacity = mode == QIcon::Disabled ? 0.35 : 1.0;
        const QString key = QStringLiteral("imomushi/%1/%2/%3x%4/%5").arg(name_, color.name()).arg(size.width()).arg(size.height()).arg(opacity);
        QPixmap pixmap;
        if (QPixmapCache::find(key, &pixmap)) return pixmap;
        pixmap = QPixmap(size);
        pixmap.fill(Qt::transparent);
        QPainter painter(&pixmap);
        painter.setOpacity(opacity);
        QSvgRenderer(iconSource(name_, color)).render(&painter, QRectF(QPointF(0, 0), QSizeF(size)));
        painter.end();
        QPixmapCache::insert(key, pixmap);
        return pixmap;
    }

    QString name_;
    Role role_;
};

constexpr const char* kStyle = R"(
* { outline: none; }
QWidget { color: @text; }
QMainWindow, QDialog, QMessageBox { background: @window; }
QMainWindow::separator { background: @window; width: 5px; height: 5px; }
QMainWindow::separator:hover { background: @line; }
QToolTip { background: @field; color: @text; border: 1px solid @line; border-radius: 4px; padding: 5px 8px; }

QMenuBar { background: @window; padding: 3px 6px; }
QMenuBar::item { padding: 5px 10px; border-radius: 5px; background: transparent; }
QMenuBar::item:selected { background: @hover; }
QMenu { background: @panel; border: 1px solid @line; border-radius: 8px; padding: 6px; }
QMenu::item { padding: 6px 28px 6px 12px; border-radius: 5px; }
QMenu::icon { padding-left: 8px; }
QMenu::item:selected { background: @hover; }
QMenu::item:disabled { color: @faint; }
QMenu::separator { height: 1px; background: @line; margin: 6px 8px; }
QMenu::indicator { width: 14px; height: 14px; left: 8px; }
QMenu::indicator:checked { image: url(@check-icon); }
QMenu::right-arrow { image: url(@right-icon); width: 14px; height: 14px; right: 6px; }

QToolBar { background: @window; border: none; padding: 6px 5px; spacing: 3px; }
QToolBar::separator { background: @line; height: 1px; margin: 4px 7px; }
QToolButton { background: transparent; border: none; border-radius: 7px; padding: 7px; }
QToolButton:hover { background: @hover; }
QToolButton:pressed { background: @field; }
QToolButton:checked { background: @tint; }
QToolButton:focus { border: 1px solid @accent; padding: 6px; }
QToolButton::menu-button { background: transparent; border: none; border-radius: 4px; width: 12px; }
QToolButton::menu-button:hover { background: @hover; }
QToolButton::menu-arrow { image: url(@down-icon); width: 10px; height: 10px; }
QToolButton[small="true"] { padding: 3px; border-radius: 5px; }
QToolButton[small="true"]:focus { padding: 2px; }
QToolButton[link="true"] { color: @muted; padding: 3px 8px; border-radius: 5px; }
QToolButton[link="true"]:hover { color: @text; }

QDockWidget { titlebar-close-icon: url(@close-icon); color: @text; }
QDockWidget::title { background: @panel; text-align: left; padding: 6px 12px; }
QDockWidget > QWidget { background: @panel; }
QTabBar { background: transparent; qproperty-drawBase: 0; }
QTabBar::tab { background: transparent; color: @muted; padding: 7px 13px; border: none; border-bottom: 2px solid transparent; }
QTabBar::tab:hover { color: @text; }
QTabBar::tab:selected { color: @text; border-bottom: 2px solid @accent; }
QTabWidget::pane { border: none; background: @panel; }
QTabWidget::tab-bar { left: 8px; }

QTreeView, QListView, QTableView, QTableWidget, QListWidget { background: @panel; border: none; selection-background-color: @tint; selection-color: @text; alternate-background-color: @panel; }
QTreeView::item, QListView::item { padding: 4px 2px; border: none; }
QTreeView::item:hover, QListView::item:hover { background: @hover; }
QTreeView::item:selected, QListView::item:selected { background: @tint; color: @text; }
QTreeView::branch { background: transparent; }
QTreeView::branch:selected { background: @tint; }
QTreeView::branch:hover:!selected { background: @hover; }
QTreeView::branch:has-children:closed { image: url(@right-icon); }
QTreeView::branch:has-children:open { image: url(@down-icon); }
QHeaderView::section { background: @panel; color: @muted; border: none; border-bottom: 1px solid @line; padding: 6px 8px; }
QTableView::item { padding: 3px 8px; }

QLineEdit, QAbstractSpinBox, QComboBox, QKeySequenceEdit, QPlainTextEdit { background: @field; border: 1px solid @fieldline; border-radius: 6px; padding: 4px 8px; min-height: 18px; selection-background-color: @accent; selection-color: @onaccent; }
QLineEdit:hover, QAbstractSpinBox:hover, QComboBox:hover { border-color: @hoverline; }
QLineEdit:focus, QAbstractSpinBox:focus, QComboBox:focus, QPlainTextEdit:focus { border-color: @accent; }
QLineEdit:disabled, QAbstractSpinBox:disabled, QComboBox:disabled { color: @faint; background: @panel; }
QComboBox { padding-right: 24px; }
QComboBox::drop-down { border: none; width: 22px; }
QComboBox::down-arrow { image: url(@down-icon); width: 13px; height: 13px; }
QComboBox QAbstractItemView { background: @panel; border: 1px solid @line; border-radius: 6px; padding: 4px; selection-background-color: @hover; }
QComboBox QAbstractItemView::item { padding: 5px 8px; min-height: 20px; border-radius: 4px; }
QTreeView QLineEdit, QTableView QLineEdit { padding: 0 4px; min-height: 0; border-radius: 4px; }

QDialogButtonBox { dialogbuttonbox-buttons-have-icons: 0; }
QMessageBox { messagebox-text-interaction-flags: 5; }
#qt_msgbox_label { font-weight: 600; padding: 12px 16px 2px 4px; }
#qt_msgbox_informativelabel { color: @muted; padding: 0px 16px 10px 4px; }
QPushButton { background: @field; border: 1px solid @fieldline; border-radius: 7px; padding: 6px 16px; min-height: 18px; }
QPushButton[small="true"] { padding: 1px 10px; min-height: 16px; }
QPushButton:hover { background: @hover; }
QPushButton:pressed { background: @line; }
QPushButton:focus { border-color: @accent; }
QPushButton:disabled { color: @faint; background: @panel; }
QPushButton[primary="true"], QDialog QPushButton:default { background: @accent; border-color: @accent; color: @onaccent; font-weight: 600; }
QPushButton[primary="true"]:hover, QDialog QPushButton:default:hover { background: @accenthover; }
QPushButton[primary="true"]:focus, QDialog QPushButton:default:focus { border: 1px solid @text; }
QPushButton[primary="true"]:disabled, QDialog QPushButton:default:disabled { background: @field; border-color: @fieldline; color: @faint; }
QPushButton[field="true"] { border-radius: 6px; padding: 4px 24px 4px 8px; text-align: left; }
QPushButton[flat="true"] { border: none; background: transparent; color: @accent; padding: 1px 0px; text-align: left; }
QPushButton[flat="true"]:hover, QPushButton[flat="true"]:focus { text-decoration: underline; }
QPushButton::menu-indicator { image: url(@down-icon); width: 13px; height: 13px; subcontrol-origin: border; subcontrol-position: right center; right: 6px; }

QCheckBox { spacing: 8px; background: transparent; }
QCheckBox::indicator, QTreeView::indicator, QListView::indicator { width: 16px; height: 16px; border: 1px solid @hoverline; border-radius: 4px; background: @field; }
QCheckBox::indicator:checked, QTreeView::indicator:checked, QListView::indicator:checked { background: @accent; border-color: @accent; image: url(@checkmark-icon); }
QCheckBox::indicator:focus { border-color: @text; }
QCheckBox:focus { color: @accent; }
QCheckBox:disabled { color: @faint; }
QCheckBox::indicator:disabled { background: @panel; border-color: @fieldline; }
QCheckBox::indicator:checked:disabled { background: @fieldline; }

QScrollBar:vertical { background: transparent; width: 10px; margin: 0; }
QScrollBar:horizontal { background: transparent; height: 10px; margin: 0; }
QScrollBar::handle { background: @line; border-radius: 3px; margin: 2px; min-height: 28px; min-width: 28px; }
QScrollBar::handle:hover { background: @hoverline; }
QScrollBar::add-line, QScrollBar::sub-line, QScrollBar::add-page, QScrollBar::sub-page { background: none; border: none; width: 0; height: 0; }
QAbstractScrollArea::corner { background: transparent; border: none; }
QScrollArea { border: none; background: transparent; }
QSplitter::handle { background: @line; }

QProgressBar { background: @field; border: none; border-radius: 3px; max-height: 6px; min-height: 6px; }
QProgressBar::chunk { background: @accent; border-radius: 3px; }
QSlider::groove:horizontal { background: @field; height: 4px; border-radius: 2px; }
QSlider::handle:horizontal { background: @accent; width: 14px; height: 14px; margin: -5px 0; border-radius: 7px; }

QLabel { background: transparent; }
QLabel[role="muted"] { color: @muted; }
QLabel[role="section"] { color: @text; font-weight: 600; }
QLabel[role="title"] { font-size: @titlept; font-weight: 600; }
QLabel[role="huge"] { font-size: @hugept; font-weight: 600; }
QLabel[role="warning"] { color: @warning; }
QLabel[role="error"] { color: @error; }
QLabel[role="good"] { color: @good; }

#panel { background: @panel; }
#card, #toast { background: @panel; border: 1px solid @line; border-radius: 10px; }
#tile { background: @panel; border: 1px solid @line; border-radius: 10px; text-align: left; padding: 0; }
#tile:hover { background: @hover; border-color: @hoverline; }
#tile:focus { border-color: @accent; }
#tile:disabled { background: @window; }
#statusBar { background: @window; }
#statusBar QToolButton { padding: 3px 8px; border-radius: 5px; color: @muted; }
#statusBar QToolButton:focus { padding: 2px 7px; }
#statusBar QLabel { color: @muted; }
#startPage { background: @window; }
#wall { background: @line; max-width: 1px; min-width: 1px; border: none; }
#rule { background: @line; max-height: 1px; min-height: 1px; border: none; }
#search QLineEdit { border: none; background: transparent; padding: 8px 4px; font-size: @titlept; }
#search { background: @panel; border: 1px solid @line; border-radius: 12px; }
)";

QColor mix(const QColor& a, const QColor& b, double t) {
    return QColor::fromRgbF(float(a.redF() + (b.redF() - a.redF()) * t), float(a.greenF() + (b.greenF() - a.greenF()) * t),
                            float(a.blueF() + (b.blueF() - a.blueF()) * t));
}

Appearance* theInstance = nullptr;

}  // namespace

Appearance& Appearance::instance() {
    Q_ASSERT(theInstance);
    return *theInstance;
}

void Appearance::start() {
    if (!theInstance) theInstance = new Appearance;
    theInstance->loadTranslations();
    theInstance->apply();
}

Appearance::Appearance() : QObject(qApp), images_(std::make_unique<QTemporaryDir>()) {
    const QSettings settings;
    const QString theme = settings.value(QStringLiteral("appearance/theme"), QStringLiteral("dark")).toString();
    theme_ = theme == u"light" ? Theme::Light : theme == u"contrast" ? Theme::HighContrast : Theme::Dark;
    scale_ = std::clamp(settings.value(QStringLiteral("appearance/scale"), 1.0).toDouble(), 1.0, 3.0);
    language_ = settings.value(QStringLiteral("appearance/language")).toString();
    QApplication::setStyle(QStyleFactory::create(QStringLiteral("Fusion")));
    QFont font = QApplication::font();
    // Inter has no Japanese: name the Japanese face of Noto, or its Chinese forms may be taken.
    QStringList families;
    for (const char* family : {"Inter", "Noto Sans", "Noto Sans CJK JP", "Noto Sans JP"})
        if (QFontDatabase::hasFamily(QString::fromLatin1(family))) families << QString::fromLatin1(family);
    families << font.family();
    font.setFamilies(families);
    font.setPointSizeF(basePointSize_);
    font.setHintingPreference(QFont::PreferVerticalHinting);
    QApplication::setFont(font);
}

Appearance::~Appearance() { theInstance = nullptr; }

QColor Appearance::color(Role role) const { return QColor(QLatin1String(colorsOf(theme_).values[std::size_t(role)])); }

int Appearance::px(double designPixels) const { return int(std::lround(designPixels * scale_)); }

void Appearance::setTheme(Theme theme) {
    if (theme == theme_) return;
    theme_ = theme;
    static constexpr const char* kNames[] = {"dark", "light", "contrast"};
    QSettings().setValue(QStringLiteral("appearance/theme"), QString::fromLatin1(kNames[int(theme)]));
    apply();
}

void Appearance::setScale(double scale) {
    scale = std::clamp(scale, 1.0, 3.0);
    if (scale == scale_) return;
    scale_ = scale;
    QSettings().setValue(QStringLiteral("appearance/scale"), scale);
    apply();
}

void Appearance::setLanguage(const QString& language) {
    if (language == language_) return;
    language_ = language;
    QSettings().setValue(QStringLiteral("appearance/language"), language);
    loadTranslations();
}

void Appearance::loadTranslations() {
    QCoreApplication::removeTranslator(&ours_);
    QCoreApplication::removeTranslator(&qts_);
    const QLocale locale = language_.isEmpty() ? QLocale::system() : QLocale(language_);
    QLocale::setDefault(locale);
    if (qts_.load(locale, QStringLiteral("qtbase"), QStringLiteral("_"), QLibraryInfo::path(QLibraryInfo::TranslationsPath)))
        QCoreApplication::installTranslator(&qts_);
    if (ours_.load(locale, QStringLiteral("imomushi"), QStringLiteral("_"), QStringLiteral(":/translations")))
        QCoreApplication::installTranslator(&ours_);
    else if (ours_.load(QStringLiteral(":/translations/imomushi_en.qm")))  // every other language: English with its plurals
        QCoreApplication::installTranslator(&ours_);
}

void Appearance::apply() {
    Q_EMIT aboutToChange();
    const QColor text = color(Role::Text), panel = color(Role::Panel), accent = color(Role::Accent);
    const QColor faint = mix(panel, text, theme_ == Theme::HighContrast ? 0.65 : 0.38);
    QPalette palette;
    palette.setColor(QPalette::Window, color(Role::Window));
    palette.setColor(QPalette::Base, color(Role::Field));
    palette.setColor(QPalette::AlternateBase, panel);
    palette.setColor(QPalette::Button, color(Role::Field));
    palette.setColor(QPalette::WindowText, text);
    palette.setColor(QPalette::Text, text);
    palette.setColor(QPalette::ButtonText, text);
    palette.setColor(QPalette::ToolTipBase, color(Role::Field));
    palette.setColor(QPalette::ToolTipText, text);
    palette.setColor(QPalette::PlaceholderText, color(Role::Muted));
    palette.setColor(QPalette::Highlight, accent);
    palette.setColor(QPalette::HighlightedText, color(Role::OnAccent));
    palette.setColor(QPalette::Link, color(Role::Info));
    palette.setColor(QPalette::Light, color(Role::Hover));
    palette.setColor(QPalette::Mid, color(Role::Line));
    palette.setColor(QPalette::Dark, color(Role::Window));
    palette.setColor(QPalette::Shadow, Qt::black);
    for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText}) palette.setColor(QPalette::Disabled, role, faint);
    QApplication::setPalette(palette);

    QFont font = QApplication::font();
    font.setPointSizeF(basePointSize_ * scale_);
    QApplication::setFont(font);

    // Stylesheets take pictures from files only; a new name per theme keeps Qt's cache from showing the old colour.
    ++imagesMade_;
    const auto image = [&](const char* name, const QColor& c) {
        const QString path = images_->filePath(QStringLiteral("%1-%2.svg").arg(QLatin1String(name)).arg(imagesMade_) + c.name().mid(1) + QStringLiteral(".svg"));
        QFile file(path);
        if (file.open(QIODevice::WriteOnly)) file.write(iconSource(QLatin1String(name), c));
        return path;
    };
    QString style = QString::fromLatin1(kStyle);
    static const QRegularExpression pixels(QStringLiteral("(\\d+)px"));
    if (scale_ != 1.0) {
        QString scaled;
        qsizetype last = 0;
        for (auto it = pixels.globalMatch(style); it.hasNext();) {
            const auto match = it.next();
            const int value = match.captured(1).toInt();
            scaled += QStringView(style).mid(last, match.capturedStart() - last);
            scaled += QStringLiteral("%1px").arg(value <= 2 ? value : px(value));
            last = match.capturedEnd();
        }
        style = scaled + style.mid(last);
    }
    const QColor muted = color(Role::Muted);
    const std::pair<const char*, QString> tokens[] = {
        {"@check-icon", image("check", text)},
        {"@checkmark-icon", image("check", color(Role::OnAccent))},
        {"@right-icon", image("chevron-right", muted)},
        {"@down-icon", image("chevron-down", muted)},
        {"@close-icon", image("close", muted)},
        {"@titlept", QStringLiteral("%1pt").arg(basePointSize_ * scale_ * 1.25)},
        {"@hugept", QStringLiteral("%1pt").arg(basePointSize_ * scale_ * 2.1)},
        {"@onaccent", color(Role::OnAccent).name()},
        {"@accenthover", mix(accent, text, 0.18).name()},
        {"@accent", accent.name()},
        {"@tint", mix(panel, accent, theme_ == Theme::HighContrast ? 0.45 : 0.22).name()},
        {"@window", color(Role::Window).name()},
        {"@panel", panel.name()},
        {"@fieldline", mix(color(Role::Field), text, theme_ == Theme::HighContrast ? 0.8 : 0.08).name()},
        {"@field", color(Role::Field).name()},
        {"@hoverline", mix(color(Role::Line), text, 0.25).name()},
        {"@hover", color(Role::Hover).name()},
        {"@line", color(Role::Line).name()},
        {"@text", text.name()},
        {"@muted", muted.name()},
        {"@faint", faint.name()},
        {"@warning", color(Role::Warning).name()},
        {"@error", color(Role::Error).name()},
        {"@good", color(Role::Good).name()},
    };
    for (const auto& [token, value] : tokens) style.replace(QLatin1String(token), value);
    qApp->setStyleSheet(style);
    Q_EMIT changed();
}

QIcon themedIcon(const QString& name, Appearance::Role role) { return QIcon(new LineIconEngine(name, role)); }

void usePanelBackground(QWidget* widget) {
    widget->setObjectName(QStringLiteral("panel"));  // as the style sheet calls it
    widget->setAttribute(Qt::WA_StyledBackground);
}

}  // namespace imomushi
