// SPDX-License-Identifier: GPL-3.0-or-later
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QFile>
#include <QSignalSpy>
#include <QSlider>
#include <QTabWidget>
#include <QTableWidget>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/reports/accuracy_commands.h"
#include "tests/studio/window.h"
#include "tests/support/plain_sample.h"
#include "ui/models/recent_files.h"
#include "ui/panels/accuracy/accuracy_errors.h"
#include "ui/panels/accuracy/accuracy_panel.h"
#include "ui/panels/accuracy/accuracy_plot.h"
#include "ui/widgets/appearance.h"

using namespace imomushi;

namespace {

/// The caterpillar with the accuracy panel open, and a study whose figures are made up: settings further down the list are slower and truer.
struct Studied : Window {
    AccuracyStudy study;
    QByteArray cache = qgetenv("XDG_CACHE_HOME");

    explicit Studied(QSize size = {1560, 960}) : Window(size) {
        qputenv("XDG_CACHE_HOME", folder.path().toUtf8());  // where studies are kept: none is known yet
        open(samples()[0].path);
        for (const Json& line : plainLines(samples()[0].name.toStdString())) run(line);
        panel().show(AccuracyStudy());  // the window is that of the case before: what it shows of now is what it reads from now on
        auto* dock = window().findChild<QDockWidget*>(QStringLiteral("accuracyDock"));
        REQUIRE(dock);
        dock->show();
        dock->raise();
        waitFor([&] { return panel().isVisible() && !panel().study().points.empty(); });  // it has read what is known
        settle();
        const auto input = studyInput(document().session());
        REQUIRE(input.has_value());
        study = knownStudy(*input);
        REQUIRE(study.points.size() > 10);
        for (std::size_t i = 0; i < study.points.size(); ++i) {
            AccuracyPoint& p = study.points[i];
            const double step = static_cast<double>(i);
            p.frameMs = p.predictedMs = 0.03 * std::pow(1.12, step);
            p.frameP99Ms = 1.5 * p.frameMs;
            p.precomputeSeconds = p.predictedSeconds = 0.2 * std::pow(1.2, (i * 7) % 13);
            p.relative = 0.4 * std::pow(0.8, step) * (i % 3 == 1 ? 3.0 : 1.0);
            p.percent = 10.0 * p.relative;
            p.frameBytes = 1e5 * (1.0 + step);
        }
        study.poses = {"stretch", "bend"};
        Reference& r = study.reference.emplace();
        r.mesh = "best";
        r.relative = 0.005;
        r.percent = 0.1;
        r.faceRelative = 0.004;
        r.facePercent = 0.1;
        for (std::size_t i = 0; i < 2; ++i) {
            auto& pose = r.positions.emplace_back();
            auto character = Character::build(input->reference.character).value();
            character.update(input->reference.poses[i].pose);
            for (std::size_t e = 0; e < input->reference.elements.size(); ++e) pose.push_back(character.positions(static_cast<int>(e)));
        }
        for (const auto& e : input->reference.elements) r.seen.emplace_back(static_cast<std::size_t>(e.mesh->body.vertices.rows()), 1);
        study.effects = {{"bone-dynamics", 0.011, 0.012, {}}, {"gravity", 0.02, 0.05, {}}, {"touch", 0.03, -1.0, "no responses"}};
        study.complete = true;
        panel().show(study);
        settle();
    }
    ~Studied() { qputenv("XDG_CACHE_HOME", cache); }
    AccuracyPanel& panel() { return window().accuracy(); }
    /// A unit box on x = 0 ... 1, or 1 ... 2 for "b", of two squares to a side.
    QString box(const std::string& name) {
        std::string text;
        std::map<std::array<int, 3>, int> index;
        std::string faces;
        const auto vertex = [&](std::array<int, 3> p) {
            const auto [at, fresh] = index.try_emplace(p, int(index.size()) + 1);
            if (fresh) text += "v " + std::to_string(0.5 * p[0] + (name == "b")) + " " + std::to_string(0.5 * p[1] - 0.5) + " " + std::to_string(0.5 * p[2] - 0.5) + "\n";
            return std::to_string(at->second);
        };
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {0, 2})
                for (int i = 0; i < 2; ++i)
                    for (int k = 0; k < 2; ++k) {
                        const auto corner = [&](int a, int b) {
                            std::array<int, 3> p{};
                            p[std::size_t(axis)] = side;
                            p[std::size_t((axis + 1) % 3)] = i + (side ? a : b);
                            p[std::size_t((axis + 2) % 3)] = k + (side ? b : a);
                            return vertex(p);
                        };
                        const std::string a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
                        faces += "f " + a + " " + b + " " + c + "\nf " + a + " " + c + " " + d + "\n";
                    }
        const QString path = folder.filePath(QString::fromStdString(name) + QStringLiteral(".obj"));
        QFile file(path);
        REQUIRE(file.open(QIODevice::WriteOnly));
        file.write(QByteArray::fromStdString(text + faces));
        return path;
    }
};

}  // namespace

