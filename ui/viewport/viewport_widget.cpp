// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/viewport_widget.h"

#include <QContextMenuEvent>
#include <QCoreApplication>
#include <QEvent>
#include <QKeyEvent>
#include <QLabel>
#include <QLocale>
#include <QMenu>
#include <QMouseEvent>
#include <QNativeGestureEvent>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLWidget>
#include <QPainter>
#include <QPointingDevice>
#include <QSurfaceFormat>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/tools/picking.h"
#include "ui/tools/select_tool.h"
#include "ui/viewport/axis_ball.h"

namespace imomushi {
namespace {

constexpr int kFrameMs = 16;
/// A frame that took longer than this (a stall, a sleep) moves the scene by no more than this: the most that bone dynamics take in one step.
constexpr double kLongestStep = 0.25;
/// The camera keeps to the clock also where drawing is slow, but a view never changes in less than two pictures.
constexpr double kLongestTurn = 0.12;
/// A pose whose points move less than this part of the scene in a frame has come to rest.
constexpr double kAtRest = 1e-6;
constexpr int kTellMs = 100;
/// A tool that says more than this leaves no room for how the view is moved.
constexpr int kLongHint = 72;
/// Pictures farther apart (in seconds) are not counted as frames of one movement.
constexpr double kLongestFrame = 1.0;
constexpr float kXrayOpacity = 0.45f, kBoxOpacity = 0.12f;
/// Zooming by dragging: this many pixels are a notch of the wheel.
constexpr double kPixelsPerNotch = 12.0;
/// Keypad 4, 6, 8, 2 turn the view by 15 degrees.
constexpr double kKeyTurn = std::numbers::pi / 12.0;

std::uint64_t idOf(const Document& document, const SelectionItem& item) {
    ScenePart part;
    part.part = item.part;
    part.atEnd = item.atEnd;
    switch (item.kind) {
        case SelectionItem::Kind::Element: part.kind = ScenePart::Kind::Element; break;
        case SelectionItem::Kind::Bone: part.kind = ScenePart::Kind::Bone; break;
        case SelectionItem::Kind::Endpoint: part.kind = ScenePart::Kind::Endpoint; break;
        case SelectionItem::Kind::Face: {
            part.kind = ScenePart::Kind::Face;
            const auto element = document.elements.find(item.part);
            part.face = element == document.elements.end() ? -1 : element->second->faceIndex(item.face);
            if (part.face < 0) return 0;
            break;
        }
    }
    return sceneId(part);
}

QSurfaceFormat wantedFormat() {
    QSurfaceFormat format;
    format.setVersion(3, 3);
    format.setProfile(QSurfaceFormat::CoreProfile);
    format.setDepthBufferSize(24);
    format.setSamples(0);  // the renderer smooths edges itself
    return format;
}

/// Asked before a QOpenGLWidget is made: in a window that cannot have one, Qt 6.4 crashes at the first repaint.
bool hasOpenGl() {
    QOpenGLContext context;
    context.setFormat(wantedFormat());
    if (!context.create()) return false;
    QOffscreenSurface surface;
    surface.setFormat(context.format());
    surface.create();
    if (!context.makeCurrent(&surface)) return false;
    context.doneCurrent();
    return context.format().version() >= qMakePair(3, 3);
}

}  // namespace

/// What is drawn with OpenGL. Pointer and keys go through to the viewport around it.
class ViewportWidget::Canvas : public QOpenGLWidget {
public:
    explicit Canvas(ViewportWidget& owner) : QOpenGLWidget(&owner), owner_(owner) {
        setFormat(wantedFormat());
        setAttribute(Qt::WA_TransparentForMouseEvents);
        setFocusPolicy(Qt::NoFocus);
    }

protected:
    void initializeGL() override { owner_.initializeGraphics(); }
    void paintGL() override { owner_.paint(); }

private:
    ViewportWidget& owner_;
};

ViewportWidget::ViewportWidget(StudioDocument& document, QWidget* parent)
    : QWidget(parent), document_(document), tool_(makeTool(ToolKind::Select, document)) {
    setMouseTracking(true);
    setFocusPolicy(Qt::StrongFocus);
    setAccessibleName(tr("3D view"));
    setObjectName(QStringLiteral("viewport"));

    timer_.setTimerType(Qt::PreciseTimer);
    timer_.setInterval(kFrameMs);
    connect(&timer_, &QTimer::timeout, this, &ViewportWidget::tick);
    connect(&document_, &StudioDocument::structureChanged, this, &ViewportWidget::structureChanged);
    connect(&document_, &StudioDocument::poseChanged, this, &ViewportWidget::poseChanged);
    const auto changed = [this] {
        redraw();
        updateHint();
    };
    connect(&document_, &StudioDocument::responsesChanged, this, [this] {
        animate();
        updateHint();
    });
    connect(&document_, &StudioDocument::selectionChanged, this, changed);
    connect(&document_, &StudioDocument::hoverChanged, this, &ViewportWidget::redraw);
    empty_ = document_.document().elements.empty();
    hint_ = hint();
    if (hasOpenGl()) {
        canvas_ = new Canvas(*this);
    } else {
        showMessage(tr("The 3D view needs OpenGL 3.3. Update the graphics driver, or start with LIBGL_ALWAYS_SOFTWARE=1."));
    }
}

ViewportWidget::~ViewportWidget() {
    tool_.reset();
    releaseGraphics();
    delete canvas_;  // while this is still whole: its context calls back as it goes
}

// ---- tools -----------------------------------------------------------------------------------------------------------

void ViewportWidget::setTool(ToolKind kind) {
    if (kind == kind_) return;
    tool_->cancel();
    tool_ = makeTool(kind, document_);
    kind_ = kind;
    document_.setHovered(std::nullopt);
    redraw();
    updateHint();
    Q_EMIT toolChanged(kind);
    tool_->begin();
}

bool ViewportWidget::busy() const { return tool_->busy(); }

void ViewportWidget::cancel() {
    tool_->cancel();
    redraw();
    updateHint();
}

QString ViewportWidget::hint() const {
    const QString tool = tool_->hint();
    if (tool_->pending() || tool.size() > kLongHint) return tool;
    const QString view = preset_ == NavigationPreset::Blender
                             ? tr("Middle: orbit · Shift+middle: pan · Wheel: zoom")
                             : tr("Alt+left: orbit · Alt+middle: pan · Wheel: zoom");
    return tool.isEmpty() ? view : tool + QStringLiteral("   |   ") + view;
}

void ViewportWidget::updateHint() {
    QString now = hint();
    if (now == hint_) return;
    hint_ = std::move(now);
    Q_EMIT hintChanged(hint_);
}

void ViewportWidget::toolActed(const QElapsedTimer& since) {
    workMs_ += double(since.nsecsElapsed()) * 1e-6;
    redraw();
    updateHint();
}

// ---- camera ----------------------------------------------------------------------------------------------------------

std::vector<Vec3> ViewportWidget::pointsOf(const std::vector<SelectionItem>& items) const {
    std::vector<Vec3> points;
    Session& session = document_.session();
    const Document& d = document_.document();
    Character* character = session.character();
    const auto addBody = [&](PartId id, const std::vector<std::int32_t>* only) {
        const TriangleMesh& rest = d.elements.at(id)->mesh->body;
        const int index = session.elementIndex(id);
        const float* posed = character && index >= 0 ? character->surface(index).positions : nullptr;
        const auto add = [&](std::int32_t v) {
            points.push_back(posed ? Vec3(posed[3 * v], posed[3 * v + 1], posed[3 * v + 2]) : Vec3(rest.vertices.row(v)));
        };
        if (only)
            for (const std::int32_t v : *only) add(v);
        else
            for (std::int32_t v = 0; v < rest.vertices.rows(); ++v) add(v);
    };
    const auto addEnd = [&](const EndpointRef& end) {
        if (const auto at = endpointPosition(session, end)) points.push_back(*at);
    };
    for (const SelectionItem& item : items) switch (item.kind) {
            case SelectionItem::Kind::Element:
                if (d.elements.contains(item.part)) addBody(item.part, nullptr);
                break;
            case SelectionItem::Kind::Face:
                if (const auto element = d.elements.find(item.part); element != d.elements.end())
                    if (const int face = element->second->faceIndex(item.face); face >= 0)
                        addBody(item.part, &element->second->faces[std::size_t(face)].vertices);
                break;
            case SelectionItem::Kind::Bone:
                addEnd({item.part, false});
                addEnd({item.part, true});
                break;
            case SelectionItem::Kind::Endpoint: addEnd({item.part, item.atEnd}); break;
        }
    return points;
}

void ViewportWidget::frameAll(bool animated) {
    std::vector<SelectionItem> all;
    for (const auto& [id, element] : document_.document().elements)
        if (element->visible) all.push_back({SelectionItem::Kind::Element, id, {}, false});
    for (const auto& [id, bone] : document_.document().bones) all.push_back({SelectionItem::Kind::Bone, id, {}, false});
    camera_.frame(pointsOf(all), animated && isVisible());
    animate();
}

void ViewportWidget::frameSelection(bool animated) {
    const auto points = pointsOf(document_.selection());
    if (points.empty()) return frameAll(animated);
    camera_.frame(points, animated && isVisible());
    animate();
}

void ViewportWidget::setNavigationPreset(NavigationPreset preset) {
    preset_ = preset;
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

void ViewportWidget::setBonesVisible(bool on) {
    if (on == bones_) return;
    bones_ = on;
    redraw();
    Q_EMIT viewChanged();
}

void ViewportWidget::setGridVisible(bool on) {
    if (on == grid_) return;
    grid_ = on;
    redraw();
    Q_EMIT viewChanged();
}

void ViewportWidget::setXray(bool on) {
    if (on == xray_) return;
    xray_ = on;
    redraw();
    Q_EMIT viewChanged();
}

void ViewportWidget::setMarkedTriangles(PartId element, std::vector<std::int32_t> triangles) {
    markedElement_ = element;
    marked_ = std::move(triangles);
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
    if (!document_.document().elements.contains(markedElement_)) setMarkedTriangles(0, {});
    poseChanged();
    updateHint();
}

void ViewportWidget::poseChanged() {
    if (stepping_) return redraw();
    relaxing_ = !document_.document().held.empty();
    animate();
}

// A frame that is stepped leaves the take that is shown, and is what a recording is made of.
bool ViewportWidget::posing() const {
    const Session& session = document_.session();
    return session.recording() || (!session.showsTake() && (relaxing_ || document_.session().moving()));
}

void ViewportWidget::follow(TakeDeck& deck) {
    deck_ = &deck;
    connect(deck_, &TakeDeck::changed, this, &ViewportWidget::animate);
}

void ViewportWidget::animate() {
    redraw();
    if (timer_.isActive() || !isVisible() || (!camera_.moving() && !posing() && !(deck_ && deck_->playing()))) return;
    clock_.start();
    timer_.start();
}

void ViewportWidget::tick() {
    const double passed = double(clock_.nsecsElapsed()) * 1e-9, seconds = std::min(kLongestStep, passed);
    clock_.start();
    camera_.advance(std::min(kLongestTurn, passed));
    const bool playing = deck_ && deck_->playing();
    if (playing) {
        QElapsedTimer work;
        work.start();
        deck_->advance(passed);
        workMs_ += double(work.nsecsElapsed()) * 1e-6;
    } else if (posing()) {
        QElapsedTimer work;
        work.start();
        before_ = document_.document().pose.points;
        stepping_ = true;
        document_.stepFrame(seconds);
        stepping_ = false;
        const auto& now = document_.document().pose.points;
        double moved = before_.size() == now.size() ? 0.0 : 1.0, size = 0.0;
        for (std::size_t i = 0; i < now.size() && i < before_.size(); ++i) {
            moved = std::max(moved, (now[i] - before_[i]).norm());
            size = std::max(size, (now[i] - now[0]).norm());
        }
        relaxing_ = relaxing_ && !(moved <= kAtRest * size);
        workMs_ += double(work.nsecsElapsed()) * 1e-6;
    }
    redraw();
    if (!camera_.moving() && !posing() && !(deck_ && deck_->playing())) timer_.stop();
}

// ---- drawing -----------------------------------------------------------------------------------------------------------

void ViewportWidget::initializeGraphics() {
    // A widget that moves to another window gets another context, and everything in the old one goes with it.
    connect(canvas_->context(), &QOpenGLContext::aboutToBeDestroyed, this, &ViewportWidget::releaseGraphics, Qt::UniqueConnection);
    auto renderer = render::SceneRenderer::create();
    if (!renderer) {
        showMessage(tr("The 3D view needs OpenGL 3.3. Update the graphics driver, or start with LIBGL_ALWAYS_SOFTWARE=1.") +
                    QStringLiteral("\n\n") + QString::fromStdString(renderer.error().message));
        return;
    }
    renderer_ = std::move(*renderer);
    if (message_) message_->hide();
}

void ViewportWidget::releaseGraphics() {
    if (!renderer_) return;
    canvas_->makeCurrent();
    renderer_.reset();
    canvas_->doneCurrent();
}

void ViewportWidget::redraw() {
    if (canvas_) canvas_->update();
}

void ViewportWidget::setDeformOn(DeformOn where) {
    deformOn_ = where;
    redraw();
}

QImage ViewportWidget::grabFramebuffer() { return canvas_ ? canvas_->grabFramebuffer() : QImage(); }

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
    options.bones = bones_ || kind_ == ToolKind::Bone || kind_ == ToolKind::Pose;
    options.faces = kind_ == ToolKind::Face || kind_ == ToolKind::Bone;
    options.bodyOpacity = xray_ ? kXrayOpacity : 1.0f;
    for (const SelectionItem& item : document_.selection())
        if (const std::uint64_t id = idOf(d, item)) options.selected.push_back(id);
    if (document_.hovered()) options.hovered = idOf(d, *document_.hovered());
    return options;
}

void ViewportWidget::paint() {
    if (!renderer_) return;
    QElapsedTimer drawing;
    drawing.start();
    camera_.setViewport(width(), height());
    SceneOptions options = sceneOptions();
    if (deformOn_ == DeformOn::Card || (deformOn_ == DeformOn::Automatic && !renderer_->software())) options.card = renderer_.get();
    documentScene_.update(document_.session(), options, scene_);
    scene_.camera = camera_.camera();
    scene_.grid = grid_;
    scene_.darkTheme = dark();
    scene_.pixelRatio = float(devicePixelRatioF());
    if (!marked_.empty())
        if (render::Body* body = bodyOf(scene_, markedElement_)) body->markedTriangles = &marked_;
    tool_->decorate(scene_);
    renderer_->draw(scene_, canvas_->defaultFramebufferObject(), int(std::lround(width() * devicePixelRatioF())),
                    int(std::lround(height() * devicePixelRatioF())));
    paintOver();

    const double cpuMs = workMs_ + double(drawing.nsecsElapsed()) * 1e-6;
    workMs_ = 0.0;
    // Frames follow each other while something moves, by itself or by hand.
    const bool running = timer_.isActive() || tool_->busy() || navigation_ != Navigation::None || ballPressed_;
    const double seconds = painted_.isValid() ? double(painted_.nsecsElapsed()) * 1e-9 : kLongestFrame;
    if (!running || seconds >= kLongestFrame)
        frameSeconds_ = 0.0;
    else
        frameSeconds_ = frameSeconds_ > 0.0 ? 0.9 * frameSeconds_ + 0.1 * seconds : seconds;
    painted_.start();
    if (!told_.isValid() || told_.elapsed() >= kTellMs || !running) {
        told_.start();
        int vertices = 0;
        for (const render::Body& body : scene_.bodies) vertices += int(body.mesh ? body.mesh->body.vertices.rows() : 0);
        Q_EMIT frameMeasured(cpuMs, frameSeconds_ > 0.0 ? 1.0 / frameSeconds_ : 0.0, vertices, renderer_->uploadMs());
    }
}

void ViewportWidget::paintOver() {
    QPainter painter(canvas_);
    const QRectF area = AxisBall::area(width());
    if (width() > 2.0 * area.width()) AxisBall::paint(painter, camera_.axes(), area, ballHovered_, overBall_ || ballPressed_, dark());
    if (document_.document().elements.empty()) {
        painter.setPen(dark() ? QColor(255, 255, 255, 150) : QColor(0, 0, 0, 150));
        QFont font = painter.font();
        font.setPointSizeF(font.pointSizeF() * 1.4);
        painter.setFont(font);
        painter.drawText(rect(), Qt::AlignCenter, tr("Drop a mesh or a project here"));
    }
    if (const auto box = tool_->box()) {
        const QColor edge = palette().color(QPalette::Highlight);
        QColor fill = edge;
        fill.setAlphaF(kBoxOpacity);
        painter.setPen(QPen(edge, 1.0));
        painter.setBrush(fill);
        painter.drawRect(*box);
        painter.setBrush(Qt::NoBrush);
    }
    if (deck_) paintTake(painter);
    if (deck_ && deck_->counting()) paintCount(painter);
}

/// Seconds until a recording starts, where nobody overlooks them.
void ViewportWidget::paintCount(QPainter& painter) {
    const double radius = 3.2 * QFontMetricsF(painter.font()).height();
    const QRectF disc(0.5 * width() - radius, 0.5 * height() - radius, 2.0 * radius, 2.0 * radius);
    QColor red(kRecordRed);
    red.setAlphaF(0.85f);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(red);
    painter.drawEllipse(disc);
    QFont font = painter.font();
    font.setPixelSize(int(1.1 * radius));
    font.setWeight(QFont::DemiBold);
    painter.setFont(font);
    painter.setPen(Qt::white);
    painter.drawText(disc, Qt::AlignCenter, QLocale().toString(deck_->counting()));
}

void ViewportWidget::paintTake(QPainter& painter) {
    const auto recording = document_.session().recording();
    const Take* take = deck_->take();
    if (!recording && !(deck_->shown() && take)) return;
    const QString text = recording ? QStringLiteral("%1   %2").arg(QString::fromStdString(recording->take), clockText(recording->seconds))
                                   : tr("%1 – drag the character to leave it", "a take that is shown").arg(QString::fromStdString(take->name));
    const QFontMetricsF metrics(painter.font());
    const double high = metrics.height() * 1.7, dot = metrics.ascent() * 0.6, wide = metrics.horizontalAdvance(text) + (recording ? dot + high * 0.4 : 0.0) + high;
    const QRectF pill((width() - wide) / 2.0, high * 0.6, wide, high);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(recording ? QColor(kRecordRed) : dark() ? QColor(20, 22, 26, 190) : QColor(255, 255, 255, 210));
    painter.drawRoundedRect(pill, high / 2.0, high / 2.0);
    const QColor ink = recording || dark() ? Qt::white : QColor(31, 36, 33);
    QRectF line = pill.adjusted(high / 2.0, 0.0, -high / 2.0, 0.0);
    if (recording) {
        painter.setBrush(ink);
        painter.drawEllipse(QRectF(line.left(), pill.center().y() - dot / 2.0, dot, dot));
        line.setLeft(line.left() + dot + high * 0.4);
    }
    painter.setPen(ink);
    painter.drawText(line, Qt::AlignLeft | Qt::AlignVCenter, text);
    if (!recording) return;
    const double frame = high / 7.0;
    painter.setPen(QPen(QColor(kRecordRed), frame, Qt::SolidLine, Qt::SquareCap, Qt::MiterJoin));
    painter.setBrush(Qt::NoBrush);
    painter.drawRect(QRectF(rect()).adjusted(frame / 2.0, frame / 2.0, -frame / 2.0, -frame / 2.0));
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

// ---- events --------------------------------------------------------------------------------------------------------------

PointerEvent ViewportWidget::pointer(QPointF position, Qt::MouseButton button, Qt::MouseButtons buttons,
                                     Qt::KeyboardModifiers modifiers) const {
    PointerEvent e;
    e.x = position.x();
    e.y = position.y();
    e.button = button;
    e.buttons = buttons;
    e.modifiers = modifiers;
    e.bonesVisible = sceneOptions().bones;
    CameraController camera = camera_;
    camera.setViewport(width(), height());
    camera.aim(e);
    return e;
}

bool ViewportWidget::event(QEvent* e) {
    switch (e->type()) {
        case QEvent::ShortcutOverride: {
            // While something is unfinished, its keys belong to the tool and not to the menu.
            auto* key = static_cast<QKeyEvent*>(e);
            const bool plain = !(key->modifiers() & (Qt::ControlModifier | Qt::AltModifier | Qt::MetaModifier));
            if ((tool_->busy() && (plain || key->matches(QKeySequence::Undo))) || (plain && tool_->wants(key->key())) ||
                (key->key() == Qt::Key_Escape && tool_->pending())) {
                e->accept();
                return true;
            }
            break;
        }
        case QEvent::NativeGesture: {
            const auto* gesture = static_cast<QNativeGestureEvent*>(e);
            if (gesture->gestureType() == Qt::ZoomNativeGesture) {
                camera_.zoom(std::log1p(std::max(-0.9, gesture->value())) / 0.128, gesture->position().x(), gesture->position().y());
                redraw();
                return true;
            }
            break;
        }
        case QEvent::WindowDeactivate:
            if (tool_->busy()) cancel();
            break;
        case QEvent::LanguageChange:
            setAccessibleName(tr("3D view"));
            updateHint();
            redraw();
            break;
        case QEvent::PaletteChange: redraw(); break;
        default: break;
    }
    return QWidget::event(e);
}

void ViewportWidget::mousePressEvent(QMouseEvent* e) {
    const QPointF p = e->position();
    last_ = p;
    if (tool_->busy()) {
        if (e->button() == Qt::RightButton) {
            cancel();
            swallowMenu_ = true;
        }
        return;
    }
    if (navigation_ != Navigation::None || ballPressed_) return;
    if (e->button() == Qt::LeftButton && AxisBall::contains(AxisBall::area(width()), p)) {
        ballPressed_ = true;
        ballMoved_ = false;
        return;
    }
    navigation_ = navigationOf(preset_, e->button(), e->modifiers());
    if (navigation_ != Navigation::None) {
        navigationButton_ = e->button();
        swallowMenu_ = e->button() == Qt::RightButton;
        return;
    }
    if (e->button() == Qt::RightButton && tool_->pending()) {
        cancel();
        swallowMenu_ = true;
        return;
    }
    QElapsedTimer since;
    since.start();
    tool_->press(pointer(p, e->button(), e->buttons(), e->modifiers()));
    toolActed(since);
}

void ViewportWidget::mouseMoveEvent(QMouseEvent* e) {
    const QPointF p = e->position(), d = p - last_;
    last_ = p;
    if (ballPressed_) {
        ballMoved_ = ballMoved_ || d.manhattanLength() > 2.0;
        if (ballMoved_) camera_.orbit(d.x(), d.y());
        return redraw();
    }
    switch (navigation_) {
        case Navigation::Orbit: camera_.orbit(d.x(), d.y()); return redraw();
        case Navigation::Pan: camera_.pan(d.x(), d.y()); return redraw();
        case Navigation::Zoom: camera_.zoom((d.x() - d.y()) / kPixelsPerNotch, width() / 2.0, height() / 2.0); return redraw();
        case Navigation::None: break;
    }
    if (tool_->busy() && !(e->buttons() & Qt::LeftButton)) {
        // The release went elsewhere: what was reached so far stands.
        tool_->release(pointer(p, Qt::LeftButton, e->buttons(), e->modifiers()));
    }
    const QRectF area = AxisBall::area(width());
    const bool over = !tool_->busy() && AxisBall::contains(area, p);
    const auto hovered = over ? AxisBall::hit(camera_.axes(), area, p) : std::nullopt;
    if (over != overBall_ || hovered != ballHovered_) {
        overBall_ = over;
        ballHovered_ = hovered;
        redraw();
    }
    if (over) {
        document_.setHovered(std::nullopt);
        return;
    }
    QElapsedTimer since;
    since.start();
    tool_->move(pointer(p, Qt::NoButton, e->buttons(), e->modifiers()));
    toolActed(since);
}

void ViewportWidget::mouseReleaseEvent(QMouseEvent* e) {
    const QPointF p = e->position();
    if (ballPressed_ && e->button() == Qt::LeftButton) {
        ballPressed_ = false;
        if (!ballMoved_)
            if (const auto axis = AxisBall::hit(camera_.axes(), AxisBall::area(width()), p)) setViewAxis(*axis);
        return redraw();
    }
    if (navigation_ != Navigation::None) {
        if (e->button() == navigationButton_) navigation_ = Navigation::None;
        return;
    }
    QElapsedTimer since;
    since.start();
    tool_->release(pointer(p, e->button(), e->buttons(), e->modifiers()));
    toolActed(since);
}

void ViewportWidget::mouseDoubleClickEvent(QMouseEvent* e) {
    const QPointF p = e->position();
    if (tool_->busy() || e->button() != Qt::LeftButton || AxisBall::contains(AxisBall::area(width()), p) ||
        navigationOf(preset_, e->button(), e->modifiers()) != Navigation::None)
        return mousePressEvent(e);
    QElapsedTimer since;
    since.start();
    tool_->doubleClick(pointer(p, e->button(), e->buttons(), e->modifiers()));
    toolActed(since);
}

void ViewportWidget::wheelEvent(QWheelEvent* e) {
    const QPointF p = e->position();
    const QPoint angle = e->angleDelta(), pixels = e->pixelDelta();
    const double notches = (angle.y() != 0 ? angle.y() : angle.x()) / 120.0;
    const bool trackpad = e->device() && e->device()->type() == QInputDevice::DeviceType::TouchPad;
    e->accept();
    if (notches != 0.0 && tool_->wheel(notches, pointer(p, Qt::NoButton, e->buttons(), e->modifiers()))) {
        redraw();
        updateHint();
        return;
    }
    if (trackpad && !(e->modifiers() & Qt::ControlModifier)) {
        // Two fingers orbit, with Shift they pan; pinching or Ctrl zooms.
        const QPointF d = pixels.isNull() ? QPointF(angle) / 8.0 : QPointF(pixels);
        if (e->modifiers() & Qt::ShiftModifier)
            camera_.pan(d.x(), d.y());
        else
            camera_.orbit(d.x(), d.y());
    } else {
        camera_.zoom(notches, p.x(), p.y());
    }
    redraw();
}

bool ViewportWidget::navigationKey(QKeyEvent* e) {
    const bool opposite = (e->modifiers() & Qt::ControlModifier) != 0;
    const bool keypad = (e->modifiers() & Qt::KeypadModifier) != 0;
    switch (e->key()) {
        case Qt::Key_1: setViewAxis(opposite ? ViewAxis::Back : ViewAxis::Front); return true;
        case Qt::Key_3: setViewAxis(opposite ? ViewAxis::Left : ViewAxis::Right); return true;
        case Qt::Key_7: setViewAxis(opposite ? ViewAxis::Bottom : ViewAxis::Top); return true;
        case Qt::Key_5: setOrthographic(!camera_.orthographic()); return true;
        case Qt::Key_F:
        case Qt::Key_Period: frameSelection(); return true;
        case Qt::Key_Home: frameAll(); return true;
        default: break;
    }
    if (!keypad) return false;
    switch (e->key()) {
        case Qt::Key_4: camera_.turn(-kKeyTurn, 0.0); break;
        case Qt::Key_6: camera_.turn(kKeyTurn, 0.0); break;
        case Qt::Key_8: camera_.turn(0.0, kKeyTurn); break;
        case Qt::Key_2: camera_.turn(0.0, -kKeyTurn); break;
        default: return false;
    }
    redraw();
    return true;
}

void ViewportWidget::keyPressEvent(QKeyEvent* e) {
    QElapsedTimer since;
    since.start();
    if (e->key() == Qt::Key_Escape && tool_->pending()) {
        cancel();
        return;
    }
    if (tool_->busy() && e->matches(QKeySequence::Undo)) {
        cancel();
        return;
    }
    if (!e->isAutoRepeat() || e->key() == Qt::Key_Up || e->key() == Qt::Key_Down || e->key() == Qt::Key_Left || e->key() == Qt::Key_Right) {
        if (tool_->key(e->key(), e->modifiers())) {
            toolActed(since);
            return;
        }
    }
    if (!tool_->busy() && navigationKey(e)) return;
    QWidget::keyPressEvent(e);
}

void ViewportWidget::keyReleaseEvent(QKeyEvent* e) {
    if (!e->isAutoRepeat()) tool_->keyReleased(e->key());
    QWidget::keyReleaseEvent(e);
}

void ViewportWidget::contextMenuEvent(QContextMenuEvent* e) {
    if (swallowMenu_ || tool_->busy()) {
        swallowMenu_ = false;
        return;
    }
    Session& session = document_.session();
    if (e->reason() == QContextMenuEvent::Mouse) {
        const auto item = pickItem(session, pointer(e->pos(), Qt::RightButton, Qt::RightButton, e->modifiers()));
        if (!item)
            document_.select({});
        else if (!document_.isSelected(*item))
            document_.select({*item});
    }
    QMenu menu(this);
    const auto selection = document_.selection();
    for (const SelectionItem& item : selection) {
        if (item.kind != SelectionItem::Kind::Endpoint || selection.size() > 1) continue;
        const EndpointRef end = holdingEndpoint(session, {item.part, item.atEnd});
        const std::string path = pathOf(document_.document(), end);
        const auto held = document_.document().held.find(end);
        const bool isHeld = held != document_.document().held.end(), pinned = isHeld && held->second.pinned;
        menu.addAction(pinned ? tr("Unpin") : tr("Pin"), this,
                       [=, this] { document_.execute(commands::setPinned(path, !pinned)); });
        if (isHeld) menu.addAction(tr("Let go"), this, [=, this] { document_.execute(commands::release(path)); });
    }
    menu.addAction(tr("Frame selection"), this, [this] { frameSelection(); })->setEnabled(!selection.empty());
    menu.addAction(tr("Frame all"), this, [this] { frameAll(); });
    menu.addSeparator();
    menu.addAction(tr("Remove"), this, [this] { removeSelection(document_); })->setEnabled(!selection.empty());
    menu.exec(e->globalPos());
}

void ViewportWidget::focusOutEvent(QFocusEvent* e) {
    if (tool_->busy()) cancel();
    QWidget::focusOutEvent(e);
}

void ViewportWidget::leaveEvent(QEvent* e) {
    if (!tool_->busy()) {
        tool_->leave();
        document_.setHovered(std::nullopt);
        updateHint();
        redraw();
    }
    overBall_ = false;
    ballHovered_.reset();
    QWidget::leaveEvent(e);
}

void ViewportWidget::showEvent(QShowEvent* e) {
    QWidget::showEvent(e);
    animate();  // what was to move while nobody looked
}

void ViewportWidget::hideEvent(QHideEvent* e) {
    if (tool_->busy()) cancel();
    timer_.stop();
    navigation_ = Navigation::None;
    ballPressed_ = false;
    QWidget::hideEvent(e);
}

}  // namespace imomushi
