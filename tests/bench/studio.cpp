// SPDX-License-Identifier: GPL-3.0-or-later
// How long the studio's window is held up by what a person does with a large character: the longest event of the GUI thread for each thing done, without drawing,
// which is the graphics card's (or, here, a software renderer's that stands in for one) and printed beside it.
// Then the latency of each sample, from a move of the mouse and from a packet of the network to the picture that follows it.
//   bench_studio [ELEMENTS] [VERTICES OF EACH] [BONES] [MINUTES OF TAKE]    100, 2,500, 100 and 1 unless given; on a display, as that of xvfb-run
#include <QAbstractEventDispatcher>
#include <QApplication>
#include <QElapsedTimer>
#include <QMouseEvent>
#include <QTemporaryDir>
#include <QTest>
#include <QTimer>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "core/commands/core_commands.h"
#include "core/io/character_file.h"
#include "tests/support/osc_bytes.h"
#include "tests/support/own_home.h"
#include "tests/support/shapes.h"
#include "tests/support/udp_sender.h"
#include "ui/models/input_deck.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/studio.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/number_field.h"
#include "ui/window/file_flow.h"
#include "ui/window/main_window.h"
#include "ui/window/step_flow.h"
#include "ui/window/studio_actions.h"

using namespace imomushi;

namespace {

/// An event of a drag that takes longer is felt: half of a frame at 60 Hz.
constexpr double kMostDragMs = 8.0;
/// What follows a click or a command is felt where it takes longer.
constexpr double kMostMs = 50.0;
constexpr int kFollowMs = 4000;
constexpr int kViewMs = 1500;  // until the view has turned, where the processor draws it

/// Measures each event that the GUI thread works on, those within it included, but for what an event loop within it works on: these count by themselves.
class WatchedApplication : public QApplication {
public:
    WatchedApplication(int& argc, char** argv) : QApplication(argc, argv) {
        auto* dispatcher = QAbstractEventDispatcher::instance();
        connect(dispatcher, &QAbstractEventDispatcher::aboutToBlock, this, [this] { waiting_.start(); });
        connect(dispatcher, &QAbstractEventDispatcher::awake, this, [this] {
            if (waiting_.isValid()) waited_ += 1e-6 * static_cast<double>(waiting_.nsecsElapsed());
            waiting_.invalidate();
        });
    }

    bool notify(QObject* receiver, QEvent* event) override {
        const QEvent::Type type = event->type();
        const bool drawing = type == QEvent::Paint || type == QEvent::UpdateRequest || type == QEvent::Expose;
        const std::string name = std::string(receiver->metaObject()->className()) + " " + std::to_string(int(type));
        const bool frame = qobject_cast<StudioDocument*>(receiver) != nullptr;  // before it may be deleted
        const bool byLoop = waiting_.isValid();  // Qt's dispatcher works on events while it says that it blocks
        if (byLoop) waited_ += 1e-6 * static_cast<double>(waiting_.nsecsElapsed());
        waiting_.invalidate();
        const double before = drawn_, waited = waited_;
        QElapsedTimer clock;
        clock.start();
        ++depth_;
        const bool result = QApplication::notify(receiver, event);
        --depth_;
        const double ms = 1e-6 * static_cast<double>(clock.nsecsElapsed());
        if (drawing) drawn_ = before + ms;
        const double held = ms - (drawn_ - before) - (waited_ - waited);
        if (byLoop) {
            if (depth_ > 0) waited_ += held;
            waiting_.start();
        }
        if (depth_ > 0 && !byLoop) return result;
        longestDrawn = std::max(longestDrawn, drawn_ - before);
        if (held > longest) longest = held, longestIs = name;
        // Frames of the performance come beside what the hand does.
        if (!frame) longestOwn = std::max(longestOwn, held);
        return result;
    }
    void forget() { longest = longestOwn = longestDrawn = 0.0, longestIs.clear(); }

