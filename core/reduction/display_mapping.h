// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi {

/// Carries displacements from the surface that was solved on to the vertices that are seen. Linear, so that it is applied once to all columns of A'.
///
/// A display vertex x follows the nearest point p of the solver's free surface, among triangles that face its way. With the corners x_i of
/// p's triangle, barycentric coordinates b_i, displacements u_i and displacement gradients G_i,
///
///     u(x) = sum_i b_i ( u_i + 1/2 G_i (p - x_i) + G_i (x - p) )
///
/// G_i is the mean, by area, over the free triangles around x_i. Along a triangle the gradient is that of its corners' displacements;
/// across it, that of a surface free of traction (isotropic, Poisson ratio nu, unit normal n, surface gradient G_s):
///
///     du/dn = - G_s^T n - nu / (1 - nu) tr(G_s) n
///
/// Exact for rigid motions and for constant strain without traction on the surface; the half makes it exact for quadratic
/// displacements along a flat surface, where linear interpolation errs by h^2 / 8 of the second derivative.
class DisplayMapping {
public:
    struct Input {
        const TriangleMesh* display = nullptr;
        std::span<const char> leaveOut;            ///< per display vertex: not 0 = not mapped (held by a joint face). Empty: map all
        const TriangleMesh* solver = nullptr;      ///< closed
        std::span<const std::int32_t> heldTriangles;  ///< solver triangles that are not free of traction (those of joint faces)
        int threads = 1;                           ///< changes no byte
    };
    /// Errors: "cancelled", "bad-value" (sizes, indices or numbers), "no-free-surface".
    static Result<DisplayMapping> build(const Input& input, const Progress& progress);

    /// How far the display lies from the solver's surface, over the mapped vertices.
    struct Distance {
        double largest = 0.0, rms = 0.0;  ///< in diagonals of the display's bounding box
        /// rms over the mean half thickness 2 V / A of the solver's body (the radius of a long cylinder): the order of the relative error of
        /// solving another shape than the one that is seen. Wrinkles that the solver mesh lacks cost about a third of it.
        double shape = 0.0;
    };
    [[nodiscard]] const Distance& distance() const { return distance_; }

    /// The mapped display vertices, ascending.
    [[nodiscard]] const std::vector<std::int32_t>& vertices() const { return vertices_; }

    /// What mapping gives, and what it costs. An estimate per column: the size of the terms by which u(x) goes beyond linear interpolation on
    /// the solver's triangles (first term) and by which the gradients of neighbouring triangles disagree over the distance x - p
    /// (second). The solver's own error is not in it, nor that
    /// of solving another shape (Distance::shape).
    struct Mapped {
        Eigen::MatrixXd displacement;  ///< 3 * #vertices() x g, xyz per vertex
        Eigen::VectorXd error;         ///< g: estimate, 2-norm over the mapped vertices relative to that of the column's displacement
        Eigen::VectorXd largestError;  ///< g: estimate, largest over the vertices, in units of the column's displacement
    };
    /// `displacement`: 3 * #solver vertices x g, xyz per vertex, held ones included. nu: 0...0.5. Errors: "cancelled", "bad-value".
    [[nodiscard]] Result<Mapped> apply(const Eigen::MatrixXd& displacement, double nu, int threads, const Progress& progress) const;

    [[nodiscard]] std::size_t bytes() const;

private:
    struct Place {
        Vec3 barycentric;  ///< of p
        Vec3 offset;       ///< x - p, m
        std::int32_t triangle = 0;
    };
    std::vector<std::int32_t> vertices_;
    std::vector<Place> places_;  ///< of vertices_
    TriangleMesh solver_;
    std::vector<char> free_;             ///< per solver triangle
    VertexCorners around_;               ///< of the free triangles, at each solver vertex
    Distance distance_;
};

}  // namespace imomushi
