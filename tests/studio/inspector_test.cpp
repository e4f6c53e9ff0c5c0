// SPDX-License-Identifier: GPL-3.0-or-later
#include <QAbstractItemView>
#include <QComboBox>
#include <QLabel>

#include "core/document/material_preset.h"
#include "tests/studio/window.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/widgets/number_field.h"

using namespace imomushi;

namespace {

PartId cylinder(Window& w, const std::string& name, const QString& file, double half) {
    w.import(file);
    const PartId id = w.now().elements.rbegin()->first;
    w.run({{"do", "rename"}, {"target", w.now().elements.at(id)->name}, {"name", name}});
    w.run({{"do", "add-joint-face"}, {"element", name}, {"name", "tip"}, {"plane", {{"origin", {0, 0, half}}, {"normal", {0, 0, 1}}}}});
    w.run({{"do", "add-joint-face"}, {"element", name}, {"name", "root"}, {"plane", {{"origin", {0, 0, -half}}, {"normal", {0, 0, -1}}}}});
    return id;
}

QString fact(Window& w, const char* label) {
    auto* text = inspectorRow<QLabel>(w, label);
    return text ? text->text() : QString();
}

/// The row comes to say this: what changed is shown soon, not at once.
bool says(Window& w, const char* label, const QString& text) {
    return QTest::qWaitFor([&] { return fact(w, label) == text; }, kWaitMs);
}

/// Opens a list of choices and clicks on one.
void choose(Window& w, const char* label, const QString& text) {
    waitFor([&] { return inspectorRow<QComboBox>(w, label) != nullptr; });  // some wait for an estimate, which is made beside the window
    auto* box = inspectorRow<QComboBox>(w, label);
    QTest::mouseClick(box, Qt::LeftButton);
    QAbstractItemView* list = box->view();
    waitFor([&] { return list->isVisible(); });
    w.shoot("choices");
    const QModelIndex index = list->model()->index(box->findText(text), 0);
    REQUIRE(index.isValid());
    list->scrollTo(index);
    // A click takes what the pointer is over, and the list hears of that by way of the display: only of true moves, and not at once.
    const QPoint at = list->visualRect(index).center();
    QTest::mouseMove(list->viewport(), at + QPoint(5, 0));
    w.settle();
    QTest::mouseMove(list->viewport(), at);
    waitFor([&] { return list->currentIndex() == index; });
    // A list that has just opened takes no click yet: once more where it stays open.
    waitFor([&] {
        if (list->isVisible()) QTest::mouseClick(list->viewport(), Qt::LeftButton, {}, at);
        return !list->isVisible();
    });
    w.activate();
}

void precompute(Window& w) {
    QPushButton* button = nullptr;
    waitFor([&] {
        for (auto* b : w.window().findChildren<InspectorPanel*>().first()->findChildren<QPushButton*>())
            if (b->isVisible() && b->text() == QStringLiteral("Precompute")) button = b;
        return button;
    });
    QTest::mouseClick(button, Qt::LeftButton);
    waitFor([&] { return !w.window().precompute().job().running(); }, 120000);
    w.settle();
}

}  // namespace

TEST_CASE("inspector: the solver mesh is chosen by clicks, shows its cost and its error, and goes out of date and back") {
    Window w;
    const QString file = QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj");
    const PartId id = cylinder(w, "limb", file, 2.0);
    w.document().select({{SelectionItem::Kind::Element, id, {}, false}});
    w.settle();
    const auto mesh = [&] { return solverMeshName(w.now().elements.at(id)->solverMesh); };
    CHECK(says(w, "State", QStringLiteral("Not yet")));
    CHECK(says(w, "Typical error", QStringLiteral("below 2 %")));
    waitFor([&] { return fact(w, "Will take").startsWith(QStringLiteral("about ")); });
    CHECK(fact(w, "Estimated error").isEmpty());
    w.shoot("before");

    choose(w, "Solver mesh", QStringLiteral("As it is"));
    CHECK(mesh() == "as-is");
    CHECK(says(w, "Typical error", QStringLiteral("up to 23 %")));
    precompute(w);
    CHECK(says(w, "State", QStringLiteral("Up to date")));
    CHECK(fact(w, "Estimated error").endsWith(QStringLiteral(" %")));
    CHECK(says(w, "Solved on", QStringLiteral("%1 vertices").arg(w.now().elements.at(id)->mesh->body.vertices.rows())));
    CHECK(fact(w, "Will take").isEmpty());
    w.shoot("after");

    choose(w, "Solver mesh", QStringLiteral("Refined"));
    const auto vertices = int(w.now().elements.at(id)->mesh->body.vertices.rows());
    CHECK(mesh() == "refined:" + std::to_string(2 * vertices));
    CHECK(says(w, "State", QStringLiteral("Out of date")));
    CHECK(says(w, "Typical error", QStringLiteral("known afterwards")));
    auto* count = inspectorRow<NumberField>(w, "To vertices");
    REQUIRE(count);
    QTest::mouseClick(count, Qt::LeftButton);
    QTest::keyClick(count, Qt::Key_A, Qt::ControlModifier);
    QTest::keyClicks(count, QStringLiteral("400"));
    QTest::keyClick(count, Qt::Key_Return);
    w.settle();
    CHECK(mesh() == "refined:400");
    w.shoot("refined");
    w.trigger("undo");
    CHECK(mesh() == "refined:" + std::to_string(2 * vertices));
    w.trigger("undo");
    CHECK(mesh() == "as-is");
    CHECK(says(w, "State", QStringLiteral("Up to date")));
    CHECK(inspectorRow<NumberField>(w, "To vertices") == nullptr);
}

