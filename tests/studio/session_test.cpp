// SPDX-License-Identifier: GPL-3.0-or-later
#include <QElapsedTimer>
#include <QProgressBar>
#include <QSettings>
#include <QTreeWidget>
#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>

#include "tests/studio/window.h"
#include "tests/support/left_out.h"
#include "ui/dialogs/bones_dialog.h"
#include "ui/dialogs/clips_dialog.h"
#include "ui/dialogs/links_dialog.h"
#include "ui/jobs/character_job.h"
#include "ui/panels/takes_panel.h"
#include "ui/picking/picking.h"
#include "ui/scene/cut_frame.h"
#include "ui/widgets/number_field.h"
#include "ui/window/studio_docks.h"

using namespace imomushi;

namespace {

/// Third-party meshes are not kept with the project.
const std::filesystem::path kPenguin = IMOMUSHI_SHARED_MESHES "/penguin.obj";

/// A point of the body that is seen from `from`, nearest to `wanted` across that direction.
Vec3 seen(const TriangleMesh& body, const Vec3& wanted, const Vec3& from) {
    const Vec3 to = from.normalized();
    Vec3 best = Vec3::Zero();
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        const auto corner = [&](int k) -> Vec3 { return body.vertices.row(body.triangles(t, k)).transpose(); };
        if ((corner(1) - corner(0)).cross(corner(2) - corner(0)).dot(to) <= 0.0) continue;
        const Vec3 at = (corner(0) + corner(1) + corner(2)) / 3.0, away = at - wanted;
        // Among those behind each other the first one.
        const double across = (away - away.dot(to) * to).norm() - 1e-3 * at.dot(to);
        if (across < least) least = across, best = at;
    }
    return best;
}

/// By the mouse, in the drag tool.
void drag(Window& w, const EndpointRef& end, QPoint by) {
    const QPoint from = w.view().onScreen(end)->toPoint();
    QTest::mouseMove(&w.view(), from);
    w.settle();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
    for (int i = 1; i <= 10; ++i) {
        QTest::mouseMove(&w.view(), from + by * i / 10);
        w.settle();
    }
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + by);
    w.settle();
    CHECK(w.now().goals.contains(end));
    CHECK((*w.view().onScreen(end) - QPointF(from + by)).manhattanLength() < 30.0);
}

/// Of all edges that are seen, as they are now, m: a torn one would be as long as what lies on both sides of it is apart, as far as a part was dragged.
double longestEdge(const CharacterSource& character, const Points& now) {
    double longest = 0.0;
    const Triangles& triangles = character.model->mesh.body.triangles;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) longest = std::max(longest, (now.row(triangles(t, k)) - now.row(triangles(t, (k + 1) % 3))).norm());
    return longest;
}

}  // namespace

