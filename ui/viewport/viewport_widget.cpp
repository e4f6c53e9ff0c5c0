// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/viewport_widget.h"

#include <QElapsedTimer>
#include <QLabel>
#include <QPainter>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/mesh/bounds.h"
#include "ui/models/failures.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/picking/picking.h"
#include "ui/viewport/limit_words.h"
#include "ui/viewport/view_overlay.h"
#include "ui/viewport/view_words.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

/// A tool that says more than this leaves no room for how the view is moved.
constexpr int kLongHint = 72;
constexpr float kXrayOpacity = 0.45f;
/// Where the processor draws, a picture that has not changed for this long is drawn again with smooth edges.
constexpr int kStillMs = 150;
constexpr double kMarkedShare = 0.06;  // of the diagonal, around a place that is framed

}  // namespace

void prepareView(const Document& document) {
    decodeTextures(document);
    makePicking(document.elements, document.characters);
}

ViewportWidget::ViewportWidget(StudioDocument& document, QWidget* parent)
    : QWidget(parent), document_(document), tools_(document), clock_(camera_, meter_) {
    setMouseTracking(true);
    setAttribute(Qt::WA_AcceptTouchEvents);
    setFocusPolicy(Qt::StrongFocus);
    setAccessibleName(tr("3D view"));
    setObjectName(QStringLiteral("viewport"));

    connect(&tools_, &ToolHost::interrupted, this, [this] {
        move_.reset();
        touch_.forget();
    });
    connect(&tools_, &ToolHost::changed, this, [this] {
        redraw();
        updateHint();
    });
    connect(&clock_, &FrameClock::ticked, this, &ViewportWidget::redraw);
    connect(&document_, &StudioDocument::frameStepped, this, [this] {
        if (const auto frame = document_.session().performed()) {
            meter_.addWork(frame->milliseconds);
            latency_.shows(frame->input);
        }
        redraw();
    });
    nextMove_.setSingleShot(true);
    nextMove_.setTimerType(Qt::PreciseTimer);
    connect(&nextMove_, &QTimer::timeout, this, &ViewportWidget::giveMove);
    touch_.press.setSingleShot(true);
    connect(&touch_.press, &QTimer::timeout, this, &ViewportWidget::pressAsMouse);
    connect(&document_, &StudioDocument::structureChanged, this, &ViewportWidget::structureChanged);
    connect(&document_, &StudioDocument::poseChanged, this, &ViewportWidget::animate);
    connect(&document_, &StudioDocument::responsesArriving, this, [this] {
        if (canvas_ && isVisible()) fade_ = shapeKept();
    });
    connect(&document_, &StudioDocument::changing, this, &ViewportWidget::beforeChange);
    connect(&document_, &StudioDocument::changeDone, this, &ViewportWidget::afterChange);
    connect(&document_, &StudioDocument::responsesChanged, this, [this] {
        animate();
        updateHint();
    });
    connect(&document_, &StudioDocument::selectionChanged, this, [this] {
        redraw();
        updateHint();
    });
    connect(&document_, &StudioDocument::hoverChanged, this, [this] {
        redraw();
        updateHint();
    });
    still_.setSingleShot(true);
    still_.setInterval(kStillMs);
    connect(&still_, &QTimer::timeout, this, [this] {
        smooth_ = true;
        redraw();
    });
    empty_ = document_.document().elements.empty();
    hint_ = hint();
    const QString needed = tr("The 3D view needs OpenGL 3.3. Update the graphics driver, or start with LIBGL_ALWAYS_SOFTWARE=1.");
    if (!GlCanvas::available()) {
        showMessage(needed);
        return;
    }
    canvas_ = new GlCanvas(this);
    connect(canvas_, &GlCanvas::painting, this, &ViewportWidget::paint);
    connect(canvas_, &GlCanvas::frameSwapped, this, [this] {
        if (const auto latency = latency_.swapped(inputTime())) Q_EMIT latencyMeasured(*latency);
        clock_.swapped();
    });
    connect(canvas_, &GlCanvas::failed, this, [this, needed](const QString& why) { showMessage(needed + QStringLiteral("\n\n") + why); });
    connect(canvas_, &GlCanvas::ready, this, [this] {
        if (message_) message_->hide();
    });
}

ViewportWidget::~ViewportWidget() {
    attempt([this] { tools_.tool().cancel(); });  // while this is still whole: a gesture that is taken back changes the document
    document_.disconnect(this);
}

// ---- hints -----------------------------------------------------------------------------------------------------------

