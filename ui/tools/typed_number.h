// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <array>
#include <optional>
#include <string>
#include <string_view>

class QKeyEvent;

namespace imomushi {

/// What a key types while something is dragged. Digits are those of the physical keys, so that layouts whose digits need Shift type them, too; the keypad types digits
/// whatever its lock says. Empty: nothing.
QString typedBy(const QKeyEvent& key);

/// Numbers that are typed while something is dragged: they lead in the place of the pointer. Units ("12 cm", "30°"), expressions ("1/3", "2*(1+0.5)"); an operator at the
/// beginning works on what the pointer says ("*1.5", "/2", "-"), and "-" after a plain number turns its sign round. Tab goes to the next axis. Backspace takes away the last
/// sign; where there is none, everything. Without any sign the pointer leads again.
class TypedNumber {
public:
    /// Lengths: metres, where no unit is typed. Angles: typed in degrees, given in radians. Factors: 1 changes nothing.
    enum class Of { Length, Angle, Factor };

    /// `axes`: what is typed one after the other, like "XYZ", "Y", or "" for one number without a name. True: the key is used.
    bool key(int key, const QString& text, Of of, std::string_view axes);
    /// The axes are other ones from now on: along one alone the number that is being typed stays.
    void setAxes(std::string_view axes);
    void clear();
    /// Something is typed: it leads.
    [[nodiscard]] bool leads() const;
    [[nodiscard]] Of of() const { return of_; }
    /// Of each of the axes, where the pointer says `pointer`: an axis that nothing is typed of stays (0, of factors 1) where another one has a number.
    [[nodiscard]] std::array<double, 3> values(const std::array<double, 3>& pointer) const;
    [[nodiscard]] double value(double pointer) const { return values({pointer, 0.0, 0.0})[0]; }
    /// For the view; empty: nothing was typed.
    [[nodiscard]] QString shown(const std::array<double, 3>& pointer) const;

private:
    [[nodiscard]] std::size_t count() const { return axes_.empty() ? 1 : axes_.size(); }
    [[nodiscard]] QString& now() { return texts_[current_]; }
    bool type(QChar sign);

    Of of_ = Of::Length;
    std::string axes_;
    std::array<QString, 3> texts_;
    std::size_t current_ = 0;
    bool begun_ = false;  ///< something was typed, or Tab
};

/// What was typed, in metres, radians or as a factor; `pointer`: what an operator at the beginning works on. An unfinished end ("1*", "12 c") is left out. None: there is no
/// number, or none that is finite and less than 1e6.
std::optional<double> evaluateTyped(const QString& text, TypedNumber::Of of, double pointer);

}  // namespace imomushi
