// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/flow_skeleton.h"

#include "core/body/cgal/arena.h"
// CGAL's flow collapses edges in the order of their addresses. In an arena that is the order in which they were made, so that the same body gives the same bytes.
#define CGAL_ALLOCATOR(T) imomushi::cgal::ArenaAllocator<T>

#include <CGAL/Eigen_solver_traits.h>
#include <CGAL/Mean_curvature_flow_skeletonization.h>
#include <CGAL/Polygon_mesh_processing/measure.h>

#include <cmath>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"

namespace imomushi {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Flow = CGAL::Mean_curvature_flow_skeletonization<cgal::SurfaceMesh>;

/// The flow ends when a step changes the area by less than this part of the whole, as in CGAL, or after so many steps: characters take 10 to 60.
constexpr double kSettled = 1e-4;
constexpr int kMostSteps = 200;
/// Bytes; 3,000 vertices take a tenth. What is not used is never touched.
constexpr std::size_t kArena = std::size_t(1) << 29;

}  // namespace

Result<FlowSkeleton> flowSkeleton(const TriangleMesh& mesh, double shortest, const Progress& progress) {
    const FloatingPointGuard guard;
    const cgal::Arena arena(kArena);
    const auto none = [] { return fail("no-skeleton", "The body does not shrink to lines: it has no limbs that can be told, or touches itself. Cut it by hand, or use handles."); };
    const cgal::SurfaceMesh surface = cgal::toSurfaceMesh(mesh);
    if (surface.number_of_faces() != static_cast<std::size_t>(mesh.triangles.rows()) || surface.number_of_faces() < 4 || !CGAL::is_closed(surface)) return none();
    Flow::Skeleton skeleton;
    try {
        Flow flow(surface);
        flow.set_min_edge_length(shortest * (mesh.vertices.colwise().maxCoeff() - mesh.vertices.colwise().minCoeff()).norm());
        const double whole = pmp::area(surface);
        double last = 0.0;
        for (int step = 0; step < kMostSteps; ++step) {
            if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
            flow.contract();
            const double area = pmp::area(flow.meso_skeleton());
            if (!std::isfinite(area)) return none();
            if (std::abs(area - last) < kSettled * whole) break;
            last = area;
        }
        flow.convert_to_skeleton(skeleton);
    } catch (const std::exception&) {  // CGAL's preconditions, a factorisation that failed
        return none();
    }
    FlowSkeleton out;
    for (const auto v : CGAL::make_range(boost::vertices(skeleton))) {
        const auto& p = skeleton[v].point;
        out.points.emplace_back(p.x(), p.y(), p.z());
        if (!out.points.back().allFinite()) return none();
        auto& from = out.vertices.emplace_back();
        for (const auto original : skeleton[v].vertices) from.push_back(static_cast<std::int32_t>(original));
    }
    for (const auto e : CGAL::make_range(boost::edges(skeleton)))
        out.edges.push_back({static_cast<std::int32_t>(source(e, skeleton)), static_cast<std::int32_t>(target(e, skeleton))});
    if (out.points.empty()) return none();
    return out;
}

}  // namespace imomushi