TEST_CASE("studio: a whole penguin is cut into head, wings and trunk by four clicks, gets bones by clicks, and each part is dragged") {
    if (!std::filesystem::exists(kPenguin)) return leaveOut("there is no " + kPenguin.string());
    Window w;
    w.trigger("soft-at-once");
    QElapsedTimer clock;
    clock.start();
    w.import(QString::fromStdString(kPenguin.string()));
    REQUIRE(w.now().elements.size() == 1);
    const auto character = [&]() -> const CharacterSource& { return *w.now().characters.begin()->second; };
    const TriangleMesh whole = w.now().elements.begin()->second->mesh->body;
    const Vec3 low = whole.vertices.colwise().minCoeff(), high = whole.vertices.colwise().maxCoeff(), size = high - low;
    const auto at = [&](double x, double y) -> Vec3 { return low + Vec3(x * size.x(), y * size.y(), 0.5 * size.z()); };

    // Cuts: a click each, seen from the front.
    const Vec3 front(0.0, 0.1, 1.0);
    w.trigger("tool-face");
    w.look(front);
    for (const Vec3& place : {at(0.5, 0.74), at(0.86, 0.55), at(0.14, 0.55)}) {
        const std::size_t before = w.now().elements.size();
        w.click(w.onScreen(seen(whole, place, front)));
        CHECK(w.now().elements.size() == before + 1);
    }
    w.shoot("session-cut");
    REQUIRE(w.now().elements.size() == 4);
    // Soft at once: drafts, without being asked for.
    const auto soft = [&] {
        return std::all_of(w.now().elements.begin(), w.now().elements.end(), [&](const auto& e) { return w.document().session().responses().fittingOf(e.first) != nullptr; });
    };
    QElapsedTimer waiting;
    waiting.start();
    waitFor(soft);
    MESSAGE("cut after " << 1e-3 * double(clock.elapsed()) << " s; soft " << 1e-3 * double(waiting.elapsed()) << " s after the last cut was seen");

    // Bones: up the spine through the neck, and one in each wing from its shoulder.
    const auto cutAt = [&](std::size_t i) { return w.onScreen(cutFrame(w.document().session(), character().cuts[i].id)->centre); };
    w.trigger("tool-bone");
    w.look(front);
    w.click(w.onScreen(at(0.5, 0.2)));
    w.click(cutAt(0));
    w.click(w.onScreen(at(0.5, 0.93)));
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    for (const auto& [cut, tip] : {std::pair{1, at(0.95, 0.4)}, std::pair{2, at(0.05, 0.4)}}) {
        w.click(cutAt(std::size_t(cut)));
        w.click(w.onScreen(tip));
        QTest::keyClick(&w.view(), Qt::Key_Escape);
    }
    w.shoot("session-bones");
    REQUIRE(w.now().bones.size() == 4);
    for (const auto& [id, bone] : w.now().bones) CHECK(bone->element != 0);
    // The foot of the spine stays.
    const EndpointRef foot{w.now().bones.begin()->first, false};
    w.document().select({{SelectionItem::Kind::Endpoint, foot.bone, {}, foot.atEnd}});
    w.trigger("pin");
    waitFor(soft);

    // Each part is dragged by the mouse: wings up, the head aside.
    w.trigger("tool-pose");
    w.look(front);
    std::vector<PartId> bones;
    for (const auto& [id, bone] : w.now().bones) bones.push_back(id);
    drag(w, {bones[1], true}, QPoint(-70, 20));
    drag(w, {bones[2], true}, QPoint(60, -170));
    drag(w, {bones[3], true}, QPoint(-60, -170));
    w.shoot("session-dragged");
    MESSAGE("dragged " << 1e-3 * double(clock.elapsed()) << " s after the file was dropped, with a pointer that does not hesitate");

    // One continuous surface: vertices at one place stay together, and no edge over a cut is torn.
    const Points now = w.document().session().renderPositionsOf(character().id);
    const Points& rest = character().model->mesh.body.vertices;
    REQUIRE(now.allFinite());
    CHECK((now - rest).rowwise().norm().maxCoeff() > 0.2 * size.y());
    const Json gap = *w.document().execute({{"do", "measure"}, {"what", "gap"}});
    CHECK(gap["value"].get<double>() < 1e-6 * size.norm());
    const double longest = longestEdge(character(), now);
    const double moved = (now - rest).rowwise().norm().maxCoeff();
    MESSAGE("the longest edge is " << longest << " m, the farthest a vertex was dragged " << moved << " m");
    CHECK(longest < 0.5 * moved);

    // Better answers come by themselves, or by hand where they take long; nothing jumps far.
    waitFor([&] { return !w.window().precompute().job().running(); });
    w.settle();
    if (!std::all_of(w.now().elements.begin(), w.now().elements.end(), [&](const auto& e) { return w.document().session().responseState(e.first) == Session::ResponseState::Fresh; })) {
        w.trigger("precompute");
        waitFor([&] { return !w.window().precompute().job().running(); });
    }
    w.settle();
    const double jump = (w.document().session().renderPositionsOf(character().id) - now).rowwise().norm().maxCoeff();
    MESSAGE("from drafts to default the surface moved by " << jump / size.norm() << " of the diagonal at most");
    CHECK(jump < 0.05 * size.norm());
    w.shoot("session-precomputed");
}

