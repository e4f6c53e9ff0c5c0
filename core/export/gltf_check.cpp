// SPDX-License-Identifier: GPL-3.0-or-later
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_JSON
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

#include "core/export/gltf_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/parallel.h"
#include "core/base/try.h"
#include "core/export/body_frames.h"

namespace imomushi {

namespace {

constexpr std::size_t kFrames = 10;                                // of each clip
constexpr std::size_t kCheckPiece = 1024, kVerticesBetweenReports = 32 * kCheckPiece;  // vertices

/// Thrown and caught in this file: what was read back differs from what was written.
struct Unreadable {
    std::string why;
};

/// The numbers of an accessor of zeros with few others, three per item, as real values.
std::vector<float> sparseNumbersOf(const tinygltf::Model& model, const tinygltf::Accessor& a) {
    std::vector<float> out(3 * a.count, 0.0f);
    const bool whole = a.componentType == TINYGLTF_COMPONENT_TYPE_SHORT;
    if (!a.sparse.isSparse || a.type != TINYGLTF_TYPE_VEC3 || a.sparse.indices.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT || (!whole && a.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT))
        throw Unreadable{"an accessor has another type"};
    const auto bytes = [&](int view, std::size_t size) {
        const auto& from = model.bufferViews.at(static_cast<std::size_t>(view));
        const auto& data = model.buffers.at(static_cast<std::size_t>(from.buffer)).data;
        if (from.byteOffset + size > data.size()) throw Unreadable{"an accessor leaves its buffer"};
        return data.data() + from.byteOffset;
    };
    const auto count = static_cast<std::size_t>(a.sparse.count);
    const unsigned char *items = bytes(a.sparse.indices.bufferView, 4 * count), *values = bytes(a.sparse.values.bufferView, (whole ? 6 : 12) * count);
    for (std::size_t i = 0; i < 3 * count; ++i) {
        std::uint32_t item = 0;
        std::memcpy(&item, items + 4 * (i / 3), 4);
        float& to = out.at(3 * static_cast<std::size_t>(item) + i % 3);
        if (std::int16_t number = 0; whole) {
            std::memcpy(&number, values + 2 * i, 2);
            to = std::max(static_cast<float>(number) / 32767.0f, -1.0f);
        } else {
            std::memcpy(&to, values + 4 * i, 4);
        }
    }
    return out;
}

/// The numbers of an accessor, as real values.
std::vector<float> numbersOf(const tinygltf::Model& model, int index) {
    const auto& a = model.accessors.at(static_cast<std::size_t>(index));
    if (a.bufferView < 0) return sparseNumbersOf(model, a);
    const auto& view = model.bufferViews.at(static_cast<std::size_t>(a.bufferView));
    const auto& data = model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
    const auto width = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type)));
    const auto size = static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(a.componentType)));
    const int stride = a.ByteStride(view);
    if (stride <= 0) throw Unreadable{"an accessor has no stride"};
    std::vector<float> out(a.count * width);
    if (const std::size_t begin = view.byteOffset + a.byteOffset; a.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT && static_cast<std::size_t>(stride) == width * size) {
        if (begin + out.size() * size > data.size()) throw Unreadable{"an accessor leaves its buffer"};
        std::memcpy(out.data(), data.data() + begin, out.size() * size);
        return out;
    }
    for (std::size_t i = 0; i < a.count; ++i) {
        const std::size_t at = view.byteOffset + a.byteOffset + i * static_cast<std::size_t>(stride);
        if (at + width * size > data.size()) throw Unreadable{"an accessor leaves its buffer"};
        for (std::size_t k = 0; k < width; ++k) {
            const unsigned char* from = data.data() + at + k * size;
            const auto as = [&](auto kind, float most) {
                std::memcpy(&kind, from, sizeof kind);
                return a.normalized ? std::max(static_cast<float>(kind) / most, -1.0f) : static_cast<float>(kind);
            };
            float& to = out[i * width + k];
            switch (a.componentType) {
                case TINYGLTF_COMPONENT_TYPE_FLOAT: std::memcpy(&to, from, sizeof to); break;
                case TINYGLTF_COMPONENT_TYPE_SHORT: to = as(std::int16_t{}, 32767.0f); break;
                case TINYGLTF_COMPONENT_TYPE_BYTE: to = as(std::int8_t{}, 127.0f); break;
                case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: to = as(std::uint8_t{}, 255.0f); break;
                case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: to = as(std::uint16_t{}, 65535.0f); break;
                case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: to = as(std::uint32_t{}, 1.0f); break;
                default: throw Unreadable{"an accessor has another type"};
            }
        }
    }
    return out;
}

