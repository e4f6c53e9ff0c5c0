// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <future>
#include <memory>

#include "ui/picking/cut_preview.h"

namespace imomushi {

/// The sections of the body that a tool works on. Those of a large body are made beside the window. Belongs to the GUI thread.
class LazySections {
public:
    /// `ready`: called when sections are there that were not when somebody asked for them.
    explicit LazySections(std::function<void()> ready) : ready_(std::make_shared<std::function<void()>>(std::move(ready))) {}

    /// Of the body that `owner` has. Null: they are being made, and ready() follows; never where `wait`, for whoever wants them now.
    std::shared_ptr<const SectionFinder> of(const std::shared_ptr<const void>& owner, const TriangleMesh& body, bool wait = false);

private:
    std::shared_ptr<std::function<void()>> ready_;
    std::shared_ptr<const void> owner_;
    std::shared_future<std::shared_ptr<const SectionFinder>> made_;  ///< of owner_
};

}  // namespace imomushi
