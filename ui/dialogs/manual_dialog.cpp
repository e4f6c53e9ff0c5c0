// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/manual_dialog.h"

#include <QEvent>
#include <QFile>
#include <QHBoxLayout>
#include <QImage>
#include <QLineEdit>
#include <QListWidget>
#include <QPushButton>
#include <QRegularExpression>
#include <QScrollBar>
#include <QTextBlock>
#include <QTextTable>
#include <QVBoxLayout>

#include "ui/models/recent_files.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

constexpr int kFileRole = Qt::UserRole;

QString read(const QString& path) {
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? QString::fromUtf8(file.readAll()) : QString();
}

QString anchorOf(const QString& heading) {
    QString name = heading.toLower();
    name.replace(u' ', u'-');
    return name.remove(QRegularExpression(QStringLiteral("[!-,./:-@\\[-^`{-~]")));  // ASCII punctuation but - and _
}

}  // namespace

ManualPage::ManualPage(QWidget* parent) : QTextBrowser(parent) {
    setOpenExternalLinks(true);
    setFrameShape(QFrame::NoFrame);
    document()->setDocumentMargin(px(18));
}

QVariant ManualPage::loadResource(int type, const QUrl& name) {
    QVariant found = QTextBrowser::loadResource(type, name);
    if (type != QTextDocument::ImageResource) return found;
    QImage picture = found.canConvert<QImage>() ? found.value<QImage>() : QImage();
    if (picture.isNull()) picture.loadFromData(found.toByteArray());
    // Sharp on dense screens, too: as many pixels as the page is wide there.
    const int width = this->width() - verticalScrollBar()->sizeHint().width() - 2 * int(document()->documentMargin());
    const int pixels = qRound(width * devicePixelRatioF());
    if (width > 0 && picture.width() > pixels) picture = picture.scaledToWidth(pixels, Qt::SmoothTransformation);
    picture.setDevicePixelRatio(std::max(1.0, picture.width() / double(std::max(1, std::min(width, picture.width())))));
    return picture;
}

void ManualPage::doSetSource(const QUrl& name, QTextDocument::ResourceType type) {
    QTextBrowser::doSetSource(name, type);
    setType();
}

void ManualPage::setType() {
    for (QTextBlock block = document()->begin(); block.isValid(); block = block.next()) {
        QTextCursor cursor(block);
        QTextBlockFormat format = block.blockFormat();
        const bool program = format.hasProperty(QTextFormat::BlockCodeFence) || format.nonBreakableLines();
        format.setNonBreakableLines(false);
        if (program) {
            format.setBackground(themeColor(Appearance::Role::Hover));
            format.setLeftMargin(px(10));
        } else if (!cursor.currentTable() && !block.textList()) {
            format.setTopMargin(format.headingLevel() > 0 ? px(16) : px(4));
            format.setBottomMargin(px(6));
        }
        cursor.setBlockFormat(format);
    }
    for (QTextFrame* frame : document()->rootFrame()->childFrames()) {
        auto* table = qobject_cast<QTextTable*>(frame);
        if (!table) continue;
        // Qt's reader leaves an empty line in the first cell.
        QTextCursor first = table->cellAt(0, 0).firstCursorPosition();
        if (first.block().text().isEmpty() && table->cellAt(0, 0).lastCursorPosition().block() != first.block()) first.deleteChar();
        first.movePosition(QTextCursor::EndOfBlock, QTextCursor::KeepAnchor);
        QTextCharFormat head;
        head.setFontWeight(QFont::Bold);
        first.mergeCharFormat(head);
        QTextTableFormat format = table->format();
        format.setBorderCollapse(true);
        format.setBorder(1.0);
        format.setBorderStyle(QTextFrameFormat::BorderStyle_Solid);
        format.setBorderBrush(themeColor(Appearance::Role::Line));
        format.setCellSpacing(0.0);
        format.setCellPadding(px(5));
        format.setTopMargin(px(6));
        format.setBottomMargin(px(10));
        table->setFormat(format);
    }
}

void ManualPage::scrollToHeading(const QString& anchor) {
    for (QTextBlock block = document()->begin(); block.isValid(); block = block.next()) {
        if (block.blockFormat().headingLevel() == 0 || anchorOf(block.text()) != anchor) continue;
        QTextCursor cursor(block);
        setTextCursor(cursor);
        verticalScrollBar()->setValue(verticalScrollBar()->value() + cursorRect(cursor).top() - int(document()->documentMargin()));
        return;
    }
}

