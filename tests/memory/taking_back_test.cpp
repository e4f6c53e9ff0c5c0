// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <memory>
#include <utility>

#include "core/document/document_change.h"
#include "core/session/prepared_step.h"
#include "tests/document/workbench.h"
#include "tests/memory/ways.h"
#include "tests/support/left_out.h"

using namespace imomushi;

namespace {

/// What is answered while the n-th request for memory fails, and whether one did.
template <class Act>
std::pair<Result<Json>, bool> failing(long n, Fails fails, const Act& act) {
    const FailingMalloc malloc(n, fails);
    Result<Json> answer = act();
    return {std::move(answer), FailingMalloc::failed()};
}

std::string outcome(const Result<Json>& answer) { return answer ? "done" : answer.error().code + ": " + answer.error().message; }

}  // namespace

TEST_CASE(
    "no memory: whichever request fails while a gesture is taken back, the document is as it was before it, and the character can be built "
    "again") {
    if (!FailingMalloc::works()) return leaveOut("the malloc of this build cannot be replaced");
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    int tried = 0;
    for (const Fails fails : kWays)
        for (long n = 1;; n = after(n, fails)) {
            const Document before = w.session.document();
            const int position = w.session.position();
            w.session.setListener({});
            w.session.beginGesture();
            w.good({{"do", "remove-bone"}, {"name", "b"}});
            w.good({{"do", "set"}, {"target", "A"}, {"property", "stiffness"}, {"value", 2.0}});
            w.good({{"do", "enable"}, {"effect", "bone-dynamics"}});
            bool told = false;
            w.session.setListener([&told](const Session::Change& change) { told = change.replaced || change.document.structure(); });
            bool failed = false;
            {
                const FailingMalloc failing(n, fails);
                w.session.cancelGesture();
                failed = FailingMalloc::failed();
            }
            INFO(named(fails) << n);
            CHECK(told);
            CHECK(difference(before, w.session.document()).empty());
            CHECK(w.session.position() == position);
            CHECK(w.session.builtCharacter().has_value());
            CHECK(w.code({{"do", "undo"}}) == "ok");  // of a step before it: no gesture goes on
            w.good({{"do", "redo"}});
            if (!failed) break;
            ++tried;
        }
    CHECK(tried > 20);
}

TEST_CASE("no memory: whichever request fails while a prepared step is taken over, it is there as a whole or not at all") {
    if (!FailingMalloc::works()) return leaveOut("the malloc of this build cannot be replaced");
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const int position = w.session.position();
    const Document before = w.session.document();
    const Json command{{"do", "remove-bone"}, {"name", "b"}};
    int told = 0;
    for (const Fails fails : kWays)
        for (long n = 1;; n = after(n, fails)) {
            auto made = prepareStep(coreRegistry(), w.session.project(), {command}, {}, {});
            REQUIRE(made);
            const auto tried = failing(n, fails, [&] { return w.session.takePrepared(*made); });
            const Result<Json>& answer = tried.first;
            INFO(named(fails) << n << ": " << outcome(answer));
            CHECK(w.session.position() == position + (answer ? 1 : 0));
            CHECK((w.session.document().boneNamed("b") == nullptr) == answer.has_value());
            CHECK(w.session.builtCharacter().has_value());
            if (answer) w.good({{"do", "undo"}});
            CHECK(difference(before, w.session.document()).empty());
            if (!tried.second) break;
            told += !answer;
        }
    CHECK(told > 5);
}

TEST_CASE("no memory: whichever request fails while a character is made soft, all of it is taken back, or its step can be undone") {
    if (!FailingMalloc::works()) return leaveOut("the malloc of this build cannot be replaced");
    Workbench w;
    const Json command{{"do", "make-soft"}, {"path", "trunk"}, {"name", "it"}, {"precompute", false}};
    int told = 0, after = 0;
    for (const Fails fails : kWays)
        for (long n = 1;; n = 2 * n) {
            const std::string before = w.content();
            const auto tried = failing(n, fails, [&] { return w.session.execute(command); });
            const Result<Json>& answer = tried.first;
            INFO(named(fails) << n << ": " << outcome(answer));
            const bool done = answer || answer.error().code == "no-memory-after";
            CHECK(w.session.position() == (done ? 1 : 0));
            if (done) w.good({{"do", "undo"}});
            CHECK(w.content() == before);
            CHECK(w.code({{"do", "undo"}}) == "nothing-to-undo");
            if (!tried.second) break;
            ++(done ? after : told);
        }
    CHECK(told > 10);
    MESSAGE(told << " told, " << after << " made all the same");
}
