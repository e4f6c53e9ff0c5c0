// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/response_store.h"

#include <new>
#include <utility>

#include "core/project/response_folder.h"

namespace imomushi {

ResponseStore::ResponseStore(Limits limits) : limits_(limits) {}

ResponseStore::ResponseStore(Limits limits, const std::filesystem::path& folder) : limits_(limits), folder_(std::make_unique<ResponseFolder>(folder, limits.disk)) {}

ResponseStore::~ResponseStore() = default;

void ResponseStore::setLimits(const Limits& limits) {
    const std::lock_guard lock(mutex_);
    limits_ = limits;
    evict();
    if (folder_) folder_->setLimit(limits.disk);
}

std::shared_ptr<const ElementResponse> ResponseStore::inMemory(const ContentKey& key) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return nullptr;
    uses_.splice(uses_.end(), uses_, found->second.use);
    return found->second.response;
}

std::shared_ptr<const ElementResponse> ResponseStore::find(const ContentKey& key) {
    const std::lock_guard lock(mutex_);
    return inMemory(key);
}

std::shared_ptr<const ElementResponse> ResponseStore::find(const ContentKey& key, const TriangleMesh& body, std::span<const JointFace> faces) {
    std::unique_lock lock(mutex_);
    for (;;) {
        if (auto known = inMemory(key)) return known;
        if (!folder_) return nullptr;
        if (!reading_.contains(key)) break;
        readEnded_.wait(lock);
    }
    std::shared_ptr<const ElementResponse> read;
    {
        const Reading unlocked(*this, key, lock);
        read = folder_->read(key, body, faces);
    }
    if (!read) return nullptr;
    if (auto known = inMemory(key)) return known;  // inserted meanwhile
    keep(key, read);
    return read;
}

ResponseStore::Reading::Reading(ResponseStore& store, const ContentKey& key, std::unique_lock<std::mutex>& lock)
    : store_(store), key_(store.reading_.insert(key).first), lock_(lock) {
    lock_.unlock();
}

ResponseStore::Reading::~Reading() {
    lock_.lock();
    store_.reading_.erase(key_);
    store_.readEnded_.notify_all();
}

bool ResponseStore::has(const ContentKey& key) const {
    const std::lock_guard lock(mutex_);
    return entries_.contains(key) || (folder_ && folder_->has(key));
}

void ResponseStore::insert(const ContentKey& key, std::shared_ptr<const ElementResponse> response) {
    const std::lock_guard lock(mutex_);
    keep(key, std::move(response));
    revision_.fetch_add(1, std::memory_order_release);
}

void ResponseStore::insertComputed(const ContentKey& key, std::shared_ptr<const ElementResponse> response) {
    if (folder_) folder_->write(key, response);
    insert(key, std::move(response));
}

std::size_t ResponseStore::count() const {
    const std::lock_guard lock(mutex_);
    return entries_.size();
}

std::size_t ResponseStore::bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

void ResponseStore::keep(const ContentKey& key, std::shared_ptr<const ElementResponse> response) {
    const auto use = uses_.insert(uses_.end(), key);
    const auto [found, isNew] = [&] {
        try {
            return entries_.try_emplace(key);
        } catch (const std::bad_alloc&) {
            uses_.erase(use);
            throw;
        }
    }();
    Entry& entry = found->second;
    if (!isNew) uses_.erase(entry.use);
    entry.use = use;
    bytes_ -= entry.bytes;
    entry.response = std::move(response);
    entry.bytes = entry.response->bytes();
    bytes_ += entry.bytes;
    evict();
}

void ResponseStore::evict() {
    for (auto use = uses_.begin(); bytes_ > limits_.memory && use != uses_.end();) {
        const auto found = entries_.find(*use);
        // Who holds one got it from here: a single use is the store's own. Where somebody takes it up again at this moment, it is read again next time, at worst.
        if (found->second.response.use_count() > 1) {
            ++use;
            continue;
        }
        bytes_ -= found->second.bytes;
        entries_.erase(found);
        use = uses_.erase(use);
    }
}

}  // namespace imomushi
