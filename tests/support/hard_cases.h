// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/reduction/element_response.h"

/// What is hard for elasticity, each case written once: a test checks its expectation, a benchmark times it, and the maker
/// (tests/stability/maker) leaves it as a project that the studio opens.
namespace imomushi {

/// An answer to be judged, with what was asked.
struct SolvedElement {
    const ResponseInput& input;
    const ElementResponse& response;
};

/// A bound on an error that is known without another solver.
struct HardCheck {
    std::string what;    ///< what is compared, e.g. "stretch"
    double bound = 0.0;  ///< largest relative error
    std::string why;     ///< why the error must stay below the bound
    std::function<Result<double>(const SolvedElement&)> error;
    /// The bound with the solver mesh "default" where it is another than with "as-is", and why; 0: the same.
    double boundByDefault = 0.0;
    std::string whyByDefault;
};

struct HardFace {
    std::string name;
    /// Where nothing else is given: the plane through `origin` with this outward normal, chosen as "add-joint-face" does.
    Vec3 origin = Vec3::Zero(), normal = Vec3::Zero();
    std::vector<std::int32_t> vertices;  ///< body vertices; empty: by plane
};

struct HardElement {
    std::string name;
    TriangleMesh mesh;  ///< as a file would give it
    std::vector<HardFace> faces;
    double nu = 0.3;
    double stiffness = 1.0;
    std::vector<HardCheck> checks;
};

struct HardBone {
    std::string name, element;
    std::variant<std::string, Vec3> from, to;  ///< "element/face", "bone/end" or a point
};

struct HardCase {
    std::string name;  ///< also of its files
    std::string hard;  ///< what is hard about it
    std::vector<HardElement> elements;
    std::vector<std::pair<std::string, std::string>> joins;  ///< "element/face" each
    std::vector<HardBone> bones;
    /// The endpoint that is dragged, and by how much (m).
    std::string endpoint;
    Vec3 drag = Vec3::Zero();

    /// A refusal that is expected: of the command of that name, with that code. No command: none, the case is solved and `checks` hold.
    struct Refusal {
        std::string command, code;
        std::string why;
    };
    Refusal refusal;
    /// Solving within the bounds is as good as the refusal: the case lies where double precision ends.
    bool orSolved = false;
};

/// All of them, always in the same order.
const std::vector<HardCase>& hardCases();
/// The case of that name; there must be one.
const HardCase& hardCase(const std::string& name);

/// The joint face as "add-joint-face" makes it (tolerance as there). Errors: those of jointFaceByPlane and jointFaceByVertices.
Result<JointFace> makeFace(const TriangleMesh& mesh, const HardFace& face);
/// What a precompute of the element takes, without import and document: for benchmarks and comparisons. Errors: those of makeFace().
Result<ResponseInput> responseInput(const HardElement& element);

/// The joint parameters of all faces for the displacement u(x) = gradient (x - centre) + shift, exact for the basis "affine".
Eigen::VectorXd parametersOf(const SolvedElement& solved, const Eigen::Matrix3d& gradient, const Vec3& centre, const Vec3& shift);

}  // namespace imomushi
