// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/previous_model_state.h"

#include <cblas.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

constexpr double kFrame = 1.0 / 60.0;
constexpr double kDamping = 10.0;      // 1/s
// The explicit step is stable below (step * fastest frequency)^2 = 4; the damping and an estimate of the frequency want room.
constexpr double kSafeStep = 1.0;
constexpr int kPowerSteps = 40;
constexpr double kMinArea = 1e-6;    // of the mean area of a vertex: masses are areas and must not be 0

}  // namespace

void PreviousModel::State::prepare(const CharacterInput& input) {
    joints.resize(input.joints.size());
    std::vector<std::vector<std::vector<int>>> node(input.elements.size());  // per element, face, vertex of the face
    std::vector<std::vector<int>> jointOf(input.elements.size());
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        node[e].resize(input.elements[e].faces.size());
        jointOf[e].assign(input.elements[e].faces.size(), -1);
    }
    for (std::size_t j = 0; j < input.joints.size(); ++j) {
        const auto& given = input.joints[j];
        auto& out = joints[j];
        out.element = given.faces[0].element;
        for (std::size_t f = 0; f < given.faces.size(); ++f) {
            const auto& [element, face, bone] = given.faces[f];
            const auto& body = input.elements[element].mesh->body;
            const auto& patch = input.elements[element].faces[face];
            const auto& first = input.elements[given.faces[0].element].faces[given.faces[0].face];
            jointOf[element][face] = static_cast<int>(j);
            for (const auto v : patch.vertices) {
                int index = -1;
                if (f == 1)
                    for (const auto& [a, b] : given.welded)
                        if (b == v) index = static_cast<int>(std::lower_bound(first.vertices.begin(), first.vertices.end(), a) - first.vertices.begin());
                if (index < 0) {
                    index = static_cast<int>(out.nodes.size());
                    out.nodes.push_back({body.vertices.row(v).transpose()});
                    if (f == 0) out.vertices.push_back(v);
                }
                node[element][face].push_back(index);
            }
        }
    }
    elements.resize(input.elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const auto& given = input.elements[e];
        const auto& body = given.mesh->body;
        auto& out = elements[e];
        out.rest = body.vertices;
        out.stiffness = given.stiffness;
        if (body.vertices.rows() > 0) out.scale = 1.0 / std::max(1e-30, diagonalOf(body.vertices));
        for (std::size_t f = 0; f < given.faces.size(); ++f) {
            const auto& patch = given.faces[f];
            std::vector<double> area(patch.vertices.size(), 0.0);
            for (const auto t : patch.triangles) {
                const Vec3 a = body.vertices.row(body.triangles(t, 0)).transpose(), b = body.vertices.row(body.triangles(t, 1)).transpose(),
                           c = body.vertices.row(body.triangles(t, 2)).transpose();
                const double third = (b - a).cross(c - a).norm() / 6.0;
                for (int k = 0; k < 3; ++k)
                    area[std::lower_bound(patch.vertices.begin(), patch.vertices.end(), body.triangles(t, k)) - patch.vertices.begin()] += third;
            }
            for (std::size_t i = 0; i < patch.vertices.size(); ++i) {
                area[i] = std::max(area[i], kMinArea * patch.area / static_cast<double>(patch.vertices.size()));
                out.held.push_back({patch.vertices[i], jointOf[e][f], node[e][f][i], area[i], patch.frame.axes});
                joints[jointOf[e][f]].nodes[node[e][f][i]].area += area[i];
            }
        }
        if (const auto& r = given.response) {
            out.free = r->freeVertices;
            const auto rows = r->response.rows();
            out.matrix.resize(rows + r->tractions.rows(), r->columns());
            for (std::size_t i = 0; i < out.held.size(); ++i) {
                const auto column = 3 * static_cast<Eigen::Index>(i);
                const Matrix3d toFace = out.held[i].axes.transpose();
                out.matrix.topRows(rows).middleCols<3>(column) = (r->response.middleCols<3>(column) * toFace).cast<float>();
                out.matrix.bottomRows(r->tractions.rows()).middleCols<3>(column) = (r->tractions.middleCols<3>(column) * toFace).cast<float>();
            }
            out.x = Eigen::VectorXf::Zero(out.matrix.cols());
            out.y = Eigen::VectorXf::Zero(out.matrix.rows());
        } else {
            std::vector<char> onFace(static_cast<std::size_t>(body.vertices.rows()), 0);
            for (const auto& h : out.held) onFace[h.vertex] = 1;
            for (std::size_t v = 0; v < onFace.size(); ++v)
                if (!onFace[v]) out.free.push_back(static_cast<std::int32_t>(v));
        }
        const std::size_t padded = (static_cast<std::size_t>(body.vertices.rows()) / kVertexBlock + 2) * kVertexBlock;
        out.positions = AlignedBuffer<float>(3 * padded);
        out.normals = AlignedBuffer<float>(3 * padded);
        out.stencils = normalStencils(body.vertices, {body.triangles.data(), body.triangles.data() + body.triangles.size()}, out.scale);
    }
    for (auto& joint : joints) {
        for (std::size_t i = 0; i < joint.vertices.size(); ++i) joint.middle += joint.nodes[i].rest / static_cast<double>(joint.vertices.size());
        const auto n = static_cast<Eigen::Index>(joint.nodes.size());
        joint.force = Eigen::VectorXd::Zero(3 * n);
        Vec3 middle = Vec3::Zero();
        double area = 0.0;
        for (const auto& node_ : joint.nodes) middle += node_.area * node_.rest, area += node_.area;
        middle /= area;
        joint.held.resize(3 * n, 6);
        for (Eigen::Index i = 0; i < n; ++i) {
            const Vec3 r = joint.nodes[static_cast<std::size_t>(i)].rest - middle;
            joint.held.middleRows<3>(3 * i) << Matrix3d::Identity(), Vec3(0, -r.z(), r.y()), Vec3(r.z(), 0, -r.x()), Vec3(-r.y(), r.x(), 0);
        }
        Eigen::VectorXd weight(3 * n);
        for (Eigen::Index i = 0; i < n; ++i) weight.segment<3>(3 * i).setConstant(joint.nodes[static_cast<std::size_t>(i)].area);
        for (int k = 0; k < 6; ++k) {
            Eigen::VectorXd motion = joint.held.col(k);
            const double before = std::sqrt(motion.dot(weight.cwiseProduct(motion)));
            for (int twice = 0; twice < 2; ++twice)
                for (int l = 0; l < k; ++l) motion -= joint.held.col(l) * joint.held.col(l).dot(weight.cwiseProduct(motion));
            const double length = std::sqrt(motion.dot(weight.cwiseProduct(motion)));
            if (length > 1e-9 * before)
                joint.held.col(k) = motion / length;
            else
                joint.held.col(k).setZero();  // vertices in a line
        }
    }
}

