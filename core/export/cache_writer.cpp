// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/cache_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <set>
#include <string_view>

#include "core/base/atomic_file.h"
#include "core/base/try.h"
#include "core/export/obj_model.h"
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

/// What the vertices of a cache are.
struct CacheObject {
    std::string name;            // empty: the elements that are under no mesh
    int mesh = -1;               // of the scene
    std::vector<int> elements;   // whose bodies it has
    TriangleMesh rest;
};

/// Bodies one after the other.
TriangleMesh wholeBody(const CharacterInput& input, const std::vector<int>& elements) {
    TriangleMesh out;
    Eigen::Index v = 0, t = 0;
    const auto bodyOf = [&input](int e) -> const TriangleMesh& { return input.elements[static_cast<std::size_t>(e)].mesh->body; };
    for (const int e : elements) v += bodyOf(e).vertices.rows(), t += bodyOf(e).triangles.rows();
    out.vertices.resize(v, 3);
    out.triangles.resize(t, 3);
    v = t = 0;
    for (const int e : elements) {
        const TriangleMesh& body = bodyOf(e);
        out.vertices.middleRows(v, body.vertices.rows()) = body.vertices;
        out.triangles.middleRows(t, body.triangles.rows()) = body.triangles.array() + static_cast<std::int32_t>(v);
        v += body.vertices.rows();
        t += body.triangles.rows();
    }
    return out;
}

std::vector<CacheObject> objectsOf(const Motion& motion, const ExportScene& scene) {
    std::vector<CacheObject> out;
    std::vector<int> alone;
    for (std::size_t e = 0; e < motion.seen.size(); ++e)
        if (motion.seen[e].mesh < 0) alone.push_back(static_cast<int>(e));
    if (!alone.empty()) out.push_back({"", -1, alone, wholeBody(scene.character, alone)});
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) out.push_back({scene.meshes[m].name, static_cast<int>(m), {}, scene.meshes[m].model->mesh.body});
    return out;
}

