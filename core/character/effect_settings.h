// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace imomushi {

struct Frame;
class FrameJobs;
struct ElementTables;

/// What a character is asked to do beyond its pose: the numbers of one effect (model.md section 6) and the job that they become. Each effect derives its
/// own in the header of its job, by EffectOf.
struct EffectSettings {
    std::vector<char> elements;  ///< per element of the character, 0: it does not act there; empty: it acts on all

    EffectSettings() = default;
    EffectSettings(const EffectSettings&) = default;
    EffectSettings& operator=(const EffectSettings&) = default;
    virtual ~EffectSettings() = default;

    [[nodiscard]] bool on(std::size_t element) const { return elements.empty() || (element < elements.size() && elements[element]); }
    /// The name under which statistics tell its time; that of the document.
    [[nodiscard]] virtual std::string_view name() const = 0;
    /// Which rule the numbers break. Errors: "bad-value".
    [[nodiscard]] virtual Result<void> validate() const { return {}; }
    /// Adds the tables and columns that it needs of an element on which it acts (element_runtime.h).
    virtual void ask(ElementTables&) const {}
    /// Adds its job to those of a frame whose joints and elements are built; none where it has nothing to do. Errors: "bad-value".
    [[nodiscard]] virtual Result<void> addJob(Frame& frame, FrameJobs& jobs) const = 0;
};

/// `T` derives from this and has `static constexpr std::string_view kName`.
template <class T>
struct EffectOf : EffectSettings {
    [[nodiscard]] std::string_view name() const final { return T::kName; }
};

/// The same settings as those of effect `T`, null: they are of another effect.
template <class T>
const T* settingsAs(const EffectSettings& settings) {
    return settings.name() == T::kName ? static_cast<const T*>(&settings) : nullptr;
}

/// The effects of a character. Which of them it has, and where, is fixed when it is built; their numbers may change while it moves (Character::tune()).
class CharacterEffects {
public:
    /// Null: it has no such effect.
    template <class T>
    [[nodiscard]] const T* find() const {
        for (const auto& s : all_)
            if (const T* found = settingsAs<T>(*s)) return found;
        return nullptr;
    }
    template <class T>
    [[nodiscard]] bool has() const {
        return find<T>() != nullptr;
    }
    /// Adds an effect, or replaces its settings.
    void set(std::shared_ptr<const EffectSettings> settings) {
        erase(settings->name());
        all_.push_back(std::move(settings));
    }
    template <std::derived_from<EffectSettings> T>
    void set(T settings) {
        set(std::shared_ptr<const EffectSettings>(std::make_shared<const T>(std::move(settings))));
    }
    template <class T>
    void erase() {
        erase(T::kName);
    }

    [[nodiscard]] auto begin() const { return all_.begin(); }
    [[nodiscard]] auto end() const { return all_.end(); }

private:
    void erase(std::string_view name) {
        std::erase_if(all_, [name](const auto& s) { return s->name() == name; });
    }
    std::vector<std::shared_ptr<const EffectSettings>> all_;
};

}  // namespace imomushi
