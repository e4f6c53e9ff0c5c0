// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/typed_number.h"

#include <doctest/doctest.h>

#include <QKeyEvent>
#include <numbers>

#include "ui/tools/axis_lock.h"

using namespace imomushi;
using Of = TypedNumber::Of;

namespace {

/// Types each sign; '\t' is Tab, '<' Backspace.
void type(TypedNumber& number, const QString& signs, Of of = Of::Length, std::string_view axes = "XYZ") {
    for (const QChar sign : signs)
        number.key(sign == u'\t' ? Qt::Key_Tab : sign == u'<' ? Qt::Key_Backspace : Qt::Key_unknown, sign == u'\t' || sign == u'<' ? QString() : QString(sign), of, axes);
}

/// What a key of a Linux keyboard types: its place (code of the driver) and what its layout says.
QString key(int driver, int key, const QString& text, Qt::KeyboardModifiers modifiers = {}) { return typedBy(QKeyEvent(QEvent::KeyPress, key, modifiers, quint32(driver + 8), 0, 0, text)); }

}  // namespace

TEST_CASE("typed number: units and expressions") {
    const auto length = [](const char* text, double pointer = 0.5) { return evaluateTyped(QString::fromUtf8(text), Of::Length, pointer).value_or(-99.0); };
    CHECK(length("12 cm") == doctest::Approx(0.12));
    CHECK(length("12cm") == doctest::Approx(0.12));
    CHECK(length("3 mm") == doctest::Approx(0.003));
    CHECK(length("1.5") == doctest::Approx(1.5));
    CHECK(length(".5m") == doctest::Approx(0.5));
    CHECK(length("-2") == doctest::Approx(-2.0));
    CHECK(length("6'2\"") == doctest::Approx(6 * 0.3048 + 2 * 0.0254));
    CHECK(length("1/3") == doctest::Approx(1.0 / 3.0));
    CHECK(length("2*(1+0.5)") == doctest::Approx(3.0));
    CHECK(length("12 cm+3mm") == doctest::Approx(0.123));
    CHECK(length("2*3 cm") == doctest::Approx(2.0 * 0.03));
    // An operator at the beginning works on what the pointer says.
    CHECK(length("*1.5") == doctest::Approx(0.75));
    CHECK(length("/2") == doctest::Approx(0.25));
    CHECK(length("-") == doctest::Approx(-0.5));
    const auto angle = [](const char* text) { return evaluateTyped(QString::fromUtf8(text), Of::Angle, 0.2).value_or(-99.0) * 180.0 / std::numbers::pi; };
    CHECK(angle("30") == doctest::Approx(30.0));
    CHECK(angle("30°") == doctest::Approx(30.0));
    CHECK(angle("90/4") == doctest::Approx(22.5));
    CHECK(angle("2*(10+5)") == doctest::Approx(2.0 * 15.0));
    CHECK(evaluateTyped(QStringLiteral("50%"), Of::Factor, 1.0) == doctest::Approx(0.5));
}

TEST_CASE("typed number: what is unfinished counts as far as it goes, and nothing becomes infinite") {
    CHECK(evaluateTyped(QStringLiteral("12 c"), Of::Length, 0.0) == doctest::Approx(12.0));
    CHECK(evaluateTyped(QStringLiteral("3*"), Of::Length, 0.0) == doctest::Approx(3.0));
    CHECK(evaluateTyped(QStringLiteral("2*(1+"), Of::Length, 0.0) == doctest::Approx(2.0));
    CHECK(evaluateTyped(QStringLiteral("1/0"), Of::Length, 0.0) == doctest::Approx(1.0));
    CHECK(!evaluateTyped(QStringLiteral("."), Of::Length, 0.0));
    CHECK(evaluateTyped(QStringLiteral("9999999999"), Of::Length, 0.0) == doctest::Approx(999999.0));
    CHECK(!evaluateTyped(QString(39, u'('), Of::Length, 0.0));
}

