// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/typed_number.h"

#include <QGuiApplication>
#include <QKeyEvent>
#include <QLocale>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "ui/models/texts.h"

namespace imomushi {
namespace {

using Of = TypedNumber::Of;

constexpr double kLargestTyped = 1e6;
constexpr qsizetype kLongestTyped = 40;

struct Unit {
    QStringView name;
    double factor;
};
/// The longer ones first: what is a prefix of another one is tried after it.
constexpr Unit kLengths[] = {{u"mm", 1e-3}, {u"cm", 1e-2}, {u"m", 1.0}, {u"in", 0.0254}, {u"\"", 0.0254}, {u"ft", 0.3048}, {u"'", 0.3048}};
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Unit kAngles[] = {{u"°", kDegree}, {u"deg", kDegree}, {u"d", kDegree}, {u"rad", 1.0}, {u"r", 1.0}};
constexpr Unit kFactors[] = {{u"%", 1e-2}};

template <class Act>
auto withUnits(Of of, const Act& act) {
    switch (of) {
        case Of::Angle: return act(kAngles);
        case Of::Factor: return act(kFactors);
        case Of::Length: break;
    }
    return act(kLengths);
}

bool isOperator(QChar c) { return c == u'*' || c == u'/' || c == u'+' || c == u'-'; }

/// Sums, products, signs and parentheses, from left to right. Where the rest makes no sense, ok_ is false and at_ is there.
class Evaluation {
public:
    Evaluation(QStringView text, Of of, double pointer) : text_(text), of_(of), pointer_(pointer) {}
    std::optional<double> run() {
        skip();
        if (at_ == text_.size()) return std::nullopt;
        double value = 0.0;
        if (peek() == u'*' || peek() == u'/')
            value = sum(pointer_);
        else if (peek() == u'-' && at_ + 1 == text_.size())
            return -pointer_;
        else
            value = sum(std::nullopt);
        skip();
        if (!ok_ || at_ != text_.size() || !std::isfinite(value) || std::abs(value) >= kLargestTyped) return std::nullopt;
        return value;
    }

private:
    [[nodiscard]] QChar peek() const { return at_ < text_.size() ? text_[at_] : QChar(); }
    void skip() {
        while (peek() == u' ') ++at_;
    }
    bool take(char16_t c) {
        skip();
        if (peek() != c) return false;
        ++at_;
        return true;
    }
    double sum(std::optional<double> first) {
        double value = product(first);
        while (ok_)
            if (take(u'+'))
                value += product(std::nullopt);
            else if (take(u'-'))
                value -= product(std::nullopt);
            else
                break;
        return value;
    }
    /// A factor of a product is a plain number, and what it is a factor of has the unit: "2 * 3 cm", "1 / 3".
    double product(std::optional<double> first) {
        double value = first ? *first : factor(false);
        while (ok_)
            if (take(u'*'))
                value *= factor(true);
            else if (take(u'/'))
                value = divided(value, factor(true));
            else
                break;
        return value;
    }
    double divided(double value, double by) {
        if (std::abs(by) < 1.0 / kLargestTyped) return ok_ = false, 0.0;
        return value / by;
    }
    double factor(bool plain) {
        if (++depth_ > kLongestTyped) return ok_ = false, 0.0;
        if (take(u'-')) return -factor(plain);
        if (take(u'+')) return factor(plain);
        if (take(u'(')) {
            const bool before = std::exchange(plain_, plain || plain_);
            const double value = sum(std::nullopt);
            plain_ = before;
            skip();
            if (at_ < text_.size() && !take(u')')) ok_ = false;
            return value;
        }
        double value = quantity(plain || plain_);
        // Feet and inches.
        for (skip(); ok_ && of_ == Of::Length && united_ && peek().isDigit(); skip()) value += quantity(plain || plain_);
        return value;
    }
    double quantity(bool plain) {
        skip();
        const qsizetype from = at_;
        while (peek().isDigit() || peek() == u'.') ++at_;
        bool ok = false;
        const double number = QLocale::c().toDouble(text_.mid(from, at_ - from), &ok);
        if (!ok || number >= kLargestTyped) return ok_ = false, 0.0;
        skip();
        united_ = false;
        return withUnits(of_, [&](const auto& units) {
            for (const Unit& unit : units)
                if (text_.mid(at_).startsWith(unit.name)) {
                    at_ += unit.name.size();
                    united_ = true;
                    return number * unit.factor;
                }
            return plain || of_ != Of::Angle ? number : number * kDegree;
        });
    }

