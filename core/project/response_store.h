// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>

#include "core/base/hash.h"
#include "core/reduction/element_response.h"

namespace imomushi {

class ResponseFolder;

/// Precomputed responses by content key: in memory, and where a folder is given on disk too. Sessions of one process may share one, and projects share a folder.
/// Never undone: undo asks for another key. Thread-safe.
class ResponseStore {
public:
    struct Limits {
        std::size_t memory = std::size_t{4} << 30;        ///< bytes. Responses that somebody holds stay, even beyond it
        std::uintmax_t disk = std::uintmax_t{8} << 30;    ///< bytes of the folder
    };
    /// In memory alone.
    ResponseStore() : ResponseStore(Limits{}) {}
    explicit ResponseStore(Limits limits);
    /// `folder` is made when needed; see ResponseFolder.
    ResponseStore(Limits limits, const std::filesystem::path& folder);
    ~ResponseStore();
    /// At once: what is over them goes, least recently used first.
    void setLimits(const Limits& limits);
    ResponseStore(const ResponseStore&) = delete;
    ResponseStore& operator=(const ResponseStore&) = delete;

    /// In memory; null: not there.
    [[nodiscard]] std::shared_ptr<const ElementResponse> find(const ContentKey& key);
    /// In memory or on disk; null: in neither. `body`, `faces`: of an element with this key. While a file is read only who asks for the same key waits.
    [[nodiscard]] std::shared_ptr<const ElementResponse> find(const ContentKey& key, const TriangleMesh& body, std::span<const JointFace> faces);
    /// In memory or on disk, without reading it.
    [[nodiscard]] bool has(const ContentKey& key) const;
    /// Into memory alone: what a project file holds has its place there.
    void insert(const ContentKey& key, std::shared_ptr<const ElementResponse> response);
    /// Into the folder too, in the background.
    void insertComputed(const ContentKey& key, std::shared_ptr<const ElementResponse> response);

    /// Rises with every insertion.
    [[nodiscard]] std::uint64_t revision() const { return revision_.load(std::memory_order_acquire); }
    [[nodiscard]] std::size_t count() const;  ///< in memory
    [[nodiscard]] std::size_t bytes() const;  ///< in memory

private:
    struct Entry {
        std::shared_ptr<const ElementResponse> response;
        std::size_t bytes = 0;
        std::list<ContentKey>::iterator use;
    };
    /// While it lives a key is being read, and the lock is open.
    class Reading {
    public:
        Reading(ResponseStore& store, const ContentKey& key, std::unique_lock<std::mutex>& lock);
        ~Reading();
        Reading(const Reading&) = delete;
        Reading& operator=(const Reading&) = delete;

    private:
        ResponseStore& store_;
        std::set<ContentKey>::iterator key_;
        std::unique_lock<std::mutex>& lock_;
    };
    // These three under the lock.
    std::shared_ptr<const ElementResponse> inMemory(const ContentKey& key);
    void keep(const ContentKey& key, std::shared_ptr<const ElementResponse> response);
    void evict();

    mutable std::mutex mutex_;
    Limits limits_;
    std::map<ContentKey, Entry> entries_;
    std::list<ContentKey> uses_;  // least recently used first
    std::size_t bytes_ = 0;
    std::set<ContentKey> reading_;
    std::condition_variable readEnded_;
    std::atomic<std::uint64_t> revision_ = 0;
    std::unique_ptr<ResponseFolder> folder_;
};

}  // namespace imomushi
