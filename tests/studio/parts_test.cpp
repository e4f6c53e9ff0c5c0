// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a character in the inspector.
#include <QComboBox>
#include <QFile>
#include <QScrollBar>
#include <QTextStream>

#include "core/base/rotation_vector.h"
#include "core/document/attachments.h"
#include "tests/studio/window.h"
#include "tests/support/shapes.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/widgets/number_field.h"

using namespace imomushi;

namespace {

/// A head of radius 1 m, and one object of two eyes that look out of it.
QString writeHead(const QString& path) {
    QFile file(path);
    REQUIRE(file.open(QIODevice::WriteOnly));
    QTextStream out(&file);
    Eigen::Index first = 1;
    const auto ball = [&](double radius, int level, const Vec3& at) {
        const TriangleMesh mesh = shapes::sphere(radius, level).mesh;
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) out << "v " << mesh.vertices(v, 0) + at.x() << ' ' << mesh.vertices(v, 1) + at.y() << ' ' << mesh.vertices(v, 2) + at.z() << '\n';
        for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) out << "f " << mesh.triangles(t, 0) + first << ' ' << mesh.triangles(t, 1) + first << ' ' << mesh.triangles(t, 2) + first << '\n';
        first += mesh.vertices.rows();
    };
    out << "o head\n";
    ball(1.0, 3, Vec3::Zero());
    out << "o eyes\n";
    ball(0.2, 2, Vec3(-0.35, 0.3, 0.85));
    ball(0.2, 2, Vec3(0.35, 0.3, 0.85));
    return path;
}

void pick(Window& w, const char* label, const QString& text) {
    auto* box = inspectorRow<QComboBox>(w, label);
    REQUIRE(box);
    REQUIRE(box->isEnabled());
    const int index = box->findText(text);
    REQUIRE(index >= 0);
    box->setCurrentIndex(index);
    Q_EMIT box->activated(index);
    w.settle();
}

void type(Window& w, const char* label, const QString& number) {
    auto* field = inspectorRow<NumberField>(w, label);
    REQUIRE(field);
    REQUIRE(field->isEnabled());
    w.window().inspector().ensureWidgetVisible(field);
    QTest::mouseClick(field, Qt::LeftButton);
    QTest::keyClick(field, Qt::Key_A, Qt::ControlModifier);
    QTest::keyClicks(field, number);
    QTest::keyClick(field, Qt::Key_Return);
    w.settle();
}

}  // namespace

TEST_CASE("studio: parts of a character are chosen in the inspector, attached, given a pivot and turned, each in one step") {
    Window w;
    w.import(writeHead(w.folder.filePath(QStringLiteral("head.obj"))));
    REQUIRE(w.now().characters.size() == 1);
    const auto character = [&]() -> const CharacterSource& { return *w.now().characters.begin()->second; };
    const SelectionItem whole{SelectionItem::Kind::Character, character().id, {}, false};
    w.document().select({whole});
    w.settle();
    w.look(Vec3(0.2, 0.2, 1.0));
    auto* parts = inspectorRow<QComboBox>(w, "Part");
    REQUIRE(parts);
    QStringList names;
    for (int i = 1; i < parts->count(); ++i) names << parts->itemText(i);
    CHECK(names == QStringList{QStringLiteral("head"), QStringLiteral("eyes"), QStringLiteral("eyes#1"), QStringLiteral("eyes#2")});
    CHECK(!inspectorRow<QComboBox>(w, "Follows")->isEnabled());
    CHECK(!inspectorRow<NumberField>(w, "About Y")->isEnabled());

    const ModelPart left{1, 0};
    pick(w, "Part", QStringLiteral("eyes#1"));
    CHECK(inspectorRow<QComboBox>(w, "Follows")->currentText() == QStringLiteral("by itself"));
    CHECK(!inspectorRow<QComboBox>(w, "Element")->isEnabled());
    CHECK(!inspectorRow<NumberField>(w, "About Y")->isEnabled());
    w.window().inspector().ensureWidgetVisible(inspectorRow<NumberField>(w, "About Z"));
    w.shoot("part-chosen");

    const int before = w.document().session().position();
    pick(w, "Follows", QStringLiteral("rigidly"));
    REQUIRE(character().attachments.contains(left));
    CHECK(character().attachments.at(left).mode == Attachment::Mode::Rigid);
    CHECK(w.document().session().position() == before + 1);
    CHECK(inspectorRow<NumberField>(w, "Pivot at rest: X")->value() == doctest::Approx(-0.35));
    CHECK(inspectorRow<NumberField>(w, "About Y")->value() == 0.0);

    type(w, "Pivot at rest: Z", QStringLiteral("0.8"));
    CHECK(pivotOf(character(), left).z() == doctest::Approx(0.8));
    CHECK(pivotOf(character(), left).x() == doctest::Approx(-0.35));
    CHECK(w.document().session().position() == before + 2);
    for (auto* button : w.window().inspector().findChildren<QPushButton*>())
        if (button->text() == QStringLiteral("Middle of the part")) QTest::mouseClick(button, Qt::LeftButton);
    w.settle();
    CHECK(!character().attachments.at(left).pivot);
    CHECK(w.document().session().position() == before + 3);

    type(w, "About Y", QStringLiteral("40"));
    type(w, "About X", QStringLiteral("-20"));
    CHECK(w.document().session().position() == before + 5);
    const auto turn = w.now().turns.find({character().id, left});
    REQUIRE(turn != w.now().turns.end());
    const double degree = std::acos(-1.0) / 180.0;
    CHECK((rotationVector(turn->second.target) - Vec3(-20.0 * degree, 40.0 * degree, 0.0)).norm() < 1e-9);
    CHECK(cutOff(w.window().inspector()) == "");
    w.shoot("part-turned");

    pick(w, "Element", QString::fromStdString(w.now().elements.begin()->second->name));
    CHECK(character().attachments.at(left).element == w.now().elements.begin()->first);
    pick(w, "Follows", QStringLiteral("as flesh"));
    CHECK(w.now().turns.empty());
    CHECK(!inspectorRow<NumberField>(w, "About Y")->isEnabled());
    w.trigger("undo");
    CHECK(w.now().turns.size() == 1);
    CHECK(inspectorRow<NumberField>(w, "About Y")->isEnabled());
    w.trigger("rest");
    CHECK(w.now().turns.empty());
    CHECK(inspectorRow<NumberField>(w, "About Y")->value() == 0.0);
    w.document().select({});
    w.settle();
    w.shoot("part-left");
}

