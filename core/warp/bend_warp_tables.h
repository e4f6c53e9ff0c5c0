// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/reduction/element_response.h"
#include "core/warp/coarse_body.h"
#include "core/warp/sparse_factor.h"
#include "core/warp/triangle_kernels.h"

// Of core/warp's own files alone.
namespace imomushi {

/// Vectors of single precision: x y z and nothing.
using Vectors = std::vector<Eigen::Vector4f, Eigen::aligned_allocator<Eigen::Vector4f>>;

/// What the bend warp of an element (bend_warp.h) reads in a frame and never changes. Lengths are in sizes of the element, positions are about the mean of its
/// faces' origins, and vertices are in the order of elimination: those that the system solves for, one of each shell that no face holds, then the held ones.
struct BendWarpTables {
    /// Of a coarse body with a carrier where the body is large. Errors: see BendWarp::build().
    static Result<std::shared_ptr<const BendWarpTables>> build(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response, double nu,
                                                               std::span<const std::int32_t> blocks, const Vec3& middle, const Progress& progress);
    /// Of the body itself, whatever its size.
    static Result<std::shared_ptr<BendWarpTables>> buildWhole(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response, double nu,
                                                              std::span<const std::int32_t> blocks, const Vec3& middle, const Progress& progress);

    int solved = 0, vertices = 0;  // of the order above
    int free = 0;                  // solved, and one of each floating shell
    double size = 1.0, nu = 0.45;
    Vec3 middle = Vec3::Zero(), origin = Vec3::Zero();  // of the element's box as given, of its faces (m)
    std::vector<JointFace> faces;
    std::vector<FaceBasis> bases;
    std::vector<int> firstColumn;
    std::vector<Points> restOfFace;  // in its axes, m
    std::vector<std::int32_t> held;  // body vertices
    std::vector<std::int32_t> indexOfHeld;
    std::vector<std::int64_t> slot;            // of free vertices: their x in `local`
    Eigen::MatrixXf response;                  // 3 free x g, in sizes
    std::vector<Eigen::MatrixXf> heldColumns;  // per face, 3 #vertices x g_f, in sizes
    Eigen::VectorXd volumeChange;              // per column, in sizes^3
    double volume = 0.0;
    Vectors rest;
    std::vector<WarpBatch> triangles;   // that count
    std::vector<SurfaceBatch> surface;  // all
    std::vector<std::int32_t> neighbors, firstNeighbor;  // of vertex i along the surface, each once: neighbors[firstNeighbor[i]] up to neighbors[firstNeighbor[i + 1]]
    std::vector<float> inflation;                      // per vertex, 0...1
    SparseFactor factor;
    struct Shell {
        std::vector<std::int32_t> vertices;
        std::vector<WarpBatch> batches;
        std::size_t triangles = 0;
    };
    std::vector<Shell> floating;  // shells without held vertices
    struct Contact {
        std::int32_t vertex;
        float depth, weight;
    };
    std::vector<std::vector<Contact>> contacts;  // per face
    std::vector<FollowBatch> follow;  // triangles in the band of a face, ascending; parts of a triangle add up to 1 at most
    std::vector<std::int32_t> indexOf;  // of each body vertex, in the order above
    std::shared_ptr<const CoarseBody::Carrier> carrier;  // null: the body itself is solved for; else all of the above is of the coarse one, but for contacts, which there are none
    double seconds = 0.0;  // wall time of build()
};

}  // namespace imomushi