Points wholePositions(const Motion& motion, const CacheObject& object) {
    if (object.mesh >= 0) return motion.character.renderPositions(object.mesh);
    Points out(object.rest.vertices.rows(), 3);
    Eigen::Index v = 0;
    for (const int e : object.elements) {
        const Points at = motion.character.positions(e);
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

/// Names as parts of file names, each once; systems that know no capitals tell them apart.
std::vector<std::string> fileNames(const std::vector<std::string>& names) {
    std::vector<std::string> out;
    std::set<std::string> taken;
    for (const std::string& given : names) {
        const std::string wish = fileName(given);
        std::string name = wish, small;
        for (int n = 2;; ++n) {
            small = name;
            for (char& c : small)
                if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
            if (taken.insert(small).second) break;
            name = wish + " " + std::to_string(n);
        }
        out.push_back(std::move(name));
    }
    return out;
}

std::filesystem::path besides(const std::filesystem::path& path, const std::string& name) {
    std::filesystem::path out = path;
    return out.replace_filename(path.stem().string() + "_" + name + path.extension().string());
}

/// Where each object goes: one to `path`, as elements under no mesh do; others beside it, after their names.
std::vector<std::filesystem::path> placesOf(const std::filesystem::path& path, const std::vector<CacheObject>& objects) {
    if (objects.size() == 1) return {path};
    std::vector<std::string> meshes;
    for (const auto& object : objects)
        if (object.mesh >= 0) meshes.push_back(object.name);
    const auto names = fileNames(meshes);
    std::vector<std::filesystem::path> places;
    for (const auto& object : objects) places.push_back(object.mesh < 0 ? path : besides(path, names[static_cast<std::size_t>(object.mesh)]));
    return places;
}

/// Where each clip goes: a single one to `path`; several beside it, after their names.
std::vector<std::filesystem::path> placesOf(const std::filesystem::path& path, const ExportScene& scene) {
    if (scene.clips.size() == 1) return {path};
    std::vector<std::string> clips;
    for (const ExportClip& clip : scene.clips) clips.push_back(clip.name);
    std::vector<std::filesystem::path> places;
    for (const std::string& name : fileNames(clips)) {
        if (path.extension() == ".obj" || path.extension() == ".ply")
            places.push_back(path.parent_path() / (path.stem().string() + "_" + name) / path.filename());
        else
            places.push_back(besides(path, name));
    }
    return places;
}

class CacheFile {
public:
    CacheFile(Motion& motion, const ExportScene& scene, const CacheObject& object, ExportReport& report)
        : motion_(motion), object_(object), report_(report), vertices_(static_cast<std::size_t>(object.rest.vertices.rows())) {
        report.vertices += static_cast<int>(vertices_);
        report.triangles += static_cast<int>(object.rest.triangles.rows());
        if (object.mesh >= 0) {
            model_ = scene.meshes[static_cast<std::size_t>(object.mesh)].model.get();
            report.written.push_back({object.name, true, static_cast<int>(model_->parts.size()), static_cast<int>(vertices_), static_cast<int>(object.rest.triangles.rows())});
        }
        for (const int e : object.elements) {
            const TriangleMesh& body = scene.character.elements[static_cast<std::size_t>(e)].mesh->body;
            report.written.push_back({scene.elements[static_cast<std::size_t>(e)], false, 0, static_cast<int>(body.vertices.rows()), static_cast<int>(body.triangles.rows())});
        }
    }

    /// A file per frame.
    Result<void> writeSequence(const Motion::Clip& clip, const std::filesystem::path& path, const Progress& progress) {
        std::error_code error;
        if (!path.parent_path().empty() && !std::filesystem::is_directory(path.parent_path(), error)) std::filesystem::create_directory(path.parent_path(), error);
        if (error) return fail("not-writable", "The folder " + path.parent_path().string() + " cannot be made: " + error.message() + ".");
        std::filesystem::path materials;
        if (model_ && path.extension() == ".obj") {
            IMOMUSHI_TRY(materials, writeMaterials(path));
        }
        for (std::size_t k = 0; k < clip.times.size(); ++k) {
            if (progress.cancelled()) return cancelled();
            progress.report("write", static_cast<double>(k) / static_cast<double>(clip.times.size()));
            motion_.character.show(clip.shapes[k].data());
            const auto file = numbered(path, k);
            const Points at = wholePositions(motion_, object_);
            const auto written = model_ && path.extension() == ".obj" ? writeObjModel(file, *model_, at, motion_.character.renderSurface(object_.mesh).normals, materials)
                                                                      : writeMesh(file, at, object_.rest.triangles);
            if (!written) return written;
            done(file);
        }
        for (const auto& file : beside_) done(file);
        // Doubles, as they are.
        checked_ += static_cast<int>(std::min(clip.times.size(), kCheckedFrames));
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
            const auto add = [&](const Character::Surface& surface) {
                const auto count = 3 * static_cast<std::size_t>(surface.vertices);
                if (!mdd && std::endian::native == std::endian::little)
                    row.append(reinterpret_cast<const char*>(surface.positions), count * sizeof(float));
                else
                    for (std::size_t i = 0; i < count; ++i) put(row, surface.positions[i], mdd);
            };
            for (const int e : object_.elements) add(motion_.character.surface(e));
            if (object_.mesh >= 0) add(motion_.character.renderSurface(object_.mesh));
            file.write(row);
        }
        if (auto finished = file.finish(); !finished) return finished;
        done(path);
        return readBack(clip, path, head.size(), mdd, progress);
    }

    /// What a point cache is put on.
    Result<void> writeRest(std::filesystem::path path) {
        path.replace_extension(".obj");
        if (model_) {
            IMOMUSHI_TRY(const auto materials, writeMaterials(path));
            if (auto written = writeObjModel(path, *model_, object_.rest.vertices, nullptr, materials); !written) return written;
        } else if (auto written = writeMesh(path, object_.rest.vertices, object_.rest.triangles); !written) {
            return written;
        }
        done(path);
        for (const auto& file : beside_) done(file);
        return {};
    }

    [[nodiscard]] double largest() const { return largest_; }  // m^2, of what was read back
    [[nodiscard]] double squares() const { return squares_; }
    [[nodiscard]] double points() const { return static_cast<double>(vertices_) * static_cast<double>(checked_); }
    [[nodiscard]] int checked() const { return checked_; }

private:
    static tl::unexpected<Error> cancelled() { return fail(kCancelled, "The export was cancelled."); }

    void done(const std::filesystem::path& file) {
        std::error_code error;
        report_.files.push_back(file);
        report_.bytes += std::filesystem::file_size(file, error);
    }

    /// The materials of the model beside `path`. Empty: it has none.
    Result<std::filesystem::path> writeMaterials(const std::filesystem::path& path) {
        IMOMUSHI_TRY(beside_, writeObjMaterials(path, *model_));
        return beside_.empty() ? std::filesystem::path() : beside_.front();
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
            const Points goal = wholePositions(motion_, object_);
            for (std::size_t v = 0; v < vertices_; ++v) {
                Vec3 p;
                for (std::size_t a = 0; a < 3; ++a) p[static_cast<Eigen::Index>(a)] = get(row.data() + 12 * v + 4 * a, mdd);
                const double d = (p - goal.row(static_cast<Eigen::Index>(v)).transpose()).squaredNorm();
                largest_ = std::max(largest_, d);
                squares_ += d;
            }
        }
        checked_ += static_cast<int>(count);
        return {};
    }

    Motion& motion_;
    const CacheObject& object_;
    const RenderModel* model_ = nullptr;
    ExportReport& report_;
    std::size_t vertices_;
    std::vector<std::filesystem::path> beside_;  // materials and textures
    int checked_ = 0;
    double largest_ = 0.0, squares_ = 0.0;
};

}  // namespace

Result<void> writeCache(Motion& motion, const ExportScene& scene, const std::filesystem::path& path, ExportReport& report, const Progress& progress) {
    const std::string suffix = path.extension().string();
    const bool sequence = suffix == ".obj" || suffix == ".ply";
    if (!sequence && suffix != ".pc2" && suffix != ".mdd")
        return fail("unknown-format", "\"" + path.string() + "\" is no cache: its name must end in .pc2, .mdd, .obj or .ply.");
    const auto objects = objectsOf(motion, scene);
    const auto places = placesOf(path, objects);
    const double count = static_cast<double>(objects.size() * scene.clips.size());
    double done = 0.0, largest = 0.0, squares = 0.0, points = 0.0;
    for (std::size_t o = 0; o < objects.size(); ++o) {
        CacheFile writer(motion, scene, objects[o], report);
        const auto clips = placesOf(places[o], scene);
        for (std::size_t c = 0; c < clips.size(); ++c, done += 1.0) {
            const auto& clip = motion.clips[c];
            const Progress part = progress.part(done / count, (done + 1.0) / count);
            if (auto ok = sequence ? writer.writeSequence(clip, clips[c], part) : writer.writePoints(clip, scene.clips[c].name, clips[c], part); !ok) return ok;
            report.keys += clip.times.size();
        }
        if (!sequence)
            if (auto ok = writer.writeRest(places[o]); !ok) return ok;
        largest = std::max(largest, writer.largest());
        squares += writer.squares();
        points += writer.points();
        report.checked = std::max(report.checked, writer.checked());
    }
    report.check = {std::sqrt(largest) / motion.diagonal, std::sqrt(squares / std::max(1.0, points)) / motion.diagonal};
    return {};
}

}  // namespace imomushi
