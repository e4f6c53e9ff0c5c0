// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <thread>

#include "core/base/hash.h"
#include "core/reduction/element_response.h"

namespace imomushi {

/// Responses on disk, a file KEY.response per content key: the key and a packed response, which holds its digest. A file appears whole or not at all. One that is
/// damaged, or holds another key than its name says, counts as absent and is removed; one that cannot be read now counts as absent and stays; files of other names are left alone. Beyond the limit the files that were
/// used longest ago are removed. Failures to write are no errors: the response is computed again next time. Thread-safe.
class ResponseFolder {
public:
    /// `limit`: bytes of all files together. Knows the files that are there now, and its own.
    ResponseFolder(std::filesystem::path folder, std::uintmax_t limit);
    /// Waits for what is being written.
    ~ResponseFolder();
    void setLimit(std::uintmax_t limit);
    ResponseFolder(const ResponseFolder&) = delete;
    ResponseFolder& operator=(const ResponseFolder&) = delete;

    /// Null: absent. `body`, `faces`: of an element with this key. Nobody else waits for it. Throws std::bad_alloc.
    [[nodiscard]] std::shared_ptr<const ElementResponse> read(const ContentKey& key, const TriangleMesh& body, std::span<const JointFace> faces);
    /// Without reading the file.
    [[nodiscard]] bool has(const ContentKey& key);
    /// In the background, in the order of the calls. Nothing where the key is there already.
    void write(const ContentKey& key, std::shared_ptr<const ElementResponse> response);

private:
    struct File {
        std::uintmax_t bytes = 0;
        std::filesystem::file_time_type used;
    };
    struct Job {
        ContentKey key;
        std::shared_ptr<const ElementResponse> response;
    };
    [[nodiscard]] std::filesystem::path pathOf(const ContentKey& key) const;
    void remove(const ContentKey& key);  // these two under the lock; nothing where it is not there
    void evict();
    void work();

    const std::filesystem::path folder_;
    std::mutex mutex_;
    std::uintmax_t limit_;
    std::condition_variable wake_;
    std::map<ContentKey, File> files_;
    std::uintmax_t bytes_ = 0;
    std::deque<Job> jobs_;
    bool ending_ = false;
    std::thread writer_;
};

}  // namespace imomushi
