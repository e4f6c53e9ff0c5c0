// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <string>

#include "core/document/document_change.h"
#include "tests/document/workbench.h"
#include "tests/memory/ways.h"
#include "tests/support/left_out.h"

using namespace imomushi;

namespace {

struct Tried {
    int failed = 0, succeeded = 0;
    long last = 0;  ///< n
};

/// Runs a command with the n-th request for memory failing, or all from the n-th on, for n from 1 until there is none. It may succeed, where it can do without; else it says
/// what happened, and the document, its history and what `unchanged` checks are as they were. `prepare` runs before each, unhindered; `done` after what was done all the same.
Tried tryAll(
    Workbench& w, const std::function<Json()>& prepare, const std::function<void()>& unchanged, const std::function<void()>& done = [] {}) {
    Tried tried;
    for (const Fails fails : kWays)
        for (long n = 1;; n = after(n, fails)) {
            const Json command = prepare();
            const Document before = w.session.document();
            const auto steps = w.session.steps().size();
            const bool modified = w.session.modified();
            bool ran = true;
            Result<Json> answer;
            bool failed = false;
            try {
                const FailingMalloc failing(n, fails);
                answer = w.session.execute(command);
                failed = FailingMalloc::failed();
            } catch (const std::exception& e) {
                ran = false;
                FAIL_CHECK(named(fails) << n << " of " << command.dump() << ": " << e.what());
            }
            if (!ran) break;
            tried.last = std::max(tried.last, n);
            if (!failed) {
                if (!answer) FAIL_CHECK(command.dump() << ": " << answer.error().message);
                break;
            }
            INFO(named(fails) << n << " of " << command.dump() << ": "
                              << (answer ? "done" : answer.error().code + ": " + answer.error().message));
            if (answer || answer.error().code == "no-memory-after") {
                ++tried.succeeded;
                CHECK((answer || w.session.steps().size() > steps));  // there is a step to undo
                done();
                continue;
            }
            ++tried.failed;
            CHECK(!answer.error().message.empty());
            CHECK(answer.error().code != "damaged");  // it says nothing of any file or part
            CHECK(answer.error().code != "not-sound");
            CHECK(difference(before, w.session.document()).empty());
            CHECK(w.session.steps().size() == steps);
            CHECK(w.session.modified() == modified);
            unchanged();
        }
    return tried;
}

std::string fileNames(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    std::string text;
    for (const auto& name : names) text += name + " ";
    return text;
}

/// An empty folder of this case.
std::filesystem::path emptyFolder(const char* name) {
    const auto made = Workbench::folder() / name;
    std::filesystem::create_directory(made);
    return made;
}

}  // namespace

TEST_CASE("no memory: whichever request fails while a project is saved, it is told, and the file is the old one or the new one") {
    if (!FailingMalloc::works()) return leaveOut("the malloc of this build cannot be replaced");
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const auto place = emptyFolder("saving");
    const Json save{{"do", "save"}, {"path", (place / "work.imomushi").string()}};
    w.good(save);
    w.good(save);  // the first one has no version to keep
    std::string kept;
    int number = 0;
    const auto tried = tryAll(w, [&] {
        w.good({{"do", "rename"}, {"target", "A"}, {"name", "A" + std::to_string(++number)}});
        w.good({{"do", "rename"}, {"target", "A" + std::to_string(number)}, {"name", "A"}});
        kept = readFile(place / "work.imomushi");
        return save;
    }, [&] {
        CHECK(readFile(place / "work.imomushi") == kept);
        CHECK(fileNames(place) == "work.imomushi work.imomushi-versions ");
    });
    CHECK(tried.failed > 20);
    w.good(save);
    w.good({{"do", "open"}, {"path", (place / "work.imomushi").string()}});
    MESSAGE(tried.failed << " told, " << tried.succeeded << " saved all the same, of " << tried.last << " requests");
}

