// SPDX-License-Identifier: GPL-3.0-or-later
#include <QLineEdit>
#include <QListWidget>
#include <QPushButton>
#include <QScrollBar>
#include <QTextBlock>

#include "tests/studio/window.h"
#include "ui/dialogs/manual_dialog.h"

using namespace imomushi;

namespace {

struct Reading : Window {
    Reading() : Window({1560, 960}, __builtin_FILE()) {
        trigger("manual");
        waitFor([&] { return dialog() != nullptr && dialog()->isVisible(); });
        REQUIRE(QTest::qWaitForWindowExposed(dialog()));
        settle();
    }
    ManualDialog* dialog() { return window().findChild<ManualDialog*>(); }
    template <class Widget>
    Widget& part(const char* name) {
        auto* widget = dialog()->findChild<Widget*>(QLatin1String(name));
        REQUIRE(widget);
        return *widget;
    }
    ManualPage& page() { return part<ManualPage>("manualPage"); }
    QListWidget& contents() { return part<QListWidget>("manualContents"); }
    QString file() { return page().source().fileName(); }
    int listed() {
        int count = 0;
        for (int i = 0; i < contents().count(); ++i) count += contents().item(i)->isHidden() ? 0 : 1;
        return count;
    }
};

}  // namespace

TEST_CASE("manual: it opens offline, with its contents, pictures and links, in both languages") {
    Reading w;
    CHECK(w.file() == QStringLiteral("index.md"));
    CHECK(w.contents().count() == 13);
    for (const char* language : {"en", "ja"}) {
        CAPTURE(language);
        Appearance::instance().setLanguage(QLatin1String(language));
        w.settle();
        CHECK(w.page().source().path().contains(QStringLiteral("/manual/%1/").arg(QLatin1String(language))));
        CHECK_MESSAGE(QTest::qWaitFor([&] { return cutOff(*w.dialog()) == ""; }), cutOff(*w.dialog()));
        for (int i = 0; i < w.contents().count(); ++i) {
            QTest::mouseClick(w.contents().viewport(), Qt::LeftButton, {}, w.contents().visualItemRect(w.contents().item(i)).center());
            w.settle();
            CHECK(w.contents().currentRow() == i);
            CHECK(w.page().document()->begin().blockFormat().headingLevel() == 1);
            // Pictures are there, and no wider than the page.
            for (QTextBlock block = w.page().document()->begin(); block.isValid(); block = block.next())
                for (auto part = block.begin(); !part.atEnd(); ++part) {
                    if (!part.fragment().charFormat().isImageFormat()) continue;
                    const QUrl url = w.page().source().resolved(QUrl(part.fragment().charFormat().toImageFormat().name()));
                    const QImage picture = w.page().document()->resource(QTextDocument::ImageResource, url).value<QImage>();
                    CHECK_MESSAGE(!picture.isNull(), url.toString().toStdString());
                    CHECK(picture.deviceIndependentSize().width() <= w.page().viewport()->width());
                }
            if (i < 6) w.shoot(qPrintable(QStringLiteral("manual-%1-%2").arg(QLatin1String(language)).arg(i)));
        }
    }
    w.dialog()->close();
}

TEST_CASE("manual: links lead to headings, back returns, and what is typed is found") {
    Reading w;
    w.page().setSource(QUrl(w.page().source().resolved(QUrl(QStringLiteral("accuracy.md#joint-modes")))));
    w.settle();
    CHECK(w.file() == QStringLiteral("accuracy.md"));
    CHECK(w.page().verticalScrollBar()->value() > 100);
    CHECK(w.page().textCursor().block().text() == QStringLiteral("Joint modes"));
    QTest::mouseClick(&w.part<QPushButton>("manualBack"), Qt::LeftButton);
    CHECK(w.file() == QStringLiteral("index.md"));

    auto& search = w.part<QLineEdit>("manualSearch");
    search.setFocus();
    QTest::keyClicks(&search, QStringLiteral("penguin of 3,362"));
    CHECK(w.listed() == 1);
    QTest::keyClick(&search, Qt::Key_Return);
    CHECK(w.file() == QStringLiteral("accuracy.md"));
    CHECK(w.page().textCursor().selectedText() == QStringLiteral("penguin of 3,362"));
    CHECK(w.dialog()->isVisible());  // Enter closes nothing
    search.clear();
    CHECK(w.listed() == 13);
    QTest::keyClicks(&search, QStringLiteral("no such words"));
    CHECK(w.listed() == 0);
    w.dialog()->close();
}