    double longest = 0.0, longestOwn = 0.0, longestDrawn = 0.0;
    std::string longestIs;

private:
    int depth_ = 0;
    double drawn_ = 0.0, waited_ = 0.0;  // ms so far; waited: in event loops within events
    QElapsedTimer waiting_;
};

Result<ImportResult> tube(const ImportRequest& request, int vertices) {
    const int around = std::max(8, static_cast<int>(std::sqrt(vertices / 2.0)));
    ImportedBody body;
    body.name = request.path.string();
    body.closed = true;
    body.mesh.body = shapes::cylinder(0.5, 1.0, around, std::max(2, vertices / around)).mesh;
    body.mesh.body.vertices.col(2).array() += std::stod(body.name);
    for (std::int32_t v = 0; v < body.mesh.body.vertices.rows(); ++v) body.mesh.renderMesh.bodyVertex.push_back(v);
    body.mesh.renderMesh.triangles = body.mesh.body.triangles;
    ImportResult result;
    result.format = "shape";
    result.bodies = {body};
    return result;
}

/// A second of dragging at 60 frames per second, again and again: minutes of it are recorded in no time.
Take longTake(const Take& second, double minutes) {
    Take take = second;
    take.times.clear();
    take.poses = take.shapes = {};
    std::vector<double> pose(second.poses.width()), shape(second.shapes.width());
    for (std::size_t f = 0; f < static_cast<std::size_t>(3600.0 * minutes); ++f) {
        second.poses.at(f % second.times.size(), pose.data());
        second.shapes.at(f % second.times.size(), shape.data());
        take.times.push_back(static_cast<double>(f) / 60.0);
        take.poses.add(pose);
        take.shapes.add(shape);
    }
    take.poses.finish();
    take.shapes.finish();
    take.targets.clear();
    return take;
}

}  // namespace

