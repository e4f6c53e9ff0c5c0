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

/// CGAL's wrap, which knows what alpha is from place to place.
class GradedWrap : public Wrapper {
public:
    GradedWrap(const Oracle& oracle, const WrapSetting& setting) : Wrapper(oracle), setting_(setting) {}
    [[nodiscard]] double alpha(const Vec3& at) const { return setting_.alpha(at); }

private:
    const WrapSetting& setting_;
};

/// Ends a wrap that nobody wants any more or that becomes too large.
struct Watch : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
    const WrapSetting* setting = nullptr;
    const Progress* progress = nullptr;
    std::size_t steps = 0;

    template <class AnyWrap, class Gate>
    void before_facet_treatment(const AnyWrap& wrap, const Gate&) {
        if (++steps % kLook == 0 && progress->cancelled()) throw Cancelled{};
        if (wrap.triangulation().number_of_vertices() > setting->mostVertices) throw TooLarge{};
    }
};

}  // namespace
}  // namespace imomushi

// Whether the ball fits through a facet, asked with the alpha of that place. CGAL 5.5 asks with one alpha for all.
template <>
bool imomushi::Wrapper::is_traversable(const Facet& f) const {
    imomushi::Vec3 middle = imomushi::Vec3::Zero();
    for (int k = 1; k < 4; ++k) {
        const auto& p = m_dt.point(f.first, (f.second + k) & 3);
        middle += imomushi::Vec3(p.x(), p.y(), p.z()) / 3.0;
    }
    const double alpha = static_cast<const imomushi::GradedWrap*>(this)->alpha(middle);
    return CGAL::Alpha_wraps_3::internal::less_squared_radius_of_min_empty_sphere(alpha * alpha, f, m_dt);
}

namespace imomushi {
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
        GradedWrap wrap(oracle, setting);
        Watch watch;
        watch.setting = &setting, watch.progress = &progress;
        wrap(setting.coarsest, setting.offset, surface, CGAL::parameters::visitor(std::ref(watch)));
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
