// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/joint_equilibrium.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "core/base/block_cholesky.h"
#include "core/base/decompositions.h"
#include "core/base/finite.h"
#include "core/base/parallel.h"
#include "core/character/element_runtime.h"
#include "core/joints/warping.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Places of a face where its slopes are looked at.
constexpr std::size_t kMaxPlaces = 32;
// How far points lie apart for slopes, over the size of the face.
constexpr double kSlopeStep = 1e-4;

/// x near 0, below `limit` everywhere, smooth: x (1 + (x / limit)^6)^(-1/6).
double boundFactor(double x, double limit) {
    const double part = x / limit, cube = part * part * part;
    return 1.0 / std::sqrt(std::cbrt(1.0 + cube * cube));
}

}  // namespace

struct JointEquilibrium::State {
    // Free parameters of a joint: S as xx, xy, yy, then those of warping columns, all in the axes of its first face. Each is one or two entries of the
    // table of vectors, one per scalar shape x, y, phi_1 ..., that the joint's displacement is made of.
    struct JointTables {
        std::shared_ptr<const ElementMesh> mesh;  // what they are made of: of the first face
        std::vector<JointFace> face;
        int shapes = 0;
        Matrix3d axes = Matrix3d::Identity();
        Vec3 origin = Vec3::Zero(), place = Vec3::Zero();
        Warping warping;
        std::vector<Eigen::Matrix2Xd> slopes;  // per place: 2 x #shapes
    };
    struct Joint {
        std::shared_ptr<const JointTables> tables;
        Matrix3d rotation = Matrix3d::Identity(), stretch = Matrix3d::Identity();
        Eigen::Matrix3Xd table;  // 3 x (2 + #shapes), bounded, in the axes of the first face
        Eigen::Matrix3Xd turned;  // warping in rest axes
    };
    struct FaceTables {
        std::shared_ptr<const JointTables> joint;
        Matrix3d axes, fromJoint;  // of the face; from the joint's axes to those
        bool untwist = false;      // the basis "paper" leaves out twists
        int first = 0, count = 0;  // columns of the response
        MatrixXd spread;           // count x 3 (2 + #shapes): v of the face from the table, turned into its axes
        MatrixXd pull;             // 3 (2 + #shapes) x columns: mu spread^T K
    };
    struct ElementTables {
        CharacterInput::Element of;       // what they are made of, with the joints of its faces
        std::vector<FaceTables> faces;
        std::vector<MatrixXd> stiffness;  // of pairs of faces f, g <= f at f (f + 1) / 2 + g: between tables
    };
    struct Face {
        int joint = 0;
        Matrix3d rotation = Matrix3d::Identity();  // from the joint's axes to those of the face as the element moves
        VectorXd force;                            // on the table
    };
    struct Element {
        std::shared_ptr<const ElementTables> tables;  // null: it has no response
        std::vector<Face> faces;                      // as those of the tables
        VectorXd rigid, v, extra;
        bool loaded = false;
    };

