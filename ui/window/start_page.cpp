// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/start_page.h"

#include <QAction>
#include <QAbstractButton>
#include <QEvent>
#include <QFileInfo>
#include <QGridLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QLocale>
#include <QMenu>
#include <QPainter>
#include <QPainterPath>
#include <QPushButton>
#include <QScrollArea>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/models/recent_files.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

constexpr int kMaxColumns = 4, kFewestColumns = 3;
constexpr int kTileWidth = 232, kLeastTileWidth = 200, kTileWords = 56, kGap = 16, kBeside = 28;
constexpr int kWayMargin = 16, kWayPlate = 40, kWayGap = 12, kWayNote = 9;  // of the cards for ways to begin

// A button that is painted by itself and pressed by Enter, too.
class Card : public QAbstractButton {
public:
    using QAbstractButton::QAbstractButton;

protected:
    void keyPressEvent(QKeyEvent* event) override {
        if (event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter) click();
        else QAbstractButton::keyPressEvent(event);
    }
};

// A project as a card: its picture, its name, and one line below.
class Tile : public Card {
public:
    Tile(int width, QImage picture, QString title, QString note, QString icon, QWidget* parent)
        : Card(parent), picture_(std::move(picture)), note_(std::move(note)), icon_(std::move(icon)) {
        setText(title);
        setAccessibleName(title);
        setAccessibleDescription(note_);
        setCursor(Qt::PointingHandCursor);
        setFocusPolicy(Qt::StrongFocus);
        setFixedSize(width, pictureHeight(width) + px(kTileWords));
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
        const QRectF top(frame.left(), frame.top(), frame.width(), pictureHeight(width()));
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
        const QRectF text = frame.adjusted(px(12), pictureHeight(width()) + px(7), -px(12), -px(7));
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
    static int pictureHeight(int width) { return width * 5 / 8; }
    QImage picture_;
    QString note_, icon_;
};

// A way to begin, as a card: a sign, what it is from, and what comes of it.
class WayCard : public Card {
public:
    WayCard(QString icon, QString title, QString note, QWidget* parent) : Card(parent), note_(std::move(note)), icon_(std::move(icon)) {
        setText(title);
        setAccessibleName(title);
        setAccessibleDescription(note_);
        setCursor(Qt::PointingHandCursor);
        setFocusPolicy(Qt::StrongFocus);
        setAttribute(Qt::WA_Hover);
        setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    }
    [[nodiscard]] QSize sizeHint() const override { return {px(kTileWidth), heightAt(px(kTileWidth))}; }
    /// All of its words can be read at this height.
    [[nodiscard]] int heightAt(int width) const {
        const QRect note = fontMetrics().boundingRect(QRect(0, 0, width - 2 * px(kWayMargin), 10000), Qt::AlignLeft | Qt::AlignTop | Qt::TextWordWrap, note_);
        return px(kWayMargin) + titleHeight(width) + px(kWayNote) + note.height() + px(kWayMargin);
    }

protected:
    void paintEvent(QPaintEvent*) override {
        using Role = Appearance::Role;
        QPainter p(this);
        p.setRenderHint(QPainter::Antialiasing);
        const QRectF frame = QRectF(rect()).adjusted(0.75, 0.75, -0.75, -0.75);
        const bool lit = underMouse() || hasFocus();
        p.setPen(QPen(themeColor(lit ? Role::Accent : Role::Line), lit ? 1.5 : 1.0));
        p.setBrush(themeColor(lit ? Role::Hover : Role::Panel));
        p.drawRoundedRect(frame, px(10), px(10));
        QColor tint = themeColor(Role::Accent);
        tint.setAlphaF(0.18f);
        const QRectF plate(px(kWayMargin), px(kWayMargin), px(kWayPlate), px(kWayPlate));
        p.setPen(Qt::NoPen);
        p.setBrush(tint);
        p.drawRoundedRect(plate, px(10), px(10));
        themedIcon(icon_, Role::Accent).paint(&p, plate.adjusted(px(8), px(8), -px(8), -px(8)).toRect());
        p.setFont(titleFont());
        p.setPen(themeColor(Role::Text));
        const int high = titleHeight(width());
        p.drawText(QRect(int(plate.right()) + px(kWayGap), px(kWayMargin), titleWidth(width()), high), Qt::AlignLeft | Qt::AlignVCenter | Qt::TextWordWrap, text());
        p.setFont(font());
        p.setPen(themeColor(Role::Muted));
        const int top = px(kWayMargin) + high + px(kWayNote);
        p.drawText(QRect(px(kWayMargin), top, width() - 2 * px(kWayMargin), height() - top), Qt::AlignLeft | Qt::AlignTop | Qt::TextWordWrap, note_);
    }

private:
    [[nodiscard]] QFont titleFont() const {
        QFont bold = font();
        bold.setWeight(QFont::DemiBold);
        bold.setPointSizeF(bold.pointSizeF() * 1.12);
        return bold;
    }
    [[nodiscard]] static int titleWidth(int width) { return width - px(kWayMargin) - px(kWayPlate) - 2 * px(kWayGap); }
    [[nodiscard]] int titleHeight(int width) const {
        return std::max(px(kWayPlate), QFontMetrics(titleFont()).boundingRect(QRect(0, 0, titleWidth(width), 10000), Qt::AlignLeft | Qt::TextWordWrap, text()).height());
    }

