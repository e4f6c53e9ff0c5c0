// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

std::string savedChain() {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "record"}, {"take", "t"}, {"action", "start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1, 0.4, 5.2}}, {"seconds", 0.1}});
    w.good({{"do", "step"}, {"frames", 6}});
    w.good({{"do", "record"}, {"take", "t"}, {"action", "stop"}});
    const auto path = (Workbench::folder() / "chain.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    return path;
}

}  // namespace

TEST_CASE("append: another project comes whole, results and takes included, under names of its own, as one step") {
    const std::string path = savedChain();
    Workbench w;
    w.good({{"do", "import-element"}, {"path", "bar4"}, {"name", "A"}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"element", "A"}, {"from", {0, 0, 12}}, {"to", {0, 0, 15}}});
    const std::string before = w.content();
    const Json answer = w.good({{"do", "append"}, {"path", path}});
    CHECK(answer["elements"] == Json::array({"A 2", "B"}));
    CHECK(answer["bones"] == Json::array({"a", "b 2"}));
    CHECK(answer["takes"] == Json::array({"t"}));
    const Json list = w.good({{"do", "list"}});
    CHECK(list["elements"][1]["state"] == "fresh");
    CHECK(list["joints"] == Json::array({{"A 2/out", "B/in"}}));
    CHECK(list["bones"][2]["parent"] == "a");
    CHECK(w.session.character() != nullptr);
    w.good({{"do", "play"}, {"take", "t"}, {"time", 0.1}});
    CHECK(w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b 2/end"}})["value"] != Json::array({0, 0, 6}));
    const auto whole = (Workbench::folder() / "both.imomushi").string();
    w.good({{"do", "save"}, {"path", whole}});
    CHECK(Workbench().good({{"do", "open"}, {"path", whole}})["elements"].size() == 3);
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
}

TEST_CASE("append: an offset puts a character beside another, with its results and takes, and new names are told") {
    const std::string path = savedChain();
    Workbench w, alone;
    w.buildChain();
    const std::string before = w.content();
    const Json answer = w.good({{"do", "append"}, {"path", path}, {"offset", {4, 0.5, -0.25}}});
    CHECK(answer["elements"] == Json::array({"A 2", "B 2"}));
    CHECK(answer["renamed"][0] == Json{{"from", "A"}, {"to", "A 2"}});
    CHECK(answer["renamed"].size() == 4);  // two elements, two bones
    const Json list = w.good({{"do", "list"}});
    for (const std::size_t e : {2, 3}) CHECK(list["elements"][e]["state"] == "fresh");
    alone.good({{"do", "open"}, {"path", path}});
    const auto end = [](Workbench& bench, const char* name) {
        bench.good({{"do", "play"}, {"take", "t"}, {"time", 0.1}});
        const Json at = bench.good({{"do", "measure"}, {"what", "position"}, {"endpoint", name}})["value"];
        return Vec3(at[0], at[1], at[2]);
    };
    CHECK((end(w, "b 2/end") - end(alone, "b/end") - Vec3(4, 0.5, -0.25)).norm() < 1e-12);
    w.good({{"do", "undo"}});
    CHECK(w.content() == before);
    CHECK(w.code({{"do", "append"}, {"path", path}, {"offset", {1e9, 0, 0}}}) == "bad-value");

    // Into an empty project the take shows what was seen, elsewhere.
    Workbench empty;
    empty.good({{"do", "append"}, {"path", path}, {"offset", {4, 0.5, -0.25}}});
    CHECK(empty.good({{"do", "play"}, {"take", "t"}, {"time", 0.1}})["exact"] == true);
    alone.good({{"do", "play"}, {"take", "t"}, {"time", 0.1}});
    for (const int e : {0, 1}) {
        const Points is = empty.session.character()->positions(e), was = alone.session.character()->positions(e);
        CHECK(((is - was).rowwise() - Eigen::RowVector3d(4, 0.5, -0.25)).cwiseAbs().maxCoeff() < 1e-9);
    }
}

TEST_CASE("append: a character on top of another would be one with it, and is refused") {
    const std::string path = savedChain();
    Workbench w;
    w.buildChain();
    const std::string before = w.content();
    CHECK(w.code({{"do", "append"}, {"path", path}}) == "bone-loop");
    CHECK(w.content() == before);
}

TEST_CASE("append: beside what is there") {
    const std::string path = savedChain();
    Workbench w;
    w.buildChain();
    const Json answer = w.good({{"do", "append"}, {"path", path}, {"beside", true}});
    CHECK(answer["offset"][0].get<double>() == doctest::Approx(1.1));  // a bar is as wide as 1, and a tenth of that lies between
    CHECK(answer["elements"].size() == 2);
    CHECK(w.code({{"do", "append"}, {"path", path}, {"beside", true}, {"offset", {0, 0, 0}}}) == "bad-value");
    Workbench empty;
    CHECK(empty.good({{"do", "append"}, {"path", path}, {"beside", true}})["offset"] == Json::array({0.0, 0.0, 0.0}));
}

TEST_CASE("append: one element comes with its bone, and what it hung on is a place") {
    const std::string path = savedChain();
    Workbench w;
    const Json answer = w.good({{"do", "append"}, {"path", path}, {"elements", {"B"}}});
    CHECK(answer["elements"] == Json::array({"B"}));
    CHECK(answer["bones"] == Json::array({"b"}));
    CHECK(answer["takes"].empty());
    CHECK(w.session.document().joints.empty());
    CHECK(w.good({{"do", "measure"}, {"what", "length"}, {"bone", "b"}})["value"].get<double>() == doctest::Approx(3.0));
}

TEST_CASE("append: what is no project, or not in it, is refused and changes nothing") {
    const std::string path = savedChain();
    Workbench w;
    w.buildChain();
    const std::string before = w.content();
    CHECK(w.code({{"do", "append"}, {"path", "none.imomushi"}}) == "file-not-found");
    CHECK(w.code({{"do", "append"}, {"path", path}, {"elements", {"C"}}}) == "no-such-element");
    CHECK(w.code({{"do", "append"}, {"path", path}, {"elements", Json::array()}}) == "no-element");
    CHECK(w.code({{"do", "append"}, {"path", path}, {"elements", {1}}}) == "bad-type");
    CHECK(w.content() == before);
}
