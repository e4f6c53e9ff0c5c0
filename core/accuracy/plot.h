// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace imomushi {

/// A logarithmic axis. All values are > 0.
struct LogAxis {
    double low = 1.0, high = 10.0;
    /// The axis that shows all of `values` with a little room; those that are not positive and finite are left out.
    static LogAxis around(const std::vector<double>& values);
    /// 0 at low, 1 at high.
    [[nodiscard]] double at(double value) const;
    /// Places of lines: powers of ten with `major`, and where few of them fit their twos and fives too.
    struct Tick {
        double value = 1.0;
        bool major = true;
    };
    [[nodiscard]] std::vector<Tick> ticks() const;
};

/// "0.02", "5", "200", "2e-05": short and exact for ticks.
std::string tickText(double value);

/// A table in Markdown; the first row holds titles.
std::string markdownTable(const std::vector<std::vector<std::string>>& rows);

struct PlotPoint {
    double x = 0.0, y = 0.0;
    std::string name;      ///< shown by viewers that show titles; with `label` also beside the point
    bool front = false, present = false, label = false;
};

/// Points on logarithmic axes with their front, as an SVG file that needs nothing but a viewer. Colours are those of a light page, safe for colour-blind readers; what
/// is on the front is a filled disc, the rest rings, the present one a square.
struct ScatterPlot {
    std::string title, xTitle, yTitle;
    std::vector<PlotPoint> points;
    double floor = 0.0;     ///< values of y below it cannot be told apart: shaded; 0: none
    std::string floorText;
    [[nodiscard]] std::string svg() const;
};

/// Lines over one logarithmic axis each, e.g. growth.
struct LinePlot {
    std::string title, xTitle, yTitle;
    struct Line {
        std::string name;
        std::vector<std::pair<double, double>> points;
    };
    std::vector<Line> lines;
    [[nodiscard]] std::string svg() const;
};

}  // namespace imomushi