    QString note_, icon_;
};

// Where files may be dropped, which is everywhere; lit while one is held over the window.
class DropPlace : public QWidget {
public:
    explicit DropPlace(QWidget* parent) : QWidget(parent) {
        auto* sign = new QLabel(this);
        sign->setPixmap(themedIcon(QStringLiteral("import"), Appearance::Role::Muted).pixmap(QSize(px(20), px(20)), devicePixelRatioF()));
        auto* text = styled(new QLabel(StartPage::tr("Or drop meshes (OBJ, PLY, STL, glTF, FBX, DAE) and projects anywhere on this window."), this), "muted");
        text->setWordWrap(true);
        fill(new QHBoxLayout(this), QMargins(px(16), px(9), px(16), px(9)), Spacing{px(10)}, sign, Share{text, 1});
    }
    void setLit(bool lit) {
        lit_ = lit;
        update();
    }

protected:
    void paintEvent(QPaintEvent*) override {
        QPainter p(this);
        p.setRenderHint(QPainter::Antialiasing);
        QPen pen(themeColor(lit_ ? Appearance::Role::Accent : Appearance::Role::Line), lit_ ? px(2) : 1.5);
        pen.setDashPattern({5.0, 4.0});
        p.setPen(pen);
        if (lit_) {
            QColor tint = themeColor(Appearance::Role::Accent);
            tint.setAlphaF(0.12f);
            p.setBrush(tint);
        }
        p.drawRoundedRect(QRectF(rect()).adjusted(1, 1, -1, -1), px(10), px(10));
    }

private:
    bool lit_ = false;
};

QString sampleNote(const QString& name) {
    if (name == u"caterpillar") return StartPage::tr("Five elements in a row");
    if (name == u"octopus") return StartPage::tr("A body with eight arms");
    if (name == u"figure") return StartPage::tr("Head, trunk, arms and legs");
    if (name == u"dragon") return StartPage::tr("A rigged file, made soft");
    return {};
}

}  // namespace

QString sampleTitle(const QString& name) {
    if (name == u"caterpillar") return StartPage::tr("Caterpillar");
    if (name == u"octopus") return StartPage::tr("Octopus");
    if (name == u"figure") return StartPage::tr("Cartoon figure");
    if (name == u"dragon") return StartPage::tr("Baby dragon");
    return name;
}

StartPage::StartPage(RecentFiles& recent, QWidget* parent) : QWidget(parent), recent_(recent) {
    setObjectName(QStringLiteral("startPage"));
    setAttribute(Qt::WA_StyledBackground);
    auto* scroll = new QScrollArea(this);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setObjectName(QStringLiteral("startScroll"));
    fill(new QVBoxLayout(this), QMargins(0, 0, 0, 0), scroll);
    connect(&recent, &RecentFiles::changed, this, [this] {
        if (isVisible()) rebuild();
    });
    connect(&Appearance::instance(), &Appearance::changed, this, &StartPage::rebuild);
}

void StartPage::setDropping(bool dropping) {
    if (drop_) static_cast<DropPlace*>(drop_)->setLit(dropping);
}

void StartPage::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    rebuild();
}

void StartPage::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    if (columnsThatFit() != columns_ || tileWidthThatFits() != tileWidth_) rebuild();
}

void StartPage::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) rebuild();
}

void StartPage::addReplay(QWidget& tile, const QString& title, const QString& script) {
    auto* replay = named(new QToolButton(&tile), "replay");
    replay->setIcon(themedIcon(QStringLiteral("play"), Appearance::Role::Text));
    replay->setToolTip(tr("Watch how it was built"));
    replay->setAccessibleName(tr("Watch how “%1” was built").arg(title));
    replay->setFocusPolicy(Qt::StrongFocus);
    replay->setCursor(Qt::PointingHandCursor);
    const int side = px(30), inset = px(8);
    replay->setGeometry(tile.width() - side - inset, inset, side, side);
    connect(replay, &QToolButton::clicked, this, [this, title, script] { Q_EMIT replayWanted(title, script); }, Qt::QueuedConnection);
}

int StartPage::columnsThatFit() const {
    const int useful = std::clamp(int(std::max(samples().size(), recent_.paths().size())), kFewestColumns, kMaxColumns);
    return std::clamp((room() + px(kGap)) / px(kLeastTileWidth + kGap), 1, useful);
}

int StartPage::room() const { return width() - 2 * px(kBeside) - style()->pixelMetric(QStyle::PM_ScrollBarExtent); }

int StartPage::tileWidthThatFits() const {
    const int columns = columnsThatFit();
    if (columns == 1) return px(kTileWidth);
    return std::clamp((room() - (columns - 1) * px(kGap)) / columns, px(kLeastTileWidth), px(kTileWidth));
}