QString ViewportWidget::hint() const {
    QString tool = tools_.tool().hint();
    const QString name = overlapped();
    if (!name.isEmpty()) tool = tr("“%1”, one of %2 ends here · Tab or a second click: the next", "the end of a bone").arg(name).arg(overlapping_) + QStringLiteral(" · ") + tool;
    if (tools_.tool().pending() || tool.size() > kLongHint) return tool;
    const QString view = navigator_.preset() == NavigationPreset::Blender
                             ? tr("Middle: orbit · Shift+middle: pan · Wheel: zoom")
                             : tr("Alt+left: orbit · Alt+middle: pan · Wheel: zoom");
    return tool.isEmpty() ? view : tool + QStringLiteral("   |   ") + view;
}

QString ViewportWidget::overlapped() const {
    const auto& hovered = document_.hovered();
    if (overlapping_ < 2 || tools_.tool().busy() || !hovered || hovered->kind != SelectionItem::Kind::Endpoint) return {};
    return QString::fromStdString(pathOf(document_.document(), *hovered));
}

void ViewportWidget::updateHint() {
    if (const QString words = viewWords(document_); words != accessibleDescription()) setAccessibleDescription(words);
    QString now = hint();
    if (now == hint_) return;
    hint_ = std::move(now);
    Q_EMIT hintChanged(hint_);
}

// ---- view ------------------------------------------------------------------------------------------------------------

void ViewportWidget::frameAll(bool animated) {
    std::vector<SelectionItem> all;
    for (const auto& [id, element] : document_.document().elements)
        if (element->visible) all.push_back({SelectionItem::Kind::Element, id, {}, false});
    for (const auto& [id, bone] : document_.document().bones) all.push_back({SelectionItem::Kind::Bone, id, {}, false});
    camera_.frame(pointsOf(document_.session(), all), animated && isVisible());
    animate();
}

void ViewportWidget::frameSelection(bool animated) {
    const auto points = pointsOf(document_.session(), document_.selection());
    if (points.empty()) return frameAll(animated);
    camera_.frame(points, animated && isVisible());
    animate();
}

void ViewportWidget::setNavigationPreset(NavigationPreset preset) {
    navigator_.setPreset(preset);
    updateHint();
}

void ViewportWidget::setViewAxis(ViewAxis axis) {
    camera_.setAxis(axis, isVisible());
    animate();
}

void ViewportWidget::setOrthographic(bool on) {
    if (on == camera_.orthographic()) return;
    camera_.setOrthographic(on);
    redraw();
    Q_EMIT viewChanged();
}

void ViewportWidget::switchOption(bool& option, bool on) {
    if (option == on) return;
    option = on;
    redraw();
    Q_EMIT viewChanged();
}

void ViewportWidget::setBonesVisible(bool on) { switchOption(bones_, on); }
void ViewportWidget::setGridVisible(bool on) { switchOption(grid_, on); }
void ViewportWidget::setXray(bool on) { switchOption(xray_, on); }

void ViewportWidget::setBodiesVisible(bool on) { switchOption(bodies_, on); }

void ViewportWidget::setBare(bool on) {
    bare_ = on;
    redraw();
}

void ViewportWidget::stripScene() {
    scene_.grid = false;
    scene_.markers.clear();
    for (render::Body& body : scene_.bodies) {
        body.selected = body.hovered = body.outdated = false;
        body.highlightedTriangles = nullptr;
        body.opacity = 1.0f;
    }
}

void ViewportWidget::setMarked(std::optional<MarkedPlace> place) {
    marked_ = std::move(place);
    redraw();
}

void ViewportWidget::frameMarked() {
    if (!marked_) return;
    std::vector<Vec3> points;
    const auto character = document_.document().characters.find(marked_->character);
    if (character == document_.document().characters.end()) return;
    const TriangleMesh& mesh = character->second->model->mesh.body;
    const double around = kMarkedShare * diagonalOf(mesh.vertices);
    const auto add = [&](const Vec3& p) {
        for (int k = 0; k < 8; ++k) points.push_back(p + around * Vec3(k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0));
    };
    if (marked_->point) add(*marked_->point);
    for (const std::int32_t t : marked_->triangles)
        if (t >= 0 && t < mesh.triangles.rows()) add(mesh.vertices.row(mesh.triangles(t, 0)));
    if (points.empty()) return;
    camera_.frame(points, isVisible());
    animate();
}

void ViewportWidget::setHighlightedTriangles(PartId element, std::vector<std::int32_t> triangles) {
    highlightedElement_ = element;
    highlighted_ = std::move(triangles);
    redraw();
}

void ViewportWidget::setDeformOn(DeformOn where) {
    deformOn_ = where;
    redraw();
}

void ViewportWidget::setPictureQuality(PictureQuality quality) {
    quality_ = quality;
    redraw();
}

