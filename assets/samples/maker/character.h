// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "shape.h"

namespace imomushi::samples {

/// Where two elements meet: a flat disc, the part of the plane around `centre` that lies inside the shape.
struct JointSpec {
    int a, b;                 ///< elements
    Vec3 centre;
    Vec3 normal;              ///< from a to b
    int rim;                  ///< vertices on the rim
    std::vector<int> rings;   ///< vertices of the rings inside it, outermost first; a last ring of 1 is the centre
};

struct ElementSpec {
    std::string name;
    Vec3 centre;           ///< sees its whole surface: where the mesh starts from and the texture is projected from
    int vertices = 0;      ///< of the body; 0: as the sizes ask
    int textureWidth = 256;
    Vec3 pole = Vec3::UnitX();   ///< axis of the texture's projection
    Vec3 seam = -Vec3::UnitY();  ///< side where the texture begins and ends
    bool cylinder = false;       ///< projected from the axis (stripes across it stay straight) instead of from the centre
};

struct BoneSpec {
    std::string name, element;
    std::variant<std::string, Vec3> from, to;
    std::string parent;
};

/// Colour (sRGB, 0...1) of a surface point; `texel`: size of a texel there (m), for smooth edges.
using Paint = std::function<Vec3(int element, const Vec3& p, const Vec3& n, double texel)>;

struct CharacterSpec {
    std::string name;
    Shape shape;                                 ///< of the whole character, cut into elements by the joints
    std::function<double(const Vec3&)> size;     ///< edge length of the triangles, m
    Paint paint;
    double shade = 0.35;                         ///< how much hollows are darkened
    std::vector<ElementSpec> elements;
    std::vector<JointSpec> joints;
    std::vector<BoneSpec> bones;
    std::vector<std::string> pins;
    bool stands = false;  ///< on the ground; its trunk stays upright
    std::vector<nlohmann::ordered_json> settings;  ///< script lines before the precompute
    /// Limits the lengths (of the rest length) of all bones whose name holds `part`; later limits win.
    void stretch(double least, double most, const std::string& part);
};

/// Writes FOLDER/NAME/ELEMENT.glb for every element and FOLDER/NAME/make.jsonl, and prints how good the meshes are.
void make(const CharacterSpec& character, const std::filesystem::path& folder);

CharacterSpec caterpillar();
CharacterSpec octopus();
CharacterSpec figure();

// ---- paint: each returns how much of a point is covered, 0...1 ---------------------------------------------------------
inline Vec3 rgb(unsigned hex) { return Vec3(double(hex >> 16 & 255), double(hex >> 8 & 255), double(hex & 255)) / 255.0; }
inline Vec3 mix(const Vec3& a, const Vec3& b, double t) { return a + (b - a) * t; }
/// 1 inside (d < 0), 0 outside, over a width of `soft` metres.
double cover(double d, double soft);
/// A point's place in a flat picture around `centre`, looking along -`out` with `up` up: (right, up).
Eigen::Vector2d onPicture(const Vec3& p, const Vec3& centre, const Vec3& out, const Vec3& up);
double ovalDistance(const Eigen::Vector2d& q, const Eigen::Vector2d& centre, const Eigen::Vector2d& radii);
/// A big shining eye with radii (m) around the middle of a picture; paints over `colour`.
Vec3 paintEye(Vec3 colour, const Eigen::Vector2d& q, const Eigen::Vector2d& radii, double texel);
/// An arc of `width` metres that smiles: around `centre`, `radius`, half opening angle (radians).
double smile(const Eigen::Vector2d& q, const Eigen::Vector2d& centre, double radius, double halfAngle, double width, double texel);

}  // namespace imomushi::samples