TEST_CASE("accuracy: the slider walks along the front, from the fastest to the truest") {
    Studied w;
    auto* slider = w.panel().findChild<QSlider*>(QStringLiteral("accuracySlider"));
    REQUIRE(slider);
    const auto front = w.panel().study().frontPerFrame();
    REQUIRE(front.size() > 3);
    CHECK(slider->maximum() == int(front.size()) - 1);
    double slower = 0.0, worse = 1e9;
    for (int i = 1; i <= slider->maximum(); ++i) {
        slider->setValue(i);
        CHECK(w.panel().chosen() == int(front[std::size_t(i)]));
        const auto& p = w.panel().study().points[std::size_t(w.panel().chosen())];
        CHECK(p.frameMs > slower);
        CHECK(p.relative < worse);
        slower = p.frameMs;
        worse = p.relative;
    }
    w.shoot("accuracy");
    w.panel().findChild<QTabWidget*>()->setCurrentIndex(1);
    w.panel().findChild<QComboBox*>(QStringLiteral("accuracyPose"))->setCurrentIndex(2);
    w.shoot("accuracy-body");
    w.panel().findChild<QTabWidget*>()->setCurrentIndex(2);
    w.shoot("accuracy-effects");
    w.panel().findChild<QTabWidget*>()->setCurrentIndex(3);
    w.shoot("accuracy-costs");
}

TEST_CASE("accuracy: one click takes a setting over as one step, and undo takes it back") {
    Studied w;
    const int before = w.document().session().position();
    const CharacterSettings settings = w.now().settings;
    const AccuracySetting wanted{false, {BasisKind::Modes, 12}, true, {}, ResponseFormat::Int16};
    int point = -1;
    for (std::size_t i = 0; i < w.study.points.size(); ++i)
        if (w.study.points[i].setting == wanted) point = int(i);
    REQUIRE(point > 0);
    w.panel().choose(point);
    QTest::mouseClick(w.panel().findChild<QPushButton*>(QStringLiteral("accuracyApply")), Qt::LeftButton);
    w.settle();
    CHECK(presentSetting(w.now()) == wanted);
    CHECK(w.document().session().position() == before + 1);
    (void)w.document().execute({{"do", "undo"}});
    CHECK(w.now().settings == settings);
    CHECK_FALSE(w.now().effects.has(EffectKind::SmoothJoints));
}

TEST_CASE("accuracy: a point of a plot tells about itself and is chosen by a click, as a row of the table is") {
    Studied w;
    auto* plot = w.panel().findChild<AccuracyPlot*>(QStringLiteral("accuracyPerFrame"));
    REQUIRE(plot);
    QSignalSpy hovered(plot, &AccuracyPlot::hovered);
    const QPoint at = plot->place(9).toPoint();
    QTest::mouseMove(plot, QPoint(2, 2));
    w.settle();
    QTest::mouseMove(plot, at);
    CHECK(QTest::qWaitFor([&] { return hovered.count() >= 1; }, 5000));
    QTest::mouseClick(plot, Qt::LeftButton, {}, at);
    CHECK(w.panel().chosen() == 9);
    auto* table = w.panel().findChild<QTableWidget*>(QStringLiteral("accuracyTable"));
    REQUIRE(table->rowCount() == int(w.study.points.size()));
    table->selectRow(3);
    CHECK(w.panel().chosen() == table->item(3, 0)->data(Qt::UserRole).toInt());
}

TEST_CASE("accuracy: a budget finds the truest setting within it") {
    Studied w;
    const double budget = 0.1;
    w.panel().findChild<QDoubleSpinBox*>(QStringLiteral("accuracyBudget"))->setValue(budget);
    const int best = w.panel().study().best(budget);
    REQUIRE(best >= 0);
    for (const auto& p : w.study.points) {
        const bool truer = p.frameMs <= budget && p.relative < w.study.points[std::size_t(best)].relative;
        CHECK_FALSE(truer);
    }
}

TEST_CASE("accuracy: a study runs in the background, can be stopped, and keeps what arrived") {
    Studied w;
    auto input = studyInput(w.document().session()).value();
    input.seconds = 2.0;
    QSignalSpy arrived(&w.panel().job(), &AccuracyJob::arrived), finished(&w.panel().job(), &BackgroundJob::finished);
    w.panel().job().start(input);
    waitFor([&] { return arrived.count() > 0; });
    CHECK(w.panel().job().running());
    w.panel().job().cancel();
    CHECK(finished.count() == 1);
    CHECK_FALSE(w.panel().job().running());
    CHECK(w.panel().study().points.size() == w.study.points.size());
}

