// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>
#include <random>

#include "tests/document/tamper.h"
#include "tests/document/workbench.h"
#include "tests/support/thorough.h"

using namespace imomushi;

namespace {

std::string openCode(const std::filesystem::path& path) {
    const auto project = openProject(path);
    return project ? "ok" : project.error().code;
}

/// A chain with a response, a held and pinned pose, a material and a texture.
void richDocument(Workbench& w) {
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.4, 0.2, 5.5}}, {"roll", 0.25}});
    w.good({{"do", "set"}, {"target", "A"}, {"property", "color"}, {"value", "#123456"}});
    w.good({{"do", "add-bone"}, {"name", "c"}, {"from", "b/end"}, {"to", {0, 1, 7}}});
    w.good({{"do", "set"}, {"target", "c"}, {"property", "visible"}, {"value", false}});
    w.good({{"do", "set"}, {"target", "A/in"}, {"property", "locked"}, {"value", true}});
    Project project = w.session.project();
    Document& document = project.document;
    auto element = std::make_shared<Element>(*document.elements.begin()->second);
    auto mesh = std::make_shared<ElementMesh>(*element->mesh);
    mesh->renderMesh.normals.setRandom(mesh->body.vertices.rows(), 3);
    mesh->renderMesh.texCoords.setRandom(mesh->body.vertices.rows(), 2);
    mesh->renderMesh.material.assign(static_cast<std::size_t>(mesh->body.triangles.rows()), 0);
    mesh->renderMesh.materials.push_back({"うろこ", {0.1f, 0.2f, 0.3f, 1.0f}, 0.5f, 0.25f, 0});
    mesh->renderMesh.textures.push_back({"scales", "image/png", {1, 2, 3, 0, 255}});
    element->mesh = mesh;
    element->issues.push_back({Severity::Info, "unwelded", "Vertices were welded.", 3, true, {0, 1}, {2}});
    document.elements[element->id] = element;
    const auto path = Workbench::folder() / "rich.imomushi";
    REQUIRE(saveProject(path, project));
    w.good({{"do", "open"}, {"path", path.string()}});
    // From here on the document is compared with itself: nothing may be missing by now.
    const Element& opened = *w.session.document().elements.at(element->id);
    const RenderMesh &made = mesh->renderMesh, &read = opened.mesh->renderMesh;
    REQUIRE(read.normals == made.normals);
    REQUIRE(read.texCoords == made.texCoords);
    REQUIRE(read.material == made.material);
    REQUIRE(read.materials.at(0).name == made.materials[0].name);
    REQUIRE(read.textures.at(0).bytes == made.textures[0].bytes);
    REQUIRE(opened.issues.size() == element->issues.size());
    REQUIRE(opened.faces.at(static_cast<std::size_t>(opened.faceIndex("in"))).locked);
    REQUIRE(!w.session.document().boneNamed("c")->visible);
}

}  // namespace

TEST_CASE("storage: what was saved opens as it was, responses included") {
    Workbench w;
    richDocument(w);
    const auto path = Workbench::folder() / "虫 🐛.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    const std::string saved = w.content();
    const Json before = w.good({{"do", "list"}});
    const auto position = w.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}});
    Workbench other;
    const Json opened = other.good({{"do", "open"}, {"path", path.string()}});
    CHECK(opened == before);
    CHECK(opened["elements"][0]["state"] == "fresh");
    CHECK(other.content() == saved);
    CHECK(other.good({{"do", "measure"}, {"what", "position"}, {"endpoint", "b/end"}}) == position);
    CHECK(other.good({{"do", "precompute"}})["elements"][0]["cached"] == true);
    CHECK(other.session.document().elements.begin()->second->mesh->renderMesh.textures[0].bytes == std::vector<std::uint8_t>{1, 2, 3, 0, 255});
    CHECK(!other.session.modified());
    const auto second = Workbench::folder() / "again.imomushi";
    other.good({{"do", "save"}, {"path", second.string()}});
    CHECK(readFile(second) == readFile(path));
}

TEST_CASE("storage: a stale response comes back as the last one that fits") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good({{"do", "set"}, {"target", "A"}, {"property", "nu"}, {"value", 0.3}});
    const auto path = (Workbench::folder() / "stale.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    const Json opened = other.good({{"do", "open"}, {"path", path}});
    CHECK(opened["elements"][0]["state"] == "stale");
    CHECK(opened["elements"][1]["state"] == "fresh");
    CHECK(other.session.character()->input().elements[0].response != nullptr);
}