/// Global transforms of the nodes of a file at one time.
class Player {
public:
    explicit Player(const tinygltf::Model& model) : model_(model) {
        parent_.assign(model.nodes.size(), -1);
        for (std::size_t n = 0; n < model.nodes.size(); ++n)
            for (const int child : model.nodes[n].children) parent_.at(static_cast<std::size_t>(child)) = static_cast<int>(n);
        for (const auto& animation : model.animations) {
            auto& clip = clips_.emplace_back();
            for (const auto& channel : animation.channels) {
                const auto& sampler = animation.samplers.at(static_cast<std::size_t>(channel.sampler));
                clip.push_back({channel.target_node, channel.target_path, numbersOf(model, sampler.input), numbersOf(model, sampler.output)});
            }
        }
        rest();
    }

    void rest() {
        nodes_.assign(model_.nodes.size(), {});
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            const auto& node = model_.nodes[n];
            auto& to = nodes_[n];
            if (node.translation.size() == 3) to.place = Vec3(node.translation[0], node.translation[1], node.translation[2]);
            if (node.rotation.size() == 4) to.rotation = Eigen::Quaterniond(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
            if (node.scale.size() == 3) to.scale = Vec3(node.scale[0], node.scale[1], node.scale[2]);
            if (node.mesh >= 0) to.weights = model_.meshes.at(static_cast<std::size_t>(node.mesh)).weights;
        }
    }

    void play(std::size_t clip, double time) {
        rest();
        for (const auto& c : clips_.at(clip)) {
            auto& to = nodes_.at(static_cast<std::size_t>(c.node));
            const auto after = std::upper_bound(c.times.begin(), c.times.end(), static_cast<float>(time));
            const auto key = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - c.times.begin() - 1, 0));
            const std::size_t next = std::min(key + 1, c.times.size() - 1);
            double part = 0.0;
            if (next > key) part = std::clamp((time - c.times[key]) / (static_cast<double>(c.times[next]) - c.times[key]), 0.0, 1.0);
            const std::size_t width = c.numbers.size() / c.times.size();
            const float *a = c.numbers.data() + key * width, *b = c.numbers.data() + next * width;
            const auto mixed = [&](std::size_t i) { return a[i] + part * (b[i] - a[i]); };
            if (c.path == "translation") {
                to.place = Vec3(mixed(0), mixed(1), mixed(2));
            } else if (c.path == "rotation") {
                to.rotation = Eigen::Quaterniond(a[3], a[0], a[1], a[2]).slerp(part, Eigen::Quaterniond(b[3], b[0], b[1], b[2])).normalized();
            } else if (c.path == "weights") {
                to.weights.resize(width);
                for (std::size_t i = 0; i < width; ++i) to.weights[i] = mixed(i);
            }
        }
    }

    [[nodiscard]] Eigen::Affine3d world(int n) const {
        Eigen::Affine3d out = Eigen::Affine3d::Identity();
        for (; n >= 0; n = parent_[static_cast<std::size_t>(n)]) {
            const auto& node = nodes_[static_cast<std::size_t>(n)];
            Eigen::Affine3d own;
            own.linear() = node.rotation.toRotationMatrix() * node.scale.asDiagonal();
            own.translation() = node.place;
            own.makeAffine();
            out = own * out;
        }
        return out;
    }
    [[nodiscard]] const std::vector<double>& weights(int n) const { return nodes_[static_cast<std::size_t>(n)].weights; }

private:
    struct Node {
        Vec3 place = Vec3::Zero(), scale = Vec3::Ones();
        Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
        std::vector<double> weights;
    };
    struct Channel {
        int node;
        std::string path;
        std::vector<float> times, numbers;
    };
    const tinygltf::Model& model_;
    std::vector<int> parent_;
    std::vector<Node> nodes_;
    std::vector<std::vector<Channel>> clips_;
};

/// The mesh of an element in the file.
struct ReadMesh {
    int node = -1, skin = -1;
    std::vector<float> positions, joints, weights;
    std::vector<std::vector<float>> targets;
};