TEST_CASE("typed number: Tab goes to the next axis, and axes without a number stay") {
    TypedNumber number;
    CHECK(!number.leads());
    CHECK(number.values({1, 2, 3}) == std::array<double, 3>{1, 2, 3});
    type(number, QStringLiteral("5\t\t7"));
    CHECK(number.leads());
    CHECK(number.values({1, 2, 3}) == std::array<double, 3>{5, 0, 7});
    CHECK(number.shown({1, 2, 3}).contains(QStringLiteral("X\u20095 m")));
    CHECK(number.shown({1, 2, 3}).contains(QStringLiteral("Z\u20097▏")));
    // What is typed goes along when the drag is confined to another axis.
    number.setAxes("Y");
    CHECK(number.value(2.0) == doctest::Approx(7.0));
    // Another kind of number begins anew.
    type(number, QStringLiteral("9"), Of::Angle, "");
    CHECK(number.value(0.0) == doctest::Approx(9.0 * std::numbers::pi / 180.0));
}

TEST_CASE("typed number: minus turns the sign round, and goes into expressions") {
    TypedNumber number;
    type(number, QStringLiteral("12-"), Of::Length, "X");
    CHECK(number.value(0.0) == doctest::Approx(-12.0));
    type(number, QStringLiteral("-3"), Of::Length, "X");
    CHECK(number.value(0.0) == doctest::Approx(123.0));
    type(number, QStringLiteral("*2-1"), Of::Length, "X");
    CHECK(number.value(0.0) == doctest::Approx(245.0));
}

TEST_CASE("typed number: an operator alone works on all axes that the pointer leads") {
    TypedNumber number;
    type(number, QStringLiteral("*2"));
    CHECK(number.values({1, 2, 3}) == std::array<double, 3>{2, 4, 6});
}

TEST_CASE("typed number: Backspace takes signs away until the pointer leads again, then clears") {
    TypedNumber number;
    type(number, QStringLiteral("12\t3<"));
    CHECK(number.values({1, 2, 3}) == std::array<double, 3>{12, 0, 0});
    type(number, QStringLiteral("<"));
    CHECK(!number.leads());
    CHECK(number.values({1, 2, 3}) == std::array<double, 3>{1, 2, 3});
    CHECK(number.shown({1, 2, 3}).isEmpty());
    CHECK(!number.key(Qt::Key_Backspace, {}, Of::Length, "XYZ"));
}

TEST_CASE("typed number: keys that are no part of a number are left to the tool") {
    TypedNumber number;
    for (const char* letter : {"m", "k", "x", "p", " ", ")"}) CHECK(!number.key(0, QString::fromLatin1(letter), Of::Length, "XYZ"));
    CHECK(!number.leads());
    type(number, QStringLiteral("3"));
    CHECK(!number.key(0, QStringLiteral("x"), Of::Length, "XYZ"));
    CHECK(!number.key(0, QStringLiteral("b"), Of::Length, "XYZ"));
    CHECK(number.key(0, QStringLiteral("c"), Of::Length, "XYZ"));
}

