// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/wrap.h"

#include <CGAL/alpha_wrap_3.h>

#include <Eigen/Geometry>
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
using Triangle = Kernel::Triangle_3;

Vec3 vec(const Point& p) { return {p.x(), p.y(), p.z()}; }

/// The convex hull of four points, for a test in doubles whether something is clearly beside it.
class Reach {
public:
    template <class Tetrahedron>
    explicit Reach(const Tetrahedron& tetrahedron) {
        std::array<Vec3, 4> p;
        for (int k = 0; k < 4; ++k) p[static_cast<std::size_t>(k)] = vec(tetrahedron[k]);
        low_ = p[0].cwiseMin(p[1]).cwiseMin(p[2]).cwiseMin(p[3]);
        high_ = p[0].cwiseMax(p[1]).cwiseMax(p[2]).cwiseMax(p[3]);
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 &a = p[(k + 1) % 4], &b = p[(k + 2) % 4], &c = p[(k + 3) % 4];
            Vec3 n = (b - a).cross(c - a).normalized();
            if (n.dot(p[k] - a) > 0.0) n = -n;
            normals_[k] = n;
            most_[k] = std::max({n.dot(p[0]), n.dot(p[1]), n.dot(p[2]), n.dot(p[3])}) + kMargin;  // over all corners: right for any direction, also that of a needle's face
        }
    }
    [[nodiscard]] bool box(const Vec3& low, const Vec3& high) const {
        if ((low.array() > high_.array()).any() || (high.array() < low_.array()).any()) return false;
        for (std::size_t k = 0; k < 4; ++k)
            if (normals_[k].cwiseProduct(low).cwiseMin(normals_[k].cwiseProduct(high)).sum() > most_[k]) return false;
        return true;
    }
    [[nodiscard]] bool triangle(const Triangle& t) const {
        for (std::size_t k = 0; k < 4; ++k)
            if (std::min({normals_[k].dot(vec(t[0])), normals_[k].dot(vec(t[1])), normals_[k].dot(vec(t[2]))}) > most_[k]) return false;
        return true;
    }

private:
    static constexpr double kMargin = 1e-9;  ///< of a mesh of the size of 1
    Vec3 low_, high_;
    std::array<Vec3, 4> normals_;
    std::array<double, 4> most_{};
};

/// What CGAL asks of the triangles: exact answers where a topology hangs on them, distances in doubles. CGAL's own oracle tests boxes exactly, too, which takes more time than all else.
class Oracle {
public:
    using Geom_traits = CGAL::Alpha_wraps_3::internal::Alpha_wrap_AABB_traits<Kernel>;

    explicit Oracle(const TriangleMesh& mesh) : mesh_(mesh), near_(mesh) {
        triangles_.reserve(static_cast<std::size_t>(mesh.triangles.rows()));
        for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
            std::array<Point, 3> p;
            for (int k = 0; k < 3; ++k) {
                const auto row = mesh.vertices.row(mesh.triangles(f, k));
                p[static_cast<std::size_t>(k)] = Point(row[0], row[1], row[2]);
            }
            triangles_.emplace_back(p[0], p[1], p[2]);
            solid_.push_back(!triangles_.back().is_degenerate());
            box_ += triangles_.back().bbox();
        }
    }

    [[nodiscard]] Geom_traits geom_traits() const { return {}; }
    [[nodiscard]] CGAL::Bbox_3 bbox() const { return box_; }
    [[nodiscard]] bool do_intersect(const Geom_traits::Ball_3& ball) const { return look(ball.boundary().center()).squaredDistance <= ball.boundary().squared_radius(); }
    template <class K>
    [[nodiscard]] bool do_intersect(const CGAL::Alpha_wraps_3::internal::Tetrahedron_with_outside_info<K>& tetrahedron) const {
        // Nothing is in it where the nearest triangle to the place that was asked for last, its circumcenter, is farther than all of its corners.
        double reach = 0.0;
        for (int k = 0; k < 4; ++k) reach = std::max(reach, CGAL::squared_distance(tetrahedron.m_tet[k], asked_));
        if (hit_.triangle >= 0 && hit_.squaredDistance > kRounding * reach) return false;
        const Reach near(tetrahedron.m_tet);
        const auto intersects = Geom_traits().do_intersect_3_object();
        return near_.any([&](const Vec3& low, const Vec3& high) { return near.box(low, high); },
                         [&](std::int32_t f) {
                             const Triangle& triangle = triangles_[static_cast<std::size_t>(f)];
                             return solid_[static_cast<std::size_t>(f)] && near.triangle(triangle) && intersects(tetrahedron, triangle);
                         });
    }
    [[nodiscard]] Point closest_point(const Point& to) const {
        TriangleTree::Hit hit = look(to);
        if (hit.triangle < 0) {  // a circumcenter at no finite distance
            Vec3 within = vec(to);
            for (int k = 0; k < 3; ++k) within[k] = std::clamp(std::isfinite(within[k]) ? within[k] : 0.0, box_.min(k), box_.max(k));
            hit = near_.nearest(within);
        }
        const Vec3 p = hit.barycentric.transpose() * mesh_.vertices(mesh_.triangles.row(hit.triangle), Eigen::all);
        return {p.x(), p.y(), p.z()};
    }
    bool first_intersection(const Point& from, const Point& to, Point& at, double offset) const {
        const auto distance = [this](const Point& p) { return std::sqrt(near_.nearest(vec(p)).squaredDistance); };
        return CGAL::Alpha_wraps_3::internal::Offset_intersection<Geom_traits, decltype(distance)>(distance, offset, kPrecision * offset, 1).first_intersection(from, to, at);
    }

private:
    static constexpr double kPrecision = 1e-2;  ///< CGAL's
    static constexpr double kRounding = 1.0 + 1e-9;

    const TriangleTree::Hit& look(const Point& p) const {
        if (p != asked_ || hit_.triangle < 0) {
            asked_ = p;
            hit_ = near_.nearest(vec(p));
        }
        return hit_;
    }

    const TriangleMesh& mesh_;
    TriangleTree near_;
    std::vector<Triangle> triangles_;
    std::vector<bool> solid_;  ///< of those with an area
    CGAL::Bbox_3 box_;
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
        const Oracle oracle(mesh);
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
