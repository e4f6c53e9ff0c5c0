// SPDX-License-Identifier: GPL-3.0-or-later
#include "character.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include "core/base/parallel.h"
#include "element.h"
#include "encode_png.h"
#include "glb.h"

namespace imomushi::samples {

namespace {

constexpr double kSoles = -0.001;  // m: meshes of feet that stand at 0 reach a little deeper
constexpr double kGrazing = 0.6;  // cosine between the normal and the ray of a texel below which hollows are darkened less
constexpr double kPad = 1.15;  // textures run on past their seam, so that a triangle across it needs no wrapping

/// How a texture lies on an element: u around the pole from the seam, 0...1; v from the pole, 0...1, by angle or along the axis.
class Projection {
public:
    Projection(const ElementSpec& e, const Mesh& mesh) : e_(e), s_((e.seam - e.pole * e.seam.dot(e.pole)).normalized()), t_(e.pole.cross(s_)) {
        for (const Vec3& p : mesh.points) {
            low_ = std::min(low_, (p - e.centre).dot(e.pole));
            high_ = std::max(high_, (p - e.centre).dot(e.pole));
        }
        const double margin = 0.03 * (high_ - low_);  // so that filtering at the ends finds the same colour
        low_ -= margin;
        high_ += margin;
    }
    [[nodiscard]] Eigen::Vector2d at(const Vec3& p) const {
        const Vec3 d = p - e_.centre;
        double u = std::atan2(d.dot(t_), d.dot(s_)) / (2 * M_PI);
        if (u < 0) u += 1;
        if (e_.cylinder) return {u, (high_ - d.dot(e_.pole)) / (high_ - low_)};
        return {u, std::acos(std::clamp(d.normalized().dot(e_.pole), -1.0, 1.0)) / M_PI};
    }
    /// The ray that hits the surface at (u, v).
    [[nodiscard]] std::pair<Vec3, Vec3> ray(double u, double v) const {
        const Vec3 around = std::cos(2 * M_PI * u) * s_ + std::sin(2 * M_PI * u) * t_;
        if (e_.cylinder) return {e_.centre + (high_ - v * (high_ - low_)) * e_.pole, around};
        return {e_.centre, std::sin(M_PI * v) * around + std::cos(M_PI * v) * e_.pole};
    }

private:
    const ElementSpec& e_;
    Vec3 s_, t_;
    double low_ = 1e9, high_ = -1e9;
};

std::vector<unsigned char> bakeTexture(const CharacterSpec& c, int element, const Projection& projection) {
    const int width = c.elements[element].textureWidth, height = int(std::lround(width / kPad / 2 / 4)) * 4;
    std::vector<unsigned char> pixels(3 * std::size_t(width) * height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto [origin, d] = projection.ray(kPad * (x + 0.5) / width, (y + 0.5) / height);
            double start = 0;  // between two legs an axis may begin outside
            while (start < 1.0 && c.shape(origin + start * d) >= 0) start += 0.01;
            if (start >= 1.0) start = 0;
            const double far = start + hit(c.shape, origin + start * d, d, 3.0);
            const Vec3 p = origin + far * d, n = normal(c.shape, p);
            double open = 0, weight = 0;  // how far the surroundings stay outside along the normal
            for (double step : {0.03, 0.07, 0.14}) {
                open += std::clamp(c.shape(p + step * n) / step, 0.0, 1.0);
                weight += 1;
            }
            // A side that runs along the ray gets few texels for its whole length: a shade between them would be seen as streaks.
            const double facing = std::clamp(n.dot(d) / kGrazing, 0.0, 1.0);
            const double shade = c.shade * facing * facing * (3 - 2 * facing) * (1 - open / weight);
            const Vec3 lit = c.paint(element, p, n, 2 * M_PI * kPad * far / width) * (1 - shade);
            for (int k = 0; k < 3; ++k) pixels[3 * (std::size_t(y) * width + x) + k] = static_cast<unsigned char>(std::lround(255 * std::clamp(lit[k], 0.0, 1.0)));
        }
    return encodePng(pixels, width, height);
}

RenderMesh dress(const CharacterSpec& c, const Mesh& mesh, const Projection& projection) {
    RenderMesh r;
    std::vector<double> u;
    const auto add = [&](const Vec3& p, const Eigen::Vector2d& uv) {
        r.positions.push_back(p.cast<float>());
        r.normals.push_back(normal(c.shape, p).cast<float>());
        r.texCoords.push_back(Eigen::Vector2f(float(uv.x() / kPad), float(uv.y())));
        u.push_back(uv.x());
        return int(r.positions.size()) - 1;
    };
    for (const Vec3& p : mesh.points) add(p, projection.at(p));
    std::map<int, int> beyond;  // the copy of a vertex past the seam
    for (auto t : mesh.triangles) {
        const double high = std::max({u[t[0]], u[t[1]], u[t[2]]});
        for (int& v : t)
            if (high - u[v] > 0.5) {
                const auto it = beyond.find(v);
                if (it != beyond.end()) {
                    v = it->second;
                } else {
                    const int copy = add(mesh.points[v], {u[v] + 1, r.texCoords[v].y()});
                    beyond[v] = copy;
                    v = copy;
                }
            }
        r.triangles.push_back(t);
    }
    return r;
}

void report(const ElementSpec& e, const Mesh& mesh) {
    double least = 180, mean = 0;
    int slivers = 0;
    for (const auto& t : mesh.triangles) {
        const double a = smallestAngle(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]) * 180 / M_PI;
        least = std::min(least, a);
        mean += a;
        slivers += a < 25;
    }
    std::printf("%-22s %5zu vertices  smallest angle %4.1f, mean of the smallest %4.1f degrees, %d under 25\n", e.name.c_str(), mesh.points.size(), least,
                mean / double(mesh.triangles.size()), slivers);
    std::fflush(stdout);
}

nlohmann::ordered_json vector(const Vec3& v) {
    nlohmann::ordered_json a = nlohmann::ordered_json::array();
    for (int k = 0; k < 3; ++k) a.push_back(std::round(v[k] * 1e6) / 1e6 + 0.0);
    return a;
}

void writeScript(const CharacterSpec& c, const std::filesystem::path& file) {
    std::ofstream out(file, std::ios::binary);
    const auto line = [&](const nlohmann::ordered_json& j) { out << j.dump() << "\n"; };
    out << "# Makes the sample \"" << c.name << "\". Run it in this folder: imomushi run make.jsonl\n";
    line({{"do", "new"}});
    for (const auto& e : c.elements) line({{"do", "import-element"}, {"path", e.name + ".glb"}, {"name", e.name}});
    for (const auto& j : c.joints) {
        const std::string a = c.elements[j.a].name, b = c.elements[j.b].name;
        const Vec3 n = j.normal.normalized();
        line({{"do", "add-joint-face"}, {"element", a}, {"name", b}, {"plane", {{"origin", vector(j.centre)}, {"normal", vector(n)}}}});
        line({{"do", "add-joint-face"}, {"element", b}, {"name", a}, {"plane", {{"origin", vector(j.centre)}, {"normal", vector(-n)}}}});
        line({{"do", "join"}, {"a", a + "/" + b}, {"b", b + "/" + a}});
    }
    const auto place = [](const std::variant<std::string, Vec3>& p) {
        return std::holds_alternative<Vec3>(p) ? vector(std::get<Vec3>(p)) : nlohmann::ordered_json(std::get<std::string>(p));
    };
    for (const auto& b : c.bones) {
        nlohmann::ordered_json j = {{"do", "add-bone"}, {"name", b.name}, {"element", b.element}, {"from", place(b.from)}, {"to", place(b.to)}};
        if (!b.parent.empty()) j["parent"] = b.parent;
        line(j);
    }
    for (const auto& p : c.pins) line({{"do", "pin"}, {"endpoint", p}});
    for (const auto& s : c.settings) line(s);
    line({{"do", "enable"}, {"effect", "bend-warp"}, {"auto", true}});
    for (const char* effect : {"smooth-joints", "bone-dynamics"}) line({{"do", "enable"}, {"effect", effect}});
    if (c.stands) {
        line({{"do", "set"}, {"target", "ground"}, {"property", "height"}, {"value", kSoles}});
        line({{"do", "enable"}, {"effect", "ground"}});
        line({{"do", "set"}, {"target", "character"}, {"property", "body-follows"}, {"value", 1}});
    }
    line({{"do", "precompute"}});
    line({{"do", "save"}, {"path", "../" + c.name + ".imomushi"}});
}

}  // namespace

