// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/response_folder.h"

#include <algorithm>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "core/document/storage.h"

namespace imomushi {

namespace {

constexpr const char* kSuffix = ".response";

/// The key that a file name says, where it says one.
std::optional<ContentKey> keyNamed(const std::filesystem::path& file) {
    const std::string name = file.stem().string();
    if (file.extension() != kSuffix || name.size() != 32 || name.find_first_not_of("0123456789abcdef") != std::string::npos) return std::nullopt;
    return ContentKey{std::stoull(name.substr(0, 16), nullptr, 16), std::stoull(name.substr(16), nullptr, 16)};
}

/// A project of the one element that a response is of. Its look does not count: triangles are shown as they are.
Project projectOf(const ContentKey& key, const ResponseInput& input, std::shared_ptr<const ElementResponse> response) {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = input.mesh->body;
    for (std::int32_t v = 0; v < mesh->body.vertices.rows(); ++v) mesh->look.bodyVertex.push_back(v);
    mesh->look.triangles = mesh->body.triangles;
    auto element = std::make_shared<Element>();
    element->id = 1;
    element->name = "element";
    element->mesh = std::move(mesh);
    element->faces = input.faces;
    element->nu = input.nu;
    element->solverMesh = input.solverMesh;
    Project project;
    project.document.settings.basis = input.basis;
    project.document.nextId = 2;
    project.document.elements.emplace(element->id, std::move(element));
    project.responses.emplace(1, Project::Response{key, key, std::move(response)});
    return project;
}

}  // namespace

ResponseFolder::ResponseFolder(std::filesystem::path folder, std::uintmax_t limit) : folder_(std::move(folder)), limit_(limit) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
        const auto key = keyNamed(entry.path());
        if (!key) continue;
        std::error_code unknown;
        const File file{entry.file_size(unknown), entry.last_write_time(unknown)};
        if (unknown) continue;
        files_.emplace(*key, file);
        bytes_ += file.bytes;
    }
    evict();
    writer_ = std::thread([this] { work(); });
}

ResponseFolder::~ResponseFolder() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake_.notify_all();
    writer_.join();
}

std::filesystem::path ResponseFolder::pathOf(const ContentKey& key) const { return folder_ / (key.hex() + kSuffix); }

std::shared_ptr<const ElementResponse> ResponseFolder::read(const ContentKey& key) {
    const std::lock_guard lock(mutex_);
    const auto found = files_.find(key);
    if (found == files_.end()) return nullptr;
    auto project = openProject(pathOf(key));
    if (!project || project->responses.size() != 1 || project->responses.begin()->second.key != key) {
        remove(key);
        return nullptr;
    }
    found->second.used = std::filesystem::file_time_type::clock::now();
    std::error_code error;
    std::filesystem::last_write_time(pathOf(key), found->second.used, error);
    return project->responses.begin()->second.response;
}

void ResponseFolder::write(const ContentKey& key, const ResponseInput& input, std::shared_ptr<const ElementResponse> response) {
    {
        const std::lock_guard lock(mutex_);
        if (files_.contains(key)) return;
        jobs_.push_back({key, input, std::move(response)});
    }
    wake_.notify_all();
}

void ResponseFolder::remove(const ContentKey& key) {
    std::error_code error;
    std::filesystem::remove(pathOf(key), error);
    const auto found = files_.find(key);
    bytes_ -= found->second.bytes;
    files_.erase(found);
}

void ResponseFolder::evict() {
    while (bytes_ > limit_)
        remove(std::min_element(files_.begin(), files_.end(), [](const auto& a, const auto& b) { return a.second.used < b.second.used; })->first);
}

void ResponseFolder::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        wake_.wait(lock, [this] { return ending_ || !jobs_.empty(); });
        if (jobs_.empty()) return;
        Job job = std::move(jobs_.front());
        jobs_.pop_front();
        if (files_.contains(job.key)) continue;
        lock.unlock();
        std::error_code error;
        std::filesystem::create_directories(folder_, error);
        const auto path = pathOf(job.key);
        bool written = false;
        try {
            written = saveProject(path, projectOf(job.key, job.input, std::move(job.response))).has_value();
        } catch (const std::bad_alloc&) {  // then without
        }
        const auto bytes = std::filesystem::file_size(path, error);
        lock.lock();
        if (!written || error) continue;
        files_[job.key] = {bytes, std::filesystem::file_time_type::clock::now()};
        bytes_ += bytes;
        evict();
    }
}

}  // namespace imomushi
