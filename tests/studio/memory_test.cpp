// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that runs out anywhere in the studio is said, and the studio goes on with what it had.
#include <QThreadPool>
#include <new>

#include "core/document/document_change.h"
#include "core/mesh/connectivity.h"
#include "tests/studio/window.h"
#include "tests/support/failing_new.h"
#include "tests/support/shapes.h"
#include "ui/models/failures.h"
#include "ui/models/gesture.h"
#include "ui/picking/picking.h"

using namespace imomushi;

namespace {

/// A window, and how often it was said that something failed.
struct Told : Window {
    int told = 0;
    QObject hears;
    Told() {
        QObject::connect(&Failures::instance(), &Failures::failed, &hears, [this] { ++told; });
    }
    /// What failed is said, once the event loop turns.
    void isSaid(int before) {
        waitFor([&] { return told > before; });
        CHECK(window().messages().isVisible());
        CHECK(window().messages().text().contains(QStringLiteral("memory")));
        window().messages().hide();
    }
};

class Job : public BackgroundJob {
public:
    using BackgroundJob::launch;
};

[[noreturn]] void runOut() { throw std::bad_alloc(); }

}  // namespace

TEST_CASE("memory: an event whose handler runs out of it is left out and said, and those that follow are handled") {
    Told w;
    QTimer::singleShot(0, &w.hears, runOut);
    w.isSaid(0);
    bool handled = false;
    QTimer::singleShot(0, &w.hears, [&] { handled = true; });
    waitFor([&] { return handled; });
    CHECK(w.told == 1);
}

TEST_CASE(
    "memory: whichever request fails while the view is painted, the last good picture stays, it is said, and the next picture is whole") {
    Told w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    w.settle();
    w.window().messages().hide();
    const QImage good = w.view().grabFramebuffer();
    REQUIRE(w.view().grabFramebuffer() == good);
    int failures = 0;
    for (const auto fails : {FailingNew::Fails::Once, FailingNew::Fails::FromThenOn})
        for (long n = 1;; n += std::max(1L, n / 2)) {
            CAPTURE(n);
            (void)w.document().releaseCharacter();  // it is built again, while the view is painted
            const int before = w.told;
            bool failed = false;
            QImage picture;
            {
                const FailingNew failing(FailingNew::On::ThisThread, n, fails);
                picture = w.view().grabFramebuffer();
                failed = FailingNew::failed();
            }
            CHECK(picture == good);
            if (!failed) break;
            w.settle();
            if (w.told == before) continue;  // it can be done without what was asked for
            ++failures;
            w.isSaid(before);
            CHECK(w.view().grabFramebuffer() == good);
        }
    CHECK(failures > 10);
}

TEST_CASE("memory: a task of the thread pool that runs out of it is said, and what it was to make is made when it is asked for") {
    Told w;
    Document document;
    auto element = std::make_shared<Element>();
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = shapes::cylinder(0.5, 2.0, 16, 8).mesh;
    element->mesh = mesh;
    document.elements.emplace(1, element);
    bool failed = false;
    {
        const FailingNew failing(FailingNew::On::OtherThreads, 1, FailingNew::Fails::FromThenOn);
        preparePicking(document);
        QThreadPool::globalInstance()->waitForDone();
        failed = FailingNew::failed();
    }
    CHECK(failed);
    w.isSaid(0);
    std::vector<std::int32_t> triangles;
    mesh->connectivity().clusters().along(
        Vec3(0, 0, 10), Vec3(0, 0, -1), [&](std::int32_t v) { return Vec3(mesh->body.vertices.row(v)); }, triangles);
    CHECK(!triangles.empty());
}

TEST_CASE("memory: a job in the background that runs out of it, or whose answer cannot be taken in, has failed, and that is said") {
    Told w;
    for (const bool inWork : {true, false}) {
        CAPTURE(inWork);
        const int before = w.told;
        Job job;
        std::optional<bool> completed;
        bool failed = false;
        QObject::connect(&job, &BackgroundJob::finished, &w.hears, [&](bool c) { completed = c; });
        job.launch(
            [inWork](const Progress&) {
                if (inWork) runOut();
            },
            runOut, [&] { failed = true; });
        w.isSaid(before);
        CHECK(failed);
        CHECK(completed == false);
        CHECK(!job.running());
    }
}

TEST_CASE(
    "memory: a gesture is taken back, and a change is made, whoever runs out of it while it is told; who did not hear of it is told "
    "everything next time") {
    Told w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const Document before = w.now();
    const int position = w.document().session().position();
    bool runsOut = false;
    std::vector<bool> heard;  // that anything may differ, by those who are told last
    QObject::connect(&w.document(), &StudioDocument::structureChanged, &w.hears, [&] {
        if (runsOut) runOut();
    });
    QObject::connect(&w.document(), &StudioDocument::structureChanged, &w.hears,
                     [&](const DocumentChange& change) { heard.push_back(change.unknown); });
    QObject::connect(&w.document(), &StudioDocument::historyChanged, &w.hears, [&] {
        if (runsOut) runOut();
    });
    {
        Gesture gesture(w.document());
        REQUIRE(w.document().execute(
            {{"do", "set"}, {"target", w.now().elements.begin()->second->name}, {"property", "nu"}, {"value", 0.4}}));
        heard.clear();
        runsOut = true;
    }
    runsOut = false;
    CHECK(difference(before, w.now()).empty());
    CHECK(w.document().session().position() == position);
    CHECK(heard.empty());
    w.isSaid(0);
    w.run({{"do", "rest"}});
    REQUIRE(!heard.empty());
    CHECK(heard.front());
}
