// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/start_page.h"

#include <QAction>
#include <QAbstractButton>
#include <QEvent>
#include <QFileInfo>
#include <QGridLayout>
#include <QLabel>
#include <QLocale>
#include <QMenu>
#include <QPainter>
#include <QPainterPath>
#include <QPushButton>
#include <QScrollArea>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/models/recent_files.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr int kMaxColumns = 4, kFewestColumns = 3;
constexpr int kTileWidth = 232, kPicture = 145, kTileHeight = 201, kGap = 16;

// A project as a card: its picture, its name, and one line below.
class Tile : public QAbstractButton {
public:
    Tile(QImage picture, QString title, QString note, QString icon, QWidget* parent)
        : QAbstractButton(parent), picture_(std::move(picture)), note_(std::move(note)), icon_(std::move(icon)) {
        setText(title);
        setAccessibleName(title);
        setAccessibleDescription(note_);
        setCursor(Qt::PointingHandCursor);
        setFocusPolicy(Qt::StrongFocus);
        setFixedSize(px(kTileWidth), px(kTileHeight));
        setAttribute(Qt::WA_Hover);
    }

protected:
    void paintEvent(QPaintEvent*) override {
        QPainter painter(this);
        painter.setRenderHint(QPainter::Antialiasing);
        painter.setRenderHint(QPainter::SmoothPixmapTransform);
        const QRectF frame = QRectF(rect()).adjusted(0.75, 0.75, -0.75, -0.75);
        QPainterPath shape;
        shape.addRoundedRect(frame, px(10), px(10));
        const bool lit = isEnabled() && (underMouse() || hasFocus());
        painter.fillPath(shape, themeColor(lit ? Appearance::Role::Hover : Appearance::Role::Panel));
        const QRectF top(frame.left(), frame.top(), frame.width(), px(kPicture));
        painter.save();
        painter.setClipPath(shape);
        painter.fillRect(top, themeColor(Appearance::Role::Field));
        if (!picture_.isNull()) {
            painter.drawImage(top, picture_);
        } else {
            painter.setOpacity(isEnabled() ? 0.8 : 0.45);
            const int side = px(44);
            themedIcon(icon_, Appearance::Role::Muted).paint(&painter, QRect(int(top.center().x()) - side / 2, int(top.center().y()) - side / 2, side, side));
        }
        painter.restore();
        painter.setPen(QPen(themeColor(hasFocus() ? Appearance::Role::Accent : Appearance::Role::Line), hasFocus() ? 1.5 : 1.0));
        painter.drawPath(shape);
        const QRectF text = frame.adjusted(px(12), px(kPicture) + px(7), -px(12), -px(7));
        painter.setPen(themeColor(isEnabled() ? Appearance::Role::Text : Appearance::Role::Muted));
        QFont bold = font();
        bold.setWeight(QFont::DemiBold);
        painter.setFont(bold);
        painter.drawText(text, Qt::AlignLeft | Qt::AlignTop, QFontMetrics(bold).elidedText(this->text(), Qt::ElideRight, int(text.width())));
        painter.setFont(font());
        painter.setPen(themeColor(isEnabled() ? Appearance::Role::Muted : Appearance::Role::Warning));
        painter.drawText(text, Qt::AlignLeft | Qt::AlignBottom, fontMetrics().elidedText(note_, Qt::ElideMiddle, int(text.width())));
    }

private:
    QImage picture_;
    QString note_, icon_;
};

QString sampleNote(const QString& name) {
    if (name == u"caterpillar") return StartPage::tr("Five elements in a row");
    if (name == u"octopus") return StartPage::tr("A body with eight arms");
    if (name == u"figure") return StartPage::tr("Head, trunk, arms and legs");
    return {};
}

}  // namespace

QString sampleTitle(const QString& name) {
    if (name == u"caterpillar") return StartPage::tr("Caterpillar");
    if (name == u"octopus") return StartPage::tr("Octopus");
    if (name == u"figure") return StartPage::tr("Cartoon figure");
    return name;
}

StartPage::StartPage(RecentFiles& recent, QWidget* parent) : QWidget(parent), recent_(recent) {
    setObjectName(QStringLiteral("startPage"));
    setAttribute(Qt::WA_StyledBackground);
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    auto* scroll = new QScrollArea(this);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setObjectName(QStringLiteral("startScroll"));
    layout->addWidget(scroll);
    connect(&recent, &RecentFiles::changed, this, [this] {
        if (isVisible()) rebuild();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, &StartPage::rebuild);
}

void StartPage::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    rebuild();
}

void StartPage::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    if (columnsThatFit() != columns_) rebuild();
}

void StartPage::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) rebuild();
}

int StartPage::columnsThatFit() const {
    const int useful = std::clamp(int(std::max(samples().size(), recent_.paths().size())), kFewestColumns, kMaxColumns);
    return std::clamp((width() - px(96) + px(kGap)) / px(kTileWidth + kGap), 1, useful);
}

