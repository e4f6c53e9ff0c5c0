// SPDX-License-Identifier: GPL-3.0-or-later
// Two characters from one input and one pose: one evaluates its vertices, the other's are made by OpenGL and read back.
#include "ui/render/gpu_deformer.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/character/character.h"
#include "core/effects/touch_job.h"
#include "tests/character/random_characters.h"
#include "tests/render/picture.h"
#include "ui/render/offscreen.h"

using namespace imomushi;
using namespace imomushi::render;

namespace {

using Eigen::Vector3f;

// What the GPU may get wrong of positions, relative to the size of an element.
constexpr double kPositions = 1e-5;
constexpr double kEpsilon = 6e-8;  // half a step of single precision

double sizeOf(const ElementMesh& mesh) {
    return (mesh.body.vertices.colwise().maxCoeff() - mesh.body.vertices.colwise().minCoeff()).norm();
}

/// A character that the GPU deforms, beside one that does it all by itself.
class Twins {
public:
    explicit Twins(const CharacterInput& input) : here_(Character::build(input).value()), there_(Character::build(input).value()) {
        REQUIRE(context_.has_value());
        const auto ready = deformer_.prepare();
        REQUIRE_MESSAGE(ready.has_value(), (ready ? "" : ready.error().message));
        REQUIRE(deformer_.upload(there_.deformInput()));
        for (int e = 0; e < elements(); ++e)
            CHECK(there_.deformExternally(e, deformer_.supports(e)) == there_.deformInput().elements[static_cast<std::size_t>(e)].possible);
        // Joined faces are covered, as in the studio.
        covered_.resize(input.elements.size());
        for (const auto& joint : input.joints)
            for (const auto& f : joint.faces)
                if (joint.faces.size() > 1) {
                    const auto& more = input.elements[static_cast<std::size_t>(f.element)].faces[static_cast<std::size_t>(f.face)].triangles;
                    auto& all = covered_[static_cast<std::size_t>(f.element)];
                    all.insert(all.end(), more.begin(), more.end());
                }
        for (std::size_t e = 0; e < input.elements.size(); ++e) geometry_.push_back(std::make_unique<BodyGeometry>(*input.elements[e].mesh, &covered_[e]));
    }
    [[nodiscard]] int elements() const { return static_cast<int>(here_.input().elements.size()); }
    Character& here() { return here_; }
    Character& there() { return there_; }
    GpuDeformer& deformer() { return deformer_; }

    void update(const Pose& pose, double seconds = 0.0) {
        here_.update(pose, seconds);
        there_.update(pose, seconds);
        deformer_.deform(there_.deformInput());
        CHECK(glGetError() == GL_NO_ERROR);
    }

    /// Largest difference of positions, relative to what is allowed.
    double wrongPositions() {
        double worst = 0.0;
        for (int e = 0; e < elements(); ++e) {
            const auto s = here_.surface(e);
            std::vector<float> made(3 * static_cast<std::size_t>(s.vertices));
            deformer_.readBack(e, 0, s.vertices, made.data());
            double wrong = 0.0, far = 0.0;
            for (std::size_t i = 0; i < made.size(); i += 3) {
                wrong = std::max(wrong, (Eigen::Map<const Vector3f>(&made[i]) - Eigen::Map<const Vector3f>(s.positions + i)).cast<double>().norm());
                far = std::max(far, Eigen::Map<const Vector3f>(s.positions + i).cast<double>().norm());
            }
            // Both round places of the world, which may be far away.
            worst = std::max(worst, wrong / (kPositions * sizeOf(*here_.input().elements[static_cast<std::size_t>(e)].mesh) + 8 * kEpsilon * far));
            const auto& bounds = deformer_.bounds(e);
            for (std::size_t i = 0; i < made.size(); i += 3) {
                const float slack = static_cast<float>(far * 1e-5);
                CHECK((Eigen::Map<const Vector3f>(&made[i]) - bounds.conservative.min()).minCoeff() >= -slack);
                CHECK((bounds.conservative.max() - Eigen::Map<const Vector3f>(&made[i])).minCoeff() >= -slack);
            }
            lastWrong_ = std::max(lastWrong_, wrong + 2 * kEpsilon * far);
        }
        return worst;
    }