TEST_CASE("studio: an eye that is attached looks where the pointer pulls it, in one step, with both tools and in a body that is turned") {
    Window w;
    w.import(writeHead(w.folder.filePath(QStringLiteral("head.obj"))));
    REQUIRE(w.now().characters.size() == 1);
    const CharacterSource& character = *w.now().characters.begin()->second;
    const std::string name = character.name, element = w.now().elements.begin()->second->name;
    const PartId whole = character.id;
    const ModelPart left{1, 0};
    w.look(Vec3(0, 0, 1));
    const Vec3 front(-0.35, 0.3, 1.05);
    Eigen::Index vertex = 0;
    (character.model->mesh.body.vertices.rowwise() - front.transpose()).rowwise().squaredNorm().minCoeff(&vertex);
    const auto seen = [&] { return w.onScreen(w.document().session().renderPositionsOf(whole).row(vertex).transpose()); };
    // One that is not attached is no part that turns.
    w.trigger("tool-select");
    QTest::mouseMove(&w.view(), seen());
    w.settle();
    CHECK(!w.view().hint().startsWith(QStringLiteral("Drag: turn")));
    w.run({{"do", "attach"}, {"character", name}, {"part", "eyes#1"}, {"mode", "rigid"}});

    const auto pull = [&](QPoint by, const char* picture) {
        const int steps = w.document().session().position();
        const QPoint from = seen();
        for (const QPoint& place : {from + QPoint(3, 3), from}) {  // what is there may have changed under a pointer that stood still
            QTest::mouseMove(&w.view(), place);
            w.settle();
        }
        CHECK_MESSAGE(w.view().hint().startsWith(QStringLiteral("Drag: turn eyes#1")), w.view().hint().toStdString());
        QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
        for (int i = 1; i <= 5; ++i) {
            QTest::mouseMove(&w.view(), from + by * i / 5);
            w.settle();
        }
        w.shoot(picture);
        CHECK((seen() - from - by).manhattanLength() <= 8);  // it goes round, the pointer straight on
        QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + by);
        w.settle();
        CHECK(w.document().session().position() == steps + 1);
    };
    const auto turned = [&] {
        const auto turn = w.now().turns.find({whole, left});
        return turn == w.now().turns.end() ? Vec3(Vec3::Zero()) : rotationVector(turn->second.target);
    };
    pull({20, 0}, "part-pulled");
    CHECK(turned().y() > 0.1);
    CHECK(std::abs(turned().x()) + std::abs(turned().z()) < 0.2 * turned().y());
    w.trigger("undo");
    CHECK(turned() == Vec3::Zero());
    w.trigger("tool-pose");
    pull({0, -20}, "part-pulled-up");
    CHECK(turned().x() < -0.1);
    w.trigger("undo");

    // A click turns nothing, Esc takes it back.
    const int steps = w.document().session().position();
    w.click(seen());
    CHECK(w.document().session().position() == steps);
    CHECK(w.document().selection() == std::vector<SelectionItem>{{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    const QPoint from = seen();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
    QTest::mouseMove(&w.view(), from + QPoint(15, 15));
    CHECK(w.now().turns.size() == 1);
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    CHECK(w.now().turns.empty());
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + QPoint(15, 15));
    CHECK(w.document().session().position() == steps);

    // The head lies on its side.
    const double half = std::sqrt(0.5);
    w.run({{"do", "handle"}, {"element", element}, {"name", "top"}, {"point", {0, 1, 0}}});
    w.run({{"do", "set"}, {"target", element}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.run({{"do", "precompute"}});
    w.run({{"do", "drag"}, {"endpoint", "top"}, {"to", {-1, 0, 0}}, {"rotation", {0, 0, half, half}}});
    w.settle();
    pull({20, 0}, "part-pulled-on-its-side");
    CHECK(turned().x() > 0.1);  // what is seen right of it is the bottom of the head
    CHECK(std::abs(turned().y()) < 0.5 * std::abs(turned().x()));
}
