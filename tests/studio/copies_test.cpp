// SPDX-License-Identifier: GPL-3.0-or-later
#include <QMessageBox>

#include "tests/studio/window.h"

using namespace imomushi;

namespace {

const QString kMesh = QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj");
const QString kSample = QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi");

void selectElement(Window& w, PartId id) { w.document().select({{SelectionItem::Kind::Element, id, {}, false}}); }

}  // namespace

TEST_CASE("studio: what is selected is duplicated and mirrored by keys, the copies are selected, and one undo takes each back") {
    Window w;
    w.import(kMesh);
    w.document().select({});
    w.settle();
    for (const char* id : {"duplicate", "mirror-x", "mirror-y", "mirror-z", "replace-mesh"}) CHECK(!w.window().actions()[id]->isEnabled());
    const PartId first = w.now().elements.begin()->first;
    selectElement(w, first);
    w.settle();
    w.trigger("duplicate");
    REQUIRE(w.now().elements.size() == 2);
    REQUIRE(w.document().selection().size() == 1);
    const PartId copy = w.document().selection().front().part;
    CHECK(copy != first);
    // Away from the plane, its mirror image lies on the other side.
    w.trigger("mirror-x");
    REQUIRE(w.now().elements.size() == 3);
    const auto middle = [&](PartId id) { return w.now().elements.at(id)->mesh->body.vertices.col(0).mean(); };
    CHECK(middle(w.document().selection().front().part) == doctest::Approx(-middle(copy)));
    CHECK(w.window().messages().isVisible());
    w.view().frameAll(false);
    w.shoot("copies");
    w.trigger("undo");
    w.trigger("undo");
    CHECK(w.now().elements.size() == 1);
    w.trigger("redo");
    CHECK(w.now().elements.size() == 2);
}

TEST_CASE("studio: a project that is dropped on another one is added beside it or opened, as the artist says") {
    Window w;
    w.import(kMesh);
    const auto answer = [&](const char* button) {
        whenModal<QMessageBox>([&w, button](QMessageBox* box) {
            w.shoot("dropped-project");
            CHECK(cutOff(*box) == "");
            for (QAbstractButton* b : box->buttons())
                if (b->text() == QLatin1String(button)) b->click();
        });
        w.window().files().drop({kSample});
        w.settle();
        waitFor([&] { return !w.window().steps().running(); });
    };
    answer("Cancel");
    CHECK(w.now().elements.size() == 1);
    answer("Add");
    CHECK(w.now().elements.size() == 6);
    double end = w.now().elements.begin()->second->mesh->body.vertices.col(0).maxCoeff();
    for (auto e = std::next(w.now().elements.begin()); e != w.now().elements.end(); ++e) CHECK(e->second->mesh->body.vertices.col(0).minCoeff() > end);
    CHECK(w.document().selection().size() == 5);
    w.shoot("added-project");
    w.trigger("undo");
    CHECK(w.now().elements.size() == 1);
    (void)w.document().execute({{"do", "new"}});
    w.window().files().drop({kSample});  // nothing is lost: nobody is asked
    CHECK(w.now().elements.size() == 5);
    // Of several the first is opened, the others are added.
    (void)w.document().execute({{"do", "new"}});
    w.window().files().drop({kSample, kSample, kSample});
    waitFor([&] { return !w.window().steps().running(); });
    CHECK(w.now().elements.size() == 15);
    CHECK(w.document().session().path() == std::filesystem::path(kSample.toStdString()));
}

TEST_CASE("studio: another mesh takes the place of an element's by the import dialog, and what was lost is told") {
    Window w;
    w.import(kMesh);
    const PartId id = w.now().elements.begin()->first;
    const std::string name = w.now().elements.at(id)->name;
    selectElement(w, id);
    const auto before = w.now().elements.at(id)->mesh;
    w.window().files().replaceMesh(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_fine.obj"));
    auto* dialog = w.window().findChild<ImportDialog*>();
    REQUIRE(dialog);
    auto* button = dialog->findChild<QPushButton*>(QStringLiteral("importButton"));
    waitFor([&] { return button->isEnabled(); });
    w.shoot("replace-mesh");
    w.settle();  // a label that says more is laid out anew
    CHECK(cutOff(*dialog) == "");
    QTest::mouseClick(button, Qt::LeftButton);
    w.settle();
    REQUIRE(w.now().elements.size() == 1);
    CHECK(w.now().elements.at(id)->name == name);
    CHECK(w.now().elements.at(id)->mesh != before);
    CHECK(w.window().messages().isVisible());
    w.trigger("undo");
    CHECK(w.now().elements.at(id)->mesh == before);
}