TEST_CASE("storage: a file is SQLite with our application id, and a newer version is refused without touching it") {
    Workbench w;
    w.buildChain();
    const auto path = Workbench::folder() / "newer.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    CHECK(readFile(path).substr(0, 15) == "SQLite format 3");
    CHECK(readFile(path).substr(68, 4) == "IMOM");
    sql(path, "PRAGMA user_version=99");
    const std::string bytes = readFile(path);
    const auto time = std::filesystem::last_write_time(path);
    CHECK(openCode(path) == "newer-version");
    CHECK(readFile(path) == bytes);
    CHECK(std::filesystem::last_write_time(path) == time);
    CHECK(w.code({{"do", "open"}, {"path", path.string()}}) == "newer-version");
    CHECK(w.session.document().elements.size() == 2);  // the document stays
    for (const auto& file : std::filesystem::directory_iterator(Workbench::folder()))
        CHECK(file.path().string().find("newer.imomushi-") == std::string::npos);  // no journal beside it
}

TEST_CASE("storage: what is no project is refused with a reason") {
    const auto path = Workbench::folder() / "other.imomushi";
    CHECK(openCode(Workbench::folder() / "nothing.imomushi") == "file-not-found");
    CHECK(openCode(Workbench::folder()) == "not-readable");
    Workbench::writeFile(path, "");
    CHECK(openCode(path) == "not-a-project");
    Workbench::writeFile(path, std::string(5000, 'x'));
    CHECK(openCode(path) == "not-a-project");
    std::filesystem::remove(path);
    sql(path, "CREATE TABLE t(x); INSERT INTO t VALUES (1)");
    CHECK(openCode(path) == "not-a-project");
    sql(path, "PRAGMA application_id=" + std::to_string(kProjectApplicationId) + "; PRAGMA user_version=" + std::to_string(kProjectVersion - 1));
    CHECK(openCode(path) == "before-release");
    sql(path, "PRAGMA user_version=" + std::to_string(kProjectVersion));
    CHECK(openCode(path) == "damaged");
}

TEST_CASE("storage: saving fails cleanly where nothing can be written, and the old file stays") {
    Workbench w;
    w.buildChain();
    CHECK(w.code({{"do", "save"}}) == "missing-key");
    CHECK(w.code({{"do", "save"}, {"path", "somewhere.txt"}}) == "bad-value");
    CHECK(w.code({{"do", "save"}, {"path", (Workbench::folder() / "no folder" / "a.imomushi").string()}}) == "not-writable");
    const auto folder = Workbench::folder() / "folder.imomushi";
    std::filesystem::create_directories(folder);
    CHECK(w.code({{"do", "save"}, {"path", folder.string()}}) == "not-writable");
    CHECK(w.session.path().empty());
    CHECK(w.session.modified());
}

TEST_CASE("storage: a truncated or flipped file is refused or opens as it was, and never crashes") {
    Workbench w;
    richDocument(w);
    const auto path = Workbench::folder() / "whole.imomushi", broken = Workbench::folder() / "broken.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    const std::string whole = readFile(path);
    const std::string content = w.content();
    const auto check = [&](const std::string& bytes) {
        Workbench::writeFile(broken, bytes);
        const auto project = openProject(broken);
        if (!project) return;
        Workbench other;
        other.good({{"do", "open"}, {"path", broken.string()}});
        CHECK(other.content() == content);
    };
    for (std::size_t i = 0; i < 64; ++i) check(whole.substr(0, whole.size() * i / 64));
    std::mt19937 random(7);
    for (int i = 0; i < 400; ++i) {
        std::string bytes = whole;
        // Half of the flips hit the first pages, where the structure is.
        const std::size_t at = random() % (i % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 8192));
        bytes[at] = static_cast<char>(bytes[at] ^ (1u << (random() % 8)));
        check(bytes);
    }
    for (int i = 0; i < 100; ++i) {
        std::string bytes = whole;
        for (int k = 0; k < 64; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
        check(bytes);
    }
}

