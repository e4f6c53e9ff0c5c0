// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/response_folder.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "core/base/abandoned_files.h"
#include "core/base/atomic_file.h"
#include "core/base/try.h"
#include "core/project/packed_response.h"

namespace imomushi {

namespace {

constexpr const char* kResponseSuffix = ".response";

/// The key that a file name says, where it says one.
std::optional<ContentKey> keyNamed(const std::filesystem::path& file) {
    const std::string name = file.stem().string();
    if (file.extension() != kResponseSuffix || name.size() != 32 || name.find_first_not_of("0123456789abcdef") != std::string::npos) return std::nullopt;
    return ContentKey{std::stoull(name.substr(0, 16), nullptr, 16), std::stoull(name.substr(16), nullptr, 16)};
}

/// What a file holds. Errors: those of packResponse().
Result<std::string> contentOf(const ContentKey& key, const ElementResponse& response) {
    IMOMUSHI_TRY(const auto packed, packResponse(response));
    return key.hex().append(reinterpret_cast<const char*>(packed.data()), packed.size());
}

/// The content of a file. Nullopt: the system does not read it now.
std::optional<std::string> contentOf(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return std::nullopt;
    stream.exceptions(std::ios::badbit);  // also what is thrown while it is read: memory that runs out
    try {
        return std::string(std::istreambuf_iterator<char>(stream), {});
    } catch (const std::ios::failure&) {
        return std::nullopt;
    }
}

/// Errors: "damaged": it holds no such response; "not-readable".
Result<ElementResponse> responseIn(const std::string& content, const ContentKey& key, const TriangleMesh& body, std::span<const JointFace> faces) {
    const std::string name = key.hex();
    if (!content.starts_with(name)) return fail("damaged", "It holds another response.");
    return unpackResponse(std::as_bytes(std::span(content)).subspan(name.size()), body, faces);
}

}  // namespace

ResponseFolder::ResponseFolder(std::filesystem::path folder, std::uintmax_t limit) : folder_(std::move(folder)), limit_(limit) {
    removeAbandonedFiles(folder_);
    std::error_code error;
    for (std::filesystem::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
        const auto key = keyNamed(entry->path());
        std::error_code unknown;
        if (!key || !entry->is_regular_file(unknown)) continue;
        const std::uintmax_t bytes = entry->file_size(unknown);
        if (unknown) continue;
        const auto used = entry->last_write_time(unknown);
        if (unknown) continue;
        files_.emplace(*key, File{bytes, used});
        bytes_ += bytes;
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

void ResponseFolder::setLimit(std::uintmax_t limit) {
    const std::lock_guard lock(mutex_);
    limit_ = limit;
    evict();
}

std::filesystem::path ResponseFolder::pathOf(const ContentKey& key) const { return folder_ / (key.hex() + kResponseSuffix); }

std::shared_ptr<const ElementResponse> ResponseFolder::read(const ContentKey& key, const TriangleMesh& body, std::span<const JointFace> faces) {
    if (!has(key)) return nullptr;
    const auto path = pathOf(key);
    const auto content = contentOf(path);
    auto response = content ? responseIn(*content, key, body, faces) : fail("not-readable", "It cannot be read.");
    std::error_code error;
    const bool gone = !std::filesystem::exists(path, error) && !error;
    if (!response && !gone && response.error().code != "damaged") return nullptr;
    const std::lock_guard lock(mutex_);
    if (!response) {
        remove(key);
        return nullptr;
    }
    if (const auto found = files_.find(key); found != files_.end()) {
        found->second.used = std::filesystem::file_time_type::clock::now();
        std::filesystem::last_write_time(path, found->second.used, error);
    }
    return std::make_shared<const ElementResponse>(std::move(*response));
}

bool ResponseFolder::has(const ContentKey& key) {
    const std::lock_guard lock(mutex_);
    return files_.contains(key);
}

void ResponseFolder::write(const ContentKey& key, std::shared_ptr<const ElementResponse> response) {
    {
        const std::lock_guard lock(mutex_);
        if (files_.contains(key)) return;
        jobs_.push_back({key, std::move(response)});
    }
    wake_.notify_all();
}

void ResponseFolder::remove(const ContentKey& key) {
    std::error_code error;
    std::filesystem::remove(pathOf(key), error);
    const auto found = files_.find(key);
    if (found == files_.end()) return;
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
        std::uintmax_t bytes = 0;
        try {
            std::error_code error;
            std::filesystem::create_directories(folder_, error);
            const auto path = pathOf(job.key);
            if (const auto content = contentOf(job.key, *job.response); content && writeFileAtomically(path, *content)) bytes = content->size();
        } catch (const std::bad_alloc&) {  // then without
        }
        job.response.reset();
        lock.lock();
        if (bytes == 0) continue;
        try {
            files_[job.key] = {bytes, std::filesystem::file_time_type::clock::now()};
            bytes_ += bytes;
            evict();
        } catch (const std::bad_alloc&) {  // it is found at the next start, and others go with the next one
        }
    }
}

}  // namespace imomushi
