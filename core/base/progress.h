// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>
#include <string_view>
#include <utility>

namespace imomushi {

/// How a builder tells where it is and learns that nobody wants its result any more.
/// A builder calls cancelled() at least every 50 ms, so that cancelling answers within 0.2 s.
class Progress {
public:
    /// stage: a short untranslated key ("assemble", "factorise", ...); fraction: of the whole work, 0...1.
    /// Called from the builder's thread.
    using Report = std::function<void(std::string_view stage, double fraction)>;

    /// Reports nowhere and is never cancelled.
    Progress() = default;
    Progress(Report report, std::stop_token stop) : report_(std::move(report)), stop_(std::move(stop)) {}

    void report(std::string_view stage, double fraction) const {
        if (report_) report_(stage, fraction);
    }
    [[nodiscard]] bool cancelled() const { return stop_.stop_requested(); }

    /// A part of this work that runs from fraction `from` to fraction `to` of it.
    [[nodiscard]] Progress part(double from, double to) const {
        if (!report_) return Progress({}, stop_);
        return Progress([outer = report_, from, to](std::string_view stage,
                                                    double f) { outer(stage, from + (to - from) * f); },
                        stop_);
    }

private:
    Report report_;
    std::stop_token stop_;
};

}  // namespace imomushi