TEST_CASE("storage: hostile values under a valid digest are refused one by one") {
    Workbench w;
    richDocument(w);
    const auto path = Workbench::folder() / "whole.imomushi", bad = Workbench::folder() / "bad.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    const std::string whole = readFile(path);
    const char* nan = "x'010000000000f07f010000000000f07f010000000000f07f'";  // three signalling NaN
    const std::string statements[] = {
        "UPDATE elements SET nu=0.7",
        "UPDATE elements SET nu='soft'",
        "UPDATE elements SET nu=9e999",
        "UPDATE elements SET stiffness=0.0",
        "UPDATE elements SET mesh=77",
        "UPDATE elements SET name=''",
        "UPDATE elements SET name='same'",
        "UPDATE elements SET name=x'ff'",
        "UPDATE elements SET name='gravity' WHERE id=1",
        "UPDATE elements SET color=x'0000c07f0000c07f0000c07f'",
        "UPDATE elements SET joint_planes=9",
        "UPDATE elements SET id=id+1000000",
        "DELETE FROM elements",
        "UPDATE meshes SET triangles=x'ffffffff0000000001000000'",
        "UPDATE meshes SET triangles=x''",
        "UPDATE meshes SET vertices=x'00'",
        "UPDATE meshes SET vertices=zeroblob(24)",
        std::string("UPDATE meshes SET vertices=") + nan,
        "UPDATE meshes SET render_body_vertices=x'ffffff7f'",
        "UPDATE meshes SET normals=x'0000c07f0000c07f0000c07f'",
        "UPDATE meshes SET triangle_materials=x'05000000'",
        "UPDATE materials SET texture=5",
        "UPDATE materials SET position=5",
        "UPDATE faces SET vertices=x'0500000004000000'",
        "UPDATE faces SET vertices=x''",
        "UPDATE faces SET triangles=x'ffffffff'",
        "UPDATE faces SET frame=zeroblob(96)",
        "UPDATE faces SET frame=x'00'",
        "UPDATE faces SET size=-1.0",
        "UPDATE faces SET area=0.0",
        "UPDATE faces SET name='one'",
        "UPDATE issues SET triangles=x'ffffff7f'",
        "UPDATE joint_faces SET face='nothing'",
        "UPDATE joint_faces SET element=99",
        "DELETE FROM joint_faces WHERE position=1",
        "UPDATE bones SET start_kind='odd'",
        "UPDATE bones SET start_kind='bone', start_part=id, start_name='end', end_kind='bone', end_part=id, end_name='start'",
        "UPDATE bones SET start_part=99",
        "UPDATE bones SET parent=99",
        "UPDATE bones SET element=99",
        "UPDATE bones SET max_stretch=0.5",
        "UPDATE bones SET end_kind='point', end_point=zeroblob(24), start_kind='point'",
        "UPDATE held SET bone=99",
        std::string("UPDATE held SET target=") + nan,
        "UPDATE held SET seconds=-1.0",
        "UPDATE pose SET points=x''",
        "UPDATE pose SET frames=zeroblob(length(frames))",
        "DELETE FROM pose",
        "UPDATE responses SET response=x''",
        "UPDATE responses SET bases=x'0900000001000000'",
        "UPDATE responses SET stiffness=zeroblob(8)",
        "UPDATE responses SET free_vertices=x'0500000004000000'",
        "UPDATE element_responses SET response=99",
        "UPDATE settings SET value='odd' WHERE name='basis'",
        "UPDATE settings SET value='odd' WHERE name='format'",
        "UPDATE settings SET value='1' WHERE name='next-id'",
        "UPDATE settings SET value='4x' WHERE name='threads'",
        "DELETE FROM settings",
    };
    for (const std::string& statement : statements) {
        CAPTURE(statement);
        Workbench::writeFile(bad, whole);
        sql(bad, statement);
        CHECK(openCode(bad) == "damaged");  // by the digest
        sign(bad);
        CHECK(openCode(bad) == "damaged");  // by its own rule
    }
    Workbench::writeFile(bad, whole);
    sign(bad);
    CHECK(openCode(bad) == "ok");
}

TEST_CASE("storage: a response that does not belong to its element is not used") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const auto path = Workbench::folder() / "swapped.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    // Under the key of this element another body's response: smaller by one vertex.
    sql(path, "UPDATE responses SET free_vertices=substr(free_vertices,1,length(free_vertices)-4), "
              "response=substr(response,1,length(response)-8*3*18), loads=substr(loads,1,length(loads)-8*3*4)");
    sign(path);
    Workbench other;
    other.good({{"do", "open"}, {"path", path.string()}});
    CHECK(other.session.character()->input().elements[0].response == nullptr);
    CHECK(other.good({{"do", "step"}, {"frames", 2}})["finite"] == true);
}