TEST_CASE("inspector: dragging a number of a precomputed element is one undo step, though other rows come to be shown") {
    Window w;
    const PartId id = cylinder(w, "limb", QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"), 2.0);
    w.run({{"do", "set"}, {"target", "limb"}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.run({{"do", "precompute"}});
    w.document().select({{SelectionItem::Kind::Element, id, {}, false}});
    w.settle();
    const double before = w.now().elements.at(id)->nu;
    const int steps = w.document().session().position();
    auto* field = inspectorRow<NumberField>(w, "Poisson ratio");
    REQUIRE(field);
    const QPoint from = field->rect().center();
    QTest::mousePress(field, Qt::LeftButton, {}, from);
    for (int i = 1; i <= 8; ++i) {
        QTest::mouseMove(field, from - QPoint(4 * i, 0));
        w.settle();
    }
    QTest::mouseRelease(field, Qt::LeftButton, {}, from - QPoint(32, 0));
    w.settle();
    CHECK(w.now().elements.at(id)->nu < before);
    CHECK(w.document().session().position() == steps + 1);
    CHECK(says(w, "State", QStringLiteral("Out of date")));
    CHECK(!fact(w, "Will take").isEmpty());
    w.trigger("undo");
    CHECK(w.now().elements.at(id)->nu == before);
    CHECK(says(w, "State", QStringLiteral("Up to date")));
}

TEST_CASE("inspector: of two congruent elements the second says whose precompute it takes over, and several are set together") {
    Window w;
    const QString file = QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj");
    const PartId one = cylinder(w, "one", file, 2.0), two = cylinder(w, "two", file, 2.0);
    for (const char* name : {"one", "two"}) w.run({{"do", "set"}, {"target", name}, {"property", "nu"}, {"value", 0.43}});  // that no other case has solved
    w.document().select({{SelectionItem::Kind::Element, one, {}, false}, {SelectionItem::Kind::Element, two, {}, false}});
    w.settle();
    choose(w, "Solver mesh", QStringLiteral("Decimated"));
    const int steps = w.document().session().position();
    CHECK(w.now().elements.at(one)->solverMesh.kind == SolverMeshSetting::Kind::Decimated);
    CHECK(w.now().elements.at(two)->solverMesh == w.now().elements.at(one)->solverMesh);
    w.trigger("undo");
    CHECK(w.document().session().position() == steps - 1);
    CHECK(w.now().elements.at(one)->solverMesh == SolverMeshSetting{});
    CHECK(w.now().elements.at(two)->solverMesh == SolverMeshSetting{});

    w.document().select({{SelectionItem::Kind::Element, two, {}, false}});
    w.settle();
    CHECK(says(w, "Shared with", QStringLiteral("one")));
    w.run({{"do", "set"}, {"target", "one"}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.settle();
    CHECK(says(w, "Shared with", QString()));
    w.run({{"do", "set"}, {"target", "two"}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.settle();
    precompute(w);
    CHECK(w.document().session().responseState(one) == Session::ResponseState::Fresh);
    CHECK(says(w, "State", QStringLiteral("Up to date")));
    CHECK(says(w, "Shared with", QStringLiteral("one")));
    w.shoot("shared");
}

TEST_CASE("inspector: a preset sets the flesh of all that is selected as one step, and is shown as custom once a number is changed") {
    Window w;
    const QString file = QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj");
    const PartId one = cylinder(w, "one", file, 2.0), two = cylinder(w, "two", file, 2.0);
    w.document().select({{SelectionItem::Kind::Element, one, {}, false}, {SelectionItem::Kind::Element, two, {}, false}});
    w.settle();
    const auto shown = [&] {
        auto* box = inspectorRow<QComboBox>(w, "Preset");
        REQUIRE(box);
        return box->currentIndex() < 0 ? box->placeholderText() : box->currentText();
    };
    CHECK(shown() == QStringLiteral("Standard: sags 3 %"));
    const int before = w.document().session().position();
    choose(w, "Preset", QStringLiteral("Jelly: sags 6 %"));
    CHECK(w.document().session().position() == before + 1);
    const MaterialPreset& jelly = *materialPreset("jelly");
    CHECK(jelly.isOf(*w.now().elements.at(one)));
    CHECK(jelly.isOf(*w.now().elements.at(two)));
    w.settle();
    CHECK(shown() == QStringLiteral("Jelly: sags 6 %"));
    w.shoot("jelly");
    w.run({{"do", "set"}, {"target", "two"}, {"property", "preset"}, {"value", "plush"}});
    w.settle();
    CHECK(shown() == QString());
    w.document().select({{SelectionItem::Kind::Element, one, {}, false}});
    w.settle();
    auto* field = inspectorRow<NumberField>(w, "Damping");
    REQUIRE(field);
    QTest::mouseClick(field, Qt::LeftButton);
    QTest::keyClick(field, Qt::Key_A, Qt::ControlModifier);
    QTest::keyClicks(field, QStringLiteral("2.5"));
    QTest::keyClick(field, Qt::Key_Return);
    w.settle();
    CHECK(w.now().elements.at(one)->damping == 2.5);
    CHECK(shown() == QStringLiteral("Custom"));
    w.shoot("custom");
    for (int i = 0; i < 3; ++i) w.trigger("undo");
    w.settle();
    CHECK(w.document().session().position() == before);
    CHECK(shown() == QStringLiteral("Standard: sags 3 %"));
}

TEST_CASE("inspector: limits of a bone and a pin that holds its direction are set by their rows, and taken back") {
    Window w;
    w.run({{"do", "add-bone"}, {"name", "root"}, {"element", ""}, {"from", {0, 0, 0}}, {"to", {0, 0, 1}}});
    w.run({{"do", "add-bone"}, {"name", "tip"}, {"element", ""}, {"from", "root/end"}, {"to", {0, 0, 2}}, {"parent", "root"}});
    const PartId id = w.now().boneNamed("tip")->id;
    w.document().select({{SelectionItem::Kind::Bone, id, {}, false}});
    w.settle();
    const auto type = [&](const char* label, const char* text) {
        auto* field = inspectorRow<NumberField>(w, label);
        REQUIRE(field);
        QTest::mouseClick(field, Qt::LeftButton);
        QTest::keyClick(field, Qt::Key_A, Qt::ControlModifier);
        QTest::keyClicks(field, QString::fromLatin1(text));
        QTest::keyClick(field, Qt::Key_Return);
        w.settle();
    };
    const auto bone = [&]() -> const Bone& { return *w.now().bones.at(id); };
    type("Bend", "30");
    CHECK(bone().maxBend == doctest::Approx(M_PI / 6.0));
    type("Twist", "45");
    CHECK(bone().maxTwist == doctest::Approx(M_PI / 4.0));
    type("Stiffness", "20");
    CHECK(bone().stiffness == 20.0);
    type("Weight", "3");
    CHECK(bone().weight == 3.0);
    w.shoot("bone");
    for (int i = 0; i < 4; ++i) w.trigger("undo");
    const Bone plain;
    CHECK(bone().maxBend == plain.maxBend);
    CHECK(bone().maxTwist == plain.maxTwist);
    CHECK(bone().stiffness == plain.stiffness);
    CHECK(bone().weight == plain.weight);

    const EndpointRef end{id, true};
    w.document().select({{SelectionItem::Kind::Endpoint, id, {}, true}});
    w.settle();
    const auto button = [&](const char* text) {
        QPushButton* found = nullptr;
        waitFor([&] {
            for (auto* b : w.window().findChildren<InspectorPanel*>().first()->findChildren<QPushButton*>())
                if (b->isVisible() && b->text() == QLatin1String(text)) found = b;
            return found != nullptr;
        });
        return found;
    };
    CHECK(!button("Hold orientation")->isEnabled());
    QTest::mouseClick(button("Pin"), Qt::LeftButton);
    button("Unpin");
    REQUIRE(button("Hold orientation")->isEnabled());
    QTest::mouseClick(button("Hold orientation"), Qt::LeftButton);
    w.settle();
    CHECK(w.now().goals.at(end).rotation);
    CHECK(button("Hold orientation")->isChecked());
    w.shoot("pin");
    w.trigger("undo");
    CHECK(w.now().goals.at(end).pinned);
    CHECK(!w.now().goals.at(end).rotation);
    waitFor([&] { return !button("Hold orientation")->isChecked(); });
    w.trigger("undo");
    CHECK(w.now().goals.empty());
    waitFor([&] { return !button("Hold orientation")->isEnabled(); });
}
