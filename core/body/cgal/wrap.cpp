// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/wrap.h"

#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"
#include "core/mesh/triangle_tree.h"

namespace imomushi {
namespace {

using Kernel = cgal::Kernel;
using Point = Kernel::Point_3;
using Soup = CGAL::Alpha_wraps_3::internal::Triangle_soup_oracle<Kernel>;

/// CGAL's triangles, their distances from a tree of doubles: they need not be exact, and CGAL's take most of the time of a wrap.
class Oracle : public Soup {
public:
    Oracle(double alpha, const TriangleMesh& mesh) : Soup(alpha, Kernel()), mesh_(mesh), near_(mesh) {
        std::vector<Point> points;
        std::vector<std::array<std::size_t, 3>> faces;
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) points.emplace_back(mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2));
        for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
            std::array<std::size_t, 3> face{};
            for (int k = 0; k < 3; ++k) face[static_cast<std::size_t>(k)] = static_cast<std::size_t>(mesh.triangles(f, k));
            faces.push_back(face);
        }
        add_triangle_soup(points, faces);
    }

    bool do_intersect(const Geom_traits::Ball_3& ball) const { return look(ball.boundary().center()).squaredDistance <= ball.boundary().squared_radius(); }
    template <class K>
    bool do_intersect(const CGAL::Alpha_wraps_3::internal::Tetrahedron_with_outside_info<K>& tetrahedron) const {
        // Nothing is in it where the nearest triangle to the place that was asked for last, its circumcenter, is farther than all of its corners.
        double reach = 0.0;
        for (int k = 0; k < 4; ++k) reach = std::max(reach, CGAL::squared_distance(tetrahedron.m_tet[k], asked_));
        return !(hit_.triangle >= 0 && hit_.squaredDistance > kRounding * reach) && Soup::do_intersect(tetrahedron);
    }
    Point closest_point(const Point& to) const {
        const TriangleTree::Hit& hit = look(to);
        if (hit.triangle < 0) return Soup::closest_point(to);
        const Vec3 p = hit.barycentric.transpose() * mesh_.vertices(mesh_.triangles.row(hit.triangle), Eigen::all);
        return {p.x(), p.y(), p.z()};
    }
    bool first_intersection(const Point& from, const Point& to, Point& at, double offset) const {
        const auto distance = [this](const Point& p) { return std::sqrt(near_.nearest({p.x(), p.y(), p.z()}).squaredDistance); };
        return CGAL::Alpha_wraps_3::internal::Offset_intersection<Geom_traits, decltype(distance)>(distance, offset, kPrecision * offset, 1).first_intersection(from, to, at);
    }

private:
    static constexpr double kPrecision = 1e-2;  ///< CGAL's
    static constexpr double kRounding = 1.0 + 1e-9;

    const TriangleTree::Hit& look(const Point& p) const {
        if (p != asked_ || hit_.triangle < 0) {
            asked_ = p;
            hit_ = near_.nearest({p.x(), p.y(), p.z()});
        }
        return hit_;
    }

    const TriangleMesh& mesh_;
    TriangleTree near_;
    mutable Point asked_ = Point(0.0, 0.0, 0.0);
    mutable TriangleTree::Hit hit_{-1, 0.0, Vec3::Zero()};
};

using Wrapper = CGAL::Alpha_wraps_3::internal::Alpha_wrap_3<Oracle>;

constexpr std::size_t kLook = 64;  ///< gates between looks whether it was cancelled: some milliseconds

struct Cancelled {};
struct TooLarge {};

/// CGAL's wrap, which knows what alpha is from place to place.
class GradedWrap : public Wrapper {
public:
    GradedWrap(const Oracle& oracle, const WrapSetting& setting) : Wrapper(oracle), setting_(setting) {}
    [[nodiscard]] const WrapSetting& setting() const { return setting_; }

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

// Whether the ball fits through a facet, asked with the alphas of that place. CGAL 5.5 asks with one alpha for all.
template <>
bool imomushi::Wrapper::is_traversable(const Facet& f) const {
    imomushi::Vec3 middle = imomushi::Vec3::Zero();
    for (int k = 1; k < 4; ++k) {
        const auto& p = m_dt.point(f.first, (f.second + k) & 3);
        middle += imomushi::Vec3(p.x(), p.y(), p.z()) / 3.0;
    }
    const imomushi::WrapSetting& setting = static_cast<const imomushi::GradedWrap*>(this)->setting();
    const auto fits = [&](double alpha) { return CGAL::Alpha_wraps_3::internal::less_squared_radius_of_min_empty_sphere(alpha * alpha, f, m_dt); };
    if (fits(setting.alpha(middle))) return true;
    if (!setting.alphaOutside || !fits(setting.alphaOutside(middle)) || !setting.outside(middle)) return false;
    // Nor may the small ball come to rest in flesh behind a slit.
    const Cell_handle beyond = f.first->neighbor(f.second);
    imomushi::Vec3 centre = imomushi::Vec3::Zero();
    for (int k = 0; k < 4; ++k) {
        const auto& p = m_dt.point(beyond, k);
        centre += imomushi::Vec3(p.x(), p.y(), p.z()) / 4.0;
    }
    return setting.outside(centre) || m_oracle.do_intersect(CGAL::Alpha_wraps_3::internal::Tetrahedron_with_outside_info<Geom_traits>(beyond, geom_traits()));
}

namespace imomushi {
Result<TriangleMesh> wrapTriangles(const TriangleMesh& mesh, const WrapSetting& setting, const Progress& progress) {
    const FloatingPointGuard guard;
    cgal::SurfaceMesh surface;
    try {
        const Oracle oracle(setting.coarsest, mesh);
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
