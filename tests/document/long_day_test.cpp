// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "tests/document/hand.h"
#include "tests/document/workbench.h"
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

double median(std::vector<std::size_t>::const_iterator begin, std::vector<std::size_t>::const_iterator end) {
    std::vector<std::size_t> sorted(begin, end);
    std::sort(sorted.begin(), sorted.end());
    return static_cast<double>(sorted[sorted.size() / 2]);
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
    Hand hand(w.session, 8);
    std::vector<std::size_t> bytes;
    std::ostringstream told;
    double nu = 0.3;
    int cuts = 0;
    for (int hour = 0; hour < hours; ++hour) {
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
            bytes.push_back(held());
        }
        told << std::fixed << std::setprecision(2) << (hour > 0 ? ", " : "") << median(bytes.end() - parts, bytes.end()) / 1048576.0;
    }
    MESSAGE("MiB held in each hour: " << told.str());
    CHECK(w.session.steps().size() == 100);
    CHECK(cuts > 0);
    if (bytes.back() == 0) return;
    const auto middle = bytes.begin() + std::ssize(bytes) / 2;
    CHECK(median(middle, bytes.end()) < 1.7 * median(bytes.begin(), middle));  // where all is kept: 2.8
}