std::optional<QPointF> ViewportWidget::onScreen(const Vec3& p) const {
    CameraController camera = camera_;
    camera.setViewport(width(), height());
    const auto at = camera.onScreen(p);
    if (!at) return std::nullopt;
    return QPointF(at->x(), at->y());
}

std::optional<QPointF> ViewportWidget::onScreen(const EndpointRef& end) const {
    const auto at = endpointPosition(document_.session(), end);
    return at ? onScreen(*at) : std::nullopt;
}

// ---- document ----------------------------------------------------------------------------------------------------------

void ViewportWidget::structureChanged() {
    const bool empty = document_.document().elements.empty();
    if (empty_ && !empty) frameAll(false);
    empty_ = empty;
    preparePicking(document_.document());
    if (!document_.document().elements.contains(highlightedElement_)) setHighlightedTriangles(0, {});
    if (marked_ && !document_.document().characters.contains(marked_->character)) setMarked(std::nullopt);
    animate();
    updateHint();
    tools_.leaveIfOver();
}

void ViewportWidget::follow(TakeDeck& deck) {
    deck_ = &deck;
    clock_.follow(deck);
    connect(deck_, &TakeDeck::changed, this, &ViewportWidget::animate);
}

void ViewportWidget::animate() {
    redraw();
    if (isVisible()) clock_.start();
}

// ---- drawing -----------------------------------------------------------------------------------------------------------

void ViewportWidget::redraw() {
    if (canvas_) canvas_->update();
}

QImage ViewportWidget::grabFramebuffer() {
    smooth_ = true;
    return canvas_ ? canvas_->grabFramebuffer() : QImage();
}

render::Scene ViewportWidget::pictureScene(const Picture& picture) {
    SceneOptions options = sceneOptions();
    options.bones = options.bones && picture.markers;
    options.faces = options.faces && picture.markers;
    options.marked = nullptr;
    options.selected.clear();
    options.hovered = 0;
    render::Scene scene;
    documentScene_.update(document_.session(), options, scene);
    if (!picture.markers) scene.markers.clear();
    scene.camera = camera_.camera();
    scene.grid = grid_ && picture.ground;
    scene.groundShadow = picture.ground;
    scene.darkTheme = dark();
    scene.transparentBackground = picture.transparent;
    scene.pixelRatio = float(Appearance::instance().scale() * picture.size.height() / std::max(height(), 1));
    return scene;
}

void ViewportWidget::resizeEvent(QResizeEvent* e) {
    QWidget::resizeEvent(e);
    camera_.setViewport(width(), height());
    if (canvas_) canvas_->setGeometry(rect());
    if (message_) message_->setGeometry(rect());
}

bool ViewportWidget::dark() const { return palette().color(QPalette::Window).lightnessF() < 0.5f; }

SceneOptions ViewportWidget::sceneOptions() const {
    const Document& d = document_.document();
    SceneOptions options;
    options.bones = bones_ || tools_.kind() == ToolKind::Bone || tools_.kind() == ToolKind::Handle || tools_.kind() == ToolKind::Pose;
    options.faces = tools_.kind() == ToolKind::Face || tools_.kind() == ToolKind::Bone;
    options.bodies = bodies_;
    options.bodyOpacity = xray_ ? kXrayOpacity : 1.0f;
    options.marked = marked_ ? &*marked_ : nullptr;
    for (const SelectionItem& item : document_.selection())
        if (const std::uint64_t id = sceneIdOf(d, item)) options.selected.push_back(id);
    if (document_.hovered()) options.hovered = sceneIdOf(d, *document_.hovered());
    return options;
}

ShapeFade ViewportWidget::shapeKept() {
    render::Scene seen;
    documentScene_.update(document_.session(), sceneOptions(), seen);
    fade_.apply(seen, 0.0, [this](std::uint64_t body) { return waits(body); });  // it may be fading already
    ShapeFade kept = fade_;
    kept.keep(seen);
    return kept;
}

bool ViewportWidget::waits(std::uint64_t body) const {
    const auto part = scenePart(body);
    return awaits_ && part && (part->kind == ScenePart::Kind::Element || part->kind == ScenePart::Kind::Body) && awaits_(part->part);
}

std::map<PartId, std::shared_ptr<const ElementResponse>> ViewportWidget::fitting() const {
    std::map<PartId, std::shared_ptr<const ElementResponse>> responses;
    for (const auto& [id, element] : document_.document().elements) responses.emplace(id, document_.session().responses().fittingOf(id));
    return responses;
}

void ViewportWidget::beforeChange() {
    before_.reset();
    if (canvas_ && isVisible() && !document_.document().elements.empty()) before_ = Before{shapeKept(), fitting()};
}