int main(int argc, char** argv) {
    const int elements = argc > 1 ? std::atoi(argv[1]) : 100, vertices = argc > 2 ? std::atoi(argv[2]) : 2500, bones = argc > 3 ? std::atoi(argv[3]) : 100;
    const double minutes = argc > 4 ? std::atof(argv[4]) : 1.0;
    ownHome();
    WatchedApplication application(argc, argv);
    prepareStudio();
    CommandRegistry registry;
    addCoreCommands(registry);
    QTemporaryDir folder;
    const QString path = folder.filePath(QStringLiteral("large.imomushi"));
    {
        Session session(registry);
        session.services().import = [vertices](const ImportRequest& request, const Progress&) { return tube(request, vertices); };
        const auto run = [&](const Json& command) {
            if (const auto answer = session.execute(command); !answer) {
                std::fprintf(stderr, "%s: %s\n", command.dump().c_str(), answer.error().message.c_str());
                std::exit(1);
            }
        };
        for (int e = 0; e < elements; ++e) {
            const std::string n = std::to_string(e), name = "e" + n;
            run({{"do", "import-element"}, {"path", n}, {"name", name}});
            run({{"do", "add-joint-face"}, {"element", name}, {"name", "in"}, {"plane", {{"origin", {0, 0, e}}, {"normal", {0, 0, -1}}}}});
            run({{"do", "add-joint-face"}, {"element", name}, {"name", "out"}, {"plane", {{"origin", {0, 0, e + 1}}, {"normal", {0, 0, 1}}}}});
            if (e > 0) run({{"do", "join"}, {"a", "e" + std::to_string(e - 1) + "/out"}, {"b", name + "/in"}});
            run({{"do", "add-bone"}, {"name", "b" + n}, {"from", e > 0 ? "b" + std::to_string(e - 1) + "/end" : std::string("e0/in")}, {"to", name + "/out"}});
        }
        for (int b = elements; b < bones; ++b)
            run({{"do", "add-bone"}, {"name", "b" + std::to_string(b)}, {"element", ""}, {"from", b > elements ? Json("b" + std::to_string(b - 1) + "/end") : Json{2, 0, 0}}, {"to", {2 + b % 2, 0, b - elements + 1}}});
        run({{"do", "precompute"}});
        run({{"do", "pin"}, {"endpoint", "b0/start"}});
        // The end of the chain moves, the rest of it is pinned.
        const int still = std::max(0, elements - 10);
        if (still > 0) run({{"do", "pin"}, {"endpoint", "b" + std::to_string(still) + "/start"}});
        run({{"do", "record"}, {"take", "dance"}, {"action", "start"}});
        for (int f = 1; f < 60; ++f) {
            const double t = 0.1 * f;
            run({{"do", "drag"}, {"endpoint", "b" + std::to_string(elements - 1) + "/end"}, {"to", {std::sin(t), std::cos(t), elements - 0.5}}});
            run({{"do", "step"}, {"frames", 1}});
        }
        run({{"do", "record"}, {"take", "dance"}, {"action", "stop"}});
        run({{"do", "rest"}});
        if (still > 0) run({{"do", "unpin"}, {"endpoint", "b" + std::to_string(still) + "/start"}});
        Project project = session.project();
        auto& take = project.document.takes.begin()->second;
        take = std::make_shared<const Take>(longTake(*take, minutes));
        std::fprintf(stderr, "a take of %.0f minutes, %.0f MB\n", minutes, 1e-6 * static_cast<double>(take->bytes()));
        if (const auto saved = storeProject(path.toStdString(), project, {}); !saved) {
            std::fprintf(stderr, "%s\n", saved.error().message.c_str());
            return 1;
        }
    }

    MainWindow window(registry);
    window.resize(1200, 800);
    window.show();
    if (!QTest::qWaitForWindowExposed(&window)) return 1;
    StudioDocument& document = window.document();
    ViewportWidget& view = window.viewport();
    QObject::connect(&document, &StudioDocument::failed, &window, [](const QString& why) { std::printf("%s\n", qPrintable(why)); });
    QObject::connect(&document, &StudioDocument::offered, &window, [](const QString& why) { std::printf("%s\n", qPrintable(why)); });
    const auto settle = [&] {
        for (int i = 0; i < 6; ++i) QTest::qWait(30);
    };
    std::printf("%d elements, %d vertices each, %d bones: milliseconds that the GUI thread is held up by one event at most (drawing apart)\n", elements, vertices, bones);
    std::printf("%-28s %9s %9s  %s\n", "", "longest", "drawing", "of");
    std::vector<std::string> slow;  // what took longer than it may
    const auto measure = [&](const char* name, const std::function<void()>& act, double most = kMostMs) {
        settle();
        application.forget();
        QTimer::singleShot(0, &window, act);  // from the event loop, as a person does it
        settle();
        // What is done beside the window counts where it is taken over.
        if (!QTest::qWaitFor([&] { return !window.steps().running(); }, 60'000)) std::printf("it never ended\n");
        settle();
        std::printf("%-28s %9.1f %9.1f  %s%s\n", name, application.longest, application.longestDrawn, application.longestIs.c_str(), application.longest > most ? "  SLOW" : "");
        std::fflush(stdout);
        if (application.longest > most) slow.push_back(name);
    };
    const auto execute = [&](const Json& command) {
        if (const auto answer = document.execute(command); !answer) std::printf("%s\n", answer.error().message.c_str());
    };
    const auto executeSlow = [&](const Json& command) {
        SlowStep step;
        step.command = command;
        step.refused = [](const Error& error) { std::printf("%s\n", error.message.c_str()); };
        document.executeSlow(std::move(step));
    };
    const auto send = [&](QEvent::Type type, QPoint at, Qt::MouseButton button, Qt::MouseButtons buttons) {
        QMouseEvent event(type, at, view.mapToGlobal(at), button, buttons, Qt::NoModifier);
        QApplication::sendEvent(&view, &event);
    };
    const auto moves = [&](QPoint from, Qt::MouseButtons buttons) {
        for (int i = 0; i < 40; ++i) {
            QTimer::singleShot(4 * i, &window, [&, i, from, buttons] { send(QEvent::MouseMove, from + QPoint(i, i / 2), Qt::NoButton, buttons); });
        }
    };
    const std::string last = "b" + std::to_string(elements - 1);

    // The view makes its OpenGL context when it is first seen, which belongs to drawing.
    window.showStart(false);
    settle();
    measure("open", [&] { window.files().open(path); });
    measure("look around", [&] { view.frameAll(false); });
    const auto hover = [&](const char* name, ToolKind tool) {
        view.tools().setTool(tool);
        measure(name, [&] { moves(view.rect().center(), Qt::NoButton); }, kMostDragMs);
    };
    // A drag from a place where nothing is, over everything.
    const auto sweep = [&](const char* name, Qt::KeyboardModifiers modifiers) {
        measure(name, [&] {
            const QPoint from(20, 60), to = view.rect().bottomRight() - QPoint(20, 20);
            const auto event = [&, modifiers](QEvent::Type type, QPoint p, Qt::MouseButton button, Qt::MouseButtons buttons) {
                QMouseEvent e(type, p, view.mapToGlobal(p), button, buttons, modifiers);
                QApplication::sendEvent(&view, &e);
            };
            event(QEvent::MouseButtonPress, from, Qt::LeftButton, Qt::LeftButton);
            for (int i = 1; i <= 20; ++i) QTimer::singleShot(4 * i, &window, [=] { event(QEvent::MouseMove, from + (to - from) * i / 20, Qt::NoButton, Qt::LeftButton); });
            QTimer::singleShot(100, &window, [=] { event(QEvent::MouseButtonRelease, to, Qt::LeftButton, Qt::NoButton); });
        }, kMostDragMs);
    };
    hover("hover", ToolKind::Select);
    hover("hover with the face tool", ToolKind::Face);
    hover("hover with the bone tool", ToolKind::Bone);
    hover("hover with the handle tool", ToolKind::Handle);
    hover("hover with the touch tool", ToolKind::Touch);
    view.tools().setTool(ToolKind::Select);
    sweep("box", Qt::NoModifier);
    sweep("lasso", Qt::ControlModifier);
    document.select({});
    hover("hover with the pose tool", ToolKind::Pose);
    const auto end = [&] {
        const auto place = document.session().positionOf({document.document().boneNamed(last)->id, true});
        return view.onScreen(*place).value_or(QPointF(view.rect().center())).toPoint();
    };
    QPoint at;
    measure("press on a bone's end", [&] { at = end(); send(QEvent::MouseMove, at, Qt::NoButton, Qt::NoButton); send(QEvent::MouseButtonPress, at, Qt::LeftButton, Qt::LeftButton); });
    measure("drag it", [&] { moves(at, Qt::LeftButton); });
    measure("let go", [&] { send(QEvent::MouseButtonRelease, at + QPoint(39, 19), Qt::LeftButton, Qt::NoButton); });
    measure("undo", [&] { window.actions()["undo"]->trigger(); });
    measure("redo", [&] { window.actions()["redo"]->trigger(); });
    // The arrow of the gizmo is 60 pixels to the right of what is selected, where the view is seen from the front.
    int tooSlow = 0;
    const auto dragGizmo = [&](const char* name, ToolKind tool, const std::vector<SelectionItem>& items = {}) {
        view.tools().setTool(tool);
        execute({{"do", "rest"}});
        view.setViewAxis(ViewAxis::Front);
        QTest::qWait(kViewMs);
        document.select(items.empty() ? std::vector<SelectionItem>{{SelectionItem::Kind::Endpoint, document.document().boneNamed(last)->id, {}, true}} : items);
        settle();
        const QPoint middle = items.empty() ? end() : view.onScreen(Vec3(0.0, 0.0, 0.5 * elements)).value_or(QPointF()).toPoint();  // all hang together
        at = middle + QPoint(int(60 * Appearance::instance().scale()), 0);
        send(QEvent::MouseMove, at, Qt::NoButton, Qt::NoButton);
        send(QEvent::MouseButtonPress, at, Qt::LeftButton, Qt::LeftButton);
        const bool busy = view.tools().busy();
        measure(name, [&] { moves(at, Qt::LeftButton); });
        const double ms = application.longestOwn;
        std::printf("  %s: %.1f ms an event of the drag at most; %.0f are allowed\n", busy ? "the gizmo" : "it was not taken", ms, kMostDragMs);
        tooSlow += !busy || ms > kMostDragMs;
        measure("let it go", [&] { send(QEvent::MouseButtonRelease, at + QPoint(39, 19), Qt::LeftButton, Qt::NoButton); });
        measure("undo that", [&] { window.actions()["undo"]->trigger(); });
    };
    dragGizmo("drag the gizmo", ToolKind::Select);
    window.actions()["snap"]->trigger();
    dragGizmo("drag it with the magnet", ToolKind::Select);
    window.actions()["snap"]->trigger();
    dragGizmo("drag the gizmo at rest", ToolKind::Bone);
    dragGizmo("drag all elements", ToolKind::Select, {{SelectionItem::Kind::Element, document.document().elements.begin()->first, {}, false}});
    view.tools().setTool(ToolKind::Select);
    measure("select all", [&] { window.actions()["select-all"]->trigger(); });
    measure("select none", [&] { window.actions()["select-none"]->trigger(); });
    measure("rename an element", [&] { execute({{"do", "rename"}, {"target", "e1"}, {"name", "other"}}); });
    measure("stiffness of an element", [&] { execute({{"do", "set"}, {"target", "other"}, {"property", "stiffness"}, {"value", 2.0}}); });
    measure("nu of an element", [&] { execute({{"do", "set"}, {"target", "other"}, {"property", "nu"}, {"value", 0.37}}); });
    measure("undo that", [&] { window.actions()["undo"]->trigger(); });
    measure("turn smooth joints on", [&] { executeSlow({{"do", "enable"}, {"effect", "smooth-joints"}}); });
    measure("remove an element", [&] { executeSlow({{"do", "remove-element"}, {"name", "other"}}); });
    measure("undo that", [&] { window.actions()["undo"]->trigger(); });
    std::vector<SelectionItem> ten;
    for (const auto& [id, element] : document.document().elements)
        if (ten.size() < 10) ten.push_back({SelectionItem::Kind::Element, id, {}, false});
    document.select(ten);
    settle();
    measure("remove ten elements", [&] { window.actions()["delete"]->trigger(); });
    if (int(document.document().elements.size()) != elements - 10) std::printf("  they were not removed\n");
    measure("undo that", [&] { window.actions()["undo"]->trigger(); });
    measure("save", [&] { window.files().save(); });
    measure("keep a copy for recovery", [&] {
        execute({{"do", "rename"}, {"target", "e2"}, {"name", "another"}});
        window.files().autosave().saveSoon();
    });
    measure("duplicate an element", [&] { executeSlow({{"do", "duplicate"}, {"names", {"e3"}}}); });
    measure("mirror an element", [&] { executeSlow({{"do", "mirror"}, {"from", {"e4"}}, {"axis", "x"}}); });
    measure("new project", [&] { execute({{"do", "new"}}); });

    // One body of as many vertices, cut into pieces.
    const auto worm = [&](const ImportRequest&, const Progress&) -> Result<CharacterFile> {
        const int around = 250, along = std::max(4, elements * vertices / around);
        const TriangleMesh mesh = shapes::cylinder(0.5, 6.0, around, along).mesh;
        CharacterFile file;
        file.format = "obj";
        file.renderModel.mesh.body = mesh;
        file.renderModel.part.assign(static_cast<std::size_t>(mesh.triangles.rows()), 0);
        file.renderModel.parts = {"worm"};
        file.renderModel.mesh.renderMesh.triangles = mesh.triangles;
        for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v) file.renderModel.mesh.renderMesh.bodyVertex.push_back(v);
        return file;
    };
    measure("import", [&] {
        SlowStep import;
        import.command = {{"do", "import-character"}, {"path", "worm.obj"}, {"name", "worm"}};
        import.arrange = [&](Session& session) { session.services().importCharacter = worm; };
        import.brings = std::int64_t(elements) * vertices;
        document.executeSlow(std::move(import));
    });
    view.frameAll(false);
    view.setViewAxis(ViewAxis::Right);
    QTest::qWait(kViewMs);
    hover("hover over one body", ToolKind::Select);
    hover("hover of a cut", ToolKind::Face);
    const auto cut = [&](const char* name, const char* of, double z) {
        measure(name, [&] { executeSlow({{"do", "cut"}, {"element", of}, {"name", name}, {"plane", {{"origin", {0, 0, z}}, {"normal", {0, 0, 1}}}}}); });
    };
    cut("cut", "worm body", 0.5);
    cut("cut again", "worm body", 0.25);
    measure("move a cut", [&] { executeSlow({{"do", "move-cut"}, {"cut", "cut"}, {"plane", {{"origin", {0, 0, 0.6}}, {"normal", {0, 0, 1}}}}}); });
    hover("hover of a third cut", ToolKind::Face);
    view.tools().setTool(ToolKind::Select);
    const auto moved = [&] { return document.document().characters.begin()->second->cuts.front().plane.origin.z(); };
    document.select({{SelectionItem::Kind::Cut, document.document().characters.begin()->second->cuts.front().id, {}, false}});
    settle();
    const auto press = [&](Qt::Key key) {
        QKeyEvent down(QEvent::KeyPress, key, Qt::NoModifier), up(QEvent::KeyRelease, key, Qt::NoModifier);
        QApplication::sendEvent(&view, &down);
        QApplication::sendEvent(&view, &up);
    };
    double was = moved();
    send(QEvent::MouseMove, view.rect().center(), Qt::NoButton, Qt::NoButton);
    measure("take a cut", [&] { press(Qt::Key_G); });
    measure("drag it", [&] { moves(view.rect().center(), Qt::NoButton); }, kMostDragMs);
    measure("let it go", [&] { press(Qt::Key_Return); });
    if (moved() == was) std::printf("  it was not moved\n");
    was = moved();
    measure("type where a cut lies", [&] {
        for (NumberField* field : window.inspector().findChildren<NumberField*>())
            if (field->value() && *field->value() == moved()) field->setProperty("value", moved() - 0.1);
    });
    if (moved() == was) std::printf("  it was not moved\n");
    view.tools().setTool(ToolKind::Select);
    sweep("box over pieces", Qt::NoModifier);
    measure("duplicate the character", [&] { executeSlow({{"do", "duplicate"}, {"names", {"worm"}}}); });
    measure("undo that", [&] { window.actions()["undo"]->trigger(); });
    measure("new project", [&] { execute({{"do", "new"}}); });
    std::printf("%zu of these take longer than they may (%.0f ms; %.0f ms of what follows the pointer)\n", slow.size(), kMostMs, kMostDragMs);

    // From a move of the mouse, or a packet of the network, to the picture that follows it: at most one step and two pictures.
    std::printf("\n%-12s %-6s %9s %9s %9s %9s  latency, ms\n", "sample", "input", "median", "99 %", "allowed", "pictures");
    int late = 0, followed = 0;
    InputDeck& inputs = window.inputs();
    inputs.setPort(0, 0);
    inputs.setOn(0, true);
    UdpSender sender(static_cast<std::uint16_t>(inputs.sources()[0].port));
    const auto follow = [&](const QString& sample, const char* input, const std::function<void(double)>& move) {
        double pictures = 0.0, fps = 0.0;
        const auto counts = QObject::connect(&view, &ViewportWidget::frameMeasured, &window, [&](double, double now) { pictures += now > 0.0, fps += now; });
        view.latency().forget();
        QElapsedTimer since;
        for (since.start(); since.elapsed() < kFollowMs; QTest::qWait(8)) move(1e-3 * static_cast<double>(since.elapsed()));
        QObject::disconnect(counts);
        const auto latency = view.latency().latency();
        if (!latency || fps <= 0.0) return;
        const double allowed = 1e3 / 60.0 + 2e3 * pictures / fps;
        const char* verdict = latency->p99Ms <= allowed ? "in time" : latency->medianMs <= allowed ? "some are LATE" : "LATE";
        late += latency->medianMs > allowed;
        ++followed;
        std::printf("%-12s %-6s %9.1f %9.1f %9.1f %9zu  %s\n", qPrintable(sample), input, latency->medianMs, latency->p99Ms, allowed, latency->pictures, verdict);
        std::fflush(stdout);
    };
    for (const Sample& sample : samples()) {
        execute({{"do", "new"}});  // or it would ask whether to save
        window.files().open(sample.path);
        if (!QTest::qWaitFor([&] { return !window.startShown() && !view.cameraController().moving(); }, 60'000)) return 1;
        settle();
        view.tools().setTool(ToolKind::Pose);
        const auto [bone, held] = *document.document().bones.rbegin();  // a copy: the document becomes another one
        const Vec3 rest = *document.session().positionOf({bone, true});
        const auto there = view.onScreen(rest);
        if (!there) continue;
        at = there->toPoint();
        send(QEvent::MouseMove, at, Qt::NoButton, Qt::NoButton);
        send(QEvent::MouseButtonPress, at, Qt::LeftButton, Qt::LeftButton);
        follow(sample.name, "mouse", [&](double t) { send(QEvent::MouseMove, at + QPoint(int(30 * std::sin(4 * t)), int(20 * std::sin(3 * t))), Qt::NoButton, Qt::LeftButton); });
        send(QEvent::MouseButtonRelease, at, Qt::LeftButton, Qt::NoButton);
        const std::string address = "/imomushi/bone/" + held->name + "/end/position";
        follow(sample.name, "OSC", [&](double t) {
            sender.send(oscBytes(address, {float(rest.x() + 0.05 * std::sin(4 * t)), float(rest.y() + 0.05 * std::sin(3 * t)), float(rest.z())}));
        });
        inputs.letGo();
        inputs.goOn();
    }
    std::printf("of %d, the median of %d is within one step and two pictures\n", followed, followed - late);
    return tooSlow > 0 || !slow.empty() || late > 0 ? 1 : 0;
}
