// SPDX-License-Identifier: GPL-3.0-or-later
// Copy and paste by keys.
#include <QClipboard>
#include <QMimeData>

#include "tests/studio/window.h"
#include "ui/panels/effects_panel.h"
#include "ui/window/clipboard_flow.h"

using namespace imomushi;

namespace {

void key(Window& w, Qt::Key letter) {
    w.view().setFocus();
    QTest::keyClick(&w.view(), letter, Qt::ControlModifier);
    w.settle();
}

void chain(Window& w) {
    w.run({{"do", "add-bone"}, {"name", "upper"}, {"from", {0, 0, 0}}, {"to", {1, 0, 0}}});
    w.run({{"do", "add-bone"}, {"name", "lower"}, {"from", "upper/end"}, {"to", {2, 0, 0}}});
    w.document().select({{SelectionItem::Kind::Bone, w.now().boneNamed("upper")->id, {}, false}, {SelectionItem::Kind::Bone, w.now().boneNamed("lower")->id, {}, false}});
    w.window().showStart(false);
    w.settle();
}

}  // namespace

TEST_CASE("clipboard: Ctrl+C and Ctrl+V make bones again, selected, as one step, and in another project too") {
    Window w;
    QApplication::clipboard()->clear();
    chain(w);
    CHECK_FALSE(w.window().actions()["paste"]->isEnabled());
    Q_EMIT w.window().findChild<EffectsPanel*>()->pasteWanted();  // its menu, which offers it always
    CHECK(w.window().messages().text() == "Nothing was copied yet.");
    key(w, Qt::Key_C);
    CHECK(QApplication::clipboard()->mimeData()->hasFormat(QLatin1String(ClipboardFlow::kMime)));
    CHECK(w.window().actions()["paste"]->isEnabled());
    const int steps = w.document().session().position();
    key(w, Qt::Key_V);
    REQUIRE(w.now().bones.size() == 4);
    CHECK(w.document().session().position() == steps + 1);
    REQUIRE(w.document().selection().size() == 2);
    CHECK(w.now().bones.at(w.document().selection()[0].part)->name == "upper 2");
    w.trigger("undo");
    CHECK(w.now().bones.size() == 2);
    (void)w.document().execute({{"do", "new"}});
    key(w, Qt::Key_V);
    REQUIRE(w.now().bones.size() == 2);
    CHECK(w.now().boneNamed("lower")->parent == 0);  // found from where it starts
    CHECK(std::get<EndpointRef>(w.now().boneNamed("lower")->start) == EndpointRef{w.now().boneNamed("upper")->id, true});
}

TEST_CASE("clipboard: Ctrl+X takes elements away as one step, and they come back with their faces by Ctrl+V") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const std::string name = w.now().elements.begin()->second->name;
    w.run({{"do", "add-joint-face"}, {"element", name}, {"name", "a"}, {"plane", {{"origin", {0, 0, -2}}, {"normal", {0, 0, -1}}}}});
    w.document().select({{SelectionItem::Kind::Element, w.now().elementNamed(name)->id, {}, false}});
    w.settle();
    key(w, Qt::Key_X);
    CHECK(w.now().elements.empty());
    key(w, Qt::Key_V);
    REQUIRE(w.now().elements.size() == 1);
    CHECK(w.now().elementNamed(name)->faces.size() == 1);
    w.trigger("undo");
    w.trigger("undo");
    CHECK(w.now().elements.size() == 1);
}

TEST_CASE("clipboard: what cannot be read or pasted is said, and nothing changes") {
    Window w;
    chain(w);
    const int steps = w.document().session().position();
    for (const char* content : {"no JSON", "[]", R"({"commands": 3})", R"({"commands": [{"do": "save", "path": "x.imomushi"}]})"}) {
        auto* data = new QMimeData;
        data->setData(QLatin1String(ClipboardFlow::kMime), content);
        QApplication::clipboard()->setMimeData(data);
        w.settle();
        key(w, Qt::Key_V);
        CHECK(w.document().session().position() == steps);
        CHECK(w.window().messages().isVisible());
    }
}