void CharacterSpec::stretch(double least, double most, const std::string& part) {
    for (const auto& b : bones) {
        if (b.name.find(part) == std::string::npos) continue;
        std::erase_if(settings, [&](const auto& line) { return line["target"] == b.name; });
        settings.push_back({{"do", "set"}, {"target", b.name}, {"property", "min-stretch"}, {"value", least}});
        settings.push_back({{"do", "set"}, {"target", b.name}, {"property", "max-stretch"}, {"value", most}});
    }
}

void make(const CharacterSpec& c, const std::filesystem::path& folder) {
    const auto home = folder / c.name;
    std::filesystem::create_directories(home);
    std::vector<Disc> discs;
    for (const auto& j : c.joints) discs.push_back(meshDisc(j, c.shape));
    std::vector<Mesh> meshes(c.elements.size());
    std::vector<RenderMesh> dressed(c.elements.size());
    parallelFor(hardwareThreads(), c.elements.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) {
            meshes[e] = meshElement(c, int(e), discs);
            const Projection projection(c.elements[e], meshes[e]);
            dressed[e] = dress(c, meshes[e], projection);
            dressed[e].png = bakeTexture(c, int(e), projection);
        }
    });
    std::size_t total = 0;
    for (std::size_t e = 0; e < c.elements.size(); ++e) {
        report(c.elements[e], meshes[e]);
        total += meshes[e].points.size();
        writeGlb(dressed[e], c.elements[e].name, home / (c.elements[e].name + ".glb"));
    }
    writeScript(c, home / "make.jsonl");
    std::printf("%s: %zu elements, %zu vertices\n", c.name.c_str(), c.elements.size(), total);
}

}  // namespace imomushi::samples
