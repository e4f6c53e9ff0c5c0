// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen of a character whose clean mesh was wrapped on purpose, against the mesh itself as its body.
#include <array>
#include <cmath>
#include <cstdio>

#include "tests/document/read_character.h"
#include "tests/document/workbench.h"
#include "tests/support/left_out.h"

using namespace imomushi;
namespace fs = std::filesystem;

namespace {

constexpr int kHandles = 3;

/// A character with handles at its ends: the highest vertex, and twice the one that is farthest from those before.
struct Handled {
    Workbench w;
    std::array<Vec3, kHandles> at, origin;
    double diagonal = 0.0, stated = 0.0;
    PartId id = 0;

    Handled(const fs::path& path, const char* body) {
        w.session.services().importCharacter = readCharacter;
        w.good({{"do", "import-character"}, {"path", path}, {"name", "it"}, {"body", body}});
        id = w.session.document().characters.begin()->first;
        const Points& rest = w.session.document().characters.begin()->second->model->mesh.body.vertices;
        diagonal = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
        Eigen::Index next = 0;
        rest.col(1).maxCoeff(&next);
        Eigen::VectorXd nearest = Eigen::VectorXd::Constant(rest.rows(), 2.0 * diagonal);
        for (int h = 0; h < kHandles; ++h) {
            at[h] = rest.row(next).transpose();
            const Json made = w.good({{"do", "handle"}, {"element", "it body"}, {"name", name(h)}, {"point", {at[h].x(), at[h].y(), at[h].z()}}, {"radius", 0.035 * diagonal}});
            for (int i = 0; i < 3; ++i) origin[h][i] = made["frame"]["origin"][static_cast<std::size_t>(i)].get<double>();
            nearest = nearest.cwiseMin((rest.rowwise() - rest.row(next)).rowwise().norm());
            nearest.maxCoeff(&next);
        }
        const Json solved = w.good({{"do", "precompute"}});
        stated = solved["elements"][0].value("error_sum", solved["elements"][0]["error"].get<double>());
    }
    static std::string name(int handle) { return "h" + std::to_string(handle); }

    /// Displacements of what is seen when one handle moves along an axis by a fiftieth of the diagonal, or turns by 10 degrees about an axis through the same point of
    /// the surface; the others are held.
    Points moved(int handle, int motion) {
        w.good({{"do", "rest"}});
        const Points rest = w.session.renderPositionsOf(id);
        for (int h = 0; h < kHandles; ++h) w.good({{"do", "pin"}, {"endpoint", name(h)}});
        Vec3 to = origin[handle];
        Json drag = {{"do", "drag"}, {"endpoint", name(handle)}};
        if (motion < 3) {
            to[motion] += 0.02 * diagonal;
        } else {
            const Eigen::Quaterniond turn(Eigen::AngleAxisd(10.0 * std::acos(-1.0) / 180.0, Vec3::Unit(motion - 3)));
            to = at[handle] + turn * (to - at[handle]);
            drag["rotation"] = {turn.x(), turn.y(), turn.z(), turn.w()};
        }
        drag["to"] = {to.x(), to.y(), to.z()};
        w.good(drag);
        return w.session.renderPositionsOf(id) - rest;
    }
};

}  // namespace

TEST_CASE("wraps: a clean character that is wrapped on purpose moves as with its exact body, within 5 %, and what is stated covers it") {
    if (!fs::exists(IMOMUSHI_SHARED_MESHES)) return leaveOut("no folder " IMOMUSHI_SHARED_MESHES);
    for (const char* file : {"penguin.obj", "cat-low-resolution.obj", "scorpion_low_resolution.obj"}) {
        CAPTURE(file);
        const fs::path path = fs::path(IMOMUSHI_SHARED_MESHES) / file;
        Handled exact(path, "exact"), wrapped(path, "wrapped");
        std::array<double, 2> squares{}, largest{};  // of moves, of turns
        for (int h = 0; h < kHandles; ++h)
            for (int motion = 0; motion < 6; ++motion) {
                const Points a = exact.moved(h, motion), b = wrapped.moved(h, motion);
                const double error = (a - b).norm() / a.norm();
                const std::size_t kind = motion / 3;
                squares[kind] += error * error / (3.0 * kHandles);
                largest[kind] = std::max(largest[kind], error);
            }
        const double all = std::sqrt(0.5 * (squares[0] + squares[1]));
        std::printf("%-28s moves %.2f %% (largest %.2f), turns %.2f %% (%.2f), together %.2f %%, stated %.2f %%\n", file, 100.0 * std::sqrt(squares[0]), 100.0 * largest[0],
                    100.0 * std::sqrt(squares[1]), 100.0 * largest[1], 100.0 * all, 100.0 * wrapped.stated);
        CHECK(std::sqrt(squares[0]) <= 0.05);
        CHECK(std::sqrt(squares[1]) <= 0.05);
        CHECK(wrapped.stated >= all / 1.5);
        CHECK(wrapped.stated <= 4.0 * all);
    }
}
