// SPDX-License-Identifier: GPL-3.0-or-later
#include <QCoreApplication>
#include <QDeadlineTimer>
#include <algorithm>
#include <utility>

#include "tests/support/proposals.h"
#include "tests/tools/stage.h"
#include "ui/tools/proposal_tool.h"

using namespace imomushi;

namespace {

/// A limb of 6 m along x, of radius 0.5, with an even surface but for its ends; the character "eel".
void addEel(ToolStage& stage) {
    stage.made->services().importCharacter = [](const ImportRequest&, const Progress&) -> Result<CharacterFile> {
        TriangleMesh mesh = shapes::cylinder(0.5, 6.0, 24, 30).mesh;
        mesh.vertices = Points(mesh.vertices * (Eigen::Matrix3d() << 0, 0, -1, 0, 1, 0, 1, 0, 0).finished());  // z -> x
        mesh.vertices.col(0).array() -= 3.0;
        CharacterFile file;
        file.format = "obj";
        file.renderModel.part.assign(std::size_t(mesh.triangles.rows()), 0);
        file.renderModel.parts = {"eel"};
        file.renderModel.mesh.renderMesh.triangles = mesh.triangles;
        for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v) file.renderModel.mesh.renderMesh.bodyVertex.push_back(v);
        file.renderModel.mesh.body = std::move(mesh);
        return file;
    };
    stage.run({{"do", "import-character"}, {"path", "eel.obj"}, {"name", "eel"}});
    stage.look(ViewAxis::Front);
}

const CharacterSource& eel(ToolStage& stage) { return *stage.now().characters.begin()->second; }

/// A trunk from x = -1.03 to 1.03; the right tip is pinned.
Proposal eelProposal() {
    Proposal p = trunkWithTwoLimbs(1.03, 2.8);
    p.pins = {{1, true}};
    return p;
}

Vec3 onSkin(double x) { return {x, 0.3, 0.4}; }

/// What tries the cuts says so by events.
void needEvents() {
    static int arguments = 1;
    static char name[] = "test_tools", *values[] = {name, nullptr};
    static QCoreApplication application(arguments, values);
}