void StartPage::rebuild() {
    columns_ = columnsThatFit();
    auto* scroll = findChild<QScrollArea*>(QStringLiteral("startScroll"));
    content_ = new QWidget;
    content_->setObjectName(QStringLiteral("startPage"));
    content_->setAttribute(Qt::WA_StyledBackground);
    auto* outer = new QHBoxLayout(content_);
    outer->setContentsMargins(px(48), px(44), px(48), px(36));
    auto* column = new QWidget(content_);
    column->setFixedWidth(columns_ * px(kTileWidth) + (columns_ - 1) * px(kGap));
    outer->addStretch(1);
    outer->addWidget(column);
    outer->addStretch(1);
    auto* layout = new QVBoxLayout(column);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->setSpacing(px(14));

    auto* head = new QHBoxLayout;
    head->setSpacing(px(16));
    auto* logo = new QLabel(column);
    logo->setPixmap(QIcon(QStringLiteral(":/icons/imomushi.svg")).pixmap(QSize(px(60), px(60)), devicePixelRatioF()));
    auto* titles = new QVBoxLayout;
    titles->setSpacing(px(1));
    auto* title = new QLabel(QStringLiteral("Imomushi"), column);
    title->setProperty("role", "huge");
    auto* line = new QLabel(tr("Soft characters that bend, stretch and squash as you drag them"), column);
    line->setProperty("role", "muted");
    titles->addWidget(title);
    titles->addWidget(line);
    head->addWidget(logo);
    head->addLayout(titles, 1);
    layout->addLayout(head);
    layout->addSpacing(px(10));

    auto* buttons = new QHBoxLayout;
    buttons->setSpacing(px(10));
    const auto button = [&](const QString& icon, const QString& text, bool primary, auto signal) {
        auto* b = new QPushButton(themedIcon(icon, primary ? Appearance::Role::OnAccent : Appearance::Role::Text), text, column);
        b->setIconSize(QSize(px(18), px(18)));
        b->setProperty("primary", primary);
        connect(b, &QPushButton::clicked, this, signal);
        buttons->addWidget(b);
    };
    button(QStringLiteral("import"), tr("Import a mesh…"), true, &StartPage::importWanted);
    button(QStringLiteral("open"), tr("Open a project…"), false, &StartPage::openWanted);
    button(QStringLiteral("new"), tr("Empty project"), false, &StartPage::newWanted);
    buttons->addStretch(1);
    layout->addLayout(buttons);

    const auto group = [&](const QString& name) {
        auto* label = new QLabel(name, column);
        label->setProperty("role", "title");
        layout->addSpacing(px(16));
        layout->addWidget(label);
        auto* grid = new QGridLayout;
        grid->setSpacing(px(kGap));
        grid->setAlignment(Qt::AlignLeft | Qt::AlignTop);
        layout->addLayout(grid);
        return grid;
    };
    const auto place = [&](QGridLayout* grid, QWidget* tile) {
        const int n = grid->count();
        grid->addWidget(tile, n / columns_, n % columns_);
    };

    const QList<Sample> all = samples();
    if (!all.isEmpty()) {
        QGridLayout* grid = group(tr("Samples"));
        for (const Sample& sample : all) {
            auto* tile = new Tile(QImage(sample.picture), sampleTitle(sample.name), sampleNote(sample.name), QStringLiteral("character"), column);
            tile->setObjectName(QStringLiteral("sample-") + sample.name);
            connect(tile, &QAbstractButton::clicked, this, [this, path = sample.path] { Q_EMIT fileWanted(path); });
            place(grid, tile);
        }
    }
    const QStringList paths = recent_.paths();
    if (!paths.isEmpty()) {
        QGridLayout* grid = group(tr("Recent projects"));
        for (const QString& path : paths) {
            const QFileInfo info(path);
            const bool there = info.exists();
            auto* tile = new Tile(there ? recent_.thumbnail(path) : QImage(), info.completeBaseName(),
                                  there ? QLocale().toString(info.lastModified(), QLocale::ShortFormat) : tr("File is missing"),
                                  there ? QStringLiteral("character") : QStringLiteral("missing"), column);
            tile->setToolTip(path);
            tile->setEnabled(there);
            connect(tile, &QAbstractButton::clicked, this, [this, path] { Q_EMIT fileWanted(path); });
            auto* forget = new QAction(tr("Remove from this list"), tile);
            tile->setContextMenuPolicy(Qt::ActionsContextMenu);
            connect(forget, &QAction::triggered, this, [this, path] { recent_.remove(path); }, Qt::QueuedConnection);
            tile->addAction(forget);
            place(grid, tile);
        }
    }
    layout->addSpacing(px(12));
    auto* drop = new QLabel(tr("You can also drop meshes (OBJ, PLY, STL, glTF, FBX, DAE) and projects anywhere on this window."), column);
    drop->setProperty("role", "muted");
    drop->setWordWrap(true);
    layout->addWidget(drop);
    layout->addStretch(1);
    scroll->setWidget(content_);
}

}  // namespace imomushi