ManualDialog::ManualDialog(QWidget* parent) : QDialog(parent) {
    setObjectName(QStringLiteral("manualDialog"));
    setAttribute(Qt::WA_DeleteOnClose);
    contents_ = named(new QListWidget(this), "manualContents");
    contents_->setFixedWidth(px(230));
    contents_->setWordWrap(true);
    page_ = named(new ManualPage(this), "manualPage");
    search_ = named(new QLineEdit(this), "manualSearch");
    search_->setClearButtonEnabled(true);
    search_->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);  // a row is no higher than its lowest part lets it be: buttons in Japanese are higher
    search_->addAction(themedIcon(QStringLiteral("search"), Appearance::Role::Muted), QLineEdit::LeadingPosition);
    back_ = named(new QPushButton(this), "manualBack");
    forward_ = named(new QPushButton(this), "manualForward");
    close_ = new QPushButton(this);
    for (QPushButton* button : {back_, forward_, close_}) button->setAutoDefault(false);  // Enter searches
    fill(new QVBoxLayout(this), QMargins(px(14), px(14), px(14), px(14)), Spacing{px(10)},
         fill(new QHBoxLayout, Spacing{px(8)}, back_, forward_, Share{search_, 1}),
         Share{fill(new QHBoxLayout, Spacing{px(10)}, contents_, Share{page_, 1}), 1}, fill(new QHBoxLayout, Stretch{}, close_));
    connect(back_, &QPushButton::clicked, page_, &QTextBrowser::backward);
    connect(forward_, &QPushButton::clicked, page_, &QTextBrowser::forward);
    connect(close_, &QPushButton::clicked, this, &QDialog::close);
    connect(page_, &QTextBrowser::backwardAvailable, back_, &QWidget::setEnabled);
    connect(page_, &QTextBrowser::forwardAvailable, forward_, &QWidget::setEnabled);
    connect(page_, &QTextBrowser::sourceChanged, this, &ManualDialog::follow);
    connect(contents_, &QListWidget::itemClicked, this, [this](QListWidgetItem* item) { open(item->data(kFileRole).toString()); });
    connect(contents_, &QListWidget::itemActivated, this, [this](QListWidgetItem* item) { open(item->data(kFileRole).toString()); });
    connect(search_, &QLineEdit::textChanged, this, &ManualDialog::filter);
    connect(search_, &QLineEdit::returnPressed, this, &ManualDialog::find);
    back_->setEnabled(false);
    forward_->setEnabled(false);
    connect(&Appearance::instance(), &Appearance::changed, page_, &QTextBrowser::reload);
    resize(px(1120), px(760));
    retranslate();
}

void ManualDialog::retranslate() {
    setWindowTitle(tr("Manual"));
    back_->setText(tr("Back"));
    forward_->setText(tr("Forward"));
    close_->setText(tr("Close"));
    search_->setPlaceholderText(tr("Search the manual"));
    search_->setAccessibleName(search_->placeholderText());
    contents_->setAccessibleName(tr("Contents"));
    page_->setAccessibleName(windowTitle());
    const QString folder = manualFolder(tr("en", "folder of the manual in this language"));
    if (folder == folder_) return;
    const QString shown = folder_.isEmpty() ? QStringLiteral("index.md") : page_->source().fileName();
    folder_ = folder;
    // The first page lists all others.
    contents_->clear();
    const QString index = read(folder_ + QStringLiteral("/index.md"));
    const auto add = [this](const QString& title, const QString& file) {
        auto* item = new QListWidgetItem(title, contents_);
        item->setData(kFileRole, file);
    };
    add(index.section(u'\n', 0, 0).mid(2), QStringLiteral("index.md"));
    static const QRegularExpression row(QStringLiteral("^\\| \\[([^\\]]+)\\]\\(([a-z-]+\\.md)\\)"), QRegularExpression::MultilineOption);
    for (auto found = row.globalMatch(index); found.hasNext();) {
        const auto match = found.next();
        add(match.captured(1), match.captured(2));
    }
    open(shown);
    filter();
}

void ManualDialog::open(const QString& file) { page_->setSource(QUrl::fromLocalFile(folder_ + u'/' + file)); }

void ManualDialog::follow(const QUrl& url) {
    for (int i = 0; i < contents_->count(); ++i)
        if (contents_->item(i)->data(kFileRole).toString() == url.fileName()) contents_->setCurrentRow(i);
    if (url.hasFragment()) page_->scrollToHeading(url.fragment(QUrl::FullyDecoded));
}

void ManualDialog::filter() {
    const QString text = search_->text().trimmed();
    for (int i = 0; i < contents_->count(); ++i) {
        QListWidgetItem* item = contents_->item(i);
        item->setHidden(!text.isEmpty() && !read(folder_ + u'/' + item->data(kFileRole).toString()).contains(text, Qt::CaseInsensitive));
    }
}

/// The next place on this page, else the first one of the next page that has any.
void ManualDialog::find() {
    const QString text = search_->text().trimmed();
    if (text.isEmpty() || page_->find(text)) return;
    const int from = contents_->currentRow();
    for (int k = 1; k <= contents_->count(); ++k) {
        const QListWidgetItem* item = contents_->item((from + k) % contents_->count());
        if (item->isHidden()) continue;
        open(item->data(kFileRole).toString());
        page_->moveCursor(QTextCursor::Start);
        if (page_->find(text)) return;
    }
}

void ManualDialog::changeEvent(QEvent* event) {
    QDialog::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) retranslate();
}

}  // namespace imomushi
