// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QImage>
#include <QPointF>
#include <QTimer>
#include <QWidget>
#include <memory>
#include <optional>

#include "ui/models/take_deck.h"
#include "ui/scene/document_scene.h"
#include "ui/scene/shape_fade.h"
#include "ui/viewport/camera_controller.h"
#include "ui/viewport/frame_clock.h"
#include "ui/viewport/frame_meter.h"
#include "ui/viewport/gl_canvas.h"
#include "ui/viewport/latency_meter.h"
#include "ui/viewport/tool_host.h"
#include "ui/viewport/view_navigator.h"
#include "ui/viewport/view_touch.h"

class QLabel;

namespace imomushi {

/// Makes what a view asks of a document when it first shows it: textures, and what is found under the pointer. Any thread.
void prepareView(const Document& document);

/// The view of the character: draws it, hands the pointer to the tool, and moves the camera. It draws when something changed, and
/// at 60 Hz only while something moves. Where there is no OpenGL 3.3 it says so and the rest of the studio goes on.
class ViewportWidget : public QWidget {
    Q_OBJECT
public:
    explicit ViewportWidget(StudioDocument& document, QWidget* parent = nullptr);
    ~ViewportWidget() override;

    /// Steps the frames of what this plays and records, and says in the view that it does. Must outlive the view.
    void follow(TakeDeck& deck);
    [[nodiscard]] ToolHost& tools() { return tools_; }
    /// Says of an element whether a response that fits it is on its way: until then what was seen of it stays.
    void setAwaits(std::function<bool(PartId)> awaits) { awaits_ = std::move(awaits); }
    /// What the mouse does now, translated.
    [[nodiscard]] QString hint() const;

    void frameAll(bool animate = true);
    /// Frames what is selected; everything where nothing is.
    void frameSelection(bool animate = true);
    /// What a picture of the view shows, from where it is seen now.
    struct Picture {
        QSize size;                ///< pixels
        bool transparent = false;  ///< where there is nothing: as PNG's alpha says
        bool markers = false;      ///< bones, handles and joint faces, as far as they are shown
        bool ground = true;
    };
    /// What a picture shows; nothing is selected in it. What it points to is valid until the session or the view changes; PictureJob draws it.
    [[nodiscard]] render::Scene pictureScene(const Picture& picture);
    void setNavigationPreset(NavigationPreset preset);
    [[nodiscard]] NavigationPreset navigationPreset() const { return navigator_.preset(); }
    /// What deforms vertices: the GPU what it can and the processor the rest, or the processor all. Automatic: the GPU, unless OpenGL is software.
    enum class DeformOn { Automatic, Processor, Gpu };
    void setDeformOn(DeformOn where);
    /// Automatic: antialiased at full resolution; with software OpenGL only while nothing moves, and half resolution without antialiasing while something moves. Fast: always half resolution. Fine: always full resolution, antialiased.
    enum class PictureQuality { Automatic, Fast, Fine };
    void setPictureQuality(PictureQuality quality);
    void setViewAxis(ViewAxis axis);
    void setOrthographic(bool on);
    [[nodiscard]] bool orthographic() const { return camera_.orthographic(); }
    void setBonesVisible(bool on);
    [[nodiscard]] bool bonesVisible() const { return bones_; }
    void setGridVisible(bool on);
    [[nodiscard]] bool gridVisible() const { return grid_; }
    void setXray(bool on);
    [[nodiscard]] bool xray() const { return xray_; }
    /// The character alone is drawn: no marks of tools, no ground lines, no words.
    void setBare(bool on);
    void setBodiesVisible(bool on);
    [[nodiscard]] bool bodiesVisible() const { return bodies_; }
    /// Triangles of an element to highlight (the places of a mesh issue); empty: none.
    void setHighlightedTriangles(PartId element, std::vector<std::int32_t> triangles);
    /// A place of a character to point out; none: nothing.
    void setMarked(std::optional<MarkedPlace> place);
    void frameMarked();

    /// Where a point of the world (m) is in this widget, logical pixels; none: behind the eye.
    [[nodiscard]] std::optional<QPointF> onScreen(const Vec3& p) const;
    /// Where an end of a bone is in this widget.
    [[nodiscard]] std::optional<QPointF> onScreen(const EndpointRef& end) const;
    [[nodiscard]] CameraController& cameraController() { return camera_; }
    /// What is shown now; null where there is no OpenGL.
    [[nodiscard]] QImage grabFramebuffer();
    /// True while a body blends from its previous shape into the new one, or keeps the previous shape because its response is being computed.
    [[nodiscard]] bool fading() const { return fade_.active(); }

    /// What is shown is out of date; the next picture follows.
    void redraw();
    [[nodiscard]] LatencyMeter& latency() { return latency_; }