// Sets `axes` of each joint: the rotation that best fits how the carrier moved the vertices of its first face (Kabsch).
void PreviousModel::State::orient() {
    for (auto& joint : joints) {
        const float* now = carrier.surface(joint.element).positions;
        const auto at = [&](std::size_t i) -> Vec3 { return Eigen::Map<const Eigen::Vector3f>(now + 3 * static_cast<std::ptrdiff_t>(joint.vertices[i])).cast<double>(); };
        Vec3 middle = Vec3::Zero();
        for (std::size_t i = 0; i < joint.vertices.size(); ++i) middle += at(i) / static_cast<double>(joint.vertices.size());
        Matrix3d along = Matrix3d::Zero();
        for (std::size_t i = 0; i < joint.vertices.size(); ++i) along += (at(i) - middle) * (joint.nodes[i].rest - joint.middle).transpose();
        const Eigen::JacobiSVD<Matrix3d> svd(along, Eigen::ComputeFullU | Eigen::ComputeFullV);
        const Matrix3d u = svd.matrixU(), v = svd.matrixV();
        joint.axes = u * Vec3(1.0, 1.0, u.determinant() * v.determinant() < 0.0 ? -1.0 : 1.0).asDiagonal() * v.transpose();
    }
}

// The largest squared angular frequency of the joint-face vertices when their masses equal their areas: the largest eigenvalue, by the power method at rest.
double PreviousModel::State::fastest() {
    std::vector<Eigen::VectorXd> w(joints.size());
    double seed = 0.5, most = 0.0, norm = 0.0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        w[j].resize(joints[j].force.size());
        for (auto& value : w[j]) value = (seed = std::fmod(seed * 997.0 + 0.1234567, 1.0)) - 0.5;  // no symmetry
        norm += w[j].squaredNorm();
    }
    for (int step = 0; step < kPowerSteps && norm > 0.0; ++step) {
        for (auto& part : w) part /= std::sqrt(norm);
        for (auto& joint : joints) joint.force.setZero();
        for (auto& e : elements) {
            for (std::size_t i = 0; i < e.held.size() && e.x.size(); ++i)
                e.x.segment<3>(3 * static_cast<Eigen::Index>(i)) = w[e.held[i].joint].segment<3>(3 * e.held[i].node).cast<float>();
            if (e.x.size() == 0) continue;
            const Eigen::VectorXf t = e.matrix.bottomRows(e.x.size()) * e.x;
            for (std::size_t i = 0; i < e.held.size(); ++i)
                joints[e.held[i].joint].force.segment<3>(3 * e.held[i].node) +=
                    e.stiffness * e.held[i].area * t.segment<3>(3 * static_cast<Eigen::Index>(i)).cast<double>();
        }
        norm = 0.0;
        for (std::size_t j = 0; j < joints.size(); ++j) {
            for (std::size_t i = 0; i < joints[j].nodes.size(); ++i)
                w[j].segment<3>(3 * static_cast<Eigen::Index>(i)) = joints[j].force.segment<3>(3 * static_cast<Eigen::Index>(i)) / joints[j].nodes[i].area;
            norm += w[j].squaredNorm();
        }
        if (step > kPowerSteps / 2) most = std::max(most, std::sqrt(norm));
    }
    return most;
}

