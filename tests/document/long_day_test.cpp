// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>

#include <iomanip>
#include <sstream>

#include "tests/document/hand.h"
#include "tests/document/workbench.h"
#include "tests/support/left_out.h"
#include "tests/support/thorough.h"

using namespace imomushi;

namespace {

/// Bytes that this program holds. 0: it has a malloc of its own that does not tell (a sanitizer's).
std::size_t held() {
#if defined(__GLIBC__)
    const struct mallinfo2 now = ::mallinfo2();
    return now.uordblks + now.hblkhd;
#else
    return 0;
#endif
}

}  // namespace

TEST_CASE("a long day: what is held stops growing when the bounds of history, script and responses are reached") {
    // Eight hours of somebody in a hurry, in two minutes; a part of them unless it is a thorough run.
    const int hours = 8, parts = repeats(5, 60);
    constexpr int kCommands = 40, kDrags = 5, kMoves = 60;
    ResponseStore::Limits limits;
    limits.memory = std::size_t{2} << 20;
    Workbench w(std::make_shared<ResponseStore>(limits));
    w.session.setHistoryDepth(100);
    w.session.setScriptBytes(std::size_t{256} << 10);
    const std::string path = (Workbench::folder() / "day.imomushi").string();
    w.good({{"do", "set"}, {"target", "character"}, {"property", "threads"}, {"value", 1}});
    std::vector<std::size_t> bytes = {held()};  // after each hour
    std::ostringstream told;
    int cuts = 0;
    for (int hour = 0; hour < hours; ++hour) {
        // Each hour is like the others, so that nothing but what is kept of former ones makes it hold more.
        Hand hand(w.session, 8);
        double nu = 0.3;
        for (int part = 0; part < parts; ++part) {
            w.buildChain();
            w.good({{"do", "record"}, {"take", "dance"}, {"action", "start"}});
            for (int drag = 0; drag < kDrags; ++drag) {
                w.session.beginGesture();
                for (int move = 0; move < kMoves; ++move) {
                    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {hand.number(-1, 1), hand.number(-1, 1), hand.number(4, 6)}}});
                    w.session.stepFrame(1.0 / 60.0);
                }
                w.session.endGesture();
            }
            w.good({{"do", "record"}, {"take", "dance"}, {"action", "stop"}});
            w.good({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", nu = nu < 0.45 ? nu + 0.0005 : 0.3}});
            w.good({{"do", "precompute"}});
            for (int i = 0; i < kCommands; ++i) w.session.execute(hand.command());
            // Another character in the same session.
            if (const auto recording = w.session.recording()) w.good({{"do", "record"}, {"take", recording->take}, {"action", "stop"}});
            const Document all = w.session.document();
            for (const auto& [id, take] : all.takes) w.good({{"do", "remove-take"}, {"take", take->name}});
            for (const auto& [id, bone] : all.bones) w.good({{"do", "remove-bone"}, {"name", bone->name}});
            for (const auto& [id, element] : all.elements) w.good({{"do", "remove-element"}, {"name", element->name}});
            for (const char* effect : {"bone-dynamics", "smooth-joints", "bend-warp", "joint-dynamics", "gravity", "inflate", "touch", "contact", "ground"}) w.code({{"do", "disable"}, {"effect", effect}});
            cuts += w.session.hasScript() ? 0 : 1;
            CHECK(w.session.responses().store().bytes() <= 2 * limits.memory);
            if (part % 5 == 4) w.good({{"do", "save"}, {"path", path}});
        }
        bytes.push_back(held());
        told << std::fixed << std::setprecision(2) << (hour > 0 ? ", " : "") << static_cast<double>(bytes.back()) / 1048576.0;
    }
    MESSAGE("MiB held after each hour: " << told.str());
    CHECK(w.session.steps().size() == 100);
    CHECK(cuts > 0);
    if (bytes.back() == 0) return leaveOut("the malloc of this build does not say how much is held");
    // Where all is kept the second half of the day adds half of what the first hour brought, times the hours.
    const double first = static_cast<double>(bytes[1]) - static_cast<double>(bytes[0]), later = static_cast<double>(bytes[hours]) - static_cast<double>(bytes[hours / 2]);
    CHECK(later < 0.1 * first * (hours / 2));
}