TEST_CASE("no memory: whichever request fails while a project is opened, it is told, and what was open stays") {
    if (!FailingMalloc::works()) return leaveOut("the malloc of this build cannot be replaced");
    const auto place = emptyFolder("opening");
    const std::string first = (place / "first.imomushi").string(), second = (place / "second.imomushi").string();
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "save"}, {"path", first}});
    w.good({{"do", "rename"}, {"target", "A"}, {"name", "other"}});
    w.good({{"do", "save"}, {"path", second}});
    const auto tried = tryAll(w, [&] {
        if (w.session.path() != first) w.good({{"do", "open"}, {"path", first}});
        return Json{{"do", "open"}, {"path", second}};
    }, [&] {
        CHECK(w.session.path() == first);
        CHECK(w.session.builtCharacter().has_value());
        for (const auto& [id, element] : w.session.document().elements) CHECK(w.session.responseState(id) == ResponseState::Fresh);
    });
    CHECK(tried.failed > 20);
    MESSAGE(tried.failed << " told, " << tried.succeeded << " opened all the same, of " << tried.last << " requests");
}

TEST_CASE("no memory: whichever request fails in a precompute, it is told, and the next one makes what it would have made") {
    if (!FailingMalloc::works()) return leaveOut("the malloc of this build cannot be replaced");
    for (const std::string mesh : {"as-is", "default"}) {
        Workbench w;
        w.buildChain(mesh);
        int number = 0;
        const auto tried = tryAll(w, [&] {
            w.good({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", 0.3 + 1e-5 * ++number}});
            return Json{{"do", "precompute"}, {"elements", {"A"}}};
        }, [] {});
        CHECK(tried.failed > 20);
        MESSAGE(mesh << ": " << tried.failed << " told, " << tried.succeeded << " computed all the same, of " << tried.last << " requests");
        w.good({{"do", "precompute"}});
        Workbench undisturbed;
        undisturbed.buildChain(mesh);
        undisturbed.good({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", 0.3 + 1e-5 * number}});
        undisturbed.good({{"do", "precompute"}});
        CHECK(w.content() == undisturbed.content());
    }
}

TEST_CASE("no memory: whichever request fails in an export, it is told, and files are the old ones or the new ones") {
    if (!FailingMalloc::works()) return leaveOut("the malloc of this build cannot be replaced");
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "record"}, {"take", "walk"}, {"action", "start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1, 0, 5}}});
    w.good({{"do", "step"}, {"frames", 5}});
    w.good({{"do", "record"}, {"take", "walk"}, {"action", "stop"}});
    const auto place = emptyFolder("exporting");
    const Json command{{"do", "export"}, {"path", (place / "chain.glb").string()}, {"take", "walk"}, {"layout", "baked"}};
    w.good(command);
    const std::string files = fileNames(place), kept = readFile(place / "chain.glb");
    const auto tried = tryAll(w, [&] { return command; }, [&] { CHECK(fileNames(place) == files); });
    CHECK(readFile(place / "chain.glb") == kept);
    CHECK(tried.failed > 20);
    MESSAGE(tried.failed << " told, " << tried.succeeded << " exported all the same, of " << tried.last << " requests");
}

TEST_CASE(
    "no memory: whichever request fails while an artist edits and poses, it is told, and the step is there as a whole or not at all") {
    if (!FailingMalloc::works()) return leaveOut("the malloc of this build cannot be replaced");
    const Json steps[] = {{{"do", "import-element"}, {"path", "bar4"}, {"name", "C"}},
                          {{"do", "add-joint-face"}, {"element", "C"}, {"name", "in"}, {"plane", {{"origin", {0, 0, 12}}, {"normal", {0, 0, -1}}}}},
                          {{"do", "remove-element"}, {"name", "C"}},
                          {{"do", "set"}, {"target", "B"}, {"property", "stiffness"}, {"value", 3.0}},
                          {{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1, 0, 5}}},
                          {{"do", "step"}, {"frames", 2}},
                          {{"do", "enable"}, {"effect", "bone-dynamics"}},
                          {{"do", "remove-bone"}, {"name", "b"}},
                          {{"do", "undo"}, {"count", 2}},
                          {{"do", "redo"}}};
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "rest"}});
    w.good({{"do", "rename"}, {"target", "a"}, {"name", "first"}});
    w.good({{"do", "rename"}, {"target", "b"}, {"name", "b"}});
    for (const Json& step : steps) {
        if (step["do"] == "redo") w.good({{"do", "undo"}});
        int position = w.session.position();
        tryAll(w, [&] {
            while (w.session.position() > position) w.good({{"do", "undo"}});
            while (w.session.position() < position) w.good({{"do", "redo"}});
            return step;
        }, [&] {
            CHECK(w.session.position() == position);
            CHECK(w.session.builtCharacter().has_value());
        });
        w.code(step);
    }
}