Result<void> PreviousModel::State::weigh() {
    const double square = fastest();
    double size = 0.0;
    for (const auto& e : elements) size = std::max(size, 1.0 / e.scale);
    for (auto& joint : joints) {
        ExplicitJointDynamics::Input in;
        in.mass.resize(joint.force.size());
        for (std::size_t i = 0; i < joint.nodes.size(); ++i)
            in.mass.segment<3>(3 * static_cast<Eigen::Index>(i)).setConstant(joint.nodes[i].area * std::max(square, 1e-30) * kFrame * kFrame / kSafeStep);
        in.damping = kDamping;
        in.seconds = kFrame;
        in.size = size;
        in.held = joint.held;
        auto built = ExplicitJointDynamics::build(in);
        if (!built) return tl::unexpected(built.error());
        joint.dynamics.push_back(std::move(*built));
    }
    return {};
}

// Writes the displacements of the joint-face vertices of an element, in its rest axes, to `x`.
void PreviousModel::State::feed(std::size_t e, const Eigen::Isometry3d& frame, const float* targets) {
    auto& out = elements[e];
    const Matrix3d back = frame.linear().transpose();
    for (std::size_t i = 0; i < out.held.size(); ++i) {
        const auto& h = out.held[i];
        const auto& joint = joints[h.joint];
        const Vec3 at = Eigen::Map<const Eigen::Vector3f>(targets + 3 * static_cast<std::ptrdiff_t>(h.vertex)).cast<double>() +
                        joint.axes * joint.dynamics[0].displacement().segment<3>(3 * h.node);
        const Vec3 u = back * (at - frame.translation()) - out.rest.row(h.vertex).transpose();
        if (out.x.size()) out.x.segment<3>(3 * static_cast<Eigen::Index>(i)) = u.cast<float>();
        Eigen::Map<Eigen::Vector3f>(out.positions.data() + 3 * static_cast<std::ptrdiff_t>(h.vertex)) = at.cast<float>();
    }
}

void PreviousModel::State::place(std::size_t e, const Eigen::Isometry3d& frame) {
    auto& out = elements[e];
    const Eigen::Matrix3f turn = frame.linear().cast<float>();
    const Eigen::Vector3f shift = frame.translation().cast<float>();
    for (std::size_t i = 0; i < out.free.size(); ++i) {
        Eigen::Vector3f p = out.rest.row(out.free[i]).transpose().cast<float>();
        if (out.y.size()) p += out.y.segment<3>(3 * static_cast<Eigen::Index>(i));
        Eigen::Map<Eigen::Vector3f>(out.positions.data() + 3 * static_cast<std::ptrdiff_t>(out.free[i])) = turn * p + shift;
    }
    findNormals(out.positions.data(), out.stencils.data(), static_cast<float>(out.scale), 0, static_cast<std::size_t>(out.rest.rows()), out.normals.data());
}