    [[nodiscard]] QSize sizeHint() const override { return {960, 640}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {160, 120}; }

Q_SIGNALS:
    void hintChanged(const QString& hint);
    /// cpuMs: solving, updating and drawing of one frame (about ten times a second while frames are drawn); fps: 0 while nothing moves.
    void frameMeasured(double cpuMs, double fps, int vertices, double uploadMs);
    /// About twice a second while frames follow inputs.
    void latencyMeasured(const LatencyMeter::Latency& latency);
    /// Projection, bones, grid, bodies or x-ray were switched, by whom ever.
    void viewChanged();

protected:
    bool event(QEvent* e) override;
    void tabletEvent(QTabletEvent* e) override;
    void mousePressEvent(QMouseEvent* e) override;
    void mouseMoveEvent(QMouseEvent* e) override;
    void mouseReleaseEvent(QMouseEvent* e) override;
    void mouseDoubleClickEvent(QMouseEvent* e) override;
    void wheelEvent(QWheelEvent* e) override;
    void keyPressEvent(QKeyEvent* e) override;
    void keyReleaseEvent(QKeyEvent* e) override;
    void contextMenuEvent(QContextMenuEvent* e) override;
    void focusOutEvent(QFocusEvent* e) override;
    void enterEvent(QEnterEvent* e) override;
    void leaveEvent(QEvent* e) override;
    void resizeEvent(QResizeEvent* e) override;
    void hideEvent(QHideEvent* e) override;
    void showEvent(QShowEvent* e) override;

private:
    // viewport_widget.cpp
    void paint();
    [[nodiscard]] ShapeFade shapeKept();  ///< from which what is seen fades into what comes
    [[nodiscard]] bool waits(std::uint64_t body) const;
    [[nodiscard]] std::map<PartId, std::shared_ptr<const ElementResponse>> fitting() const;
    void beforeChange();
    void afterChange();
    void animate();  ///< draws, and starts the clock where something moves
    [[nodiscard]] SceneOptions sceneOptions() const;
    void paintOver();   ///< what lies over the picture
    void stripScene();  ///< to what setBare() leaves
    [[nodiscard]] bool dark() const;
    void structureChanged();
    void updateHint();
    [[nodiscard]] QString overlapped() const;  ///< the end of a bone that would be taken, where others are too; empty: there is one at most
    void showMessage(const QString& text);
    void switchOption(bool& option, bool on);
    // viewport_input.cpp
    [[nodiscard]] PointerEvent pointer(QPointF position, Qt::MouseButton button, Qt::MouseButtons buttons, Qt::KeyboardModifiers modifiers) const;
    template <class Act>
    void withTool(const Act& act) {
        QElapsedTimer since;
        since.start();
        act(tools_.tool());
        meter_.addWork(elapsedMs(since));
        redraw();
        updateHint();
    }
    /// The tool hears of the pointer once a frame at most, however fast the mouse tells: of where it is now. What comes after a move is heard after it.
    void keepMove(const PointerEvent& e);
    void giveMove();
    void moveCame();  ///< giveMove() now or as soon as it may be
    [[nodiscard]] bool belongsToTool(const QKeyEvent& key) const;
    [[nodiscard]] bool navigationKey(QKeyEvent* e);
    /// Takes the end of a bone that is behind the one under the pointer, from now on until the pointer goes elsewhere.
    void takeBehind();
    [[nodiscard]] bool near(QPointF a, QPointF b) const;  ///< no further than a click moves
    // viewport_touch.cpp
    bool touch(QTouchEvent& e);
    void landFinger(int id, QPointF at);
    void liftFinger(ViewTouch::Finger finger);
    void leadCamera();
    void giveFingers();
    void cancelTouch();
    [[nodiscard]] PointerEvent pointer(const ViewTouch::Finger& finger, Qt::MouseButton button) const;
    /// The finger does what the mouse would; see ViewTouch::Role::Pointer.
    void pressAsMouse();
    void sendAsMouse(QEvent::Type type, QPointF at);

    StudioDocument& document_;
    TakeDeck* deck_ = nullptr;
    ToolHost tools_;
    CameraController camera_;
    ViewNavigator navigator_{camera_};
    FrameMeter meter_;
    LatencyMeter latency_;
    FrameClock clock_;
    DeformOn deformOn_ = DeformOn::Automatic;
    PictureQuality quality_ = PictureQuality::Automatic;
    bool swallowMenu_ = false;
    QPointF at_, pressedAt_;            ///< the pointer, and where its button was pressed last, logical pixels
    int overlapping_ = 0;               ///< ends of bones under the pointer
    struct Behind {
        QPointF at;                     ///< logical pixels
        int count = 0;                  ///< see PointerEvent::behind
    };
    std::optional<Behind> behind_;
    bool again_ = false;                ///< what the button was pressed on was selected already
    std::optional<PointerEvent> move_;  ///< that the tool has not heard of yet
    InputTime movedAt_ = 0;             ///< when it came, or the first of those that it replaced
    QElapsedTimer sinceMove_;           ///< since it heard of one
    QTimer nextMove_;
    std::optional<double> pressure_;    ///< of the pen that is down
    ViewTouch touch_;

    bool bones_ = true, grid_ = true, bodies_ = false, xray_ = false, bare_ = false;
    bool empty_ = true;           ///< there were no elements: the first that comes is framed
    PartId highlightedElement_ = 0;
    std::vector<std::int32_t> highlighted_;
    std::optional<MarkedPlace> marked_;
    QTimer still_;
    bool smooth_ = false;  ///< the next picture is one that stands still
    ShapeFade fade_;
    QElapsedTimer fading_;  ///< since the last frame of it
    /// As it was before the change that goes on.
    struct Before {
        ShapeFade shape;
        std::map<PartId, std::shared_ptr<const ElementResponse>> fitting;
    };
    std::optional<Before> before_;
    std::function<bool(PartId)> awaits_;

    GlCanvas* canvas_ = nullptr;  ///< null: there is no OpenGL 3.3
    DocumentScene documentScene_;
    render::Scene scene_;
    QLabel* message_ = nullptr;
    QString hint_;
};

}  // namespace imomushi