void StartPage::rebuild() {
    columns_ = columnsThatFit();
    tileWidth_ = tileWidthThatFits();
    auto* scroll = findChild<QScrollArea*>(QStringLiteral("startScroll"));
    content_ = named(new QWidget, "startPage");
    content_->setAttribute(Qt::WA_StyledBackground);
    auto* column = new QWidget(content_);
    column->setFixedWidth(columns_ * tileWidth_ + (columns_ - 1) * px(kGap));
    fill(new QHBoxLayout(content_), QMargins(px(kBeside), px(44), px(kBeside), px(36)), Stretch{}, column, Stretch{});
    auto* layout = fill(new QVBoxLayout(column), QMargins(0, 0, 0, 0), Spacing{px(14)});

    auto* logo = new QLabel(column);
    logo->setPixmap(QIcon(QStringLiteral(":/icons/imomushi.svg")).pixmap(QSize(px(60), px(60)), devicePixelRatioF()));
    auto* titles = fill(new QVBoxLayout, Spacing{px(1)});
    auto* title = styled(new QLabel(QStringLiteral("Imomushi"), column), "huge");
    auto* line = styled(new QLabel(tr("Soft characters that bend, stretch and squash as you drag them"), column), "muted");
    line->setWordWrap(true);
    fill(titles, title, line);
    auto* head = fill(new QHBoxLayout, Spacing{px(16)}, logo, Share{titles, 1});
    fill(layout, head, Space{px(10)});

    const QList<Sample> all = samples();
    const auto direction = columns_ < kFewestColumns ? QBoxLayout::TopToBottom : QBoxLayout::LeftToRight;
    auto* ways = new QBoxLayout(direction);
    ways->setSpacing(px(kGap));
    std::vector<WayCard*> cards;
    const auto way = [&](const char* name, const char* icon, const QString& from, const QString& note) {
        auto* card = new WayCard(QLatin1String(icon), from, note, column);
        card->setObjectName(QLatin1String(name));
        ways->addWidget(card, 1);
        cards.push_back(card);
        return card;
    };
    if (!all.isEmpty())
        connect(way("wayFromSample", "play", tr("From a sample"), tr("%1 opens, ready to be dragged. The others are below.").arg(sampleTitle(all.first().name))), &QAbstractButton::clicked, this,
                [this, path = all.first().path] { Q_EMIT fileWanted(path); });
    connect(way("wayFromMesh", "soft", tr("From a mesh"), tr("Any mesh of a creature. Cuts and bones follow its shape; seconds later you can drag it.")), &QAbstractButton::clicked, this,
            &StartPage::meshWanted);
    connect(way("wayFromRiggedFile", "bones", tr("From a rigged file"), tr("glTF, VRM, FBX or DAE with a skeleton: its bones become soft limbs, its clips takes.")), &QAbstractButton::clicked, this,
            &StartPage::riggedFileWanted);
    const int wide = ways->direction() == QBoxLayout::TopToBottom ? column->width() : (column->width() - (int(cards.size()) - 1) * px(kGap)) / int(cards.size());
    int high = 0;
    for (const WayCard* card : cards) high = std::max(high, card->heightAt(wide));
    for (WayCard* card : cards) card->setFixedHeight(high);
    layout->addLayout(ways);

    auto* drop = new DropPlace(column);
    drop_ = drop;
    auto* buttons = fill(new QBoxLayout(direction), Spacing{px(10)});
    const auto button = [&](const QString& icon, const QString& text, auto signal) {
        auto* b = new QPushButton(themedIcon(icon), text, column);
        b->setIconSize(QSize(px(18), px(18)));
        connect(b, &QPushButton::clicked, this, signal);
        buttons->addWidget(b);
    };
    buttons->addWidget(drop, 1);
    button(QStringLiteral("open"), tr("Open a project…"), &StartPage::openWanted);
    button(QStringLiteral("new"), tr("Empty project"), &StartPage::newWanted);
    layout->addLayout(buttons);

    const auto group = [&](const QString& name) {
        auto* label = styled(new QLabel(name, column), "title");
        fill(layout, Space{px(16)}, label);
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

    if (!all.isEmpty()) {
        QGridLayout* grid = group(tr("Samples"));
        for (const Sample& sample : all) {
            auto* tile = new Tile(tileWidth_, QImage(sample.picture), sampleTitle(sample.name), sampleNote(sample.name), QStringLiteral("character"), column);
            tile->setObjectName(QStringLiteral("sample-") + sample.name);
            connect(tile, &QAbstractButton::clicked, this, [this, path = sample.path] { Q_EMIT fileWanted(path); });
            if (!sample.script.isEmpty()) addReplay(*tile, sampleTitle(sample.name), sample.script);
            place(grid, tile);
        }
    }
    const QStringList paths = recent_.paths();
    if (!paths.isEmpty()) {
        QGridLayout* grid = group(tr("Recent projects"));
        for (const QString& path : paths) {
            const QFileInfo info(path);
            const bool there = info.exists();
            auto* tile = new Tile(tileWidth_, there ? recent_.thumbnail(path) : QImage(), info.completeBaseName(),
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
    layout->addStretch(1);
    scroll->setWidget(content_);
}

}  // namespace imomushi