TEST_CASE("studio: a penguin is made soft as it is imported, in one step, and a part is dragged while drafts are still better") {
    if (!std::filesystem::exists(kPenguin)) return leaveOut("there is no " + kPenguin.string());
    Window w;
    w.trigger("soft-at-once");
    QSettings().setValue(QStringLiteral("import/soft-at-first"), true);
    QElapsedTimer clock;
    clock.start();
    // Stages of a journal, s after the drop.
    std::map<std::string, double> at;
    const auto reached = [&](const char* stage) { at[stage] = 1e-3 * double(clock.elapsed()); };
    double longest = 0.0;  // that the window did not answer
    QElapsedTimer beat;
    QTimer heart;
    QObject::connect(&heart, &QTimer::timeout, [&] { longest = std::max(longest, 1e-3 * double(beat.restart())); });
    const auto steps = QObject::connect(&w.window().steps(), &StepFlow::changed, [&] { reached(w.window().steps().running() ? "accepted" : "cut"); });
    beat.start();
    heart.start(1);
    w.import(QString::fromStdString(kPenguin.string()));
    heart.stop();
    QObject::disconnect(steps);
    QSettings().setValue(QStringLiteral("import/soft-at-first"), false);
    REQUIRE(at.contains("cut"));
    CHECK(at["accepted"] < at["cut"]);
    REQUIRE(w.now().characters.size() == 1);
    CHECK(w.now().elements.size() >= 4);  // two wings, head, trunk; feet and a tail, if they are found
    CHECK(w.now().bones.size() >= 4);
    CHECK_FALSE(w.now().goals.empty());  // pins
    CHECK(w.view().tools().kind() == ToolKind::Pose);
    waitFor([&] {
        return std::all_of(w.now().elements.begin(), w.now().elements.end(), [&](const auto& e) { return w.document().session().responses().fittingOf(e.first) != nullptr; });
    });
    reached("draft");
    w.shoot("session-made-soft");

    // The end that is farthest from all pins.
    EndpointRef farthest;
    double distance = 0.0;
    for (const auto& [id, bone] : w.now().bones) {
        const EndpointRef end{id, true};
        if (w.now().goals.contains(end)) continue;
        double nearest = 1e300;
        for (const auto& [pin, goal] : w.now().goals) nearest = std::min(nearest, (*endpointPosition(w.document().session(), end) - *endpointPosition(w.document().session(), pin)).norm());
        if (nearest > distance) distance = nearest, farthest = end;
    }
    REQUIRE(distance > 0.0);
    drag(w, farthest, QPoint(60, -60));
    reached("dragged");
    w.shoot("session-made-soft-dragged");
    const CharacterSource& character = *w.now().characters.begin()->second;
    MESSAGE("a character of " << character.model->mesh.body.vertices.rows() << " vertices, seconds after the drop: proposed and accepted " << at["accepted"] << ", cut " << at["cut"] << ", all "
                              << w.now().elements.size() << " elements soft as drafts " << at["draft"] << ", dragged " << at["dragged"] << "; the window answered after " << longest << " at most");
    const Points now = w.document().session().renderPositionsOf(character.id);
    const double moved = (now - character.model->mesh.body.vertices).rowwise().norm().maxCoeff();
    CHECK(longestEdge(character, now) < longestEdge(character, character.model->mesh.body.vertices) + 0.5 * moved);
    w.trigger("undo");
    w.trigger("undo");
    CHECK(w.now().elements.empty());
    CHECK(w.now().bones.empty());
}

