// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/wrap.h"

#include <CGAL/alpha_wrap_3.h>

#include <array>
#include <vector>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"

namespace imomushi {
namespace {

using Kernel = cgal::Kernel;
using Point = Kernel::Point_3;
using Oracle = CGAL::Alpha_wraps_3::internal::Triangle_soup_oracle<Kernel>;
using Wrapper = CGAL::Alpha_wraps_3::internal::Alpha_wrap_3<Oracle>;

constexpr std::size_t kLook = 64;  ///< gates between looks whether it was cancelled: some milliseconds

struct Cancelled {};
struct TooLarge {};

/// CGAL's wrap with an alpha that changes from place to place: each gate is judged by that where the flood fill has just come to.
class GradedWrap : public Wrapper {
public:
    using Wrapper::Wrapper;
    void setAlpha(double alpha) {
        m_alpha = alpha;
        m_sq_alpha = alpha * alpha;
    }
};

struct Guide : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
    GradedWrap* wrap = nullptr;
    const WrapSetting* setting = nullptr;
    const Progress* progress = nullptr;
    std::size_t steps = 0;

    template <class AnyPoint>
    void goTo(const AnyPoint& p) {
        wrap->setAlpha(setting->alpha(Vec3(p.x(), p.y(), p.z())));
    }
    template <class W, class Gate>
    void before_facet_treatment(const W& w, const Gate& gate) {
        if (++steps % kLook == 0 && progress->cancelled()) throw Cancelled{};
        if (w.triangulation().number_of_vertices() > setting->mostVertices) throw TooLarge{};
        const auto& facet = gate.facet();
        double at[3] = {0.0, 0.0, 0.0};
        for (int k = 1; k < 4; ++k) {
            const auto& p = facet.first->vertex((facet.second + k) & 3)->point();
            at[0] += p.x() / 3.0, at[1] += p.y() / 3.0, at[2] += p.z() / 3.0;
        }
        goTo(Point(at[0], at[1], at[2]));
    }
    template <class W, class AnyPoint>
    void before_Steiner_point_insertion(const W&, const AnyPoint& p) {
        goTo(p);
    }
};

}  // namespace

Result<TriangleMesh> wrapTriangles(const TriangleMesh& mesh, const WrapSetting& setting, const Progress& progress) {
    const FloatingPointGuard guard;
    std::vector<Point> points;
    std::vector<std::array<std::size_t, 3>> faces;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) points.emplace_back(mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2));
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
        std::array<std::size_t, 3> face{};
        for (int k = 0; k < 3; ++k) face[static_cast<std::size_t>(k)] = static_cast<std::size_t>(mesh.triangles(f, k));
        faces.push_back(face);
    }
    cgal::SurfaceMesh surface;
    try {
        Oracle oracle(setting.coarsest, Kernel());
        oracle.add_triangle_soup(points, faces);
        GradedWrap wrap(oracle);
        Guide guide;
        guide.wrap = &wrap, guide.setting = &setting, guide.progress = &progress;
        wrap(setting.coarsest, setting.offset, surface, CGAL::parameters::visitor(std::ref(guide)));
    } catch (const Cancelled&) {
        return fail(kCancelled, "Cancelled.");
    } catch (const TooLarge&) {
        return fail("too-large", "A wrap that fine has too many vertices: choose a coarser detail.");
    } catch (const std::exception&) {  // CGAL's preconditions
        surface.clear();
    }
    if (surface.number_of_faces() == 0) return fail("no-volume", "No closed surface can be made around this mesh: close it in a modelling program.");
    return cgal::toTriangleMesh(surface);
}

}  // namespace imomushi