// What is solved in another way now would jump.
void ViewportWidget::afterChange() {
    if (!before_) return;
    Before before = *std::exchange(before_, std::nullopt);
    const auto now = fitting();
    const auto same = [&](std::uint64_t body) {
        const auto part = scenePart(body);
        if (!part) return true;
        const auto was = before.fitting.find(part->part);
        const auto is = now.find(part->part);
        return was == before.fitting.end() || is == now.end() || was->second == is->second;
    };
    if (std::all_of(now.begin(), now.end(), [&](const auto& e) { return before.fitting.contains(e.first) && before.fitting.at(e.first) == e.second; })) return;
    before.shape.retain([&](std::uint64_t body) { return fade_.has(body) || !same(body); });
    fade_ = std::move(before.shape);
    redraw();
}

void ViewportWidget::paint() {
    QElapsedTimer drawing;
    drawing.start();
    render::SceneRenderer& renderer = *canvas_->renderer();
    camera_.setViewport(width(), height());
    SceneOptions options = sceneOptions();
    if (bare_) options.bodies = false;
    if (!fade_.active() && (deformOn_ == DeformOn::Gpu || (deformOn_ == DeformOn::Automatic && !renderer.software()))) options.gpu = &renderer;
    documentScene_.update(document_.session(), options, scene_);
    const double since = fading_.isValid() ? 1e-3 * double(fading_.restart()) : (fading_.start(), 0.0);
    if (fade_.active()) fade_.apply(scene_, since, [this](std::uint64_t body) { return waits(body); });
    if (!fade_.active()) fading_.invalidate();
    scene_.camera = camera_.camera();
    scene_.grid = grid_;
    scene_.darkTheme = dark();
    scene_.pixelRatio = float(devicePixelRatioF() * Appearance::instance().scale());
    // Frames follow each other while something moves, by itself or by hand.
    const bool moving = clock_.running() || document_.session().moving() || tools_.tool().busy() || navigator_.active() || fade_.active();
    scene_.smooth = quality_ == PictureQuality::Fine || (!moving && (smooth_ || (quality_ == PictureQuality::Automatic && !renderer.software())));
    scene_.halved = !scene_.smooth && (quality_ == PictureQuality::Fast || (moving && renderer.software()));
    smooth_ = false;
    if (const auto element = document_.document().elements.find(highlightedElement_); !highlighted_.empty() && element != document_.document().elements.end())
        if (render::Body* body = bodyOf(scene_, *element->second)) body->highlightedTriangles = &highlighted_;
    tools_.tool().decorate(scene_);
    if (bare_) stripScene();
    try {
        renderer.draw(scene_, canvas_->defaultFramebufferObject(), int(std::lround(width() * devicePixelRatioF())),
                      int(std::lround(height() * devicePixelRatioF())));
    } catch (const std::exception&) {
        renderer.releaseMemory();  // the next picture is drawn from nothing
        throw;
    }
    if (!bare_) paintOver();
    latency_.painted();

    if (fade_.active()) redraw();
    if (!scene_.smooth && renderer.software() && quality_ == PictureQuality::Automatic) still_.start();
    if (const auto frame = meter_.drawn(elapsedMs(drawing), moving)) {
        int vertices = 0;
        for (const render::Body& body : scene_.bodies) vertices += int(body.mesh ? body.mesh->body.vertices.rows() : 0);
        Q_EMIT frameMeasured(frame->cpuMs, frame->fps, vertices, renderer.uploadMs());
    }
}

void ViewportWidget::paintOver() {
    QPainter painter(canvas_);
    navigator_.paintBall(painter, dark());
    auto box = tools_.tool().box();
    QPolygonF lasso = tools_.tool().lasso();
    const double scale = Appearance::instance().scale();
    if (box) box = QRectF(box->topLeft() * scale, box->size() * scale);
    for (QPointF& p : lasso) p *= scale;
    ViewOverlay{size(), dark(), palette().color(QPalette::Highlight), box, tools_.tool().banner(), deck_, overlapped(), at_, std::move(lasso)}.paint(painter, document_);
    for (const LimitWord& word : limitWords(document_.session()))
        if (const auto at = onScreen(word.at)) ViewOverlay{size(), dark(), palette().color(QPalette::Highlight), {}, {}, nullptr, word.text, *at}.paint(painter, document_);
}

void ViewportWidget::showMessage(const QString& text) {
    if (!message_) {
        message_ = new QLabel(this);
        message_->setObjectName(QStringLiteral("viewportMessage"));
        message_->setAlignment(Qt::AlignCenter);
        message_->setWordWrap(true);
        message_->setMargin(24);
        message_->setAutoFillBackground(true);
    }
    message_->setText(text);
    message_->setGeometry(rect());
    message_->show();
    message_->raise();
}

}  // namespace imomushi
