// SPDX-License-Identifier: GPL-3.0-or-later
#include <QCheckBox>
#include <QComboBox>
#include <QFileInfo>
#include <QLabel>
#include <QLineEdit>
#include <QSettings>

#include "tests/studio/window.h"
#include "tests/support/plain_sample.h"
#include "ui/dialogs/export_dialog.h"
#include "ui/jobs/export_job.h"
#include "ui/models/recent_files.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/choice_card.h"

using namespace imomushi;

namespace {

/// The caterpillar with a short take, and the export dialog.
struct Exporting : Window {
    ExportDialog* dialog = nullptr;

    explicit Exporting(bool withTake = true) {
        QSettings().remove(QStringLiteral("export"));
        Window::open(samples()[0].path);
        for (const Json& line : plainLines(samples()[0].name.toStdString())) run(line);
        if (withTake) {
            run({{"do", "record"}, {"take", "wave"}, {"action", "start"}});
            const auto& [id, bone] = *now().bones.rbegin();
            const Vec3 from = *endpoint({id, true});
            for (int i = 1; i <= 10; ++i) {
                run({{"do", "drag"}, {"endpoint", bone->name + "/end"}, {"to", {from.x(), from.y() + 0.01 * i, from.z()}}});
                document().stepFrame(1.0 / 60.0);
            }
            run({{"do", "record"}, {"take", "wave"}, {"action", "stop"}});
        }
        openDialog();
    }
    void openDialog() {
        trigger("export");
        dialog = window().findChild<ExportDialog*>();
        REQUIRE(dialog);
        REQUIRE(QTest::qWaitForWindowExposed(dialog));
    }
    void leaveDialog() {
        QTest::keyClick(window().findChild<ExportDialog*>(), Qt::Key_Escape);
        waitFor([&] { return !window().findChild<ExportDialog*>(); });
        activate();
    }
    std::optional<Vec3> endpoint(const EndpointRef& end) {
        const int point = document().session().pointIndex(end);
        const Pose& pose = document().session().shownPose();
        if (point >= 0 && std::size_t(point) < pose.points.size()) return pose.points[std::size_t(point)];
        return document().session().character()->input().skeleton.points[std::size_t(point)];
    }
    void choose(const char* card) { QTest::mouseClick(dialog->findChild<ChoiceCard*>(QLatin1String(card)), Qt::LeftButton); }
    QString path(const char* name) { return folder.filePath(QLatin1String(name)); }
    QPushButton& button(const char* name) { return *dialog->findChild<QPushButton*>(QLatin1String(name)); }
    void write(const QString& to) {
        dialog->setPath(to);
        QTest::mouseClick(&button("exportButton"), Qt::LeftButton);
        waitFor([&] { return !dialog->job().running(); }, 120000);
        settle();
    }
    bool says(const QString& text) {
        for (auto* label : dialog->findChildren<QLabel*>())
            if (label->isVisible() && label->text().contains(text)) return true;
        return false;
    }
};

}  // namespace

TEST_CASE("export: what is written is read back, and the dialog says how near it is") {
    Exporting w;
    w.shoot("export");
    CHECK(w.dialog->command() == Json{{"do", "export"}, {"path", w.dialog->findChild<QLineEdit*>()->text().toStdString()}, {"layout", "baked"}, {"preset", "exact"}});
    w.write(w.path("caterpillar.glb"));
    CHECK(QFileInfo(w.path("caterpillar.glb")).size() > 1000);
    CHECK(w.says(QStringLiteral("Read back and compared")));
    CHECK(w.says(QStringLiteral("caterpillar.glb")));
    CHECK(w.button("showInFolder").isVisible());
    const auto& answer = w.dialog->job().answer();
    REQUIRE(answer);
    REQUIRE(answer->has_value());
    CHECK((**answer)["check"]["max_percent"].get<double>() < 1e-3);  // 1e-5 of the diagonal
    w.shoot("export-done");
}

