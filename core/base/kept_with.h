// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>

namespace imomushi {

/// What is made of each object of a kind once, and kept while the object lives. Any thread may ask; the first one makes it, and others wait for that.
template <class Of, class Made>
class KeptWith {
public:
    template <class Make>
    std::shared_ptr<const Made> of(const std::shared_ptr<const Of>& object, const Make& make) {
        std::shared_ptr<Kept> kept;
        {
            const std::lock_guard lock(mutex_);
            std::erase_if(all_, [](const auto& entry) { return entry.second->object.expired(); });
            std::shared_ptr<Kept>& known = all_[object.get()];
            if (!known) known = std::make_shared<Kept>(object);
            kept = known;
        }
        std::call_once(kept->once, [&] { kept->made.emplace(make()); });
        return {kept, &*kept->made};
    }

private:
    struct Kept {
        explicit Kept(const std::shared_ptr<const Of>& of) : object(of) {}
        std::weak_ptr<const Of> object;
        std::once_flag once;
        std::optional<Made> made;
    };
    std::mutex mutex_;
    std::map<const Of*, std::shared_ptr<Kept>> all_;
};

}  // namespace imomushi
