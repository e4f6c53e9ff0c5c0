// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/cache_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>

#include "core/io/atomic_file.h"
#include "core/io/write_mesh.h"

namespace imomushi {

namespace {

constexpr std::size_t kCheckedFrames = 10;

void put(std::string& to, std::uint32_t bits, bool bigEndian) {
    for (int i = 0; i < 4; ++i) to.push_back(static_cast<char>(bits >> (bigEndian ? 24 - 8 * i : 8 * i) & 0xff));
}
void put(std::string& to, float value, bool bigEndian) { put(to, std::bit_cast<std::uint32_t>(value), bigEndian); }

float get(const char* from, bool bigEndian) {
    std::uint32_t bits = 0;
    for (int i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(static_cast<unsigned char>(from[i])) << (bigEndian ? 24 - 8 * i : 8 * i);
    return std::bit_cast<float>(bits);
}

/// Elements one after the other.
TriangleMesh wholeBody(const CharacterInput& input) {
    TriangleMesh out;
    Eigen::Index v = 0, t = 0;
    for (const auto& e : input.elements) v += e.mesh->body.vertices.rows(), t += e.mesh->body.triangles.rows();
    out.vertices.resize(v, 3);
    out.triangles.resize(t, 3);
    v = t = 0;
    for (const auto& e : input.elements) {
        const TriangleMesh& body = e.mesh->body;
        out.vertices.middleRows(v, body.vertices.rows()) = body.vertices;
        out.triangles.middleRows(t, body.triangles.rows()) = body.triangles.array() + static_cast<std::int32_t>(v);
        v += body.vertices.rows();
        t += body.triangles.rows();
    }
    return out;
}

Points wholePositions(const Motion& motion, const CharacterInput& input, Eigen::Index vertices) {
    Points out(vertices, 3);
    Eigen::Index v = 0;
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        const Points at = motion.character.positions(static_cast<int>(e));
        out.middleRows(v, at.rows()) = at;
        v += at.rows();
    }
    return out;
}

std::filesystem::path numbered(const std::filesystem::path& path, std::size_t frame) {
    std::string number = std::to_string(frame + 1);
    if (number.size() < 4) number.insert(0, 4 - number.size(), '0');
    std::filesystem::path out = path;
    out.replace_filename(path.stem().string() + "_" + number + path.extension().string());
    return out;
}

}  // namespace

Result<void> writeCache(Motion& motion, const ExportScene& scene, const std::filesystem::path& path, ExportReport& report, const Progress& progress) {
    const std::string suffix = path.extension().string();
    const auto& clip = motion.clips.front();
    const std::size_t frames = clip.times.size();
    const CharacterInput& input = scene.character;
    const TriangleMesh body = wholeBody(input);
    const auto vertices = static_cast<std::size_t>(body.vertices.rows());
    report.vertices = static_cast<int>(vertices);
    report.triangles = static_cast<int>(body.triangles.rows());
    report.keys = frames;
    if (motion.clips.size() > 1) report.warnings.emplace_back("A cache holds one clip: \"" + scene.clips.front().name + "\" was written.");
    const auto cancelled = [] { return fail(kCancelled, "The export was cancelled."); };
    const auto done = [&](const std::filesystem::path& file) {
        std::error_code error;
        report.files.push_back(file);
        report.bytes += std::filesystem::file_size(file, error);
    };

    if (suffix == ".obj" || suffix == ".ply") {
        for (std::size_t k = 0; k < frames; ++k) {
            if (progress.cancelled()) return cancelled();
            progress.report("write", static_cast<double>(k) / static_cast<double>(frames));
            motion.character.show(clip.shapes[k].data());
            const auto file = numbered(path, k);
            if (auto written = writeMesh(file, wholePositions(motion, input, body.vertices.rows()), body.triangles); !written) return written;
            done(file);
        }
        // Doubles, as they are.
        report.checked = static_cast<int>(std::min(frames, kCheckedFrames));
        return {};
    }
    if (suffix != ".pc2" && suffix != ".mdd")
        return fail("unknown-format", "\"" + path.string() + "\" is no cache: its name must end in .pc2, .mdd, .obj or .ply.");
    const bool mdd = suffix == ".mdd";
    const double fps = frames > 1 ? static_cast<double>(frames - 1) / clip.times.back() : 60.0;
    if (!mdd)
        for (std::size_t k = 0; k < frames; ++k)
            if (std::abs(clip.times[k] - static_cast<double>(k) / fps) > 1e-3 / fps) {
                report.warnings.emplace_back("Frames are not evenly spaced, which PC2 needs: give \"fps\".");
                break;
            }
    std::string head;
    if (mdd) {
        put(head, static_cast<std::uint32_t>(frames), true);
        put(head, static_cast<std::uint32_t>(vertices), true);
        for (const double t : clip.times) put(head, static_cast<float>(t), true);
    } else {
        head.assign("POINTCACHE2\0", 12);
        put(head, std::uint32_t{1}, false);
        put(head, static_cast<std::uint32_t>(vertices), false);
        put(head, 0.0f, false);
        put(head, 1.0f, false);
        put(head, static_cast<std::uint32_t>(frames), false);
    }
    AtomicFile file(path);
    file.write(head);
    std::string row;
    for (std::size_t k = 0; k < frames; ++k) {
        if (progress.cancelled()) return cancelled();
        progress.report("write", static_cast<double>(k) / static_cast<double>(frames));
        motion.character.show(clip.shapes[k].data());
        row.clear();
        for (std::size_t e = 0; e < input.elements.size(); ++e) {
            const auto surface = motion.character.surface(static_cast<int>(e));
            const auto count = 3 * static_cast<std::size_t>(surface.vertices);
            if (!mdd && std::endian::native == std::endian::little)
                row.append(reinterpret_cast<const char*>(surface.positions), count * sizeof(float));
            else
                for (std::size_t i = 0; i < count; ++i) put(row, surface.positions[i], mdd);
        }
        file.write(row);
    }
    if (auto finished = file.finish(); !finished) return finished;
    done(path);
    auto mesh = path;
    mesh.replace_extension(".obj");
    if (auto written = writeMesh(mesh, body.vertices, body.triangles); !written) return written;
    done(mesh);

    std::ifstream back(path, std::ios::binary);
    double largest = 0.0, squares = 0.0;
    const std::size_t count = std::min(frames, kCheckedFrames);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t k = count > 1 ? i * (frames - 1) / (count - 1) : 0;
        row.resize(12 * vertices);
        back.seekg(static_cast<std::streamoff>(head.size() + k * row.size()));
        if (!back.read(row.data(), static_cast<std::streamsize>(row.size()))) return fail("not-readable", "The cache that was written could not be read back: check the disk.");
        motion.character.show(clip.shapes[k].data());
        const Points goal = wholePositions(motion, input, body.vertices.rows());
        for (std::size_t v = 0; v < vertices; ++v) {
            Vec3 p;
            for (std::size_t a = 0; a < 3; ++a) p[static_cast<Eigen::Index>(a)] = get(row.data() + 12 * v + 4 * a, mdd);
            const double d = (p - goal.row(static_cast<Eigen::Index>(v)).transpose()).squaredNorm();
            largest = std::max(largest, d);
            squares += d;
        }
    }
    report.check = {std::sqrt(largest) / motion.diagonal, std::sqrt(squares / std::max(1.0, static_cast<double>(vertices * count))) / motion.diagonal};
    report.checked = static_cast<int>(count);
    return {};
}

}  // namespace imomushi