TEST_CASE("export: a preset sets the fields, a changed field is a key of its own, and choices are remembered") {
    Exporting w;
    w.choose("unity");
    QCheckBox* split = nullptr;
    for (auto* box : w.dialog->findChildren<QCheckBox*>())
        if (box->text().contains(QStringLiteral("0 and 1"))) split = box;
    REQUIRE(split);
    CHECK(split->isChecked());
    CHECK(!w.dialog->command().contains("split"));
    QTest::mouseClick(split, Qt::LeftButton, {}, QPoint(8, split->height() / 2));
    CHECK(w.dialog->command().at("split") == false);
    CHECK(w.dialog->command().at("preset") == "unity");
    w.choose("cache");
    CHECK(w.dialog->command().at("path").get<std::string>().ends_with(".pc2"));
    CHECK(!split->isEnabled());
    w.shoot("export-cache");
    // Caches of this format and FBX hold whole frames of one rate.
    w.choose("exact");
    CHECK(w.dialog->command().at("fps") == 60);
    w.choose("baked");
    w.choose("exact");
    CHECK(!w.dialog->command().contains("fps"));
    w.choose("unity");
    split->setChecked(false);
    w.choose("rigged");
    CHECK(w.dialog->command().at("path").get<std::string>().ends_with(".glb"));
    w.write(w.path("rigged.glb"));
    CHECK(w.says(QStringLiteral("Read back")));
    w.leaveDialog();
    w.openDialog();
    CHECK(w.dialog->command().at("layout") == "rigged");
    CHECK(w.dialog->command().at("preset") == "unity");
    CHECK(w.dialog->command().at("split") == false);
    CHECK(w.dialog->command().at("path").get<std::string>().starts_with(w.folder.path().toStdString()));
}

TEST_CASE("export: all takes go out, or one, or the pose with them or alone") {
    Exporting w;
    QComboBox* takes = nullptr;
    for (auto* box : w.dialog->findChildren<QComboBox*>())
        if (box->accessibleName() == QStringLiteral("Take")) takes = box;
    REQUIRE(takes);
    REQUIRE(takes->count() == 4);
    CHECK(!w.dialog->command().contains("take"));
    takes->setCurrentIndex(1);
    CHECK(w.dialog->command().at("pose") == true);
    CHECK(!w.dialog->command().contains("take"));
    takes->setCurrentIndex(2);
    CHECK(w.dialog->command().at("take") == "wave");
    takes->setCurrentIndex(3);
    CHECK(w.dialog->command().at("take") == Json::array());
    w.write(w.path("pose.glb"));
    const auto& answer = w.dialog->job().answer();
    REQUIRE(answer->has_value());
    REQUIRE((**answer)["clips"].size() == 1);
    CHECK((**answer)["clips"][0]["frames"] == 1);
}

TEST_CASE("export: it is cancelled at a click and leaves no file, and the studio stays alive meanwhile") {
    Exporting w;
    w.dialog->setPath(w.path("never.glb"));
    QTest::mouseClick(&w.button("exportButton"), Qt::LeftButton);
    REQUIRE(w.dialog->job().running());
    w.run({{"do", "pin"}, {"endpoint", w.now().bones.begin()->second->name + "/start"}});  // the document is not locked
    QTest::mouseClick(&w.button("closeButton"), Qt::LeftButton);
    CHECK(!w.dialog->job().running());
    w.settle();
    CHECK(w.dialog->isVisible());
    CHECK(w.says(QStringLiteral("Cancelled")));
    CHECK(stays([&] { return !QFileInfo::exists(w.path("never.glb")); }));
    QTest::mouseClick(&w.button("closeButton"), Qt::LeftButton);
    waitFor([&] { return !w.window().findChild<ExportDialog*>(); });
}

TEST_CASE("export: a file that cannot be written is said, and nothing else happens") {
    Exporting w(false);
    w.write(QStringLiteral("/nowhere/at/all/x.glb"));
    CHECK(w.says(QStringLiteral("could not be exported")));
    CHECK(!w.button("showInFolder").isVisible());
    w.shoot("export-failed");
}

TEST_CASE("export: the dialog reads in light colours, in Japanese and at 125 %, and tells what becomes of effects") {
    Exporting w;
    w.leaveDialog();
    w.run({{"do", "enable"}, {"effect", "bone-dynamics"}});
    w.run({{"do", "enable"}, {"effect", "gravity"}});
    w.openDialog();
    w.choose("skinned");
    w.shoot("export-effects");
    w.write(w.path("skinned.glb"));
    CHECK(w.says(QStringLiteral("Bone dynamics: exact")));
    w.shoot("export-skinned");
    auto& look = Appearance::instance();
    look.setTheme(Appearance::Theme::Light);
    look.setLanguage(QStringLiteral("ja"));
    w.settle();
    w.dialog = w.window().findChild<ExportDialog*>();
    REQUIRE(w.dialog);
    CHECK(w.dialog->windowTitle() == QStringLiteral("書き出し"));
    w.choose("baked");
    w.write(w.path("light.glb"));
    w.shoot("export-japanese");
    look.setLanguage(QStringLiteral("en"));
    look.setTheme(Appearance::Theme::Dark);
    look.setScale(1.25);
    w.settle();
    w.leaveDialog();
    w.openDialog();
    w.shoot("export-125");
    look.setScale(1.0);
    w.settle();
}