    State(const CharacterInput& given, std::span<const State* const> known) : input(given) {
        modes = input.basis.kind == BasisKind::Modes ? input.basis.modes : input.basis.kind == BasisKind::Full ? BasisChoice::kMaxModes : 0;
        shapes = warpShapes(modes);
        scalars = 2 + shapes;
        terms.resize(3 * static_cast<std::size_t>(scalars));
        for (int a = 0; a < 2; ++a)
            for (int d = 0; d < 2; ++d) terms[static_cast<std::size_t>(3 * a + d)].push_back({a + d, 1.0});
        for (int i = 0; i < modes; ++i)
            for (const auto& t : warpColumn(i)) terms[static_cast<std::size_t>(3 * (2 + t.shape) + t.axis)].push_back({3 + i, t.share});
        std::vector<char> free(input.joints.size(), 0);
        for (std::size_t j = 0; j < input.joints.size(); ++j) {
            joints.push_back(buildJoint(input.joints[j], known));
            for (const auto& f : input.joints[j].faces) {
                const auto& response = input.elements[f.element].response;
                free[j] = free[j] || (response && response->columns() > 0);
            }
        }
        std::set<std::pair<int, int>> pairs;
        elements.resize(input.elements.size());
        parallelFor(hardwareThreads(), elements.size(), 1, [&](std::size_t e, std::size_t) { buildElement(static_cast<int>(e), known); });
        for (const auto& element : elements)
            for (const auto& f : element.faces)
                for (const auto& g : element.faces) pairs.emplace(f.joint, g.joint);
        std::vector<int> sizes;
        for (const char f : free) sizes.push_back(f ? 3 + modes : 0);
        system = BlockCholesky<Eigen::Dynamic>(sizes, {pairs.begin(), pairs.end()});
        for (const int size : sizes) right.emplace_back(VectorXd::Zero(size));
    }

    Joint buildJoint(const CharacterInput::Joint& joint, std::span<const State* const> known) const {
        Joint out;
        out.table = Eigen::Matrix3Xd::Zero(3, scalars);
        out.turned = Eigen::Matrix3Xd::Zero(3, shapes);
        const auto& first = input.elements[joint.faces[0].element];
        const auto& face = first.faces[joint.faces[0].face];
        const Vec3 place = joint.point >= 0 ? input.skeleton.points[joint.point] : face.frame.origin;
        for (const State* one : known)
            for (const Joint& other : one->joints)
                if (const auto& t = other.tables; t->mesh == first.mesh && t->shapes == shapes && t->place == place && sameJointFaces(t->face, {face})) {
                    out.tables = t;
                    return out;
                }
        out.tables = tablesOf(first.mesh, face, place);
        return out;
    }

    [[nodiscard]] std::shared_ptr<const JointTables> tablesOf(const std::shared_ptr<const ElementMesh>& mesh, const JointFace& face, const Vec3& place) const {
        auto made = std::make_shared<JointTables>();
        JointTables& out = *made;
        const auto& body = mesh->body;
        out.mesh = mesh;
        out.face = {face};
        out.shapes = shapes;
        out.axes = face.frame.axes;
        out.origin = face.frame.origin;
        out.place = place;
        out.warping = Warping(body, face, shapes);
        if (shapes == 0) return made;
        const std::size_t stride = face.vertices.size() / kMaxPlaces + 1;
        const double step = kSlopeStep * face.size;
        for (std::size_t i = 0; i < face.vertices.size() && step > 0.0; i += stride) {
            const Vec3 p = face.frame.toLocal(body.vertices.row(face.vertices[i]).transpose());
            VectorXd high(shapes), low(shapes);
            Eigen::Matrix2Xd slope(2, shapes);
            for (int axis = 0; axis < 2; ++axis) {
                const Vec3 along = step * Vec3::Unit(axis);
                out.warping.at(p.x() + along.x(), p.y() + along.y(), high.data());
                out.warping.at(p.x() - along.x(), p.y() - along.y(), low.data());
                slope.row(axis) = (high - low).transpose() / (2.0 * step);
            }
            out.slopes.push_back(slope);
        }
        return made;
    }

    // Scalar shapes of the joint at a rest position.
    static void scalarsAt(const JointTables& joint, const Vec3& p, double* values) {
        const Vec3 about = joint.axes.transpose() * (p - joint.place), local = joint.axes.transpose() * (p - joint.origin);
        values[0] = about.x();
        values[1] = about.y();
        joint.warping.at(local.x(), local.y(), values + 2);
    }