TEST_CASE("storage: limits, stiffness and weight of bones are in the file, and broken ones are damage") {
    Workbench w;
    w.buildChain();
    const auto path = Workbench::folder() / "bones.imomushi";
    w.good({{"do", "pin"}, {"endpoint", "a/start"}, {"orientation", true}});
    for (const auto& [property, value] : {std::pair("max-bend", 0.5), std::pair("max-twist", 2.0), std::pair("stiffness", 50.0), std::pair("weight", 3.0)})
        w.good({{"do", "set"}, {"target", "b"}, {"property", property}, {"value", value}});
    w.good({{"do", "save"}, {"path", path.string()}});
    Workbench other;
    other.good({{"do", "open"}, {"path", path.string()}});
    const Bone& bone = *other.session.document().boneNamed("b");
    CHECK(bone.maxBend == 0.5);
    CHECK(bone.maxTwist == 2.0);
    CHECK(bone.stiffness == 50.0);
    CHECK(bone.weight == 3.0);
    CHECK(other.session.document().boneNamed("a")->maxBend == Skeleton::Bone::kFreeBend);
    CHECK(other.session.document().goals == w.session.document().goals);
    CHECK(other.content() == w.content());
    for (const char* bad : {"bones SET max_bend=4", "bones SET max_twist=-1", "bones SET stiffness=0", "bones SET weight=1e9", "held SET turn=zeroblob(32)", "held SET turn=zeroblob(8)"}) {
        CAPTURE(bad);
        const auto copy = Workbench::folder() / "bad.imomushi";
        std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);
        sql(copy, std::string("UPDATE ") + bad);
        sign(copy);
        CHECK(openCode(copy) == "damaged");
    }
}

TEST_CASE("storage: of a file from the future what is unknown stays, or is told where saving drops it") {
    Workbench w;
    w.buildChain();
    const auto path = Workbench::folder() / "future.imomushi", again = Workbench::folder() / "kept.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    sql(path, "INSERT INTO effects VALUES ('wind', 2); INSERT INTO effect_settings VALUES ('wind', 'speed', 3.5, 0.0, 0.0); INSERT INTO effect_elements VALUES ('wind', 1)");
    sql(path, "INSERT INTO effect_settings VALUES ('gravity', 'tides', 1.0, 2.0, 3.0); INSERT INTO settings VALUES ('palette', '朝')");
    CHECK(openCode(path) == "damaged");  // unknown rows are under the digest, too
    sign(path);
    {
        Workbench other;
        const Json opened = other.good({{"do", "open"}, {"path", path.string()}});
        CHECK(opened["unknown"] == Json::array({"wind", "gravity/tides", "palette"}));
        CHECK(!opened.contains("dropped"));
        CHECK(other.session.path() == path);
        CHECK(!other.session.modified());
        other.good({{"do", "rename"}, {"target", "a"}, {"name", "z"}});
        other.good({{"do", "save"}, {"path", again.string()}});
        const std::string bytes = readFile(again);
        Database db(std::as_bytes(std::span(bytes)));
        CHECK(db.number("SELECT enabled FROM effects WHERE effect='wind'") == 2);
        CHECK(db.number("SELECT 2*x FROM effect_settings WHERE effect='wind' AND property='speed'") == 7);
        CHECK(db.number("SELECT element FROM effect_elements WHERE effect='wind'") == 1);
        CHECK(db.number("SELECT z FROM effect_settings WHERE property='tides'") == 3);
        CHECK(db.number("SELECT count(*) FROM settings WHERE name='palette' AND value='朝'") == 1);
        // An element that is gone takes its row along.
        other.good({{"do", "remove-element"}, {"name", "A"}});
        other.good({{"do", "save"}});
        CHECK(Workbench().good({{"do", "open"}, {"path", again.string()}})["unknown"] == opened["unknown"]);
    }
    sql(path, "CREATE TABLE clouds (id INTEGER PRIMARY KEY, height REAL); INSERT INTO clouds VALUES (1, 2.0); CREATE VIEW skies AS SELECT * FROM clouds");
    sign(path);
    {
        Workbench other;
        const Json opened = other.good({{"do", "open"}, {"path", path.string()}});
        CHECK(opened["dropped"] == Json::array({"clouds", "skies"}));
        CHECK(other.session.path().empty());
        CHECK(other.session.modified());
        CHECK(other.code({{"do", "save"}}) == "missing-key");
        other.good({{"do", "save"}, {"path", again.string()}});
        CHECK(!Workbench().good({{"do", "open"}, {"path", again.string()}}).contains("dropped"));
    }
    sql(path, "UPDATE clouds SET height=3.0");
    CHECK(openCode(path) == "damaged");
}

