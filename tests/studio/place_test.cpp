// SPDX-License-Identifier: GPL-3.0-or-later
// Placing by names and numbers.
#include <QComboBox>
#include <QLineEdit>

#include "tests/studio/window.h"
#include "tests/support/shapes.h"
#include "ui/dialogs/place_dialog.h"
#include "ui/widgets/number_field.h"

using namespace imomushi;

namespace {

/// Two boxes: "high" is tallest along y, "wide" longest along x.
struct Places : Window {
    Places() {
        const auto add = [&](const char* name, const Vec3& low, const Vec3& high) {
            const QString path = writeMesh(folder.filePath(QStringLiteral("%1.obj").arg(QLatin1String(name))), shapes::box(low, high, 4, 4, 4).mesh);
            run({{"do", "import-element"}, {"path", path.toStdString()}, {"name", name}});
        };
        add("high", Vec3(0, 0, 0), Vec3(1, 3, 1));
        add("wide", Vec3(2, 0, 0), Vec3(6, 1, 1));
        window().showStart(false);
        settle();
    }
    QDialog* dialog(const char* action) {
        trigger(action);
        auto* opened = window().findChild<PlaceDialog*>();
        REQUIRE(opened);
        return opened;
    }
};

NumberField* field(const QDialog* dialog, const char* name) {
    for (auto* one : dialog->findChildren<NumberField*>())
        if (one->accessibleName() == QLatin1String(name)) return one;
    FAIL(name);
    return nullptr;
}

double value(const QDialog* dialog, const char* name) { return field(dialog, name)->value().value_or(-1e9); }

}  // namespace

TEST_CASE("place by numbers: another element has its own proposed plane, and a name of the artist's stays") {
    Places w;
    w.document().select({{SelectionItem::Kind::Element, w.now().elementNamed("high")->id, {}, false}});
    w.settle();
    QDialog* dialog = w.dialog("place-face");
    CHECK(value(dialog, "Origin: Y") == doctest::Approx(3.0));
    CHECK(value(dialog, "Normal: Y") == doctest::Approx(1.0));
    auto* on = dialog->findChild<QComboBox*>(QStringLiteral("placeOn"));
    on->setCurrentText(QStringLiteral("wide"));
    CHECK(value(dialog, "Origin: X") == doctest::Approx(6.0));
    CHECK(value(dialog, "Origin: Y") == doctest::Approx(0.5));
    CHECK(value(dialog, "Normal: X") == doctest::Approx(1.0));
    dialog->findChild<QLineEdit*>()->setText(QStringLiteral("tip"));
    on->setCurrentText(QStringLiteral("high"));
    on->setCurrentText(QStringLiteral("wide"));
    CHECK(dialog->findChild<QLineEdit*>()->text() == QStringLiteral("tip"));
    CHECK(cutOff(*dialog) == "");
    QTest::mouseClick(dialog->findChild<QPushButton*>(QStringLiteral("place")), Qt::LeftButton);
    w.settle();
    CHECK(w.now().elementNamed("wide")->faceIndex("tip") >= 0);
    CHECK(w.document().selection() == std::vector{SelectionItem{SelectionItem::Kind::Face, w.now().elementNamed("wide")->id, "tip", false}});
}

TEST_CASE("place by numbers: a joint face is moved to another plane, in one step, keeps its name and takes the end of a bone along; what cannot be is said") {
    Places w;
    const PartId wide = w.now().elementNamed("wide")->id;
    w.run({{"do", "add-joint-face"}, {"element", "wide"}, {"name", "end"}, {"plane", {{"origin", {6, 0.5, 0.5}}, {"normal", {1, 0, 0}}}}});
    w.run({{"do", "add-bone"}, {"name", "b"}, {"from", {4, 0.5, 0.5}}, {"to", "wide/end"}});
    CHECK(!w.window().actions()["edit-face"]->isEnabled());
    w.document().select({{SelectionItem::Kind::Face, wide, "end", false}});
    w.settle();
    const int before = w.document().session().position();
    QDialog* dialog = w.dialog("edit-face");
    w.shoot("move-face");
    CHECK(value(dialog, "Origin: X") == doctest::Approx(6.0));
    CHECK(value(dialog, "Normal: X") == doctest::Approx(1.0));
    auto* name = dialog->findChild<QLineEdit*>();
    CHECK(name->text() == QStringLiteral("end"));
    CHECK(!name->isEnabled());
    field(dialog, "Origin: X")->setValue(3.3);  // no flat region is there
    auto* done = dialog->findChild<QPushButton*>(QStringLiteral("place"));
    QTest::mouseClick(done, Qt::LeftButton);
    w.settle();
    CHECK(dialog->findChild<QLabel*>(QStringLiteral("refused"))->isVisible());
    CHECK(w.document().session().position() == before);
    field(dialog, "Origin: X")->setValue(2.0);
    field(dialog, "Normal: X")->setValue(-1.0);
    QTest::mouseClick(done, Qt::LeftButton);
    w.settle();
    CHECK(w.document().session().position() == before + 1);
    const Element& element = *w.now().elements.at(wide);
    REQUIRE(element.faceIndex("end") >= 0);
    CHECK((element.faces[std::size_t(element.faceIndex("end"))].frame.origin - Vec3(2, 0.5, 0.5)).norm() < 1e-9);
    CHECK((*w.document().session().positionOf({w.now().boneNamed("b")->id, true}) - Vec3(2, 0.5, 0.5)).norm() < 1e-6);
    CHECK(w.document().execute({{"do", "edit-joint-face"}, {"face", "wide/no"}, {"plane", {{"origin", {2, 0, 0}}, {"normal", {-1, 0, 0}}}}}, true).error().code == "no-such-face");
}
