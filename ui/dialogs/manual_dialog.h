// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <QTextBrowser>

class QLineEdit;
class QListWidget;
class QPushButton;

namespace imomushi {

/// A page of the manual: Markdown, with pictures no wider than the page and links to its headings.
class ManualPage : public QTextBrowser {
    Q_OBJECT
public:
    explicit ManualPage(QWidget* parent);
    /// The heading that links call so (lower case, without punctuation, hyphens for spaces) comes to the top.
    void scrollToHeading(const QString& anchor);

protected:
    QVariant loadResource(int type, const QUrl& name) override;
    void doSetSource(const QUrl& name, QTextDocument::ResourceType type) override;

private:
    void setType();  ///< space, tables and programs: Markdown says nothing about how they look
};

/// The manual of assets/manual in the language of the studio, read offline: contents, pages, back and forward, search.
class ManualDialog : public QDialog {
    Q_OBJECT
public:
    explicit ManualDialog(QWidget* parent);

protected:
    void changeEvent(QEvent* event) override;

private:
    void retranslate();
    void open(const QString& file);  ///< of the folder of the language, for example "effects.md"
    void follow(const QUrl& url);
    void filter();
    void find();

    QString folder_;
    ManualPage* page_;
    QListWidget* contents_;
    QLineEdit* search_;
    QPushButton *back_, *forward_, *close_;
};

}  // namespace imomushi