// Adds the forces of the tractions on the joint-face vertices of an element.
void PreviousModel::State::pull(std::size_t e, const Eigen::Isometry3d& frame) {
    auto& out = elements[e];
    if (out.x.size() == 0) return;
    const auto first = 3 * static_cast<Eigen::Index>(out.free.size());
    for (std::size_t i = 0; i < out.held.size(); ++i) {
        const auto& h = out.held[i];
        auto& joint = joints[h.joint];
        const Vec3 t = out.y.segment<3>(first + 3 * static_cast<Eigen::Index>(i)).cast<double>();
        joint.force.segment<3>(3 * h.node) -= out.stiffness * h.area * (joint.axes.transpose() * (frame.linear() * t));
    }
}

PreviousModel::PreviousModel(std::unique_ptr<State> state) : state_(std::move(state)) {}
PreviousModel::PreviousModel(PreviousModel&&) noexcept = default;
PreviousModel& PreviousModel::operator=(PreviousModel&&) noexcept = default;
PreviousModel::~PreviousModel() = default;

Result<PreviousModel> PreviousModel::build(CharacterInput input, const Progress& progress) {
    CharacterInput rigid = input;
    rigid.threads = 1;
    std::vector<std::shared_ptr<const ElementResponse>> responses;
    for (auto& e : rigid.elements) {
        const bool full = e.response && e.response->tractions.rows() == e.response->columns() && e.response->columns() > 0;
        if (!full && !e.faces.empty())
            return fail("bad-value", "The previous model needs the tractions of every element with joint faces: precompute them in the basis \"full\".");
        if (!full) e.response = nullptr;
        responses.push_back(std::move(e.response));
        e.response = nullptr;
    }
    auto carrier = Character::build(std::move(rigid));
    if (!carrier) return tl::unexpected(carrier.error());
    if (progress.cancelled()) return fail(kCancelled, "The comparison was cancelled.");
    auto state = std::make_unique<State>(std::move(*carrier));
    for (std::size_t e = 0; e < responses.size(); ++e) input.elements[e].response = responses[e];
    state->prepare(input);
    state->responses = std::move(responses);
    openblas_set_num_threads(1);
    if (auto ok = state->weigh(); !ok) return tl::unexpected(ok.error());
    if (progress.cancelled()) return fail(kCancelled, "The comparison was cancelled.");
    return PreviousModel(std::move(state));
}

void PreviousModel::product() {
    for (auto& e : state_->elements)
        if (e.x.size())
            cblas_sgemv(CblasColMajor, CblasNoTrans, static_cast<int>(e.matrix.rows()), static_cast<int>(e.matrix.cols()), 1.0f, e.matrix.data(),
                        static_cast<int>(e.matrix.rows()), e.x.data(), 1, 0.0f, e.y.data(), 1);
}

bool PreviousModel::frame(const std::vector<IkGoal>& goals, Pose& pose) {
    State& s = *state_;
    s.carrier.solvePose(goals, pose);
    s.carrier.update(pose);
    s.orient();
    s.overhead = s.carrier.stats().productMs + s.carrier.stats().normalsMs;
    for (std::size_t e = 0; e < s.elements.size(); ++e) s.feed(e, s.carrier.frame(static_cast<int>(e)), s.carrier.surface(static_cast<int>(e)).positions);
    product();
    for (auto& joint : s.joints) joint.force.setZero();
    for (std::size_t e = 0; e < s.elements.size(); ++e) {
        s.place(e, s.carrier.frame(static_cast<int>(e)));
        s.pull(e, s.carrier.frame(static_cast<int>(e)));
    }
    bool good = true;
    for (auto& joint : s.joints)
        good = joint.dynamics[0].step(kFrame, [&joint](const Eigen::VectorXd&, Eigen::VectorXd& force) { force = joint.force; }) && good;
    return good;
}

double PreviousModel::overheadMs() const { return state_->overhead; }
const float* PreviousModel::positions(int element) const { return state_->elements[element].positions.data(); }
const float* PreviousModel::normals(int element) const { return state_->elements[element].normals.data(); }

std::size_t PreviousModel::matrixBytes() const {
    std::size_t bytes = 0;
    for (const auto& e : state_->elements) bytes += sizeof(float) * static_cast<std::size_t>(e.matrix.size());
    return bytes;
}

int PreviousModel::columns() const {
    int count = 0;
    for (const auto& e : state_->elements) count += static_cast<int>(e.matrix.cols());
    return count;
}

}  // namespace imomushi
