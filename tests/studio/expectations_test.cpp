// SPDX-License-Identifier: GPL-3.0-or-later
// What artists expect of any studio and no other file of these tests holds: tests/expectations.md is the list.
#include <QComboBox>
#include <QFile>
#include <QLineEdit>
#include <QNativeGestureEvent>
#include <QPointingDevice>
#include <QRegularExpression>
#include <QTreeView>
#include <QWheelEvent>
#include <functional>
#include <set>

#include "tests/studio/window.h"
#include "ui/models/recent_files.h"
#include "ui/panels/outliner_panel.h"
#include "ui/window/start_page.h"
#include "ui/window/status_strip.h"

using namespace imomushi;

namespace {

QString figure() {
    for (const Sample& sample : samples())
        if (sample.name == QLatin1String("figure")) return sample.path;
    return {};
}

/// Where the vertices of an element at rest, or of all of them, are drawn; a point behind the eye counts as outside.
QRectF onView(Window& w, const Element* only = nullptr) {
    QRectF box;
    for (const auto& [id, element] : w.now().elements)
        for (Eigen::Index v = 0; (!only || only == element.get()) && v < element->mesh->body.vertices.rows(); v += 7) {
            const auto at = w.view().onScreen(Vec3(element->mesh->body.vertices.row(v).transpose()));
            if (!at) return QRectF(-1e6, -1e6, 2e6, 2e6);
            box = box.isNull() ? QRectF(*at, QSizeF(1e-6, 1e-6)) : box.united(QRectF(*at, QSizeF(1e-6, 1e-6)));
        }
    return box;
}

bool framed(Window& w, const QRectF& box) {
    const QRectF view(w.view().rect());
    return view.contains(box) && std::max(box.width() / view.width(), box.height() / view.height()) > 0.5;
}

}  // namespace

TEST_CASE("framing: a file that is opened is seen whole, Home shows everything again, and F what is selected") {
    Window w;
    w.open(figure());
    CHECK(framed(w, onView(w)));
    w.view().cameraController().zoom(-12.0, 10.0, 10.0);
    w.settle();
    REQUIRE(!framed(w, onView(w)));
    QTest::keyClick(&w.view(), Qt::Key_Home);
    w.cameraStands();
    CHECK(framed(w, onView(w)));
    const auto& [id, part] = *w.now().elements.begin();
    w.document().select({SelectionItem{.part = id}});
    REQUIRE(!framed(w, onView(w, part.get())));
    QTest::keyClick(&w.view(), Qt::Key_F);
    w.cameraStands();
    CHECK(framed(w, onView(w, part.get())));
}

TEST_CASE("trackpad: two fingers turn the view, with Shift they push it along, with Ctrl and by a pinch they zoom") {
    Window w;
    w.open(figure());
    const QPointingDevice pad(QStringLiteral("trackpad"), 77, QInputDevice::DeviceType::TouchPad, QPointingDevice::PointerType::Finger, QInputDevice::Capability::Position, 5, 1);
    const QPointF middle = QRectF(w.view().rect()).center();
    const auto scroll = [&](Qt::KeyboardModifiers keys) {
        QWheelEvent event(middle, w.view().mapToGlobal(middle), QPoint(40, 24), QPoint(40, 24), Qt::NoButton, keys, Qt::ScrollUpdate, false, Qt::MouseEventNotSynthesized, &pad);
        QCoreApplication::sendEvent(&w.view(), &event);
    };
    CameraController& camera = w.view().cameraController();
    const auto view = [&] { return camera.axes().col(2).eval(); };
    const auto apart = [&] { return onView(w).height(); };

    const Vec3 before = view();
    scroll({});
    CHECK((view() - before).norm() > 0.02);
    const Vec3 turned = view();
    const QRectF box = onView(w);
    scroll(Qt::ShiftModifier);
    CHECK((view() - turned).norm() < 1e-12);
    CHECK((onView(w).center() - box.center()).manhattanLength() > 10.0);
    const double high = apart();
    scroll(Qt::ControlModifier);
    CHECK(apart() > 1.01 * high);
    const double higher = apart();
    QNativeGestureEvent pinch(Qt::ZoomNativeGesture, &pad, 2, middle, middle, w.view().mapToGlobal(middle), 0.2, {});
    QCoreApplication::sendEvent(&w.view(), &pinch);
    CHECK(apart() > 1.01 * higher);
    CHECK((view() - turned).norm() < 1e-12);
}

TEST_CASE("recent projects: each has a card, one whose file is gone says so and opens nothing") {
    Window w;
    const QString there = w.folder.filePath(QStringLiteral("here.imomushi")), gone = w.folder.filePath(QStringLiteral("gone.imomushi"));
    w.run({{"do", "save"}, {"path", there.toStdString()}});
    RecentFiles& recent = w.window().files().recent();
    for (const QString& path : {there, gone}) recent.add(path);
    w.window().showStart(true);
    w.settle();
    int found = 0;
    for (auto* card : w.window().findChildren<QAbstractButton*>()) {
        if (card->toolTip() != there && card->toolTip() != gone) continue;
        ++found;
        CHECK(card->isEnabled() == (card->toolTip() == there));
        CHECK(card->accessibleDescription().contains(QStringLiteral("missing")) == (card->toolTip() == gone));
    }
    CHECK(found == 2);
    for (const QString& path : {there, gone}) recent.remove(path);
}