TEST_CASE("accuracy: the error in the pose of now is solved in the background, stops at once, and follows the pose") {
    Studied w;
    (void)w.document().execute({{"do", "new"}});
    // A character that is solved in a moment: two coarse boxes on two bones.
    for (const char* name : {"a", "b"}) w.run({{"do", "import-element"}, {"path", QFile::encodeName(w.box(name)).toStdString()}, {"name", name}});
    w.run({{"do", "add-joint-face"}, {"element", "a"}, {"name", "out"}, {"plane", {{"origin", {1, 0, 0}}, {"normal", {1, 0, 0}}}}});
    w.run({{"do", "add-joint-face"}, {"element", "b"}, {"name", "in"}, {"plane", {{"origin", {1, 0, 0}}, {"normal", {-1, 0, 0}}}}});
    w.run({{"do", "join"}, {"a", "a/out"}, {"b", "b/in"}});
    w.run({{"do", "add-bone"}, {"name", "first"}, {"element", "a"}, {"from", {0, 0, 0}}, {"to", "a/out"}});
    w.run({{"do", "add-bone"}, {"name", "second"}, {"element", "b"}, {"from", "first/end"}, {"to", {2, 0, 0}}, {"parent", "first"}});
    w.panel().findChild<QTabWidget*>()->setCurrentIndex(1);
    auto* errors = w.panel().findChild<AccuracyErrors*>();
    auto* measure = w.panel().findChild<QPushButton*>(QStringLiteral("accuracyPoseMeasure"));
    REQUIRE(errors);
    errors->setLimit(0.1);
    QTest::mouseClick(measure, Qt::LeftButton);
    w.settle();
    CHECK_FALSE(errors->job().running());  // nothing is precomputed: it says so
    CHECK_FALSE(errors->errors());
    w.run({{"do", "precompute"}});
    QTest::mouseClick(measure, Qt::LeftButton);
    CHECK(errors->job().running());
    QTest::mouseClick(measure, Qt::LeftButton);
    CHECK_FALSE(errors->job().running());
    CHECK_FALSE(errors->errors());
    QTest::mouseClick(measure, Qt::LeftButton);
    waitFor([&] { return errors->errors().has_value(); });
    CHECK(errors->errors()->error.relative == 0.0);  // at rest
    const PoseErrors atRest = *errors->errors();
    for (const char* end : {"first/start", "second/end"}) w.run({{"do", "pin"}, {"endpoint", end}});
    w.run({{"do", "drag"}, {"endpoint", "first/end"}, {"to", {0.9, 0.4, 0}}});
    waitFor([&] { return errors->errors()->error.relative > 1e-3; });
    // The full solution was kept: the same seconds are told again. Solved again, it would have taken others.
    CHECK(errors->errors()->reference.solutionSeconds == atRest.reference.solutionSeconds);
    w.shoot("accuracy-pose-of-now");
}

TEST_CASE("accuracy: readable in both themes, in Japanese and at 125 %") {
    Studied w;
    Appearance& look = Appearance::instance();
    auto* tabs = w.panel().findChild<QTabWidget*>();
    const QString english = tabs->tabText(0);
    for (const auto theme : {Appearance::Theme::Light, Appearance::Theme::Dark}) {
        look.setTheme(theme);
        look.setLanguage(QStringLiteral("ja"));
        look.setScale(1.25);
        w.settle();
        CHECK(tabs->tabText(0) != english);
        for (int tab = 0; tab < tabs->count(); ++tab) {
            CAPTURE(tab);
            tabs->setCurrentIndex(tab);
            w.settle();
            CHECK(pale(w.panel()) == "");
            w.shoot(qPrintable(QStringLiteral("accuracy-ja-125-%1-%2").arg(int(theme)).arg(tab)));
        }
        look.setScale(1.0);
        look.setLanguage(QStringLiteral("en"));
        w.settle();
        CHECK(tabs->tabText(0) == english);
    }
    tabs->setCurrentIndex(0);
    for (QWidget* child : w.panel().findChildren<QWidget*>())
        if (child->focusPolicy() != Qt::NoFocus && child->isVisible() && (qobject_cast<AccuracyPlot*>(child) || qobject_cast<QSlider*>(child) || qobject_cast<QTableWidget*>(child)))
            CHECK_MESSAGE(!child->accessibleName().isEmpty(), child->objectName().toStdString());
}
