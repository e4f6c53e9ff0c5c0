// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/plot.h"
#include "core/base/formatted.h"

#include <algorithm>
#include <cmath>

namespace imomushi {

namespace {

constexpr double kWidth = 860.0, kHeight = 560.0, kLeft = 86.0, kRight = 24.0, kTop = 52.0, kBottom = 64.0;
constexpr double kFewDecades = 2.5;
constexpr const char* kInk = "#1a1d21";
constexpr const char* kMuted = "#5d666f";
constexpr const char* kGrid = "#dfe3e8";
constexpr const char* kRest = "#8a94a0";
constexpr const char* kFront = "#0068b5";
constexpr const char* kPresent = "#c24e00";
constexpr const char* kLines[] = {"#0068b5", "#c24e00", "#1c7f4b", "#8a3ea8", "#7a5b00"};
constexpr const char* kDashes[] = {"", "8 4", "2 4", "12 4 2 4", "4 4"};

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

std::string n(double value) { return formatted("%.2f", value); }

std::string textAt(double x, double y, const std::string& text, const char* color, double size, const char* anchor, const std::string& more = {}) {
    return "<text x=\"" + n(x) + "\" y=\"" + n(y) + "\" fill=\"" + color + "\" font-size=\"" + n(size) + "\" text-anchor=\"" + anchor + "\"" + more + ">" + escaped(text) + "</text>\n";
}

/// The page, its axes and titles.
class Page {
public:
    Page(const std::string& title, const std::string& xTitle, const std::string& yTitle, const LogAxis& x, const LogAxis& y) : x_(x), y_(y) {
        out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + n(kWidth) + "\" height=\"" + n(kHeight) + "\" viewBox=\"0 0 " + n(kWidth) + " " + n(kHeight) +
              "\" font-family=\"Noto Sans, Noto Sans CJK JP, DejaVu Sans, sans-serif\">\n<title>" + escaped(title) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
        out += textAt(kLeft, 28.0, title, kInk, 17.0, "start", " font-weight=\"600\"");
        for (const auto& tick : x.ticks()) {
            const double at = px(tick.value);
            out += line(at, kTop, at, kHeight - kBottom, kGrid, tick.major ? 1.2 : 0.7);
            out += textAt(at, kHeight - kBottom + 18.0, tickText(tick.value), tick.major ? kInk : kMuted, tick.major ? 12.0 : 11.0, "middle");
        }
        for (const auto& tick : y.ticks()) {
            const double at = py(tick.value);
            out += line(kLeft, at, kWidth - kRight, at, kGrid, tick.major ? 1.2 : 0.7);
            out += textAt(kLeft - 8.0, at + 4.0, tickText(tick.value), tick.major ? kInk : kMuted, tick.major ? 12.0 : 11.0, "end");
        }
        out += line(kLeft, kHeight - kBottom, kWidth - kRight, kHeight - kBottom, kMuted, 1.2) + line(kLeft, kTop, kLeft, kHeight - kBottom, kMuted, 1.2);
        out += textAt(0.5 * (kLeft + kWidth - kRight), kHeight - 20.0, xTitle, kInk, 13.0, "middle");
        out += textAt(0.0, 0.0, yTitle, kInk, 13.0, "middle", " transform=\"translate(22," + n(0.5 * (kTop + kHeight - kBottom)) + ") rotate(-90)\"");
    }
    [[nodiscard]] double px(double value) const { return kLeft + x_.at(value) * (kWidth - kLeft - kRight); }
    [[nodiscard]] double py(double value) const { return kHeight - kBottom - y_.at(value) * (kHeight - kTop - kBottom); }
    static std::string line(double x0, double y0, double x1, double y1, const char* color, double width) {
        return "<line x1=\"" + n(x0) + "\" y1=\"" + n(y0) + "\" x2=\"" + n(x1) + "\" y2=\"" + n(y1) + "\" stroke=\"" + color + "\" stroke-width=\"" + n(width) + "\"/>\n";
    }
    std::string out;

private:
    LogAxis x_, y_;
};

bool shown(double x, double y) { return x > 0.0 && y > 0.0 && std::isfinite(x) && std::isfinite(y); }

}  // namespace

LogAxis LogAxis::around(const std::vector<double>& values) {
    double low = INFINITY, high = 0.0;
    for (const double v : values)
        if (v > 0.0 && std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    if (high <= 0.0) return {};
    // At least so wide that a line fits.
    const double room = std::max({0.08, 0.06 * std::log10(high / low), 0.5 * (std::log10(2.6) - std::log10(high / low))});
    return {low * std::pow(10.0, -room), high * std::pow(10.0, room)};
}

double LogAxis::at(double value) const { return std::log(value / low) / std::log(high / low); }

std::vector<LogAxis::Tick> LogAxis::ticks() const {
    std::vector<Tick> out;
    const double decades = std::log10(high / low);
    const int step = decades > 9.0 ? 2 : 1;
    for (int power = static_cast<int>(std::floor(std::log10(low))); power <= static_cast<int>(std::ceil(std::log10(high))); ++power)
        for (const int part : {1, 2, 5}) {
            const double value = part * std::pow(10.0, power);
            if (value < low || value > high) continue;
            if (part != 1 && decades > kFewDecades) continue;
            if (part == 1 && power % step != 0) continue;
            out.push_back({value, part == 1});
        }
    return out;
}

std::string tickText(double value) { return formatted("%.6g", value); }

std::string markdownTable(const std::vector<std::vector<std::string>>& rows) {
    std::string out;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        out += "|";
        for (const auto& cell : rows[r]) out += " " + cell + " |";
        out += "\n";
        if (r > 0) continue;
        out += "|---|";
        for (std::size_t c = 1; c < rows[0].size(); ++c) out += "---:|";
        out += "\n";
    }
    return out;
}

std::string ScatterPlot::svg() const {
    std::vector<double> xs, ys;
    for (const auto& p : points)
        if (shown(p.x, p.y)) xs.push_back(p.x), ys.push_back(p.y);
    Page page(title, xTitle, yTitle, LogAxis::around(xs), LogAxis::around(ys));
    if (floor > 0.0 && page.py(floor) < kHeight - kBottom) {
        const double y = std::max(kTop, page.py(floor));
        page.out += "<rect x=\"" + n(kLeft) + "\" y=\"" + n(y) + "\" width=\"" + n(kWidth - kLeft - kRight) + "\" height=\"" + n(kHeight - kBottom - y) +
                    "\" fill=\"#5d666f\" fill-opacity=\"0.10\"/>\n" + textAt(kWidth - kRight - 6.0, kHeight - kBottom - 8.0, floorText, kMuted, 11.0, "end");
    }
    std::vector<const PlotPoint*> front;
    for (const auto& p : points)
        if (p.front && shown(p.x, p.y)) front.push_back(&p);
    std::sort(front.begin(), front.end(), [](const PlotPoint* a, const PlotPoint* b) { return a->x < b->x; });
    // The front is a staircase: nothing better was measured between two points.
    std::string path;
    for (std::size_t i = 0; i < front.size(); ++i)
        path += i == 0 ? "M" + n(page.px(front[i]->x)) + " " + n(page.py(front[i]->y)) : "H" + n(page.px(front[i]->x)) + "V" + n(page.py(front[i]->y));
    if (!path.empty()) page.out += "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + kFront + "\" stroke-width=\"1.6\"/>\n";
    const auto mark = [&](const PlotPoint& p) {
        const double x = page.px(p.x), y = page.py(p.y);
        const std::string head = "<g><title>" + escaped(p.name + ": " + tickText(p.x) + ", " + tickText(p.y)) + "</title>";
        std::string body = p.front ? "<circle cx=\"" + n(x) + "\" cy=\"" + n(y) + "\" r=\"5\" fill=\"" + kFront + "\"/>"
                                   : "<circle cx=\"" + n(x) + "\" cy=\"" + n(y) + "\" r=\"4\" fill=\"#ffffff\" stroke=\"" + std::string(kRest) + "\" stroke-width=\"1.6\"/>";
        if (p.present)
            body += "<rect x=\"" + n(x - 9.0) + "\" y=\"" + n(y - 9.0) + "\" width=\"18\" height=\"18\" fill=\"none\" stroke=\"" + kPresent + "\" stroke-width=\"2\"/>";
        page.out += head + body + "</g>\n";
    };
    for (const auto& p : points)
        if (shown(p.x, p.y) && !p.front) mark(p);
    for (const auto* p : front) mark(*p);
    for (const auto& p : points)
        if (shown(p.x, p.y) && p.present && !p.front) mark(p);
    // Names of the front, where they cover neither each other nor the frame.
    struct Area {
        double x0, y0, x1, y1;
    };
    std::vector<Area> taken;
    for (const auto& p : points)
        if (shown(p.x, p.y)) taken.push_back({page.px(p.x) - 6.0, page.py(p.y) - 6.0, page.px(p.x) + 6.0, page.py(p.y) + 6.0});
    const auto fits = [&](const Area& b) {
        return b.x0 > kLeft && b.x1 < kWidth - kRight && b.y0 > kTop && b.y1 < kHeight - kBottom &&
               std::none_of(taken.begin(), taken.end(), [&](const Area& o) { return o.x0 < b.x1 && b.x0 < o.x1 && o.y0 < b.y1 && b.y0 < o.y1; });
    };
    for (const auto& p : points) {
        if (!shown(p.x, p.y) || !p.label || p.name.empty()) continue;
        const double x = page.px(p.x), y = page.py(p.y), width = 6.1 * static_cast<double>(p.name.size());
        for (const auto& [dx, dy] : {std::pair{10.0, -8.0}, {10.0, 16.0}, {-10.0 - width, 16.0}, {-10.0 - width, -8.0}, {10.0, -24.0}, {10.0, 32.0}, {-10.0 - width, 32.0}, {-10.0 - width, -24.0}}) {
            const Area box{x + dx, y + dy - 11.0, x + dx + width, y + dy + 3.0};
            if (!fits(box)) continue;
            page.out += textAt(x + dx, y + dy, p.name, p.present ? kPresent : kInk, 11.0, "start");
            taken.push_back(box);
            break;
        }
    }
    const double legend = kWidth - kRight;
    page.out += textAt(legend, 28.0, "\xE2\x97\x8F front   \xE2\x97\x8B dominated   \xE2\x96\xA1 present setting", kMuted, 12.0, "end");
    return page.out + "</svg>\n";
}

std::string LinePlot::svg() const {
    std::vector<double> xs, ys;
    for (const auto& l : lines)
        for (const auto& [x, y] : l.points)
            if (shown(x, y)) xs.push_back(x), ys.push_back(y);
    Page page(title, xTitle, yTitle, LogAxis::around(xs), LogAxis::around(ys));
    double at = kTop + 18.0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const char* color = kLines[i % std::size(kLines)];
        const std::string dash = kDashes[i % std::size(kDashes)];
        std::string path;
        for (const auto& [x, y] : lines[i].points) {
            if (!shown(x, y)) continue;
            path += (path.empty() ? "M" : "L") + n(page.px(x)) + " " + n(page.py(y));
            page.out += "<circle cx=\"" + n(page.px(x)) + "\" cy=\"" + n(page.py(y)) + "\" r=\"3\" fill=\"" + color + "\"/>\n";
        }
        const std::string stroke = std::string("fill=\"none\" stroke=\"") + color + "\" stroke-width=\"1.8\"" + (dash.empty() ? "" : " stroke-dasharray=\"" + dash + "\"");
        if (!path.empty()) page.out += "<path d=\"" + path + "\" " + stroke + "/>\n";
        page.out += "<path d=\"M" + n(kLeft + 14.0) + " " + n(at - 4.0) + "h28\" " + stroke + "/>\n" + textAt(kLeft + 50.0, at, lines[i].name, kInk, 12.0, "start");
        at += 18.0;
    }
    return page.out + "</svg>\n";
}

}  // namespace imomushi
