// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/reduction/element_response.h"
#include "core/warp/bend_warp.h"

namespace imomushi {

/// How an element looks in a pose as its linear response shows it, A' v: what a body would not do.
struct PoseMeasures {
    double area = 1.0;    ///< smallest signed area of the watched triangles over that at rest, projected on the rest normal turned with the joint face (not, half or fully: the largest counts); 0 or less: a triangle is inverted
    double depth = 1.0;   ///< of the vertex nearest to the plane of a joint face, over that at rest: 0 or less, it crosses the plane
    double volume = 0.0;  ///< volume of A' v over the volume that the stretch of the joint faces alone would give, minus 1
    double bend = 0.0;    ///< rad, 0 ... 2 pi: the largest rotation of a joint face against the element, bend and twist together
    double crease = 0.0;  ///< rad: how far a triangle beside a joint face turns away from how the face turns
};

/// Finds these measures of one element in microseconds: from the few triangles and vertices that are the first to fold and to cross when its joint faces turn,
/// twist and are pushed, and from the volume as a quadratic form in v. What happens first elsewhere is not seen; the tests count how often.
class PoseWatch {
public:
    /// body: closed. Columns of responses with more than kMostColumns columns say nothing of the volume.
    static constexpr Eigen::Index kMostColumns = 128;
    static std::shared_ptr<const PoseWatch> build(const TriangleMesh& body, std::span<const JointFace> faces, const ElementResponse& response);

    /// What measure() writes while it works.
    struct Room {
        Eigen::VectorXd moves, gentle, product;
    };
    [[nodiscard]] Room room() const;
    /// v: of the element. motions: one per face, in the frame of the element. Neither allocates nor fails; finite for finite input.
    [[nodiscard]] PoseMeasures measure(const Eigen::VectorXd& v, std::span<const FaceMotion> motions, Room& room) const;

    /// Joint faces turn, move and stretch so little that nothing is called for: no need to measure. Some hundred nanoseconds.
    [[nodiscard]] bool isCalm(std::span<const FaceMotion> motions) const;

    /// A joint face turns so far that all of the bend warp is called for, whatever the other measures are.
    [[nodiscard]] static bool isBent(std::span<const FaceMotion> motions);
    /// 0 ... 1, smooth in the measures: how much of the bend warp a pose calls for. All of it before anything folds or the volume is off by 2 %.
    static double callForWarp(const PoseMeasures& measures);

private:
    struct Triangle {
        std::array<int, 3> corner{};  // samples
        int face = 0;                 // with which it turns
        Vec3 normal = Vec3::UnitZ();  // at rest
        double area = 1.0;            // twice, at rest, m^2
    };
    struct Depth {
        int sample = 0, face = 0;
        double rest = 1.0;  // m
    };
    friend class PoseWatchBuilder;
    // rad, and relative to the size of the face.
    [[nodiscard]] double sizeOf(const FaceMotion& motion, std::size_t face) const;
    PoseWatch() = default;

    std::vector<FaceFrame> frames_;
    std::vector<double> sizes_;             // of faces, m
    std::vector<FaceBasis> bases_;
    std::vector<int> firstColumn_;
    std::vector<Points> restOfFace_;        // vertices in the axes of the face, as coefficients() wants them
    double calm_ = 0.0;                     // motions of faces up to this size call for nothing, see sizeOf()
    std::vector<std::int32_t> samples_;     // body vertices
    Eigen::MatrixXd rows_;                  // 3 #samples x columns of v
    Points rest_;                           // #samples x 3, m
    std::vector<Triangle> triangles_, rims_;
    std::vector<Depth> depths_;
    Eigen::VectorXd volumeSlope_;           // relative, per column; empty: nothing is said of the volume
    Eigen::MatrixXd volumeCurve_;           // the same, second derivative
};

/// The watch of a body, these faces and this response, built when it is first asked for. Any thread may ask, the others wait.
class LazyPoseWatch {
public:
    [[nodiscard]] std::shared_ptr<const PoseWatch> get(const TriangleMesh& body, std::span<const JointFace> faces, const ElementResponse& response) const;
    [[nodiscard]] bool ready() const { return ready_; }

private:
    mutable std::once_flag once_;
    mutable std::shared_ptr<const PoseWatch> watch_;
    mutable std::atomic<bool> ready_{false};
};

}  // namespace imomushi