    void buildElement(int e, std::span<const State* const> known) {
        const auto& given = input.elements[e];
        auto& out = elements[e];
        if (!given.response || given.response->columns() == 0) return;
        out.rigid = out.v = out.extra = VectorXd::Zero(given.response->columns());
        std::vector<int> jointOf(given.faces.size(), 0);
        for (std::size_t j = 0; j < input.joints.size(); ++j)
            for (const auto& f : input.joints[j].faces)
                if (f.element == e) jointOf[f.face] = static_cast<int>(j);
        std::vector<std::shared_ptr<const JointTables>> jointTables;
        for (const int j : jointOf) {
            out.faces.push_back({j, Matrix3d::Identity(), VectorXd::Zero(3 * scalars)});
            jointTables.push_back(joints[j].tables);
        }
        for (const State* one : known)
            for (const Element& other : one->elements)
                if (!out.tables && other.tables && fits(*other.tables, given, jointTables)) out.tables = other.tables;
        if (!out.tables) out.tables = tablesOf(given, jointTables);
    }

    static bool fits(const ElementTables& tables, const CharacterInput::Element& given, const std::vector<std::shared_ptr<const JointTables>>& jointTables) {
        return tables.of.response == given.response && tables.of.mesh == given.mesh && tables.of.stiffness == given.stiffness &&
               std::ranges::equal(tables.faces, jointTables, {}, &FaceTables::joint) && sameJointFaces(tables.of.faces, given.faces);
    }

    [[nodiscard]] std::shared_ptr<const ElementTables> tablesOf(const CharacterInput::Element& given, const std::vector<std::shared_ptr<const JointTables>>& jointTables) const {
        auto made = std::make_shared<ElementTables>();
        ElementTables& out = *made;
        const auto& response = *given.response;
        out.of = given;
        for (std::size_t f = 0; f < given.faces.size(); ++f) {
            FaceTables face;
            face.joint = jointTables[f];
            face.axes = given.faces[f].frame.axes;
            face.fromJoint = face.axes.transpose() * face.joint->axes;
            face.untwist = response.bases[f].kind == BasisKind::Paper;
            face.first = response.firstColumn[f];
            face.count = response.bases[f].columns();
            face.spread = spreadOf(given.mesh->body, given.faces[f], response.bases[f], *face.joint);
            face.pull = given.stiffness * (face.spread.transpose() * response.stiffness.middleRows(face.first, face.count));
            out.faces.push_back(std::move(face));
        }
        for (std::size_t f = 0; f < out.faces.size(); ++f)
            for (std::size_t g = 0; g <= f; ++g)
                out.stiffness.emplace_back(out.faces[f].pull.middleCols(out.faces[g].first, out.faces[g].count) * out.faces[g].spread);
        return made;
    }