    QStringView text_;
    Of of_;
    double pointer_;
    qsizetype at_ = 0, depth_ = 0;
    bool ok_ = true, united_ = false, plain_ = false;
};

/// Letters that units are made of.
bool belongsToUnit(QChar c, Of of) {
    return withUnits(of, [&](const auto& units) { return std::any_of(std::begin(units), std::end(units), [&](const Unit& unit) { return unit.name.contains(c); }); });
}

QString valueText(double value, Of of) {
    const QLocale locale;
    switch (of) {
        case Of::Angle: return locale.toString(value / kDegree, 'g', 4) + QStringLiteral("°");
        case Of::Factor: return QStringLiteral("×\u2009") + locale.toString(value, 'g', 4);
        case Of::Length: break;
    }
    return lengthText(value);
}

bool isPlain(const QString& text) {
    return std::all_of(text.begin(), text.end(), [](QChar c) { return c.isDigit() || c == u'.' || c == u'-'; });
}

/// The row of digits, by its place on the keyboard; none: another key, or places are not told here.
std::optional<int> physicalDigit(const QKeyEvent& key) {
    const auto code = int(key.nativeScanCode());
    const QString platform = QGuiApplication::platformName();
    // Codes of Linux are those of its drivers and 8 more; those of Windows are the drivers' own.
    const int first = platform == QStringLiteral("windows") ? 2 : 10;
    if (platform == QStringLiteral("cocoa")) return std::nullopt;
    if (code >= first && code < first + 10) return (code - first + 1) % 10;
    return std::nullopt;
}

/// Right of the row of digits: the minus of many keyboards.
bool isPhysicalMinus(const QKeyEvent& key) {
    const QString platform = QGuiApplication::platformName();
    return platform != QStringLiteral("cocoa") && int(key.nativeScanCode()) == (platform == QStringLiteral("windows") ? 12 : 20);
}

/// What French keys of the row of digits type without Shift, where their places are not told.
std::optional<int> frenchDigit(int key) {
    constexpr int kKeys[] = {Qt::Key_Agrave, Qt::Key_Ampersand, Qt::Key_Eacute, Qt::Key_QuoteDbl, Qt::Key_Apostrophe, Qt::Key_ParenLeft, -1, Qt::Key_Egrave, Qt::Key_Underscore, Qt::Key_Ccedilla};
    for (int digit = 0; digit < 10; ++digit)
        if (kKeys[digit] == key) return digit;
    return std::nullopt;
}

/// Without its lock the keypad has keys that move a cursor.
std::optional<QChar> keypadSign(int key) {
    switch (key) {
        case Qt::Key_Insert: return u'0';
        case Qt::Key_End: return u'1';
        case Qt::Key_Down: return u'2';
        case Qt::Key_PageDown: return u'3';
        case Qt::Key_Left: return u'4';
        case Qt::Key_Clear: return u'5';
        case Qt::Key_Right: return u'6';
        case Qt::Key_Home: return u'7';
        case Qt::Key_Up: return u'8';
        case Qt::Key_PageUp: return u'9';
        case Qt::Key_Delete:
        case Qt::Key_Comma: return u'.';
        default: return std::nullopt;
    }
}

}  // namespace

QString typedBy(const QKeyEvent& key) {
    if (key.modifiers() & (Qt::ControlModifier | Qt::MetaModifier)) return {};
    if (key.modifiers() & Qt::KeypadModifier)
        if (const auto sign = keypadSign(key.key())) return *sign;
    const QChar sign = key.text().size() == 1 ? key.text().front() : QChar();
    if (sign.isDigit()) return QChar(char16_t(u'0' + sign.digitValue()));
    const auto digit = physicalDigit(key);
    const bool shifted = (key.modifiers() & Qt::ShiftModifier) != 0, other = (key.modifiers() & Qt::AltModifier) != 0;
    if (digit && !shifted && !other) return QString::number(*digit);
    constexpr QStringView kSigns = u".*/+-°%'";
    if (!sign.isNull() && (kSigns.contains(sign) || (shifted && (sign == u'(' || sign == u'"')))) return sign;
    // A drag that Shift makes fine.
    if (digit && !other && sign != u'(' && sign != u')') return QString::number(*digit);
    if (!key.nativeScanCode() && !shifted)
        if (const auto french = frenchDigit(key.key())) return QString::number(*french);
    if (isPhysicalMinus(key) && !shifted && !sign.isLetterOrNumber() && sign != u'=') return QStringLiteral("-");
    if (sign == u',') return QStringLiteral(".");
    if (sign == u'(' || sign == u')' || sign == u'"' || sign == u' ' || (sign.isLetter() && sign.unicode() < 128)) return sign.toLower();
    return {};
}

std::optional<double> evaluateTyped(const QString& text, Of of, double pointer) {
    // What is still being typed is left out, sign by sign.
    for (qsizetype length = text.size(); length > 0; --length)
        if (const auto value = Evaluation(QStringView(text).left(length), of, pointer).run()) return value;
    return std::nullopt;
}

bool TypedNumber::leads() const {
    return std::any_of(texts_.begin(), texts_.end(), [](const QString& text) { return !text.isEmpty(); });
}

void TypedNumber::clear() {
    for (QString& text : texts_) text.clear();
    current_ = 0;
    begun_ = false;
}

void TypedNumber::setAxes(std::string_view axes) {
    if (axes == axes_) return;
    const std::array<QString, 3> before = texts_;
    const std::string named = axes_;
    const QString current = texts_[current_];
    for (QString& text : texts_) text.clear();
    axes_ = axes;
    if (count() == 1) {
        texts_[0] = current;
    } else {
        for (std::size_t i = 0; i < count(); ++i)
            if (const auto at = named.find(axes_[i]); at != std::string::npos) texts_[i] = before[at];
    }
    current_ = std::min(current_, count() - 1);
    for (std::size_t i = 0; i < count(); ++i)
        if (texts_[i] == current && !current.isEmpty()) current_ = i;
}

bool TypedNumber::type(QChar sign) {
    QString& text = now();
    if (text.size() >= kLongestTyped) return true;
    const bool expression = std::any_of(text.begin(), text.end(), [](QChar c) { return c == u'*' || c == u'/' || c == u'+' || c == u'('; });
    if (sign == u'-' && !text.isEmpty() && !expression) {
        if (text.startsWith(u'-'))
            text.remove(0, 1);
        else
            text.prepend(u'-');
        return true;
    }
    if (sign == u')' && !expression && !text.contains(u'(')) return false;
    if (sign == u' ' && text.isEmpty()) return false;
    // A unit follows a number, and two operators do not follow each other.
    if ((sign.isLetter() || sign == u'°' || sign == u'%' || sign == u'\'' || sign == u'"') && (text.isEmpty() || !belongsToUnit(sign, of_) || isOperator(text.back()))) return false;
    if ((sign == u'*' || sign == u'/' || sign == u'+') && !text.isEmpty() && isOperator(text.back())) text.chop(1);
    text += sign;
    return true;
}

bool TypedNumber::key(int key, const QString& text, Of of, std::string_view axes) {
    if (of != of_) clear();
    of_ = of;
    setAxes(axes);
    if (key == Qt::Key_Tab || key == Qt::Key_Backtab) {
        if (count() == 1) return begun_;
        current_ = (current_ + (key == Qt::Key_Tab ? 1 : count() - 1)) % count();
        begun_ = true;
        return true;
    }
    if (key == Qt::Key_Backspace) {
        if (!begun_) return false;
        if (now().isEmpty())
            clear();
        else
            now().chop(1);
        return true;
    }
    if (text.size() != 1 || !type(text.front())) return false;
    begun_ = true;
    return true;
}

std::array<double, 3> TypedNumber::values(const std::array<double, 3>& pointer) const {
    if (!leads()) return pointer;
    const double stays = of_ == Of::Factor ? 1.0 : 0.0;
    // What works on the pointer alone does so along all axes.
    const auto relative = [](const QString& text) { return text.isEmpty() || text.startsWith(u'*') || text.startsWith(u'/') || text == u"-"; };
    const bool all = std::all_of(texts_.begin(), texts_.end(), relative);
    std::array<double, 3> values{stays, stays, stays};
    for (std::size_t i = 0; i < count(); ++i) {
        const QString& text = texts_[i].isEmpty() && all ? texts_[current_] : texts_[i];
        if (const auto value = evaluateTyped(text, of_, pointer[i]))
            values[i] = *value;
        else if (all)
            values[i] = pointer[i];
    }
    return values;
}

QString TypedNumber::shown(const std::array<double, 3>& pointer) const {
    if (!begun_) return {};
    const auto now = values(pointer);
    QString line;
    for (std::size_t i = 0; i < count(); ++i) {
        if (i) line += QStringLiteral("   ");
        if (!axes_.empty()) line += QLatin1Char(axes_[i]) + QStringLiteral("\u2009");
        const QString value = valueText(now[i], of_);
        if (i != current_)
            line += value;
        else if (isPlain(texts_[i]) && of_ == Of::Angle && !texts_[i].isEmpty())
            line += texts_[i] + QStringLiteral("▏°");
        else
            line += texts_[i] + QStringLiteral("▏") + (texts_[i].isEmpty() ? value : QStringLiteral(" = ") + value);
    }
    return line;
}

}  // namespace imomushi
