// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <QDir>
#include <QStandardPaths>
#include <QTemporaryDir>
#include <algorithm>
#include <random>
#include <sstream>

#include "core/project/project_file.h"
#include "tests/support/thorough.h"
#include "tests/support/victim.h"
#include "ui/window/file_flow.h"

using namespace imomushi;

TEST_CASE("killed: a studio that is killed while it keeps, saves or recovers loses nothing that it said was done, and leaves nothing behind") {
    QTemporaryDir folder;
    const std::string project = folder.filePath(QStringLiteral("work.imomushi")).toStdString();
    QString sample;
    for (const Sample& one : samples())
        if (one.name == QStringLiteral("caterpillar")) sample = one.path;
    auto opened = openProject(sample.toStdString());
    REQUIRE(opened);
    auto& elements = opened->document.elements;
    auto named = std::make_shared<Element>(*elements.begin()->second);
    named->name = "work 0";
    elements.begin()->second = named;
    REQUIRE(saveProject(project, *opened));
    QDir recovery(QStandardPaths::writableLocation(QStandardPaths::AppDataLocation) + QStringLiteral("/recovery"));
    recovery.removeRecursively();

    const std::string self = QCoreApplication::applicationFilePath().toStdString();
    std::mt19937 random(7);
    const int kills = repeats(8, 400);
    int known = 0, recoveries = 0;
    for (int kill = 0; kill <= kills; ++kill) {
        std::vector<std::string> command = {self, "victim", project};
        if (kill == kills) command.emplace_back("last");
        const Killed killed = killAfter(command, std::chrono::milliseconds(kill < kills ? random() % 1500 : 60'000), kill == kills);
        std::istringstream lines(killed.out);
        int a = 0, b = 0;
        for (std::string word; lines >> word >> a >> b;)
            if (word == "found") {
                CHECK(std::max(a, b) >= known);
                known = std::max(a, b);
                recoveries += b >= 0;
            } else {
                CHECK(a >= known);
                known = a;
            }
        CHECK(killed.ended == (kill == kills));
        if (killed.ended) CHECK(killed.status == 0);
        CHECK(killed.left == 0);
    }
    const auto end = openProject(project);
    REQUIRE(end);
    CHECK(end->document.elements.begin()->second->name == "work " + std::to_string(known));
    CHECK(recovery.entryList(QDir::Files).join(u' ').toStdString() == "");
    CHECK(QDir(folder.path()).entryList(QDir::Files).join(u' ').toStdString() == "work.imomushi work.imomushi-versions");
    MESSAGE(kills << " kills, " << known << " steps done, " << recoveries << " recoveries");
}