TEST_CASE("typed number: the same keys type digits under US, French, German and Japanese layouts") {
    // The row of digits: codes 2 to 11 of the driver.
    CHECK(key(2, Qt::Key_1, QStringLiteral("1")) == QStringLiteral("1"));
    const QString french = QStringLiteral("&é\"'(-è_çà");
    for (int i = 0; i < 10; ++i) {
        CHECK(key(2 + i, french[i].toUpper().unicode(), french.mid(i, 1)) == QString::number((i + 1) % 10));
        CHECK(key(2 + i, Qt::Key_0 + (i + 1) % 10, QString::number((i + 1) % 10), Qt::ShiftModifier) == QString::number((i + 1) % 10));
    }
    // Shift makes a drag fine, and digits stay digits: US "!", German "§"; signs of calculation are those of the layout.
    CHECK(key(2, Qt::Key_Exclam, QStringLiteral("!"), Qt::ShiftModifier) == QStringLiteral("1"));
    CHECK(key(4, Qt::Key_section, QStringLiteral("§"), Qt::ShiftModifier) == QStringLiteral("3"));
    CHECK(key(9, Qt::Key_Asterisk, QStringLiteral("*"), Qt::ShiftModifier) == QStringLiteral("*"));
    CHECK(key(8, Qt::Key_Slash, QStringLiteral("/"), Qt::ShiftModifier) == QStringLiteral("/"));
    CHECK(key(9, Qt::Key_ParenLeft, QStringLiteral("("), Qt::ShiftModifier) == QStringLiteral("("));
    CHECK(key(40, Qt::Key_Asterisk, QStringLiteral("*"), Qt::ShiftModifier) == QStringLiteral("*"));  // Japanese, beside ";"
    CHECK(key(41, Qt::Key_degree, QStringLiteral("°"), Qt::ShiftModifier) == QStringLiteral("°"));     // German
    // Minus: of the US and Japan, of Germany, and of France, whose own is the digit 6.
    CHECK(key(12, Qt::Key_Minus, QStringLiteral("-")) == QStringLiteral("-"));
    CHECK(key(53, Qt::Key_Minus, QStringLiteral("-")) == QStringLiteral("-"));
    CHECK(key(12, Qt::Key_ParenRight, QStringLiteral(")")) == QStringLiteral("-"));
    // Commas are points; the keypad types digits with and without its lock.
    CHECK(key(51, Qt::Key_Comma, QStringLiteral(",")) == QStringLiteral("."));
    CHECK(key(83, Qt::Key_Comma, QStringLiteral(","), Qt::KeypadModifier) == QStringLiteral("."));
    CHECK(key(79, Qt::Key_1, QStringLiteral("1"), Qt::KeypadModifier) == QStringLiteral("1"));
    CHECK(key(79, Qt::Key_End, {}, Qt::KeypadModifier) == QStringLiteral("1"));
    CHECK(key(71, Qt::Key_Home, {}, Qt::KeypadModifier) == QStringLiteral("7"));
    CHECK(key(74, Qt::Key_Minus, QStringLiteral("-"), Qt::KeypadModifier) == QStringLiteral("-"));
    // Where no places are told: by what French keys type.
    CHECK(typedBy(QKeyEvent(QEvent::KeyPress, Qt::Key_Eacute, Qt::NoModifier, QStringLiteral("é"))) == QStringLiteral("2"));
    // Commands of the window type nothing.
    CHECK(key(2, Qt::Key_1, QStringLiteral("1"), Qt::ControlModifier).isEmpty());
    CHECK(key(30, Qt::Key_A, QStringLiteral("a")) == QStringLiteral("a"));
    CHECK(key(1, Qt::Key_Escape, QStringLiteral("\u001b")).isEmpty());
}

TEST_CASE("axis lock: what is seen end on does not follow the pointer, and nothing is infinite") {
    PointerEvent e;
    e.viewForward = Vec3(0.03, 0.0, -1.0).normalized();
    AxisLock lock;
    CHECK(lock.axes() == "XYZ");
    CHECK(lock.key(Qt::Key_Z, {}));
    CHECK(lock.plane(e).norm() == 0.0);
    CHECK(lock.text(e).contains(QStringLiteral("end on")));
    CHECK(lock.axes() == "Z");
    CHECK(lock.key(Qt::Key_Z, {}));
    CHECK(lock.free());
    CHECK(lock.key(Qt::Key_X, {}));
    CHECK(std::abs(lock.plane(e).norm() - 1.0) < 1e-12);
    CHECK(lock.plane(e).x() == doctest::Approx(0.0));
    CHECK(lock.key(Qt::Key_X, Qt::ShiftModifier));
    CHECK(lock.axes() == "YZ");
    CHECK(lock.confined(Vec3(1, 2, 3)) == Vec3(0, 2, 3));
    CHECK(lock.fromAxes(lock.toAxes(Vec3(1, 2, 3))) == Vec3(0, 2, 3));
    CHECK(lock.plane(e).norm() == 0.0);  // seen from its edge
    CHECK(!lock.key(Qt::Key_A, {}));
}