TEST_CASE("storage: a schema that is not ours is damage, and never runs") {
    Workbench w;
    richDocument(w);
    const auto path = Workbench::folder() / "whole.imomushi", bad = Workbench::folder() / "schema.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    const std::string whole = readFile(path);
    // A view that answers another size each time that it is asked is how a copy without a bound writes past its end.
    const std::string twice = "SELECT element, position, severity, code, text, count, fixed, "
                              "CAST(CASE WHEN random()%2 THEN zeroblob(1000000) ELSE x'' END AS BLOB) AS triangles, vertices FROM old";
    for (const std::string& statement : {
             "ALTER TABLE issues RENAME TO old; CREATE VIEW issues AS " + twice,
             std::string("ALTER TABLE elements RENAME TO old; CREATE VIEW elements AS SELECT * FROM old"),
             std::string("DROP TABLE held"),
             std::string("ALTER TABLE elements ADD COLUMN more INTEGER"),
             std::string("ALTER TABLE elements ADD COLUMN more GENERATED ALWAYS AS (zeroblob(100000000))"),
             std::string("DROP TABLE pose; CREATE TABLE pose (points BLOB GENERATED ALWAYS AS (zeroblob(24)), frames BLOB, rolls BLOB)"),
             std::string("DROP TABLE pose; CREATE TABLE pose (points, frames, rolls)"),
             std::string("DROP TABLE joints; CREATE TABLE joints (id INTEGER PRIMARY KEY) WITHOUT ROWID"),
             std::string("DROP TABLE value_parts; CREATE VIEW value_parts AS SELECT 1 AS value, 0 AS position, 8 AS total, zeroblob(9000000) AS bytes"),
             std::string("DROP TABLE info; CREATE VIEW info AS SELECT 'digest' AS name, 'x' AS value"),
         }) {
        CAPTURE(statement);
        Workbench::writeFile(bad, whole);
        sql(bad, statement);
        CHECK(openCode(bad) == "damaged");
        if (statement.find("info") == std::string::npos && statement.find("ROWID") == std::string::npos) sign(bad);
        CHECK(openCode(bad) == "damaged");
    }
    // What is only there besides does nothing.
    Workbench::writeFile(bad, whole);
    sql(bad, "CREATE TRIGGER t AFTER UPDATE ON elements BEGIN DELETE FROM elements; END; CREATE VIEW v AS SELECT random() FROM elements");
    sign(bad);
    CHECK(openProject(bad).value().dropped == std::vector<std::string>{"t", "v"});
}

TEST_CASE("storage: schemas and values changed at random under a valid digest are refused or open, and never crash") {
    Workbench w;
    richDocument(w);
    const auto path = Workbench::folder() / "whole.imomushi", bad = Workbench::folder() / "random.imomushi";
    w.good({{"do", "save"}, {"path", path.string()}});
    const std::string whole = readFile(path);
    std::vector<std::pair<std::string, std::string>> columns;  // table and column
    {
        Database db(std::as_bytes(std::span(whole)));
        for (const std::string& table : db.tables()) {
            RowReader rows(db, ("SELECT name FROM pragma_table_info('" + table + "')").c_str());
            while (rows.next()) columns.emplace_back(table, rows.text());
        }
    }
    std::mt19937 random(11);
    const auto any = [&](const auto& of) { return of[random() % std::size(of)]; };
    const char* values[] = {"NULL", "0", "-1", "9223372036854775807", "1e308", "-0.0", "'text'", "x''", "x'ff'", "zeroblob(100000)", "randomblob(24)", "randomblob(96)", "1<<33", "0.5"};
    for (int i = 0; i < repeats(250, 20'000); ++i) {
        Workbench::writeFile(bad, whole);
        const auto [table, column] = any(columns);
        const std::string value = any(values);
        std::string statement;
        switch (random() % 6) {
            case 0: statement = "ALTER TABLE " + table + " RENAME TO old; CREATE VIEW " + table + " AS SELECT * FROM old"; break;
            case 1: statement = "CREATE TRIGGER t BEFORE INSERT ON " + table + " BEGIN SELECT RAISE(ABORT, 'no'); END"; break;
            case 2: statement = "ALTER TABLE " + table + " ADD COLUMN more GENERATED ALWAYS AS (" + value + ")"; break;
            case 3: statement = "CREATE INDEX i ON " + table + " (" + column + ")"; break;
            default: statement = "UPDATE OR IGNORE " + table + " SET " + column + "=" + value;
        }
        CAPTURE(statement);
        sqlite3* handle = nullptr;  // some statements are refused, for a value that is no name of ours
        REQUIRE(sqlite3_open(bad.c_str(), &handle) == SQLITE_OK);
        sqlite3_exec(handle, statement.c_str(), nullptr, nullptr, nullptr);
        sqlite3_close(handle);
        if (table != "info") sign(bad);
        const std::string code = openCode(bad);
        CHECK((code == "ok" || code == "damaged"));
        if (code == "ok") Workbench().good({{"do", "open"}, {"path", bad.string()}});
    }
}