/// Until it is known what the cuts do, and all that waits for it is done.
void tried(const ProposalTool& tool) {
    for (QDeadlineTimer end(60'000); tool.trying() && !end.hasExpired();) QCoreApplication::processEvents(QEventLoop::WaitForMoreEvents, 100);
    REQUIRE(!tool.trying());
}

}  // namespace

TEST_CASE("proposals: planes are dragged, turned, dropped and added before anything is done; Enter does what is shown in one step") {
    needEvents();
    ToolStage stage;
    addEel(stage);
    std::vector<Json> answers, handed;
    ProposalTool::Host host;
    host.accept = [&](const Json& command) { handed.push_back(command); };
    int changed = 0;
    host.changed = [&] { ++changed; };
    ProposalTool tool(stage.document(), eel(stage).id, eelProposal(), host);
    CHECK(tool.trying());
    tried(tool);
    CHECK(changed == 1);
    const int before = stage.steps();
    CHECK(!tool.over());
    CHECK(tool.wants(Qt::Key_Return));
    CHECK(tool.banner().contains("Enter"));

    // Along its normal, whatever the pointer does across it; the ends of bones go along.
    stage.press(tool, onSkin(1.03));
    CHECK(tool.busy());
    stage.pull(tool, onSkin(1.3));
    stage.pull(tool, onSkin(1.63) + Vec3(0, 0.1, 0));
    CHECK(tool.proposal().cuts[0].plane.origin.x() == doctest::Approx(1.63).epsilon(0.01));
    stage.letGo(tool, onSkin(1.63));
    CHECK(!tool.busy());
    const double moved = tool.proposal().cuts[0].plane.origin.x();
    CHECK(moved == doctest::Approx(1.63).epsilon(0.01));
    CHECK(tool.proposal().bones[0].end.x() == doctest::Approx(moved).epsilon(1e-6));
    CHECK(tool.proposal().bones[1].start == tool.proposal().bones[0].end);
    CHECK((tool.proposal().cuts[0].plane.normal - Vec3::UnitX()).norm() < 1e-12);
    tried(tool);
    CHECK(!tool.refused()[0].has_value());
    tool.undo();
    CHECK(tool.proposal().cuts[0].plane.origin.x() == 1.03);
    tool.redo();
    CHECK(tool.proposal().cuts[0].plane.origin.x() == moved);

    // Given up in the middle, nothing happens. Beyond the end of the limb it does not cut, which is said.
    stage.press(tool, onSkin(moved));
    stage.pull(tool, onSkin(2.2));
    tool.cancel();
    CHECK(tool.proposal().cuts[0].plane.origin.x() == moved);
    stage.press(tool, onSkin(moved));
    stage.pull(tool, onSkin(2.5));
    stage.pull(tool, onSkin(3.4));
    stage.letGo(tool, onSkin(3.4));
    CHECK(tool.trying());  // the window goes on
    CHECK(stage.refusals.empty());
    tried(tool);
    CHECK(tool.refused()[0].has_value());
    CHECK(stage.refusals.size() == 1);
    tool.undo();
    tried(tool);
    CHECK(!tool.refused()[0].has_value());

    // With Ctrl it turns.
    stage.press(tool, onSkin(moved), Qt::ControlModifier);
    stage.pull(tool, onSkin(moved) + Vec3(0, 0.15, 0), Qt::ControlModifier);
    stage.letGo(tool, onSkin(moved));
    CHECK(tool.proposal().cuts[0].plane.normal.y() > 0.1);
    tried(tool);
    CHECK(!tool.refused()[0].has_value());
    tool.undo();

    stage.hover(tool, onSkin(-1.03));
    CHECK(tool.key(Qt::Key_Delete, {}));
    REQUIRE(tool.proposal().cuts.size() == 1);
    CHECK(tool.proposal().bones[2].piece == -1);

    // A click while others are tried waits for them, and so does Enter.
    stage.click(tool, onSkin(-1.72));
    CHECK(tool.trying());
    CHECK(tool.proposal().cuts.size() == 1);
    CHECK(tool.key(Qt::Key_Return, {}));
    CHECK(!tool.handedOver());
    tried(tool);
    REQUIRE(tool.proposal().cuts.size() == 2);
    const CutPlane added = tool.proposal().cuts[1].plane;
    CHECK(added.normal.x() < -0.99);
    CHECK(added.origin.x() == doctest::Approx(-1.72).epsilon(0.03));
    REQUIRE(tool.proposal().bones.size() == 4);  // the bone there is divided
    CHECK(tool.proposal().bones[3].piece == 1);

    // Nothing happened to the document until now.
    CHECK(stage.steps() == before);
    CHECK(eel(stage).cuts.empty());
    // What is handed over does not change, unless it is handed back.
    REQUIRE(handed.size() == 1);
    CHECK(tool.handedOver());
    stage.click(tool, onSkin(0.2));
    tool.undo();
    CHECK(tool.key(Qt::Key_Delete, {}));
    CHECK(tool.key(Qt::Key_Return, {}));
    CHECK(!tool.trying());
    CHECK(tool.proposal().cuts.size() == 2);
    CHECK(handed.size() == 1);
    tool.handBack();
    CHECK(!tool.over());
    CHECK(tool.key(Qt::Key_Return, {}));
    REQUIRE(handed.size() == 2);
    CHECK(handed[0] == handed[1]);
    const auto answer = stage.document().execute(handed[1]);
    REQUIRE(answer.has_value());
    answers.push_back(*answer);
    CHECK(tool.over());
    CHECK(answers[0]["refused"] == Json::array());
    CHECK(stage.steps() == before + 1);
    REQUIRE(eel(stage).cuts.size() == 2);
    CHECK(eel(stage).cuts[0].plane.origin.x() == doctest::Approx(moved));
    CHECK(eel(stage).cuts[1].plane.origin.x() == doctest::Approx(added.origin.x()));
    CHECK(stage.now().elements.size() == 3);
    CHECK(stage.now().bones.size() == 4);
    CHECK(stage.session().steps().back().name == "make-soft");
    stage.run({{"do", "undo"}});
    CHECK(eel(stage).cuts.empty());
    CHECK(stage.now().bones.empty());
}

TEST_CASE("proposals: joints are dragged and pinned, bones added and dropped, and Esc leaves everything as it is") {
    needEvents();
    ToolStage stage;
    addEel(stage);
    ProposalTool tool(stage.document(), eel(stage).id, eelProposal(), {});
    const int before = stage.steps();
    stage.click(tool, Vec3(-2.8, 0, 0));
    CHECK(isPinned(tool.proposal(), {2, true}));
    stage.click(tool, Vec3(-2.8, 0, 0));
    CHECK(!isPinned(tool.proposal(), {2, true}));
    stage.press(tool, Vec3(-2.8, 0, 0));
    stage.pull(tool, Vec3(-2.6, 0.1, 0));
    stage.pull(tool, Vec3(-2.5, 0.2, 0));
    stage.letGo(tool, Vec3(-2.5, 0.2, 0));
    CHECK((tool.proposal().bones[2].end - Vec3(-2.5, 0.2, 0)).norm() < 0.01);
    // The joint on a plane takes the plane along.
    stage.press(tool, Vec3(1.03, 0, 0));
    stage.pull(tool, Vec3(1.2, 0, 0));
    stage.pull(tool, Vec3(1.4, 0, 0));
    stage.letGo(tool, Vec3(1.4, 0, 0));
    CHECK(tool.proposal().cuts[0].plane.origin.x() == doctest::Approx(1.4).epsilon(0.01));
    // A bone from the middle of the trunk's start to the middle of the flesh elsewhere.
    stage.press(tool, Vec3(-1.03, 0, 0), Qt::ShiftModifier);
    stage.pull(tool, Vec3(-0.5, 0.3, 0), Qt::ShiftModifier);
    stage.pull(tool, Vec3(0.2, 0.3, 0), Qt::ShiftModifier);
    stage.letGo(tool, Vec3(0.2, 0.3, 0));
    tried(tool);  // which flesh it runs through
    REQUIRE(tool.proposal().bones.size() == 4);
    CHECK(tool.proposal().bones[3].parent == 0);
    CHECK(tool.proposal().bones[3].fromParentStart);
    CHECK(tool.proposal().bones[3].piece == -1);
    CHECK((tool.proposal().bones[3].end - Vec3(0.2, 0.3, 0)).norm() < 0.05);
    CHECK(checkProposal(tool.proposal()).has_value());
    // It is selected, so that Delete drops it.
    stage.hover(tool, Vec3(0, 5, 0));
    CHECK(tool.key(Qt::Key_Delete, {}));
    CHECK(tool.proposal().bones.size() == 3);
    for (int k = 0; k < 9; ++k) tool.undo();
    CHECK(tool.proposal().bones[2].end == Vec3(-2.8, 0, 0));
    CHECK(tool.proposal().pins.size() == 1);
    CHECK(tool.key(Qt::Key_Escape, {}));
    CHECK(tool.over());
    CHECK(tool.dropped());
    CHECK(!tool.wants(Qt::Key_Return));
    CHECK(stage.steps() == before);
    CHECK(stage.refusals.empty());
    // What it was for is gone: it ends by itself.
    ProposalTool other(stage.document(), eel(stage).id, eelProposal(), {});
    stage.run({{"do", "undo"}});
    CHECK(other.over());
    CHECK(!other.dropped());
    CHECK(!other.key(Qt::Key_Return, {}));
}

TEST_CASE("proposals: on a shape that mirrors itself the other side follows, until X switches that off") {
    needEvents();
    ToolStage stage;
    addEel(stage);
    Proposal p = eelProposal();
    p.pins = {};
    p.symmetry = CutPlane{Vec3::Zero(), Vec3::UnitX()};
    ProposalTool tool(stage.document(), eel(stage).id, p, {});
    const auto drag = [&](double from, double to) {
        stage.press(tool, onSkin(from));
        stage.pull(tool, onSkin(0.5 * (from + to)));
        stage.pull(tool, onSkin(to));
        stage.letGo(tool, onSkin(to));
    };
    drag(1.03, 1.6);
    CHECK(tool.proposal().cuts[0].plane.origin.x() == doctest::Approx(1.6).epsilon(0.01));
    CHECK(mirrorError(tool.proposal()) <= kMirrored);
    // One click adds two planes, and Delete drops two.
    stage.click(tool, onSkin(-2.2));
    tried(tool);
    CHECK(tool.proposal().cuts.size() == 4);
    CHECK(tool.proposal().bones.size() == 5);
    CHECK(mirrorError(tool.proposal()) <= kMirrored);
    for (const auto& why : tool.refused()) CHECK(!why.has_value());
    CHECK(tool.key(Qt::Key_Delete, {}));
    CHECK(tool.proposal().cuts.size() == 2);
    CHECK(mirrorError(tool.proposal()) <= kMirrored);
    stage.click(tool, Vec3(-2.8, 0, 0));
    CHECK(tool.proposal().pins.size() == 2);
    CHECK(mirrorError(tool.proposal()) <= kMirrored);
    CHECK(tool.wants(Qt::Key_X));
    CHECK(tool.key(Qt::Key_X, {}));
    const double left = tool.proposal().cuts[1].plane.origin.x();
    drag(1.6, 1.3);
    CHECK(tool.proposal().cuts[0].plane.origin.x() == doctest::Approx(1.3).epsilon(0.01));
    CHECK(tool.proposal().cuts[1].plane.origin.x() == left);
    CHECK(!ProposalTool(stage.document(), eel(stage).id, eelProposal(), {}).wants(Qt::Key_X));
    CHECK(stage.refusals.empty());
}
