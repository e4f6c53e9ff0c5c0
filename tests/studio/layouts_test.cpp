// SPDX-License-Identifier: GPL-3.0-or-later
// Typed numbers by the keys of other countries, as the X server tells them: setxkbmap sets the layout, xdotool presses keys by their places. On a display of its own.
#include <QGuiApplication>
#include <QProcess>
#include <QStandardPaths>

#include "tests/studio/window.h"
#include "tests/support/left_out.h"

using namespace imomushi;

namespace {

/// Places of a keyboard as X counts them: what is printed there in the US.
constexpr int kOne = 10, kTwo = 11, kThree = 12, kMinus = 20, kSlash = 61, kTab = 23, kReturn = 36, kSemicolon = 47, kBackspace = 22, kX = 53, kC = 54, kM = 58, kPad4 = 83, kPad1 = 87;

bool ran(const char* program, const QStringList& arguments) { return QProcess::execute(QString::fromLatin1(program), arguments) == 0; }

struct Keyboard {
    ~Keyboard() { ran("setxkbmap", {QStringLiteral("us")}); }
    static void press(std::initializer_list<int> places) {
        QStringList arguments{QStringLiteral("key"), QStringLiteral("--delay"), QStringLiteral("20")};
        for (const int place : places) arguments << QString::number(place);
        REQUIRE(ran("xdotool", arguments));
    }
};

}  // namespace

TEST_CASE("typed number by the X server: under US, French, German and Japanese layouts the keys of one place type the same digits, units as they are printed, and the keypad its own") {
    for (const char* needed : {"setxkbmap", "xdotool"})
        if (QStandardPaths::findExecutable(QString::fromLatin1(needed)).isEmpty()) return leaveOut(std::string(needed) + " is not installed");
    if (QGuiApplication::platformName() != QLatin1String("xcb")) return leaveOut("the display is no X server");
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    w.trigger("tool-pose");
    const EndpointRef end{w.now().boneNamed("head-bone")->id, true};
    w.document().select({{SelectionItem::Kind::Endpoint, end.bone, {}, true}});
    const Vec3 from = *w.document().session().positionOf(end);
    Keyboard keyboard;
    const auto says = [&](const char* text) { return w.view().tools().tool().banner().contains(QString::fromUtf8(text)); };
    struct Layout {
        const char* name;
        int m, minus;  ///< where they are
    };
    for (const auto& [layout, m, minus] : {Layout{"us", kM, kMinus}, {"fr", kSemicolon, kMinus}, {"de", kM, kSlash}, {"jp", kM, kMinus}}) {
        INFO(std::string(layout));
        REQUIRE(ran("setxkbmap", {QString::fromLatin1(layout)}));
        QTest::mouseMove(&w.view(), w.view().rect().center());
        w.view().setFocus();
        w.activate();
        const int before = w.document().session().position();
        QTest::keyClick(&w.view(), Qt::Key_G);
        REQUIRE(w.view().tools().busy());
        Keyboard::press({kX, kOne, kTwo, kC, m});
        waitFor([&] { return says("12cm▏ = 12 cm"); });
        Keyboard::press({kX, kTab, minus, kThree, kC, m});  // free again, and the next axis
        waitFor([&] { return says("-3cm▏ = -3 cm"); });
        // The keypad types, too, and does not turn the view.
        const Vec3 eye = w.view().cameraController().camera().eye;
        Keyboard::press({kBackspace, kBackspace, kBackspace, kPad4, kPad1, kC, m});
        waitFor([&] { return says("-41cm▏ = -41 cm"); });
        CHECK(w.view().cameraController().camera().eye == eye);
        Keyboard::press({kReturn});
        waitFor([&] { return !w.view().tools().busy(); });
        CHECK(w.document().session().position() == before + 1);
        CHECK((w.now().goals.at(end).target - from - Vec3(0.12, -0.41, 0)).norm() < 1e-9);
        w.run({{"do", "undo"}});
        w.run({{"do", "rest"}});
    }
}