    /// Largest differences of positions and normals of render meshes, positions relative to what is allowed; normals as long as triangles are no needles.
    std::pair<double, double> wrongMeshes() {
        double positions = 0.0, normals = 0.0;
        for (int m = 0; m < static_cast<int>(here_.input().renderMeshes.size()); ++m) {
            if (!there_.deformInput().external(there_.deformInput().meshes[static_cast<std::size_t>(m)])) continue;
            const auto s = here_.renderSurface(m);
            ElementMesh mesh;
            mesh.body = {here_.renderRestPositions(m), here_.input().renderMeshes[static_cast<std::size_t>(m)]->triangles};
            BodyGeometry geometry(mesh, nullptr);
            geometry.sumNormals(s.positions);
            std::vector<float> expected(static_cast<std::size_t>(geometry.vertexCount()) * BodyGeometry::kFloats), made(expected.size());
            geometry.fill(s.positions, s.normals, expected.data());
            const GpuDeformer::Shown shown{elements() + m, nullptr};
            const Buffer buffer = makeBuffer();
            glBindBuffer(GL_ARRAY_BUFFER, buffer);
            const auto bytes = static_cast<GLsizeiptr>(made.size() * sizeof(float));
            glBufferData(GL_ARRAY_BUFFER, bytes, nullptr, GL_DYNAMIC_COPY);
            deformer_.writeDisplayVertices(shown.surface, deformer_.makeDisplayMap(shown, geometry, {}), buffer);
            glBindBuffer(GL_ARRAY_BUFFER, buffer);
            glGetBufferSubData(GL_ARRAY_BUFFER, 0, bytes, made.data());
            CHECK(glGetError() == GL_NO_ERROR);
            const double size = (mesh.body.vertices.colwise().maxCoeff() - mesh.body.vertices.colwise().minCoeff()).norm();
            const auto& bounds = deformer_.bounds(shown.surface);
            double far = 0.0;
            for (std::size_t i = 0; i < made.size(); i += BodyGeometry::kFloats) far = std::max(far, Eigen::Map<const Vector3f>(&expected[i]).cast<double>().norm());
            const auto slack = static_cast<float>(far * 1e-5);
            for (std::size_t i = 0; i < made.size(); i += BodyGeometry::kFloats) {
                const Eigen::Map<const Vector3f> a(&made[i]), b(&expected[i]);
                positions = std::max(positions, (a - b).cast<double>().norm() / (kPositions * size + 8 * kEpsilon * far));
                normals = std::max(normals, (Eigen::Map<const Vector3f>(&made[i + 3]) - Eigen::Map<const Vector3f>(&expected[i + 3])).cast<double>().norm());
                CHECK((a - bounds.conservative.min()).minCoeff() >= -slack);
                CHECK((bounds.conservative.max() - a).minCoeff() >= -slack);
            }
            Vector3f one;
            deformer_.readVertex(shown, s.vertices - 1, one.data());
            CHECK((one - Eigen::Map<const Vector3f>(s.positions + 3 * (s.vertices - 1))).cast<double>().norm() <= kPositions * size + 8 * kEpsilon * far);
            ++comparedMeshes_;
        }
        return {positions, normals};
    }
    [[nodiscard]] int comparedMeshes() const { return comparedMeshes_; }

