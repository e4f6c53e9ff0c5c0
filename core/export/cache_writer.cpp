// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/cache_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>
#include <string_view>

#include "core/base/atomic_file.h"
#include "core/mesh/write_mesh.h"

namespace imomushi {

namespace {

constexpr std::size_t kCheckedFrames = 10;
constexpr std::size_t kLongestName = 120;  // bytes: with the rest of it a file name stays below 255

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

/// A name as a part of a file name that every system takes: Unicode stays, what means something else is an underscore. At most kLongestName bytes.
std::string fileName(const std::string& name) {
    std::string out;
    for (const char c : name) {
        const auto code = static_cast<unsigned char>(c);
        out.push_back(code < 0x20 || code == 0x7f || std::string_view("\\/:*?\"<>|").find(c) != std::string_view::npos ? '_' : c);
    }
    if (out.size() > kLongestName) {
        std::size_t end = kLongestName;
        while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xc0) == 0x80) --end;
        out.resize(end);
    }
    while (!out.empty() && (out.back() == '.' || out.back() == ' ')) out.pop_back();
    return out.empty() ? "_" : out;
}

/// Where each clip goes: a single one to `path`; several beside it, after their names. Systems that know no capitals tell them apart.
std::vector<std::filesystem::path> placesOf(const std::filesystem::path& path, const ExportScene& scene) {
    if (scene.clips.size() == 1) return {path};
    std::vector<std::filesystem::path> places;
    std::set<std::string> taken;
    for (const ExportClip& clip : scene.clips) {
        const std::string wish = fileName(clip.name);
        std::string name = wish, small;
        for (int n = 2;; ++n) {
            small = name;
            for (char& c : small)
                if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
            if (taken.insert(small).second) break;
            name = wish + " " + std::to_string(n);
        }
        std::filesystem::path place = path;
        if (path.extension() == ".obj" || path.extension() == ".ply")
            place = path.parent_path() / (path.stem().string() + "_" + name) / path.filename();
        else
            place.replace_filename(path.stem().string() + "_" + name + path.extension().string());
        places.push_back(std::move(place));
    }
    return places;
}

class CacheFile {
public:
    CacheFile(Motion& motion, const ExportScene& scene, ExportReport& report)
        : motion_(motion), input_(scene.character), report_(report), body_(wholeBody(input_)), vertices_(static_cast<std::size_t>(body_.vertices.rows())) {
        report.vertices = static_cast<int>(vertices_);
        report.triangles = static_cast<int>(body_.triangles.rows());
    }

    /// A file per frame.
    Result<void> writeSequence(const Motion::Clip& clip, const std::filesystem::path& path, const Progress& progress) {
        std::error_code error;
        if (!path.parent_path().empty() && !std::filesystem::is_directory(path.parent_path(), error)) std::filesystem::create_directory(path.parent_path(), error);
        if (error) return fail("not-writable", "The folder " + path.parent_path().string() + " cannot be made: " + error.message() + ".");
        for (std::size_t k = 0; k < clip.times.size(); ++k) {
            if (progress.cancelled()) return cancelled();
            progress.report("write", static_cast<double>(k) / static_cast<double>(clip.times.size()));
            motion_.character.show(clip.shapes[k].data());
            const auto file = numbered(path, k);
            if (auto written = writeMesh(file, wholePositions(motion_, input_, body_.vertices.rows()), body_.triangles); !written) return written;
            done(file);
        }
        // Doubles, as they are.
        report_.checked += static_cast<int>(std::min(clip.times.size(), kCheckedFrames));
        return {};
    }