    // v of a face from vectors of the joint's scalar shapes, in the axes of the face. What the basis of the face cannot say is left out, the rest is
    // nearest in the mean over its area: the same polynomials on two meshes of a face agree exactly.
    [[nodiscard]] MatrixXd spreadOf(const TriangleMesh& body, const JointFace& face, const FaceBasis& basis, const JointTables& joint) const {
        MatrixXd out = MatrixXd::Zero(basis.columns(), 3 * scalars);
        VectorXd value(scalars);
        if (basis.kind == BasisKind::Full) {
            for (std::size_t i = 0; i < face.vertices.size(); ++i) {
                scalarsAt(joint, body.vertices.row(face.vertices[i]).transpose(), value.data());
                for (int a = 0; a < scalars; ++a) out.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * a) = value[a] * Matrix3d::Identity();
            }
            return out;
        }
        // Scalar shapes of the face: 1, x, y, z where it is not flat, and its warping.
        const int curved = basis.flat ? 0 : 1, warped = basis.warping.count(), own = 3 + curved + warped;
        const auto points = areaPoints(body, face);
        MatrixXd left(static_cast<Eigen::Index>(points.size()), own), right_(static_cast<Eigen::Index>(points.size()), scalars);
        VectorXd mine(own);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            const Vec3& p = points[i].local;
            mine.head<3>() << 1.0, p.x() / face.size, p.y() / face.size;
            if (curved) mine[3] = p.z() / face.size;
            basis.warping.at(p.x(), p.y(), mine.data() + 3 + curved);
            if (warped > 0) mine.tail(warped) /= face.size;
            scalarsAt(joint, face.frame.toWorld(p), value.data());
            const double weight = std::sqrt(points[i].weight / face.area);
            left.row(row) = weight * mine.transpose();
            right_.row(row) = weight * value.transpose();
        }
        MatrixXd parts = leastSquares(left, right_);
        parts.bottomRows(own - 1) /= face.size;
        for (int a = 0; a < scalars; ++a) {
            const auto add = [&](int column, int axis, double part) { out(column, 3 * a + axis) += part; };
            const double one = parts(0, a), x = parts(1, a), y = parts(2, a);
            add(0, 0, x);
            add(1, 1, 0.5 * x);
            add(3, 2, x);
            add(1, 0, 0.5 * y);
            add(2, 1, y);
            add(4, 2, y);
            add(5, 2, one);
            int next = 6;
            if (basis.kind != BasisKind::Paper) {
                add(6, 0, one);
                add(7, 1, one);
                add(8, 1, 0.5 * x);
                add(8, 0, -0.5 * y);
                next = 9;
            }
            if (curved)
                for (int axis = 0; axis < 3; ++axis) add(next + axis, axis, parts(3, a));
            for (int i = 0; i < basis.modes; ++i)
                for (const auto& t : warpColumn(i)) add(basis.plainColumns() + i, t.axis, t.share * parts(3 + curved + t.shape, a));
        }
        return out;
    }

    // ---- per frame
    void turnFaces(Element& element, const Matrix3d& rotation) {
        for (std::size_t i = 0; i < element.faces.size(); ++i) {
            Face& f = element.faces[i];
            const FaceTables& t = element.tables->faces[i];
            f.rotation.noalias() = t.axes.transpose() * (rotation.transpose() * (joints[f.joint].rotation * t.axes));
            if (t.untwist) {
                const double twist = std::atan2(f.rotation(1, 0) - f.rotation(0, 1), f.rotation(0, 0) + f.rotation(1, 1));
                const double c = std::cos(twist), s = std::sin(twist);
                const Vec3 x = c * f.rotation.col(0) - s * f.rotation.col(1), y = s * f.rotation.col(0) + c * f.rotation.col(1);
                f.rotation.col(0) = x;
                f.rotation.col(1) = y;
            }
            f.rotation = (f.rotation * t.fromJoint).eval();
        }
    }

    void addForces(Element& element) {
        for (std::size_t i = 0; i < element.faces.size(); ++i) {
            Face& f = element.faces[i];
            const FaceTables& t = element.tables->faces[i];
            f.force.noalias() = t.pull * element.rigid;
            if (element.loaded) f.force.noalias() += t.spread.transpose() * element.extra.segment(t.first, t.count);
            auto& r = right[f.joint];
            for (int a = 0; a < scalars; ++a) {
                const Vec3 force = f.rotation.transpose() * f.force.segment<3>(3 * a);
                for (int d = 0; d < 3; ++d)
                    for (const auto& [to, share] : terms[static_cast<std::size_t>(3 * a + d)]) r[to] -= share * force[d];
            }
        }
    }

    void addStiffness(const Face& f, const Face& g, const MatrixXd& between) {
        bool transposed = false;
        MatrixXd& to = system.block(f.joint, g.joint, transposed);
        const bool twice = &f != &g && f.joint == g.joint;
        for (int b = 0; b < scalars; ++b)
            for (int a = 0; a < scalars; ++a) {
                Matrix3d block;
                block.noalias() = f.rotation.transpose() * (between.block<3, 3>(3 * a, 3 * b) * g.rotation).eval();
                for (int q = 0; q < 3; ++q)
                    for (const auto& [column, columnShare] : terms[static_cast<std::size_t>(3 * b + q)])
                        for (int p = 0; p < 3; ++p)
                            for (const auto& [row, rowShare] : terms[static_cast<std::size_t>(3 * a + p)]) {
                                const double part = rowShare * columnShare * block(p, q);
                                if (transposed)
                                    to(column, row) += part;
                                else
                                    to(row, column) += part;
                                if (twice) to(column, row) += part;
                            }
            }
    }

    bool solve() {
        system.setZero();
        for (auto& r : right) r.setZero();
        for (auto& element : elements) {
            addForces(element);
            std::size_t pair = 0;
            for (std::size_t f = 0; f < element.faces.size(); ++f)
                for (std::size_t g = 0; g <= f; ++g) addStiffness(element.faces[f], element.faces[g], element.tables->stiffness[pair++]);
        }
        for (std::size_t j = 0; j < joints.size(); ++j) {
            auto diagonal = system.diagonal(static_cast<int>(j)).diagonal();
            if (diagonal.size() == 0) continue;
            const double most = diagonal.maxCoeff();
            diagonal.array() += most > 0.0 ? kMinStiffness * most : 1.0;
        }
        bool good = system.factorise();
        if (good) system.solve(right);
        for (const auto& r : right) good = good && allFinite(r);
        for (std::size_t j = 0; j < joints.size(); ++j) {
            if (!good) right[j].setZero();
            if (right[j].size() > 0) shape(joints[j], right[j]);
        }
        for (auto& element : elements) {
            if (element.faces.empty()) continue;
            element.v = element.rigid;
            for (std::size_t i = 0; i < element.faces.size(); ++i) {
                Face& f = element.faces[i];
                const FaceTables& t = element.tables->faces[i];
                const auto& table = joints[f.joint].table;
                for (int a = 0; a < scalars; ++a) f.force.segment<3>(3 * a).noalias() = f.rotation * table.col(a);
                element.v.segment(t.first, t.count).noalias() += t.spread * f.force;
            }
        }
        return good;
    }

    // Bounded shapes from free parameters.
    void shape(Joint& joint, const VectorXd& q) const {
        const double middle = 0.5 * (q[0] + q[2]), half = 0.5 * (q[0] - q[2]), radius = std::hypot(half, q[1]);
        const auto bounded = [](double x) { return x * boundFactor(x, x < 0.0 ? 1.0 - kMinStretch : kMaxStretch - 1.0); };
        const double most = bounded(middle + radius), least = bounded(middle - radius);
        // The same directions with other stretches.
        const double turn = radius > 0.0 ? 0.5 * (most - least) / radius : 0.0, mean = 0.5 * (most + least);
        joint.table.setZero();
        joint.table(0, 0) = mean + turn * half;
        joint.table(1, 0) = joint.table(0, 1) = turn * q[1];
        joint.table(1, 1) = mean - turn * half;
        Matrix3d local = Matrix3d::Identity();
        local.topLeftCorner<2, 2>() += joint.table.topLeftCorner<2, 2>();
        joint.stretch.noalias() = joint.tables->axes * local * joint.tables->axes.transpose();
        if (shapes == 0) return;
        for (int i = 0; i < modes; ++i)
            for (const auto& t : warpColumn(i)) joint.table(t.axis, 2 + t.shape) += t.share * q[3 + i];
        auto warped = joint.table.rightCols(shapes);
        double worst = 0.0;
        for (const auto& slope : joint.tables->slopes) {
            Eigen::Matrix<double, 3, 2> gradient = Eigen::Matrix<double, 3, 2>::Zero();
            for (int k = 0; k < shapes; ++k) gradient.noalias() += warped.col(k) * slope.col(k).transpose();
            const double fold = gradient.topRows<2>().squaredNorm() / (kMaxFold * kMaxFold * (1.0 + least) * (1.0 + least));
            worst = std::max(worst, fold + gradient.row(2).squaredNorm() / (kMaxSlope * kMaxSlope));
        }
        warped *= boundFactor(std::sqrt(worst), 1.0);
        joint.turned.noalias() = joint.tables->axes * warped;
    }

    [[nodiscard]] double energyOf(bool rigid) const {
        double sum = 0.0;
        for (std::size_t e = 0; e < elements.size(); ++e) {
            const auto& element = elements[e];
            if (element.faces.empty()) continue;
            const VectorXd& v = rigid ? element.rigid : element.v;
            sum += 0.5 * input.elements[e].stiffness * v.dot(input.elements[e].response->stiffness * v);
            if (element.loaded) sum += v.dot(element.extra);
        }
        return sum;
    }

    const CharacterInput& input;
    int modes = 0, shapes = 0, scalars = 2;
    struct Term {
        int parameter;
        double share;
    };
    std::vector<std::vector<Term>> terms;  // of each entry of a joint's table, column by column
    std::vector<Joint> joints;
    std::vector<Element> elements;
    BlockCholesky<Eigen::Dynamic> system;
    std::vector<VectorXd> right;  // per joint; the solution after solve()
};