TEST_CASE("title: it names the project and marks what is not saved; a copy that is saved leaves both") {
    Window w;
    const QString file = w.folder.filePath(QStringLiteral("my snail.imomushi")), copy = w.folder.filePath(QStringLiteral("kept.imomushi"));
    w.open(figure());
    w.run({{"do", "save"}, {"path", file.toStdString()}});
    w.settle();
    CHECK(w.window().windowTitle().startsWith(QStringLiteral("my snail[*]")));
    CHECK(!w.window().isWindowModified());
    w.run({{"do", "rename"}, {"target", w.now().elements.begin()->second->name}, {"name", "shell"}});
    w.settle();
    CHECK(w.window().isWindowModified());
    w.run({{"do", "save"}, {"path", copy.toStdString()}, {"copy", true}});
    w.settle();
    CHECK(QFile::exists(copy));
    CHECK(w.window().windowTitle().startsWith(QStringLiteral("my snail[*]")));
    CHECK(w.window().isWindowModified());
}

TEST_CASE("status bar: left what the mouse does with the tool in hand, right vertices, milliseconds and frames per second") {
    Window w;
    w.open(figure());
    const auto& strip = *w.window().findChild<StatusStrip*>();
    std::set<QString> hints;
    for (const char* tool : {"tool-select", "tool-pose", "tool-face", "tool-bone"}) {
        w.trigger(tool);
        CHECK(!strip.hint().isEmpty());
        hints.insert(strip.hint());
    }
    CHECK(hints.size() == 4);
    const auto says = [&](const QRegularExpression& what) {
        const auto labels = strip.findChildren<QLabel*>();
        return std::any_of(labels.begin(), labels.end(), [&](const QLabel* label) { return label->isVisible() && what.match(label->text()).hasMatch(); });
    };
    waitFor([&] { return says(QRegularExpression(QStringLiteral("^[0-9,.]+ ms$"))); });  // a busy machine takes more than a thousand of them
    CHECK(says(QRegularExpression(QStringLiteral("^[0-9,]+ vertices$"))));
    CHECK(says(QRegularExpression(QStringLiteral("fps$"))));
}

TEST_CASE("outliner: what is typed into its filter leaves the rows that have it, with what they belong to") {
    Window w;
    w.open(figure());
    auto& panel = *w.window().findChild<OutlinerPanel*>();
    const auto rows = [&] {
        QStringList names;
        const std::function<void(const QModelIndex&)> walk = [&](const QModelIndex& parent) {
            for (int r = 0; r < panel.tree()->model()->rowCount(parent); ++r) {
                const QModelIndex row = panel.tree()->model()->index(r, 0, parent);
                names << row.data().toString();
                walk(row);
            }
        };
        walk({});
        return names;
    };
    const QStringList all = rows();
    REQUIRE(all.contains(QStringLiteral("hand-bone.L")));
    panel.findChild<QLineEdit*>()->setText(QStringLiteral("hand-bone"));
    w.settle();
    const QStringList few = rows();
    CHECK(few.contains(QStringLiteral("hand-bone.L")));
    CHECK(few.contains(QStringLiteral("hand-bone.R")));
    CHECK(!few.contains(QStringLiteral("head")));
    CHECK(few.size() < all.size() / 3);
    panel.findChild<QLineEdit*>()->clear();
    w.settle();
    CHECK(rows() == all);
}

TEST_CASE("import dialog: the unit that was chosen is remembered for files of that type, and for no other") {
    Window w;
    const QString mesh = QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"), other = w.folder.filePath(QStringLiteral("tetrahedron.stl"));
    {
        QFile file(other);
        REQUIRE(file.open(QIODevice::WriteOnly));
        file.write("solid t\n");
        for (const char* corners : {"0 0 0 0 1 0 1 0 0", "0 0 0 1 0 0 0 0 1", "0 0 0 0 0 1 0 1 0", "1 0 0 0 1 0 0 0 1"}) {
            const QStringList c = QString::fromLatin1(corners).split(u' ');
            QString facet = QStringLiteral("facet normal 0 0 0\nouter loop\n");
            for (int k = 0; k < 9; k += 3) facet += QStringLiteral("vertex %1 %2 %3\n").arg(c[k], c[k + 1], c[k + 2]);
            file.write((facet + QStringLiteral("endloop\nendfacet\n")).toLatin1());
        }
        file.write("endsolid t\n");
    }
    const auto unitOf = [&](const QString& path, int choose) {
        w.window().files().import({path});
        auto* dialog = w.window().findChild<ImportDialog*>();
        REQUIRE(dialog);
        auto* button = dialog->findChild<QPushButton*>(QStringLiteral("importButton"));
        waitFor([&] { return button->isEnabled(); });
        QComboBox* unit = nullptr;
        for (auto* box : dialog->findChildren<QComboBox*>())
            if (box->findText(QStringLiteral("Centimetres")) >= 0) unit = box;
        REQUIRE(unit);
        const int found = unit->currentIndex();
        if (choose < 0) {
            dialog->reject();
        } else {
            unit->setCurrentIndex(choose);
            Q_EMIT unit->activated(choose);
            waitFor([&] { return button->isEnabled(); });
            QTest::mouseClick(button, Qt::LeftButton);
            waitFor([&] { return !w.window().steps().running(); });
        }
        w.settle();
        return found;
    };
    const int before = unitOf(mesh, -1), ofOther = unitOf(other, -1), chosen = before == 2 ? 1 : 2;
    CHECK(unitOf(mesh, chosen) == before);
    CHECK(unitOf(mesh, -1) == chosen);
    CHECK(unitOf(other, -1) == ofOther);
    CHECK(unitOf(mesh, before) == chosen);
}
