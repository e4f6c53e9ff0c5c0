// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/accuracy/accuracy_body.h"

#include <QLocale>
#include <QPainter>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr double kFill = 0.92;

/// From no error to the largest: dark blue, teal, yellow; brightness rises all the way, so that it can be read without colours (after "viridis").
QColor heat(double share) {
    static constexpr double stops[][3] = {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
    const double at = 4.0 * std::clamp(share, 0.0, 1.0);
    const int low = std::min(3, int(at));
    const double part = at - low;
    const auto mix = [&](int c) { return int(std::lround((1.0 - part) * stops[low][c] + part * stops[low + 1][c])); };
    return {mix(0), mix(1), mix(2)};
}

/// `part` as it is shown, coloured by its error relative to `largest`.
ElementMesh colored(const AccuracyBody::Part& part, double largest) {
    ElementMesh mesh{{part.shown, part.triangles}, {}};
    const auto n = part.error.size();
    mesh.renderMesh.bodyVertex.resize(n);
    std::iota(mesh.renderMesh.bodyVertex.begin(), mesh.renderMesh.bodyVertex.end(), 0);
    mesh.renderMesh.triangles = part.triangles;
    mesh.renderMesh.colors.setOnes(Eigen::Index(n), 4);
    for (std::size_t v = 0; v < n; ++v)
        mesh.renderMesh.colors.row(Eigen::Index(v)).head<3>() = linearColor(heat(largest > 0.0 ? std::max(0.0f, part.error[v]) / largest : 0.0)).transpose();
    return mesh;
}

template <class A>
bool same(const A& a, const A& b) {
    return a.rows() == b.rows() && a == b;
}

}  // namespace

AccuracyBody::AccuracyBody(QWidget* parent) : TurntableView(parent) {
    scene_.grid = scene_.groundShadow = false;
    scene_.camera.orthographic = true;
    connect(&Appearance::instance(), &Appearance::changed, this, &AccuracyBody::makeBodies);
}

QSize AccuracyBody::sizeHint() const { return {px(420), px(240)}; }
QSize AccuracyBody::minimumSizeHint() const { return {px(180), px(120)}; }

void AccuracyBody::setTitles(const QString& shown, const QString& full, const QString& unit) {
    shownTitle_ = shown;
    fullTitle_ = full;
    unit_ = unit;
    setAccessibleName(shown);
    update();
}

void AccuracyBody::setParts(std::vector<Part> parts) {
    // Texts are refreshed more often than bodies.
    if (std::equal(parts.begin(), parts.end(), parts_.begin(), parts_.end(), [](const Part& a, const Part& b) {
            return a.error == b.error && same(a.triangles, b.triangles) && same(a.shown, b.shown) && same(a.full, b.full);
        }))
        return;
    parts_ = std::move(parts);
    largest_ = 0.0;
    for (const Part& p : parts_)
        for (const float e : p.error) largest_ = std::max(largest_, double(e));
    makeBodies();
}

void AccuracyBody::makeBodies() {
    scene_.bodies.clear();
    positions_.clear();
    const auto add = [this](const Points& points, ElementMesh mesh) -> render::Body& {
        std::vector<float>& positions = positions_.emplace_back(std::size_t(points.size()));
        Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(positions.data(), points.rows(), 3) = points.cast<float>();
        render::Body& body = scene_.bodies.emplace_back();
        body.id = scene_.bodies.size();
        body.mesh = std::make_shared<const ElementMesh>(std::move(mesh));
        body.positions = positions.data();
        return body;
    };
    for (const Part& p : parts_) add(p.shown, colored(p, largest_)).dataColors = true;
    for (const Part& p : parts_) add(p.full, {{p.full, p.triangles}, {}}).color = linearColor(themeColor(Appearance::Role::Muted));
    invalidate();
}

QRect AccuracyBody::pictureArea() const {
    const int line = fontMetrics().height();
    return {px(6), line + px(4), width() / 2 - px(12), height() - 2 * line - px(16)};
}

void AccuracyBody::drawPictures() {
    const auto draw = [this](bool full) {
        for (std::size_t i = 0; i < scene_.bodies.size(); ++i) scene_.bodies[i].visible = (i >= parts_.size()) == full;
        return drawn(pictureArea().size(), kFill);
    };
    shown_ = draw(false);
    full_ = draw(true);
}

void AccuracyBody::paint(QPainter& painter) {
    painter.fillRect(rect(), themeColor(Appearance::Role::Field));
    const double line = fontMetrics().height(), legend = line + px(8), half = 0.5 * width();
    painter.setPen(themeColor(Appearance::Role::Text));
    const auto title = [&](double x, const QString& text) {
        painter.drawText(QRectF(x + px(6), px(2), half - px(12), line), Qt::AlignLeft | Qt::AlignVCenter, fontMetrics().elidedText(text, Qt::ElideRight, int(half) - px(12)));
    };
    title(0.0, shownTitle_);
    title(half, fullTitle_);
    if (parts_.empty()) return;
    const QRect area = pictureArea();
    painter.drawImage(area.topLeft(), shown_);
    painter.drawImage(area.translated(int(half), 0).topLeft(), full_);
    painter.drawText(area, Qt::AlignCenter | Qt::TextWordWrap, failure());
    const QRectF bar(px(8), height() - legend + px(2), std::min(px(140) * 1.0, 0.4 * half), 0.55 * line);
    for (int i = 0; i < 48; ++i) painter.fillRect(QRectF(bar.left() + i * bar.width() / 48.0, bar.top(), bar.width() / 48.0 + 1.0, bar.height()), heat(i / 47.0));
    painter.setPen(themeColor(Appearance::Role::Text));
    painter.drawText(QRectF(bar.right() + px(8), bar.center().y() - 0.5 * line, width() - bar.right(), line), Qt::AlignLeft | Qt::AlignVCenter,
                     QStringLiteral("0 … %1 %2").arg(QLocale().toString(largest_, 'g', 2), unit_));
}

}  // namespace imomushi