    /// Largest difference of normals of display vertices, relative to what the differences of positions explain: a normal is made of two edges, and turns by
    /// as much as their ends move over their lengths, over the sine between them (a seam or a ring of triangles at most as much again).
    double wrongNormals() {
        double worst = 0.0;
        std::vector<std::vector<GpuDeformer::Neighbour>> neighbours(static_cast<std::size_t>(elements()));
        for (int e = 0; e < elements(); ++e) geometry_[static_cast<std::size_t>(e)]->sumNormals(here_.surface(e).positions);
        for (const auto& joint : here_.input().joints) {
            if (joint.faces.size() < 2) continue;
            const auto a = static_cast<std::size_t>(joint.faces[0].element), b = static_cast<std::size_t>(joint.faces[1].element);
            neighbours[a].push_back({geometry_[b].get(), static_cast<int>(b), joint.welded});
            neighbours[b].push_back({geometry_[a].get(), static_cast<int>(a), joint.welded});
            for (auto& [own, its] : neighbours[b].back().welded) std::swap(own, its);
            for (const auto& [va, vb] : joint.welded) {
                const int ga = geometry_[a]->seamGroup(va), gb = geometry_[b]->seamGroup(vb);
                if (ga < 0 || gb < 0) continue;
                geometry_[a]->addToNormal(ga, geometry_[b]->sum(gb));
                geometry_[b]->addToNormal(gb, geometry_[a]->sum(ga));
            }
        }
        for (int e = 0; e < elements(); ++e) {
            auto& geometry = *geometry_[static_cast<std::size_t>(e)];
            const auto count = static_cast<std::size_t>(geometry.vertexCount());
            const auto s = here_.surface(e);
            std::vector<float> expected(count * BodyGeometry::kFloats), made(expected.size());
            geometry.fill(s.positions, s.normals, expected.data());
            const Buffer buffer = makeBuffer();
            glBindBuffer(GL_ARRAY_BUFFER, buffer);
            const auto bytes = static_cast<GLsizeiptr>(made.size() * sizeof(float));
            glBufferData(GL_ARRAY_BUFFER, bytes, nullptr, GL_DYNAMIC_COPY);
            deformer_.writeDisplayVertices(e, deformer_.makeDisplayMap({e, nullptr}, geometry, neighbours[static_cast<std::size_t>(e)]), buffer);
            glBindBuffer(GL_ARRAY_BUFFER, buffer);
            glGetBufferSubData(GL_ARRAY_BUFFER, 0, bytes, made.data());
            CHECK(glGetError() == GL_NO_ERROR);
            const auto& t = geometry.triangles();
            double shortest = std::numeric_limits<double>::infinity();
            for (Eigen::Index f = 0; f < t.rows(); ++f)
                for (int c = 0; c < 3; ++c)
                    shortest = std::min(shortest, (Eigen::Map<const Vector3f>(s.positions + 3 * t(f, c)) - Eigen::Map<const Vector3f>(s.positions + 3 * t(f, (c + 1) % 3))).cast<double>().norm());
            constexpr double kMinSine = 0.15;  // of stencils
            const double allowed = 8.0 * lastWrong_ / (shortest * kMinSine) + 4 * kEpsilon;
            for (std::size_t i = 0; i < made.size(); i += BodyGeometry::kFloats) {
                const Vector3f a = Eigen::Map<const Vector3f>(&made[i + 3]), b = Eigen::Map<const Vector3f>(&expected[i + 3]);
                worst = std::max(worst, static_cast<double>((a - b).norm()) / allowed);
                largest_ = std::max(largest_, static_cast<double>((a - b).norm()));
            }
        }
        return worst;
    }
    [[nodiscard]] double largestNormal() const { return largest_; }

private:
    Result<std::unique_ptr<OffscreenContext>> context_ = OffscreenContext::create();
    Character here_, there_;
    GpuDeformer deformer_;
    std::vector<std::vector<std::int32_t>> covered_;
    std::vector<std::unique_ptr<BodyGeometry>> geometry_;
    double lastWrong_ = 0.0, largest_ = 0.0;
    int comparedMeshes_ = 0;
};

}  // namespace

TEST_CASE("gpu: vertices and normals of any character are those that the processor makes") {
    std::mt19937 random(11);
    double positions = 0.0, normals = 0.0, largest = 0.0;
    for (int kind = 0; kind < 24; ++kind) {
        CAPTURE(kind);
        Twins twins(randomCharacter(random));
        const auto& input = twins.here().input();
        Pose pose = restPose(input.skeleton);
        for (int frame = 0; frame < 4; ++frame) {
            CAPTURE(frame);
            if (frame > 0) wander(twins.here(), random, pose);
            if (input.effects.has<TouchEffect>() && frame == 2) {
                const Vec3 at = input.elements[0].mesh->body.vertices.row(0).transpose();
                for (Character* c : {&twins.here(), &twins.there()}) (void)setFinger(*c, 0, 0, at, 0.8 * at, 0.0);
            }
            twins.update(pose, 1.0 / 60.0);
            const double p = twins.wrongPositions(), n = twins.wrongNormals();
            CHECK(p <= 1.0);
            CHECK(n <= 1.0);
            positions = std::max(positions, p);
            normals = std::max(normals, n);
        }
        largest = std::max(largest, twins.largestNormal());
    }
    MESSAGE("of what is allowed: positions " << positions << ", normals " << normals << "; normals differ by " << largest << " at most");
}