TEST_CASE("studio: the links of flesh of a robot are looked at before it is imported, one is made thinner and one left out") {
    Window w;
    w.window().files().import({QStringLiteral(IMOMUSHI_TEST_DATA "/characters/robot.glb")});
    auto* dialog = w.window().findChild<ImportDialog*>();
    REQUIRE(dialog);
    auto* import = dialog->findChild<QPushButton*>(QStringLiteral("importButton"));
    waitFor([&] { return import->isEnabled(); });
    w.settle();
    auto* choose = dialog->findChild<QPushButton*>(QStringLiteral("chooseLinks"));
    REQUIRE(choose->isVisible());
    w.shoot("links-import");
    const std::vector<FleshLink> found = (*dialog->preparedCharacter()->body)->report.links;
    REQUIRE(found.size() > 2);
    whenModal<LinksDialog>([&](LinksDialog* links) {
        w.shoot("links-dialog");
        CHECK(cutOff(*links) == "");
        CHECK(links->chosen()->size() == found.size());
        links->findChild<QTreeWidget*>()->topLevelItem(0)->setCheckState(0, Qt::Unchecked);
        auto* radius = links->findChildren<NumberField*>().at(1);
        radius->setFocus();
        radius->selectAll();
        QTest::keyClicks(radius, QString::number(0.8 * found[1].radius));
        QTest::keyClick(radius, Qt::Key_Tab);
        QTest::mouseClick(links->findChild<QPushButton*>(QStringLiteral("useLinks")), Qt::LeftButton);
    });
    QTest::mouseClick(choose, Qt::LeftButton);
    waitFor([&] { return import->isEnabled(); });
    REQUIRE(dialog->command().contains("links"));
    CHECK(dialog->command().at("links").size() == found.size() - 1);
    w.shoot("links-changed");
    QTest::mouseClick(import, Qt::LeftButton);
    waitFor([&] { return !w.window().steps().running(); });
    w.cameraStands();
    w.activate();
    REQUIRE(w.now().characters.size() == 1);
    const std::vector<FleshLink>& made = w.now().characters.begin()->second->body->report.links;
    REQUIRE(made.size() == found.size() - 1);
    CHECK(made[0].radius == doctest::Approx(0.8 * found[1].radius).epsilon(0.01));
    CHECK(made[1].radius == found[2].radius);
}

TEST_CASE("studio: a dropped file of bones alone is offered as clips for the open character, and alone it is no mesh") {
    Window w;
    const QString walk = QStringLiteral(IMOMUSHI_TEST_DATA "/characters/walk.glb");
    const auto dialogOf = [&] {
        auto* dialog = w.window().findChild<ImportDialog*>();
        REQUIRE(dialog);
        return dialog;
    };
    w.window().files().drop({walk});
    auto* alone = dialogOf();
    waitFor([&] { return !alone->findChild<QProgressBar*>()->isVisible(); });
    CHECK(!alone->findChild<QPushButton*>(QStringLiteral("importButton"))->isEnabled());
    alone->reject();
    w.settle();
    REQUIRE(w.document().execute({{"do", "import-character"}, {"path", IMOMUSHI_TEST_DATA "/characters/two_materials.glb"}, {"name", "child"}}));
    const auto clips = [&] { return w.now().characters.begin()->second->rig->clips.size(); };
    const std::size_t before = clips();
    w.window().files().drop({walk});
    auto* dialog = dialogOf();
    auto* import = dialog->findChild<QPushButton*>(QStringLiteral("importButton"));
    waitFor([&] { return import->isEnabled(); });
    w.settle();
    w.shoot("clips-import");
    CHECK(import->text() == "Import clips");
    CHECK(cutOff(*dialog) == "");
    CHECK(dialog->command().at("do") == "import-clips");
    CHECK(dialog->command().at("character") == "child");
    QTest::mouseClick(import, Qt::LeftButton);
    waitFor([&] { return !w.window().steps().running() && clips() > before; });
    CHECK(w.now().characters.begin()->second->rig->clips.back().name == "walk");
    w.settle();
    w.shoot("clips-imported");
    CHECK(w.window().messages().isVisible());  // what came, and which bones it does not have
}