Result<ExportError> compare(const tinygltf::Model& model, const GltfContent& content, Motion& motion, int& checked, const Progress& progress) {
    std::vector<ReadMesh> meshes(content.surfaces.size());
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
        const auto& node = model.nodes[n];
        if (node.mesh < 0 || !node.extras.IsObject() || !(node.extras.Has(kElementExtra) || node.extras.Has(kPartExtra))) continue;
        const bool part = node.extras.Has(kPartExtra);
        const int number = node.extras.Get(part ? kPartExtra : kElementExtra).GetNumberAsInt();
        const auto& primitives = model.meshes.at(static_cast<std::size_t>(node.mesh)).primitives;
        std::size_t next = 0;  // of a part each surface is a primitive
        for (std::size_t s = 0; s < meshes.size(); ++s) {
            if ((part ? content.surfaces[s].part : content.surfaces[s].element) != number) continue;
            auto& out = meshes[s];
            const auto& primitive = primitives.at(next++);
            out.node = static_cast<int>(n);
            out.skin = node.skin;
            out.positions = numbersOf(model, primitive.attributes.at("POSITION"));
            if (node.skin >= 0) {
                out.joints = numbersOf(model, primitive.attributes.at("JOINTS_0"));
                out.weights = numbersOf(model, primitive.attributes.at("WEIGHTS_0"));
            }
            for (const auto& target : primitive.targets) out.targets.push_back(numbersOf(model, target.at("POSITION")));
        }
    }
    std::vector<Eigen::Affine3d> inverse;
    if (!model.skins.empty()) {
        const auto numbers = numbersOf(model, model.skins[0].inverseBindMatrices);
        for (std::size_t j = 0; 16 * j < numbers.size(); ++j)
            inverse.emplace_back(Eigen::Map<const Eigen::Matrix4f>(numbers.data() + 16 * j).cast<double>());
    }
    // Where the file has the joints and weights of each frame.
    struct Frame {
        std::vector<std::vector<Eigen::Matrix<double, 3, 4>>> moved;  // per mesh: of its node, or of the joints of its skin
        std::vector<std::vector<double>> weights;                     // per mesh
    };
    Player player(model);
    std::vector<Frame> played;
    std::vector<const double*> shapes;
    for (std::size_t c = 0; c < motion.clips.size(); ++c) {
        const auto& clip = motion.clips[c];
        const std::size_t frames = std::min(kFrames, clip.times.size());
        for (std::size_t i = 0; i < frames; ++i) {
            const std::size_t frame = frames > 1 ? i * (clip.times.size() - 1) / (frames - 1) : 0;
            if (c < model.animations.size()) player.play(c, clip.times[frame]);
            shapes.push_back(clip.shapes[frame].data());
            auto& to = played.emplace_back();
            for (std::size_t e = 0; e < meshes.size(); ++e) {
                auto& moved = to.moved.emplace_back();
                if (meshes[e].node < 0) {
                    if (content.surfaces[e].vertices() > 0) throw Unreadable{"an element is missing"};
                    to.weights.emplace_back();
                    continue;
                }
                to.weights.push_back(player.weights(meshes[e].node));
                if (to.weights.back().size() < meshes[e].targets.size()) throw Unreadable{"weights are missing"};
                if (meshes[e].skin < 0) {
                    moved.emplace_back(player.world(meshes[e].node).matrix().topRows<3>());
                } else {
                    const auto& joints = model.skins.at(0).joints;
                    for (std::size_t j = 0; j < joints.size(); ++j) moved.emplace_back((player.world(joints[j]) * inverse.at(j)).matrix().topRows<3>());
                }
            }
        }
    }
    checked = static_cast<int>(played.size());
    IMOMUSHI_TRY(const auto goals, BodyFrames::build(motion, shapes, progress));

    double largest = 0.0, squares = 0.0, points = 0.0;
    std::size_t vertices = 0, done = 0;
    for (const auto& surface : content.surfaces) vertices += surface.vertices();
    for (std::size_t e = 0; e < meshes.size(); ++e) {
        const ReadMesh& mesh = meshes[e];
        const RenderSurface& surface = content.surfaces[e];
        const auto& rows = surface.rows;
        if (rows.empty()) continue;
        if (mesh.positions.size() != 3 * rows.size()) throw Unreadable{"an element is missing"};
        for (const auto& target : mesh.targets)
            if (target.size() != mesh.positions.size()) throw Unreadable{"a target is of another mesh"};
        if (mesh.skin >= 0) {
            const auto joints = static_cast<float>(played.empty() ? 0 : played[0].moved[e].size());
            if (mesh.joints.size() != 4 * rows.size() || mesh.weights.size() != 4 * rows.size() ||
                std::any_of(mesh.joints.begin(), mesh.joints.end(), [&](float j) { return !(j < joints); }))
                throw Unreadable{"a joint is missing"};
        }
        for (std::size_t begun = 0; begun < rows.size(); begun += kVerticesBetweenReports) {
            if (progress.cancelled()) return fail(kCancelled, "The export was cancelled.");
            progress.report("check", static_cast<double>(done + begun) / static_cast<double>(vertices));
            const std::size_t here = std::min(kVerticesBetweenReports, rows.size() - begun);
            std::vector<std::pair<double, double>> missed((here + kCheckPiece - 1) / kCheckPiece);
            parallelFor(hardwareThreads(), here, kCheckPiece, [&](std::size_t begin, std::size_t end) {
                if (progress.cancelled()) return;
                const std::size_t count = end - begin, first = 3 * (begun + begin), size = 3 * count;
                Eigen::MatrixXd goal(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(played.size()));
                std::vector<std::size_t> mover(count);
                for (std::size_t v = 0; v < count; ++v) mover[v] = static_cast<std::size_t>(surface.elements[begun + begin + v]);
                for (std::size_t from = 0, to = 0; from < count; from = to) {
                    while (to < count && mover[to] == mover[from]) ++to;
                    Eigen::MatrixXd some;
                    goals.at(mover[from], {rows.data() + begun + begin + from, to - from}, some);
                    goal.middleRows(static_cast<Eigen::Index>(3 * from), some.rows()) = some;
                }
                Eigen::VectorXd at(static_cast<Eigen::Index>(size));
                auto& miss = missed[begin / kCheckPiece];
                for (std::size_t k = 0; k < played.size(); ++k) {
                    const auto part = [&](const std::vector<float>& numbers) { return Eigen::Map<const Eigen::VectorXf>(numbers.data() + first, at.size()).cast<double>(); };
                    at = part(mesh.positions);
                    for (std::size_t t = 0; t < mesh.targets.size(); ++t)
                        if (const double w = played[k].weights[e][t]; w != 0.0) at += w * part(mesh.targets[t]);
                    const auto& moved = played[k].moved[e];
                    Eigen::Isometry3d frame = goals.frame(mover[0], k);
                    for (std::size_t v = 0; v < count; ++v) {
                        if (v > 0 && mover[v] != mover[v - 1]) frame = goals.frame(mover[v], k);
                        const Vec3 local = at.segment<3>(3 * static_cast<Eigen::Index>(v));
                        const auto place = [&](std::size_t j) -> Vec3 { return moved[j].leftCols<3>() * local + moved[j].col(3); };
                        Vec3 p = Vec3::Zero();
                        if (mesh.skin < 0) p = place(0);
                        for (std::size_t i = 4 * (begun + begin + v); mesh.skin >= 0 && i < 4 * (begun + begin + v) + 4; ++i)
                            if (const float w = mesh.weights[i]; w > 0.0f) p += static_cast<double>(w) * place(static_cast<std::size_t>(mesh.joints[i]));
                        const double d = (p - frame * Vec3(goal.col(static_cast<Eigen::Index>(k)).segment<3>(3 * static_cast<Eigen::Index>(v)))).squaredNorm();
                        miss.first = std::max(miss.first, d);
                        miss.second += d;
                    }
                }
            });
            for (const auto& [most, sum] : missed) largest = std::max(largest, most), squares += sum;
        }
        done += rows.size();
        points += static_cast<double>(rows.size() * played.size());
    }
    if (progress.cancelled()) return fail(kCancelled, "The export was cancelled.");
    return ExportError{std::sqrt(largest) / motion.diagonal, std::sqrt(squares / std::max(points, 1.0)) / motion.diagonal};
}

}  // namespace

Result<ExportError> checkGltf(const std::string& bytes, const GltfContent& content, Motion& motion, int& checked, const Progress& progress) {
    const auto unreadable = [](const std::string& why) {
        return fail("not-readable", "The file that was written could not be read back (" + why + "): it was not kept. Please report this.");
    };
    tinygltf::TinyGLTF reader;
    reader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) { return true; }, nullptr);
    tinygltf::Model model;
    std::string error, warning;
    try {
        if (!reader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<unsigned int>(bytes.size())))
            return unreadable(error);
        return compare(model, content, motion, checked, progress);
    } catch (const Unreadable& reason) {
        return unreadable(reason.why);
    } catch (const std::out_of_range&) {
        return unreadable("an index is out of range");
    }
}

}  // namespace imomushi