TEST_CASE("gpu: render meshes over any character are those that the processor makes, attached parts and joints too") {
    std::mt19937 random(12);
    double positions = 0.0, normals = 0.0;
    int compared = 0;
    for (int kind = 0; kind < 24; ++kind) {
        CAPTURE(kind);
        CharacterInput input = randomCharacter(random);
        addRandomRenderMesh(input, random);
        Twins twins(input);
        Pose pose = restPose(input.skeleton);
        for (int frame = 0; frame < 6; ++frame) {
            CAPTURE(frame);
            if (frame > 0) wander(twins.here(), random, pose);
            for (Character* c : {&twins.here(), &twins.there()}) {
                (void)c->setTurn(0, 0, Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * frame, Vec3::UnitY())));
                (void)c->setMorph(0, 0, frame == 3 ? 0.8 : 0.0);
            }
            twins.update(pose, 1.0 / 60.0);
            const auto [p, n] = twins.wrongMeshes();
            CHECK(p <= 1.0);
            CHECK(n <= 1e-2);
            positions = std::max(positions, p);
            normals = std::max(normals, n);
        }
        compared += twins.comparedMeshes();
    }
    CHECK(compared > 60);
    MESSAGE(compared << " frames; of what is allowed: positions " << positions << "; normals differ by " << normals << " at most");
}

TEST_CASE("gpu: what does not move is neither uploaded nor made again") {
    Twins twins(caterpillar::make({}));
    Pose pose = restPose(twins.here().input().skeleton);
    twins.update(pose);
    CHECK(twins.deformer().stats().copied + twins.deformer().stats().deformed == 5);
    twins.update(pose);
    CHECK(twins.deformer().stats().deformed == 0);
    CHECK(twins.deformer().stats().copied == 0);
    CHECK(twins.deformer().stats().uploaded == 0);
    const std::uint64_t resting = twins.deformer().version(0), next = twins.deformer().version(3);
    pose.points[4] += Vec3(0, 0, 0.05);  // the joint of the last two
    twins.update(pose);
    CHECK(twins.deformer().stats().deformed == 3);  // one more shares a joint with them
    CHECK(twins.deformer().stats().copied == 0);
    CHECK(twins.deformer().stats().uploaded < 4096);
    CHECK(twins.deformer().version(0) == resting);
    CHECK(twins.deformer().version(3) > next);
    CHECK(twins.wrongPositions() <= 1.0);
}

TEST_CASE("gpu: another character is taken over, and a driver's state is left as it was") {
    Twins twins(caterpillar::make({}));
    twins.update(restPose(twins.here().input().skeleton));
    auto other = Character::build(caterpillar::make({})).value();
    CHECK(other.deformInput().id != twins.there().deformInput().id);
    REQUIRE(twins.deformer().upload(other.deformInput()));
    twins.deformer().deform(other.deformInput());
    CHECK(twins.deformer().stats().copied == 5);
    for (const GLenum binding : {GL_TEXTURE_BINDING_BUFFER, GL_VERTEX_ARRAY_BINDING, GL_ARRAY_BUFFER_BINDING, GL_CURRENT_PROGRAM, GL_TRANSFORM_FEEDBACK_BUFFER_BINDING,
                                 GL_RASTERIZER_DISCARD, GL_UNIFORM_BUFFER_BINDING}) {
        GLint value = -1;
        glGetIntegerv(binding, &value);
        CHECK(value == 0);
    }
    GLint unit = 0;
    glGetIntegerv(GL_ACTIVE_TEXTURE, &unit);
    CHECK(unit == GL_TEXTURE0);
}
