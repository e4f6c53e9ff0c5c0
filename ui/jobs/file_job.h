// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "core/document/command.h"
#include "core/project/project_versions.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

struct BuiltCharacter;

/// Reads or writes a project file in the background, for a command to take over. The window goes on drawing meanwhile and takes no input: what is written is the
/// document, and what is read takes its place.
class FileJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    /// As loadProject() and storeProject(); they return when that is done, or has failed by an exception, and are not called while one of them waits.
    void read(const CommandRegistry& registry, const std::filesystem::path& path, std::optional<std::int64_t> version);
    void write(const std::filesystem::path& path, Project project, const VersionLimits& limits);
    /// Called on the other thread with the document that was read: what would be made when somebody first asks is made there.
    void setAfterwards(std::function<void(const Document&)> afterwards) { afterwards_ = std::move(afterwards); }

    /// What the last one read, once; none: something else.
    [[nodiscard]] std::optional<Result<Project>> takeRead(const std::filesystem::path& path, std::optional<std::int64_t> version);
    /// Its character, once; null: there is none.
    [[nodiscard]] std::shared_ptr<const BuiltCharacter> takeCharacter() { return std::move(character_); }
    /// What the last one wrote, once; none: something else, or another project than it is now.
    [[nodiscard]] std::optional<Result<SavedProject>> takeWritten(const std::filesystem::path& path, const Project& now);

signals:
    void takesTime();  ///< longer than a person waits without being told

private:
    void wait();

    std::function<void(const Document&)> afterwards_;
    std::filesystem::path path_;
    std::optional<std::int64_t> version_;
    std::shared_ptr<const Project> project_;  // that was written
    std::optional<Result<Project>> read_;
    std::shared_ptr<const BuiltCharacter> character_;  // of read_
    std::optional<Result<SavedProject>> written_;
};

}  // namespace imomushi