    Result<void> writePoints(const Motion::Clip& clip, const std::string& name, const std::filesystem::path& path, const Progress& progress) {
        const bool mdd = path.extension() == ".mdd";
        const std::size_t frames = clip.times.size();
        const double fps = frames > 1 ? static_cast<double>(frames - 1) / clip.times.back() : 60.0;
        if (!mdd)
            for (std::size_t k = 0; k < frames; ++k)
                if (std::abs(clip.times[k] - static_cast<double>(k) / fps) > 1e-3 / fps) {
                    report_.warnings.push_back({"uneven-frames", name, "The frames of \"" + name + "\" are not evenly spaced, which PC2 needs: give \"fps\"."});
                    break;
                }
        std::string head;
        if (mdd) {
            put(head, static_cast<std::uint32_t>(frames), true);
            put(head, static_cast<std::uint32_t>(vertices_), true);
            for (const double t : clip.times) put(head, static_cast<float>(t), true);
        } else {
            head.assign("POINTCACHE2\0", 12);
            put(head, std::uint32_t{1}, false);
            put(head, static_cast<std::uint32_t>(vertices_), false);
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
            motion_.character.show(clip.shapes[k].data());
            row.clear();
            for (std::size_t e = 0; e < input_.elements.size(); ++e) {
                const auto surface = motion_.character.surface(static_cast<int>(e));
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
        return readBack(clip, path, head.size(), mdd, progress);
    }

    /// What a point cache is put on.
    Result<void> writeRest(std::filesystem::path path) {
        path.replace_extension(".obj");
        if (auto written = writeMesh(path, body_.vertices, body_.triangles); !written) return written;
        done(path);
        return {};
    }

    void finish() {
        const double points = std::max(1.0, static_cast<double>(vertices_) * static_cast<double>(report_.checked));
        report_.check = {std::sqrt(largest_) / motion_.diagonal, std::sqrt(squares_ / points) / motion_.diagonal};
    }

private:
    static tl::unexpected<Error> cancelled() { return fail(kCancelled, "The export was cancelled."); }

    void done(const std::filesystem::path& file) {
        std::error_code error;
        report_.files.push_back(file);
        report_.bytes += std::filesystem::file_size(file, error);
    }

    Result<void> readBack(const Motion::Clip& clip, const std::filesystem::path& path, std::size_t head, bool mdd, const Progress& progress) {
        std::ifstream back(path, std::ios::binary);
        const std::size_t frames = clip.times.size(), count = std::min(frames, kCheckedFrames);
        std::string row(12 * vertices_, '\0');
        for (std::size_t i = 0; i < count; ++i) {
            if (progress.cancelled()) return cancelled();
            const std::size_t k = count > 1 ? i * (frames - 1) / (count - 1) : 0;
            back.seekg(static_cast<std::streamoff>(head + k * row.size()));
            if (!back.read(row.data(), static_cast<std::streamsize>(row.size()))) return fail("not-readable", "The cache that was written could not be read back: check the disk.");
            motion_.character.show(clip.shapes[k].data());
            const Points goal = wholePositions(motion_, input_, body_.vertices.rows());
            for (std::size_t v = 0; v < vertices_; ++v) {
                Vec3 p;
                for (std::size_t a = 0; a < 3; ++a) p[static_cast<Eigen::Index>(a)] = get(row.data() + 12 * v + 4 * a, mdd);
                const double d = (p - goal.row(static_cast<Eigen::Index>(v)).transpose()).squaredNorm();
                largest_ = std::max(largest_, d);
                squares_ += d;
            }
        }
        report_.checked += static_cast<int>(count);
        return {};
    }

    Motion& motion_;
    const CharacterInput& input_;
    ExportReport& report_;
    TriangleMesh body_;
    std::size_t vertices_;
    double largest_ = 0.0, squares_ = 0.0;  // m^2, of what was read back
};

}  // namespace

Result<void> writeCache(Motion& motion, const ExportScene& scene, const std::filesystem::path& path, ExportReport& report, const Progress& progress) {
    const std::string suffix = path.extension().string();
    const bool sequence = suffix == ".obj" || suffix == ".ply";
    if (!sequence && suffix != ".pc2" && suffix != ".mdd")
        return fail("unknown-format", "\"" + path.string() + "\" is no cache: its name must end in .pc2, .mdd, .obj or .ply.");
    CacheFile writer(motion, scene, report);
    const auto places = placesOf(path, scene);
    const double count = static_cast<double>(places.size());
    for (std::size_t c = 0; c < places.size(); ++c) {
        const auto& clip = motion.clips[c];
        const Progress part = progress.part(static_cast<double>(c) / count, static_cast<double>(c + 1) / count);
        if (auto ok = sequence ? writer.writeSequence(clip, places[c], part) : writer.writePoints(clip, scene.clips[c].name, places[c], part); !ok) return ok;
        report.keys += clip.times.size();
    }
    if (!sequence)
        if (auto ok = writer.writeRest(path); !ok) return ok;
    writer.finish();
    return {};
}

}  // namespace imomushi
