// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace imomushi {

/// Lines of a script as text, each with its end: hours of dragging are some ten times smaller so than as values. They are kept in parts, so that a performance whose script is long does
/// not wait until all of it has moved to a larger place.
class ScriptLines {
public:
    ScriptLines() = default;
    explicit ScriptLines(std::string lines) { add(std::move(lines)); }

    /// Whole lines. If it throws, nothing was added.
    void add(std::string lines) {
        if (lines.empty()) return;
        const std::size_t size = lines.size();
        if (!parts_.empty() && parts_.back().size() + size <= kPart)
            parts_.back() += lines;
        else
            parts_.push_back(std::move(lines));
        size_ += size;
    }
    /// Where there is room for all of its parts, nothing fails.
    void add(ScriptLines&& more) {
        makeRoom(more.parts_.size());
        std::move(more.parts_.begin(), more.parts_.end(), std::back_inserter(parts_));
        size_ += more.size_;
        more.clear();
    }
    void makeRoom(std::size_t parts) {
        if (const std::size_t all = parts_.size() + parts; all > parts_.capacity()) parts_.reserve(std::max(all, 2 * parts_.size()));
    }
    void clear() { *this = {}; }

    [[nodiscard]] std::size_t size() const { return size_; }  ///< bytes
    [[nodiscard]] const std::vector<std::string>& parts() const { return parts_; }

private:
    static constexpr std::size_t kPart = std::size_t{1} << 20;  // so large that the system has it back at once where a script is dropped
    std::vector<std::string> parts_;
    std::size_t size_ = 0;
};

}  // namespace imomushi