JointEquilibrium::JointEquilibrium(const CharacterInput& input, std::span<const JointEquilibrium* const> known) {
    std::vector<const State*> states;
    for (const JointEquilibrium* one : known) states.push_back(one->state_.get());
    state_ = std::make_unique<State>(input, states);
}
JointEquilibrium::JointEquilibrium(JointEquilibrium&&) noexcept = default;
JointEquilibrium& JointEquilibrium::operator=(JointEquilibrium&&) noexcept = default;
JointEquilibrium::~JointEquilibrium() = default;

void JointEquilibrium::setJoint(int joint, const Matrix3d& rotation) { state_->joints[joint].rotation = rotation; }

void JointEquilibrium::setElement(int element, const Matrix3d& rotation, const VectorXd& rigid, std::span<const double> force) {
    auto& e = state_->elements[element];
    if (e.faces.empty()) return;
    state_->turnFaces(e, rotation);
    e.rigid = rigid;
    e.loaded = !force.empty();
    if (e.loaded) e.extra = state_->input.elements[element].stiffness * Eigen::Map<const VectorXd>(force.data(), static_cast<Eigen::Index>(force.size()));
}

bool JointEquilibrium::solve() { return state_->solve(); }
const Matrix3d& JointEquilibrium::stretch(int joint) const { return state_->joints[joint].stretch; }
Eigen::Ref<const Eigen::Matrix3Xd> JointEquilibrium::warping(int joint) const { return state_->joints[joint].turned; }
int JointEquilibrium::warpingShapes() const { return state_->shapes; }
void JointEquilibrium::shapes(int joint, const Vec3& rest, double* values) const {
    const auto& j = *state_->joints[joint].tables;
    const Vec3 local = j.axes.transpose() * (rest - j.origin);
    j.warping.at(local.x(), local.y(), values);
}
const VectorXd& JointEquilibrium::parameters(int element) const { return state_->elements[element].v; }
JointEquilibrium::Constants JointEquilibrium::constants() const {
    const State& s = *state_;
    Constants out;
    for (const auto& entry : s.terms) {
        auto& shares = out.entries.emplace_back();
        for (const auto& term : entry) shares.emplace_back(term.parameter, term.share);
    }
    out.parameters = 3 + s.modes;
    for (const auto& joint : s.joints) out.joints.push_back({joint.tables->axes, joint.tables->slopes});
    for (const auto& element : s.elements) {
        auto& faces = out.spread.emplace_back();
        if (!element.tables) continue;
        for (const auto& face : element.tables->faces) faces.push_back(face.spread);
    }
    return out;
}
double JointEquilibrium::energy() const { return state_->energyOf(false); }
double JointEquilibrium::rigidEnergy() const { return state_->energyOf(true); }

}  // namespace imomushi