TEST_CASE("studio: a rigged file becomes soft by the bones that are chosen, its clips become takes, and another skeleton takes its place") {
    const std::filesystem::path fox = IMOMUSHI_SHARED_MESHES "/Fox.glb";
    if (!std::filesystem::exists(fox)) return leaveOut("there is no " + fox.string());
    Window w;
    w.window().files().import({QString::fromStdString(fox.string())}, FileFlow::Lead::RiggedFile);
    auto* dialog = w.window().findChild<ImportDialog*>();
    REQUIRE(dialog);
    auto* import = dialog->findChild<QPushButton*>(QStringLiteral("importButton"));
    waitFor([&] { return import->isEnabled(); });
    w.settle();
    w.shoot("rigged-import");
    // It is 155 m large.
    auto* unit = dialog->findChild<QPushButton*>(QStringLiteral("takeUnit"));
    REQUIRE(unit->isVisible());
    QTest::mouseClick(unit, Qt::LeftButton);
    waitFor([&] { return import->isEnabled(); });
    auto* choose = dialog->findChild<QPushButton*>(QStringLiteral("chooseBones"));
    REQUIRE(choose->isVisible());
    // Neck and head stay one, the tail too.
    int proposed = 0;
    whenModal<BonesDialog>([&](BonesDialog* bones) {
        proposed = int(bones->chosen()->size());
        w.shoot("bones-dialog");
        CHECK(cutOff(*bones) == "");
        auto* tree = bones->findChild<QTreeWidget*>();
        for (QTreeWidgetItem* item : tree->findItems(QStringLiteral("Tail|Head"), Qt::MatchRegularExpression | Qt::MatchRecursive)) item->setCheckState(0, Qt::Unchecked);
        QTest::mouseClick(bones->findChild<QPushButton*>(QStringLiteral("useBones")), Qt::LeftButton);
    });
    QTest::mouseClick(choose, Qt::LeftButton);
    waitFor([&] { return import->isEnabled(); });
    const Json command = dialog->command();
    CHECK(command.at("unit") == "cm");
    REQUIRE(command.contains("bones"));
    CHECK(command.at("bones").size() > 2);
    CHECK(int(command.at("bones").size()) < proposed);
    QTest::mouseClick(import, Qt::LeftButton);
    waitFor([&] { return !w.window().steps().running(); });
    w.cameraStands();
    w.activate();
    REQUIRE(w.now().characters.size() == 1);
    REQUIRE(!w.now().bones.empty());
    for (const auto& [id, bone] : w.now().bones) CHECK(bone->name.find("Tail") == std::string::npos);
    QSettings().remove(QStringLiteral("import/sizes"));

    // Takes from its clips, by the button of the panel.
    auto* fromClip = w.window().takes().findChild<QToolButton*>(QStringLiteral("fromClip"));
    StudioDocks::raise(w.window().takes());
    w.settle();
    REQUIRE(fromClip->isVisible());
    const std::size_t clips = w.now().characters.begin()->second->rig->clips.size();
    whenModal<ClipsDialog>([&](ClipsDialog* takes) {
        QTest::mouseClick(takes->findChild<QPushButton*>(QStringLiteral("allClips")), Qt::LeftButton);
        w.shoot("clips-dialog");
        CHECK(takes->chosen().size() == clips);
        QTest::mouseClick(takes->findChild<QPushButton*>(QStringLiteral("makeTakes")), Qt::LeftButton);
    });
    QTest::mouseClick(fromClip, Qt::LeftButton);
    waitFor([&] { return !w.window().steps().running(); });
    CHECK(w.now().takes.size() == clips);
    REQUIRE(w.window().deck().take());
    CHECK(w.document().session().steps().back().name == "take-clip");
    w.activate();
    w.shoot("clips-takes");
    w.trigger("undo");
    CHECK(w.now().takes.size() == clips - 1);

    // The bones of another file take the place of these.
    const std::size_t bones = w.now().characters.begin()->second->rig->bones.size();
    const std::filesystem::path spider = IMOMUSHI_SHARED_MESHES "/rig-spider.glb";
    if (!std::filesystem::exists(spider)) return leaveOut("there is no " + spider.string());
    w.window().files().importSkeleton(*w.now().characters.begin()->second, QString::fromStdString(spider.string()));
    waitFor([&] { return !w.window().steps().running(); });
    CHECK(w.now().characters.begin()->second->rig->bones.size() != bones);
    CHECK(w.window().messages().isVisible());
}
